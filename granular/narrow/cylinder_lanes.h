// The warm looks at two cylinders, a side across a side, a rim on a side and a rim in a cap, as newton.h takes them one
// by one: here for as many pairs as a register holds.
#pragma once

#include "granular/core/placed_axes.h"
#include "granular/narrow/lane_look.h"
#include "granular/narrow/newton.h"
#include "granular/narrow/polyhedron_features.h"

namespace granular {

/// Two cylinders; of each pair one is the seat. World axes, m.
template <class Real>
struct CylinderPair {
  Triple<Real> seatAxis, guestAxis;  ///< unit
  Triple<Real> between;              ///< from the seat's centre to the guest's
  Triple<Real> last;                 ///< the last normal, out of the seat
  Real seatRadius, seatHalf, guestRadius, guestHalf;
  Real seatEnd, guestEnd;  ///< which cap or rim touches: 1 the upper, -1 the lower; of no account for sides
  Real inner;              ///< sum of the inner radii
  Real extent;             ///< largest length that enters a support point
};

/// The point of the guest's rim that lies deepest along -n, and its makings.
template <class Real>
struct RimPoint {
  Real cosine;          ///< of the guest's axis to n
  Real sine;            ///< of the angle between them
  Triple<Real> point;   ///< from the seat's centre, m
  Mask<Real> supports;  ///< the guest's other rim and the middle of its cap are less deep

  RimPoint(const CylinderPair<Real>& p, const Triple<Real>& n) : cosine(n.dot(p.guestAxis)) {
    // Twice: over a cap that lies flat what round-off leaves along the axis is not small beside the rest.
    const Triple<Real> once = n - cosine * p.guestAxis, across = once - once.dot(p.guestAxis) * p.guestAxis;
    sine = across.norm();
    const Mask<Real> tilted = sine > 1e-9;
    const Real reach = p.guestRadius / choose(tilted, sine, Real(Real{} + 1));
    point = p.between + Real(p.guestEnd * p.guestHalf) * p.guestAxis - reach * across;
    supports = both(tilted, p.guestEnd * cosine < 0);
  }
};

/// Newton's steps before a pair is left to newton.h.
inline constexpr int mostLaneSteps = 4;

/// Side across side: the normal is across both axes, x runs along the seat's.
template <class Real>
LaneLook<Real> lookAtSides(const CylinderPair<Real>& p) {
  LaneLook<Real> look;
  const Triple<Real>&s = p.seatAxis, &g = p.guestAxis;
  const Triple<Real> c = s.cross(g);
  const Real cc = c.dot(c), one = Real{} + 1;
  const Mask<Real> crosses = cc > leastLaneSine2;
  const Real inverse = 1 / choose(crosses, cc, one), sine = squareRoot(choose(crosses, cc, one));
  const Triple<Real> n = Real(signOf(c.dot(p.last)) / sine) * c, turn = n - p.last;

  // The points of the axes nearest to each other.
  const Real cosine = s.dot(g), alongS = p.between.dot(s), alongG = p.between.dot(g);
  const Real onSeat = inverse * (alongS - cosine * alongG), onGuest = inverse * (cosine * alongS - alongG);
  const Real inside = smaller(Real(p.seatHalf - magnitude(onSeat)), Real(p.guestHalf - magnitude(onGuest)));
  look.holds = both(both(crosses, turn.dot(turn) < longestNewtonStep * longestNewtonStep), inside >= 0);
  look.depth = p.seatRadius + p.guestRadius - p.between.dot(n);
  look.middle = 0.5 * (onSeat * s + Real(p.seatRadius - p.guestRadius) * n + p.between + onGuest * g);
  look.x = s;
  look.y = n.cross(s);
  look.z = n;
  look.proven = isGlobal(look.z, look.depth, Real(inside * sine), p.between, p.inner);
  return look;
}

/// Where Newton's method begins if the guest's cap lies nearly flat on the seat's side (startOnFlatCap in newton.cpp);
/// otherwise the last normal. sigma: cosine between the axes.
template <class Real>
Triple<Real> startOnFlatCap(const CylinderPair<Real>& p, const Real& sigma) {
  const Real cosine = p.last.dot(p.guestAxis), one = Real{} + 1;
  const Triple<Real> across = unit(signOf(cosine) * (p.guestAxis - sigma * p.seatAxis)),
                     side = across.cross(p.seatAxis);
  const Real q = side.dot(p.between + Real(p.guestEnd * p.guestHalf) * p.guestAxis);
  const Mask<Real> flat = both(magnitude(cosine) > 1 - 0.5 * flatCap * flatCap, magnitude(q) < p.guestRadius);
  const Real chord = squareRoot(choose(flat, Real((p.guestRadius - q) * (p.guestRadius + q)), one));
  return choose<Real>(flat, unit(across + Real(magnitude(sigma) * q / chord) * side), p.last);
}

/// The guest's rim on the seat's side: Newton's method along the circle of directions across the seat's axis, along
/// which x runs. With t = axis x n the depth has the slope -t . point and the second derivative n . point + R sigma^2 /
/// sine^3 with sigma the cosine between the axes. No part of C proves such a minimum the global one.
template <class Real>
LaneLook<Real> lookAtRimOnSide(const CylinderPair<Real>& p) {
  LaneLook<Real> look;
  const Triple<Real>& s = p.seatAxis;
  const Real one = Real{} + 1, sigma = s.dot(p.guestAxis);
  const Triple<Real> from = choose<Real>(sigma * sigma < flatCap * flatCap, startOnFlatCap(p, sigma), p.last);
  const Real ahead = from.dot(s);
  const Triple<Real> start = from - ahead * s;
  const Real length = start.norm();
  Mask<Real> holds = both(magnitude(ahead) < longestNewtonStep, length > longestNewtonStep);
  Triple<Real> n = Real(1 / choose(holds, length, one)) * start;
  const Mask<Real> none = one < 0;
  Mask<Real> arrived = none;
  for (int k = 0; k < mostLaneSteps && any(both(holds, arrived == none)); ++k) {
    const RimPoint<Real> rim(p, n);
    const Triple<Real> t = s.cross(n);
    const Real sine = choose(rim.supports, rim.sine, one);
    const Real bend = n.dot(rim.point) + p.guestRadius * sigma * sigma / (sine * sine * sine);
    const Mask<Real> bends = both(rim.supports, bend > 0);
    const Real turn = t.dot(rim.point) / choose(bends, bend, one);
    holds = both(holds, either(arrived, both(bends, magnitude(turn) < longestNewtonStep)));
    // Those that have arrived stay: what a pair gets does not depend on others.
    const Triple<Real> next = unit(n + turn * t);
    n = choose<Real>(arrived, n, next);
    arrived = either(arrived, magnitude(turn) < lastNewtonStep);
  }

  const RimPoint<Real> rim(p, n);
  const Real onSeat = rim.point.dot(s), off = magnitude(s.cross(n).dot(rim.point));
  const Real sine = choose(rim.supports, rim.sine, one);
  const Real bend = p.seatRadius + p.guestRadius * sigma * sigma / (sine * sine * sine);
  const Mask<Real> curved = both(bend < flattestPiece * p.extent, off <= slopeOfRoundOff * bend);
  const Mask<Real> stationary = either(off <= slopeOfRoundOff * p.extent, curved);
  look.holds = both(both(holds, arrived), both(stationary, both(rim.supports, magnitude(onSeat) <= p.seatHalf)));
  look.depth = p.seatRadius - n.dot(rim.point);
  look.middle = 0.5 * (onSeat * s + p.seatRadius * n + rim.point);
  look.x = s;
  look.y = n.cross(s);
  look.z = n;
  look.proven = none;
  return look;
}

/// The guest's rim in the seat's cap.
template <class Real>
LaneLook<Real> lookAtRimInCap(const CylinderPair<Real>& p) {
  LaneLook<Real> look;
  const Triple<Real> n = p.seatEnd * p.seatAxis;
  const RimPoint<Real> rim(p, n);
  const Real height = n.dot(rim.point);
  const Real margin = p.seatRadius - (rim.point - height * n).norm();
  look.holds = both(rim.supports, margin > 0);
  look.depth = p.seatHalf - height;
  look.middle = rim.point + Real(0.5 * look.depth) * n;
  look.x = tangentOf(n);
  look.y = n.cross(look.x);
  look.z = n;
  look.proven = isGlobal(look.z, look.depth, margin, p.between, p.inner);
  return look;
}

}  // namespace granular
