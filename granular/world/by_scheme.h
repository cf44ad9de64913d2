// Bodies that move, visited with the scheme by which they turn: as many side by side as a register holds numbers.
#pragma once

#include "granular/body/lanes.h"
#include "granular/integrate/seelen.h"
#include "granular/integrate/spiral.h"
#include "granular/world/stages.h"

namespace granular {

/// A bound on the way in a step of any surface point: no further than the centre's plus the turn of the outermost one.
template <class Real>
Real wayOfSurface(double dt, const Triple<Real>& vHalf, const Real& radius, const Triple<Real>& wHalf,
                  const Triple<Real>& w) {
  return dt * (vHalf.norm() + radius * squareRoot(larger(wHalf.dot(wHalf), w.dot(w))));
}

/// Square of a bound on the speed of the surface, m^2/s^2.
template <class Real>
Real squareSpeed(const Triple<Real>& v, const Triple<Real>& w, const Real& radius) {
  return v.dot(v) + w.dot(w) * radius * radius;
}

/// Writes the state at t_{n+1} of bodies that turn by a scheme.
template <class Place, class Real = typename Place::Real>
void writeState(const SphereOf<Real>& sphere, const Triple<Real>& v, const Turn<Real>& turn,
                const MotionAtHalf<Real>& half, const Place& place, Bodies& bodies) {
  place.write(sphere, bodies.bounds);
  place.writeNow(v, turn.w, bodies.motion);
  place.writeHalf(half, bodies.motion);
  place.write(turn.q, bodies.q);
  place.write(turn.q, sphere.x, bodies.frame);
}

/// How balls lie at t_{n+1}, for those who ask.
template <class Place>
void turnBalls(double dt, const Place& place, Bodies& bodies) {
  using Real = typename Place::Real;
  Quadruple<Real> q = rotateByStep(dt * place.read(bodies.motion, &MotionRow::spinHalf)) * place.read(bodies.q);
  keepUnit(q);
  place.write(q, bodies.q);
  place.write(q, bodies.qHalf);
  place.write(q, place.read(bodies.bounds).x, bodies.frame);
}

/// A row of the table as a scheme, for one body at a time.
struct SchemeOfRow {
  const RotationScheme& row;

  Turn<double> predictRotation(double dt, const HalfTurn<double>& half) const {
    Quat q;
    Vec3 w;
    row.predict(dt, toQuat(half.q), toVec3(half.w), toVec3(half.alpha), q, w);
    return {toQuadruple(q), toTriple(w)};
  }
  void advanceRotation(double dt, const Moments<double>& moments, const Triple<double>& torque, const Turn<double>& now,
                       HalfTurn<double>& half) const {
    Quat q = toQuat(half.q);
    Vec3 w = toVec3(half.w), alpha = toVec3(half.alpha);
    row.advance(dt, toVec3(moments.inertia), toVec3(moments.inverseInertia), toVec3(torque), toQuat(now.q),
                toVec3(now.w), {q, w, alpha});
    half = {toQuadruple(q), toTriple(w), toTriple(alpha)};
  }
};

/// Calls visit(scheme, place) for the places of these bodies, which turn by a scheme: whole registers of them, and
/// those left over one by one; all one by one for a scheme of the user's own.
template <class Visitor>
void visitByScheme(const WorldOptions& options, const std::vector<std::int32_t>& moving, const Visitor& visit) {
  const bool worthwhile = moving.size() >= bodiesForThreads;
  const auto visitAll = [&](const auto& scheme) {
    visitBodies(moving, options.noBatches, worthwhile, [&](const auto& place) { visit(scheme, place); });
  };
  switch (options.integrator) {
    case SchemeKind::seelen:
      return visitAll(Seelen{});
    case SchemeKind::spiral:
      return visitAll(Spiral{});
    default:
      const SchemeOfRow scheme{rotationScheme(options.integrator)};
      shareOutEvenly(moving.size(), worthwhile,
                     [&](std::size_t k) { visit(scheme, OneBody(static_cast<std::size_t>(moving[k]))); });
  }
}

/// Calls visit(place) for the places of these balls.
template <class Visitor>
void visitBalls(const WorldOptions& options, const std::vector<std::int32_t>& balls, const Visitor& visit) {
  visitBodies(balls, options.noBatches, balls.size() >= bodiesForThreads, visit);
}

}  // namespace granular
