// Two ellipsoids: two steps of Newton's method on the unit normal, for one pair or for many side by side (core/wide.h).
//
// With the support function H(n) = |D n|, D the semi-axes, the point of C = A - B below n is the gradient
// x = grad H_A + grad H_B - t, the depth is h = n . x, its gradient on the unit sphere is P x with P = 1 - n n^T, and
// its Hessian P (H_A'' + H_B'') P - h. Near the minimum each step doubles the digits.
#pragma once

#include <type_traits>

#include "granular/core/placed_axes.h"

namespace granular {

/// Semi-axes, and B's frame in A's axes: its columns and its centre.
template <class Real>
struct EllipsoidPair {
  Triple<Real> axesA, axesB;
  Triple<Real> column0, column1, column2, x;
  Real ratio;     ///< the largest of the axes' ratios
  Real roundOff;  ///< slopes below it are 0, m

  EllipsoidPair(const Triple<Real>& semiAxesA, const PlacedAxes<Real>& a, const Triple<Real>& semiAxesB,
                const PlacedAxes<Real>& b, const Real& largestRatio, const Real& smallestSlope)
      : axesA(semiAxesA),
        axesB(semiAxesB),
        column0(a.unrotate(b.column0)),
        column1(a.unrotate(b.column1)),
        column2(a.unrotate(b.column2)),
        x(a.unrotate(b.x - a.x)),
        ratio(largestRatio),
        roundOff(smallestSlope) {}

  Triple<Real> rotate(const Triple<Real>& v) const { return v.x * column0 + v.y * column1 + v.z * column2; }
  Triple<Real> unrotate(const Triple<Real>& v) const { return {column0.dot(v), column1.dot(v), column2.dot(v)}; }
};

/// Support point of H(n) = |D n| in the ellipsoid's own axes; its second derivatives are (D^2 - point point^T) / H.
template <class Real>
struct CurvedSupport {
  Triple<Real> point;
  Real height, inverse;  ///< H, 1/H

  CurvedSupport(const Triple<Real>& d, const Triple<Real>& n) {
    const Triple<Real> stretched = d.times(n);
    height = stretched.norm();
    inverse = 1 / height;
    point = inverse * d.times(stretched);
  }
  /// How the support point moves with n along s, in the ellipsoid's own axes: the second derivatives times s.
  Triple<Real> follow(const Triple<Real>& d, const Triple<Real>& s) const {
    return inverse * (d.times(d).times(s) - point.dot(s) * point);
  }
};

/// One evaluation along n, A's axes.
template <class Real>
struct EllipsoidDepth {
  CurvedSupport<Real> a, b;
  Triple<Real> normal, onA, onB, slope;  ///< slope: P x
  Real depth;

  EllipsoidDepth(const EllipsoidPair<Real>& pair, const Triple<Real>& n)
      : a(pair.axesA, n), b(pair.axesB, pair.unrotate(n)), normal(n) {
    onA = a.point;
    onB = pair.x - pair.rotate(b.point);
    const Triple<Real> between = onA - onB;
    depth = a.height + b.height - pair.x.dot(n);
    slope = between - between.dot(n) * n;
  }
};

/// Newton's steps in the tangent plane at an evaluation; valid only where the Hessian is positive definite.
template <class Real>
struct NewtonPlane {
  Triple<Real> u, v;
  Real uu, uv, vv;  ///< of the inverse Hessian
  Mask<Real> valid;

  NewtonPlane(const EllipsoidPair<Real>& pair, const EllipsoidDepth<Real>& e) {
    const Triple<Real>& n = e.normal;
    u = tangentOf(n);
    v = n.cross(u);
    const Triple<Real> uB = pair.unrotate(u), vB = pair.unrotate(v);
    const Triple<Real> alongU = e.a.follow(pair.axesA, u), alongV = e.a.follow(pair.axesA, v);
    const Triple<Real> alongUB = e.b.follow(pair.axesB, uB), alongVB = e.b.follow(pair.axesB, vB);
    const Real hu = u.dot(alongU) + uB.dot(alongUB) - e.depth, hv = v.dot(alongV) + vB.dot(alongVB) - e.depth;
    const Real huv = u.dot(alongV) + uB.dot(alongVB), determinant = hu * hv - huv * huv;
    valid = both(determinant > Real{}, hu > Real{});
    const Real inverse = 1 / choose(valid, determinant, 1 + Real{});
    uu = inverse * hv;
    uv = -inverse * huv;
    vv = inverse * hu;
  }
  Triple<Real> stepFor(const Triple<Real>& slope) const {
    const Real gu = slope.dot(u), gv = slope.dot(v);
    return Real(-uu * gu - uv * gv) * u + Real(-uv * gu - vv * gv) * v;
  }
};

/// What two steps found.
template <class Real>
struct NewtonAnswer {
  Triple<Real> normal, onA, onB;
  Real depth;
  Mask<Real> converged;  ///< stationary within round-off; otherwise nothing here means anything
};

/// What a Newton step of the length s leaves is of the order (r s)^2 with r the axes' largest ratio, and a second one
/// with the same Hessian leaves (r s)^3: after a step below lastStep/r none is needed, after one below lastButOne/r
/// one. Both leave less than 1e-13 of the bodies.
inline constexpr double lastStep = 2.5e-7, lastButOne = 4e-5;

/// Where a pair's normal is sought, A's axes: it turns as it did between the last two looks.
template <class Real>
Triple<Real> foreseeNormal(const Triple<Real>& last, const Triple<Real>& turn) {
  return unit(last + turn);
}

/// From the unit normal `start`. The last step is taken to first order: C's points move along with the normal.
template <class Real>
NewtonAnswer<Real> takeTwoSteps(const EllipsoidPair<Real>& pair, const Triple<Real>& start) {
  using Depth = EllipsoidDepth<Real>;
  const Depth e(pair, start);
  const NewtonPlane<Real> plane(pair, e);
  const Mask<Real> still = e.slope.dot(e.slope) <= pair.roundOff * pair.roundOff;
  const Triple<Real> step = choose<Real>(still, Triple<Real>{}, plane.stepFor(e.slope));
  const Real square = pair.ratio * pair.ratio * step.dot(step);
  const Mask<Real> one = square < lastStep * lastStep + Real{};
  const auto evaluateNext = [&] {
    if constexpr (std::is_same_v<Real, double>) {
      if (one) return e;  // alone, nobody else needs the second step
    }
    return Depth(pair, unit(start + step));
  };
  const Depth next = evaluateNext();
  const Triple<Real> second = plane.stepFor(next.slope);

  const Triple<Real> last = choose<Real>(one, step, second), inB = pair.unrotate(last);
  const Triple<Real> from = choose<Real>(one, start, next.normal);
  const Triple<Real> onA =
      choose<Real>(one, e.onA + e.a.follow(pair.axesA, last), next.onA + next.a.follow(pair.axesA, last));
  const Triple<Real> followB = choose<Real>(one, e.b.follow(pair.axesB, inB), next.b.follow(pair.axesB, inB));
  const Triple<Real> onB = choose<Real>(one, e.onB, next.onB) - pair.rotate(followB);
  const Real depth = choose(one, e.depth, next.depth) + 0.5 * choose<Real>(one, e.slope, next.slope).dot(last);
  const Mask<Real> converged = both(either(plane.valid, still), square < lastButOne * lastButOne + Real{});
  return {unit(from + last), onA, onB, depth, converged};
}

}  // namespace granular
