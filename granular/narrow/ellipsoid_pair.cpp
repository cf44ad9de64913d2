// Two ellipsoids (spheres included): Newton's method on the unit normal. With the support function H(n) = |D n|, D the
// semi-axes, the point of C = A - B below n is the gradient x = grad H_A + grad H_B - t, the depth is h = n . x, its
// gradient on the unit sphere is P x with P = 1 - n n^T, and its Hessian P (H_A'' + H_B'') P - h. Near the minimum each
// step doubles the digits. A ball of the least curvature radius rolls freely inside an ellipsoid (Blaschke), so that C
// holds a ball of both radii's sum that is tangent below n: a stationary normal is the global minimum while the overlap
// is smaller.
#include <algorithm>

#include "granular/narrow/gjk.h"
#include "granular/narrow/kernels.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

Vec3 semiAxesOf(const Shape& shape) {
  if (shape.kind() == ShapeKind::sphere) return Vec3::Constant(static_cast<const Sphere&>(shape).radius());
  return static_cast<const Ellipsoid&>(shape).semiAxes();
}

/// Support point of H(n) = |D n| in the ellipsoid's own axes; its second derivatives are (D^2 - point point^T) / H.
struct Curved {
  Vec3 point;
  double height;  // H

  Curved(const Vec3& d, const Vec3& n) {
    const Vec3 stretched = d.cwiseProduct(n);
    height = stretched.norm();
    point = d.cwiseProduct(stretched) / height;
  }
  /// The second derivative along p and q, in the ellipsoid's own axes.
  double second(const Vec3& d, const Vec3& p, const Vec3& q) const {
    return (d.cwiseProduct(p).dot(d.cwiseProduct(q)) - point.dot(p) * point.dot(q)) / height;
  }
};

/// Two ellipsoids, and one evaluation along n in A's axes.
struct Ellipsoids {
  Vec3 axesA, axesB;
  Frame frame;
};

struct Evaluation {
  Curved a, b;
  Vec3 normal, onA, onB, slope;  // slope: P x
  double depth;

  Evaluation(const Ellipsoids& pair, const Vec3& n)
      : a(pair.axesA, n), b(pair.axesB, pair.frame.unrotate(n)), normal(n) {
    onA = a.point;
    onB = pair.frame.x - pair.frame.rotate(b.point);
    const Vec3 x = onA - onB;
    depth = a.height + b.height - pair.frame.x.dot(n);
    slope = x - x.dot(n) * n;
  }
};

/// Newton's step in the tangent plane; false where the Hessian is not positive definite.
bool makeStep(const Ellipsoids& pair, const Evaluation& e, Vec3& step) {
  const Vec3 u = perpendicular(e.normal), v = e.normal.cross(u);
  const Vec3 uB = pair.frame.unrotate(u), vB = pair.frame.unrotate(v);
  const double uu = e.a.second(pair.axesA, u, u) + e.b.second(pair.axesB, uB, uB) - e.depth;
  const double uv = e.a.second(pair.axesA, u, v) + e.b.second(pair.axesB, uB, vB);
  const double vv = e.a.second(pair.axesA, v, v) + e.b.second(pair.axesB, vB, vB) - e.depth;
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 0) || !(uu > 0)) return false;
  const double gu = e.slope.dot(u), gv = e.slope.dot(v);
  step = ((uv * gv - vv * gu) / determinant) * u + ((uv * gu - uu * gv) / determinant) * v;
  return true;
}

/// A direction below which C's boundary is tangent to round-off, or as near to it as the steps allowed come.
Evaluation findStationary(const Ellipsoids& pair, const Vec3& start, double roundOff) {
  constexpr int maxSteps = 60;
  Evaluation e(pair, start);
  for (int k = 0; k < maxSteps && e.slope.norm() > roundOff; ++k) {
    // Where Newton's step is not downhill, follow the gradient by an angle of the order of the slope's.
    Vec3 step;
    if (!makeStep(pair, e, step)) step = -e.slope / (e.slope.norm() + std::abs(e.depth) + roundOff);
    const double length = step.norm();
    constexpr double longest = 0.5;
    if (length > longest) step *= longest / length;

    // Halve the step until the depth falls; a step that only round-off can judge is taken as it is.
    Evaluation next(pair, (e.normal + step).normalized());
    for (int halving = 0; halving < 30 && next.depth > e.depth + roundOff; ++halving) {
      step *= 0.5;
      next = Evaluation(pair, (e.normal + step).normalized());
    }
    const bool better = next.depth < e.depth - roundOff || next.slope.squaredNorm() < e.slope.squaredNorm();
    if (!better) break;
    e = next;
  }
  return e;
}

double leastCurvatureRadius(const Vec3& axes) {
  const double least = axes.minCoeff();
  return least * least / axes.maxCoeff();
}

}  // namespace

bool touchEllipsoids(const PairView& view, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  const Ellipsoids pair{semiAxesOf(view.a), semiAxesOf(view.b), relativeFrame(view.frameA, view.frameB)};
  const Vec3 &axesA = pair.axesA, &axesB = pair.axesB;
  const Frame& frame = pair.frame;
  const bool warm = cache.kind != WarmCache::cold && !view.searchAlways;

  // Warm and apart: does the last direction still separate?
  if (warm && cache.kind == WarmCache::apart) {
    const double depth = axesA.cwiseProduct(cache.direction).norm() +
                         axesB.cwiseProduct(frame.unrotate(cache.direction)).norm() - frame.x.dot(cache.direction);
    if (depth < 0) {
      ++counts.warm;
      return reportApart(cache.direction, -depth, cache);
    }
  }

  // The stationary normal from the last one, or from the line of centres.
  const double distance = frame.x.norm();
  const Vec3 centres = distance > 0 ? Vec3(frame.x / distance) : Vec3(Vec3::UnitX());
  const double roundOff =
      4 * std::numeric_limits<double>::epsilon() * (view.a.boundingRadius() + view.b.boundingRadius() + distance);
  const Evaluation e = findStationary(pair, warm ? cache.direction : centres, roundOff);
  const bool proven = e.depth <= leastCurvatureRadius(axesA) + leastCurvatureRadius(axesB);
  constexpr double slack = 1e3;
  if (proven && (!(e.depth > 0) || e.slope.norm() <= slack * roundOff)) {
    ++(warm ? counts.warm : counts.cold);
    if (!(e.depth > 0)) return reportApart(e.normal, -e.depth, cache);
    LocalMinimum found{e.normal, e.depth, e.onA, e.onB};
    const Vec3 middle = 0.5 * (e.onA + e.onB);
    found.onA = middle + 0.5 * e.depth * e.normal;
    found.onB = middle - 0.5 * e.depth * e.normal;
    return reportTouch(view, WarmCache::smooth, found, cache, counts, touch);
  }

  // Deep, or not converged: the general route.
  return touchConvex(view, cache, counts, touch);
}

}  // namespace granular
