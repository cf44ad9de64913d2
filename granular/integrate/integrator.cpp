#include "granular/integrate/integrator.h"

#include <array>
#include <string>

#include "granular/core/errors.h"
#include "granular/integrate/seelen.h"
#include "granular/integrate/spiral.h"

namespace granular {
namespace {

// A scheme's functions for one body alone.
template <class Scheme>
void start(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Quat& q, const Vec3& w,
           RotationMemory memory) {
  const Moments<double> moments{toTriple(inertia), toTriple(inverseInertia)};
  const Turn<double> now{toQuadruple(q), toTriple(w)};
  const HalfTurn<double> half = Scheme::startRotation(dt, moments, toTriple(torque), now);
  memory.qHalf = toQuat(half.q);
  memory.wHalf = toVec3(half.w);
  memory.alpha = toVec3(half.alpha);
}

template <class Scheme>
void predict(double dt, const Quat& qHalf, const Vec3& wHalf, const Vec3& alpha, Quat& q, Vec3& w) {
  const HalfTurn<double> half{toQuadruple(qHalf), toTriple(wHalf), toTriple(alpha)};
  const Turn<double> next = Scheme::predictRotation(dt, half);
  q = toQuat(next.q);
  w = toVec3(next.w);
}

template <class Scheme>
void advance(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Quat& q,
             const Vec3& w, RotationMemory memory) {
  const Moments<double> moments{toTriple(inertia), toTriple(inverseInertia)};
  const Turn<double> now{toQuadruple(q), toTriple(w)};
  HalfTurn<double> half{toQuadruple(memory.qHalf), toTriple(memory.wHalf), toTriple(memory.alpha)};
  Scheme::advanceRotation(dt, moments, toTriple(torque), now, half);
  memory.qHalf = toQuat(half.q);
  memory.wHalf = toVec3(half.w);
  memory.alpha = toVec3(half.alpha);
}

template <class Scheme>
constexpr RotationScheme rowOf(SchemeKind kind, std::string_view name) {
  return {kind, name, start<Scheme>, predict<Scheme>, advance<Scheme>};
}

// The table of schemes: one row per scheme, in the order of SchemeKind.
constexpr std::array<RotationScheme, 2> schemes = {{
    rowOf<Seelen>(SchemeKind::seelen, "seelen"),
    rowOf<Spiral>(SchemeKind::spiral, "spiral"),
}};

}  // namespace

const RotationScheme& rotationScheme(SchemeKind kind) { return schemes[static_cast<std::size_t>(kind)]; }

SchemeKind schemeFromName(std::string_view name) {
  for (const RotationScheme& row : schemes) {
    if (row.name == name) return row.kind;
  }
  std::string known;
  for (const RotationScheme& row : schemes) known += " \"" + std::string(row.name) + "\"";
  throw InputError("unknown integration scheme \"" + std::string(name) + "\"; known:" + known);
}

}  // namespace granular
