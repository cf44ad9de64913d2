// Two ellipsoids (spheres included): Newton's method on the unit normal (ellipsoid_newton.h), from where the last two
// normals say that it goes. A ball of the least curvature radius rolls freely inside an ellipsoid (Blaschke), so that C
// holds a ball of both radii's sum that is tangent below n: a stationary normal is the global minimum while the overlap
// is smaller.
#include "granular/narrow/ellipsoid_pair.h"

#include "granular/narrow/gjk.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

/// A sphere as an ellipsoid, or an ellipsoid.
struct Axes {
  Vec3 length;
  double ratio, leastCurvatureRadius;

  explicit Axes(const Shape& shape) {
    if (shape.kind() == ShapeKind::sphere) {
      leastCurvatureRadius = static_cast<const Sphere&>(shape).radius();
      length = Vec3::Constant(leastCurvatureRadius);
      ratio = 1;
    } else {
      const auto& ellipsoid = static_cast<const Ellipsoid&>(shape);
      length = ellipsoid.semiAxes();
      ratio = ellipsoid.ratio();
      leastCurvatureRadius = ellipsoid.leastCurvatureRadius();
    }
  }
};

/// A direction below which C's boundary is tangent to round-off, or as near to it as some dozens of steps come; slope
/// receives how near.
LocalMinimum descendFar(const EllipsoidPair<double>& pair, const Triple<double>& start, double& slope) {
  constexpr int maxSteps = 60;
  EllipsoidDepth<double> e(pair, start);
  for (int k = 0; k < maxSteps && e.slope.norm() > pair.roundOff; ++k) {
    // Where Newton's step is not downhill, follow the gradient by an angle of the order of the slope's.
    const NewtonPlane<double> plane(pair, e);
    Triple<double> step = plane.stepFor(e.slope);
    if (!plane.valid) step = (-1 / (e.slope.norm() + std::abs(e.depth) + pair.roundOff)) * e.slope;
    const double length = step.norm();
    constexpr double longest = 0.5;
    if (length > longest) step = (longest / length) * step;

    // Halve the step until the depth falls; a step that only round-off can judge is taken as it is.
    EllipsoidDepth<double> next(pair, unit(e.normal + step));
    for (int halving = 0; halving < 30 && next.depth > e.depth + pair.roundOff; ++halving) {
      step = 0.5 * step;
      next = EllipsoidDepth<double>(pair, unit(e.normal + step));
    }
    const bool better = next.depth < e.depth - pair.roundOff || next.slope.dot(next.slope) < e.slope.dot(e.slope);
    if (!better) break;
    e = next;
  }
  slope = e.slope.norm();
  return {toVec3(e.normal), e.depth, toVec3(e.onA), toVec3(e.onB)};
}

/// The last direction, if it still separates two that were apart.
bool isStillApart(const PairView& view, const Axes& a, const Axes& b, const Vec3& between, WarmCache& cache) {
  const Vec3 direction = view.frameA.R * cache.direction;
  const double depth = a.length.cwiseProduct(cache.direction).norm() +
                       b.length.cwiseProduct(view.frameB.unrotate(direction)).norm() - between.dot(direction);
  if (!(depth < 0)) return false;
  reportApart(cache.direction, -depth, cache);
  return true;
}

/// By the general route.
bool findByAnyRoute(const PairView& view, WarmCache& cache, NarrowCounts& counts, SmoothTouch& touch) {
  Touch found;
  if (!touchConvex(view, cache, counts, found)) return false;
  touch = {found.normal, found.overlap, 0.5 * (found.onA + found.onB)};
  return true;
}

}  // namespace

bool findEllipsoidTouch(const PairView& view, WarmCache& cache, NarrowCounts& counts, SmoothTouch& touch) {
  const Axes a(view.a), b(view.b);
  const Vec3 between = view.frameB.x - view.frameA.x;
  const bool warm = cache.kind != WarmCache::cold && !view.searchAlways;
  if (warm && cache.kind == WarmCache::apart && isStillApart(view, a, b, between, cache)) {
    ++counts.warm;
    return false;
  }

  Triple<double> start = toTriple(cache.direction);
  if (!warm) {
    const double distance = between.norm();
    start = toTriple(distance > 0 ? Vec3(view.frameA.unrotate(between) / distance) : Vec3(Vec3::UnitX()));
  } else if (cache.touched != 0 && cache.proof.floor == 0) {
    start = foreseeNormal(start, lastTurn(cache));
  }
  const PlacedAxes<double> axesA = placeAxes(view.frameA);
  const EllipsoidPair<double> pair(toTriple(a.length), axesA, toTriple(b.length), placeAxes(view.frameB),
                                   larger(a.ratio, b.ratio),
                                   slopeRoundOff(view.a.boundingRadius(), view.b.boundingRadius()));
  const NewtonAnswer<double> answer = takeTwoSteps(pair, start);
  LocalMinimum found{toVec3(answer.normal), answer.depth, toVec3(answer.onA), toVec3(answer.onB)};
  double slope = 0;
  if (!answer.converged) found = descendFar(pair, start, slope);

  // Deep, or not converged.
  constexpr double slack = 1e3;
  if (!(found.depth <= a.leastCurvatureRadius + b.leastCurvatureRadius) ||
      (found.depth > 0 && !(slope <= slack * pair.roundOff)))
    return findByAnyRoute(view, cache, counts, touch);

  ++(warm ? counts.warm : counts.cold);
  if (!(found.depth > 0)) return reportApart(found.normal, -found.depth, cache);
  const bool follows = warm && cache.touched != 0;
  rememberTurn(toTriple(follows ? Vec3(found.normal - cache.direction) : Vec3(Vec3::Zero())), cache);
  rememberTouch(WarmCache::smooth, found.normal, cache, counts);
  touch.normal = toVec3(axesA.rotate(toTriple(found.normal)));
  touch.overlap = found.depth;
  touch.middle = toVec3(axesA.toWorld(0.5 * (toTriple(found.onA) + toTriple(found.onB))));
  return true;
}

bool touchEllipsoids(const PairView& view, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  SmoothTouch found;
  if (!findEllipsoidTouch(view, cache, counts, found)) return false;
  touch.take(found);
  return true;
}

}  // namespace granular
