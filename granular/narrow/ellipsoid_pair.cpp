// Two ellipsoids (spheres included): Newton's method on the unit normal (ellipsoid_newton.h), from where the last two
// normals say that it goes. A ball of the least curvature radius rolls freely inside an ellipsoid (Blaschke), so that C
// holds a ball of both radii's sum that is tangent below n: a stationary normal is the global minimum while the overlap
// is smaller.
#include "granular/narrow/ellipsoid_pair.h"

#include <algorithm>

#include "granular/narrow/ellipsoid_newton.h"
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

}  // namespace

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

bool EllipsoidLook::begin(const PairView& view, WarmCache& cache, NarrowCounts& counts) {
  const Axes axesA(view.a), axesB(view.b);
  const Vec3 between = view.frameB.x - view.frameA.x;
  warm = cache.kind != WarmCache::cold && !view.searchAlways;

  // Warm and apart: does the last direction still separate?
  if (warm && cache.kind == WarmCache::apart) {
    const Vec3 direction = view.frameA.R * cache.direction;
    const double depth = axesA.length.cwiseProduct(cache.direction).norm() +
                         axesB.length.cwiseProduct(view.frameB.unrotate(direction)).norm() - between.dot(direction);
    if (depth < 0) {
      ++counts.warm;
      reportApart(cache.direction, -depth, cache);
      return false;
    }
  }

  ratio = std::max(axesA.ratio, axesB.ratio);
  roundOff = 8 * std::numeric_limits<double>::epsilon() * (view.a.boundingRadius() + view.b.boundingRadius());
  provenUpTo = axesA.leastCurvatureRadius + axesB.leastCurvatureRadius;
  Vec3 guess = cache.direction;
  if (!warm) {
    const double distance = between.norm();
    guess = distance > 0 ? Vec3(view.frameA.unrotate(between) / distance) : Vec3(Vec3::UnitX());
  } else if (cache.touched != 0 && cache.proof.floor == 0) {
    const auto& turn = cache.proof.axis;
    guess += Vec3(turn[0], turn[1], turn[2]);
    guess *= 1 / guess.norm();
  }
  start = toTriple(guess);
  return true;
}

EllipsoidPair<double> EllipsoidLook::pairOf(const PairView& view) const {
  return {toTriple(Axes(view.a).length),
          placeAxes(view.frameA),
          toTriple(Axes(view.b).length),
          placeAxes(view.frameB),
          ratio,
          roundOff};
}

bool touchEllipsoids(const PairView& view, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  EllipsoidLook look;
  if (!look.begin(view, cache, counts)) return false;
  return look.end(takeTwoSteps(look.pairOf(view), look.start), view, cache, counts, touch);
}

}  // namespace granular
