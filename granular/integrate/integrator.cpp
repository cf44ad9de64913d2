#include "granular/integrate/integrator.h"

#include <array>
#include <string>

#include "granular/core/errors.h"
#include "granular/core/open_table.h"
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
constexpr RotationScheme rowOf(std::string_view name) {
  return {name, start<Scheme>, predict<Scheme>, advance<Scheme>};
}

// The table of schemes: one row per scheme, in the order of SchemeKind.
constexpr std::array<RotationScheme, 2> ownSchemes = {{
    rowOf<Seelen>("seelen"),
    rowOf<Spiral>("spiral"),
}};
constinit OpenTable<RotationScheme, SchemeKind> schemes("integration scheme", ownSchemes);

}  // namespace

const RotationScheme& rotationScheme(SchemeKind kind) { return schemes[kind]; }

SchemeKind schemeFromName(std::string_view name) { return schemes.find(name); }

std::vector<std::string_view> schemeNames() { return schemes.names(); }

SchemeKind addScheme(const RotationScheme& row) {
  require(row.start && row.predict && row.advance, "integration scheme \"" + std::string(row.name) +
                                                       "\": its row needs the functions start, predict and advance");
  return schemes.add(row);
}

}  // namespace granular
