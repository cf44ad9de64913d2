// Any two convex shapes, by their support functions alone. Warm: the last separating direction, or a descent from the
// last normal. Cold: GJK for the separated, Bullet's GJK/EPA for the touching, both bounds for whatever it says, and a
// second route where it fails.
#include "granular/core/tolerances.h"
#include "granular/narrow/epa.h"
#include "granular/narrow/gjk.h"
#include "granular/narrow/kernels.h"
#include "granular/narrow/polyhedron_features.h"
#include "granular/narrow/round_features.h"
#include "granular/shape/ellipsoid.h"

namespace granular {
namespace {

/// How far Bullet's depth and direction may be off on polyhedra, relative to the pair's size: its polytope is exact
/// there but for its own tolerances.
constexpr double flatProposalError = 1e-6;

/// How far Bullet's depth may lie from the depth along its own normal, relative to the pair's size. On smooth shapes
/// its polytope ends with an error of this order, which the descent then removes; its false answers are off by far
/// more.
constexpr double proposalError = 1e-3;

/// Radius of a ball that rolls freely inside: an ellipsoid's least curvature radius (Blaschke), a sphere's own.
double rollingRadius(const Shape& shape) {
  if (shape.kind() == ShapeKind::sphere) return shape.boundingRadius();
  if (shape.kind() != ShapeKind::ellipsoid) return 0;
  const Vec3& axes = static_cast<const Ellipsoid&>(shape).semiAxes();
  return axes.minCoeff() * axes.minCoeff() / axes.maxCoeff();
}

/// Polishes the proposal if it is consistent with itself; otherwise there is none.
bool takeProposal(Difference& c, const PenetrationAnswer& proposal, LocalMinimum& best, double& proposed) {
  proposed = infinity;
  if (!proposal.penetrating) return false;
  // Either sign of the normal is taken: the depth tells them apart.
  const double along = c.depth(proposal.normal), against = c.depth(-proposal.normal);
  proposed = std::min(along, against);
  if (std::abs(proposed - proposal.overlap) > proposalError * c.size()) return false;
  best = descend(c, along <= against ? proposal.normal : -proposal.normal);
  return true;
}

/// Around a minimum that the descent has found no other is looked for within 10 degrees.
constexpr double grantedCosine = 0.98480775301220806, grantedSine = 0.17364817766693036;

/// True if no direction outside the granted cone around a local minimum can be shallower. The points of C that support
/// a ring of directions around the normal span sectors; the edge of each, by its distance from the origin's foot and
/// the lower of its two heights, covers its directions from the cone to beyond the equator, and the ball of isGlobal
/// the rest.
bool isGlobalByFan(Difference& c, const LocalMinimum& m) {
  constexpr std::size_t ring = 8;
  constexpr double tilt = 0.07;  // tan 4 degrees
  constexpr double half = 0.70710678118654752;
  constexpr std::array<std::array<double, 2>, ring> azimuths{
      {{1, 0}, {half, half}, {0, 1}, {-half, half}, {-1, 0}, {-half, -half}, {0, -1}, {half, -half}}};
  const Vec3 u = perpendicular(m.normal), v = m.normal.cross(u);
  std::array<Vec2, ring> foot;
  std::array<double, ring> height;
  for (std::size_t k = 0; k < ring; ++k) {
    const Vec3 w = c.support(m.normal + tilt * (azimuths[k][0] * u + azimuths[k][1] * v)).w;
    foot[k] = {w.dot(u), w.dot(v)};
    height[k] = w.dot(m.normal);
  }
  double radius = infinity;
  for (std::size_t k = 0; k < ring; ++k) {
    const std::size_t next = (k + 1) % ring;
    const double side = (foot[next] - foot[k]).norm();
    if (!(side > 0)) continue;
    const double reach = (foot[k].x() * foot[next].y() - foot[k].y() * foot[next].x()) / side;
    if (!(std::min(height[k], height[next]) * grantedCosine + reach * grantedSine >= m.depth)) return false;
    radius = std::min(radius, reach);
  }
  const double inner = c.shapeA().innerRadius() + c.shapeB().innerRadius();
  return radius < infinity && isGlobal(m.normal, m.depth, radius, c.frame().x, inner);
}

/// The same by an inscribed polytope, for minima near the rim of a small facet or far from the line of centres.
bool isGlobalByPolytope(Difference& c, const LocalMinimum& m) {
  const GrantedCone cone{m.normal, grantedCosine, grantedSine};
  const DepthBounds bounds = boundOverlap(c, m.normal, m.depth, 0, &cone);
  return bounds.met && bounds.upper >= m.depth - tolerance::certificate * c.size();
}

/// The proofs, the cheapest first. A ball that rolls inside either shape is tangent to C below any minimum, and holds
/// the origin while its radius is at least the overlap.
bool isGlobalMinimum(const PairView& pair, Difference& c, const LocalMinimum& m, double margin) {
  if (m.depth <= rollingRadius(pair.a) + rollingRadius(pair.b)) return true;
  const double inner = pair.a.innerRadius() + pair.b.innerRadius();
  return isGlobal(m.normal, m.depth, margin, c.frame().x, inner) || isGlobalByFan(c, m) || isGlobalByPolytope(c, m);
}

/// With a shape that a ball rolls around inside, the overlap is the layers taken off less the distance of what is left:
/// one GJK distance, global by its own proof. False while the cores are so near that the direction would lose digits.
bool touchByCores(const PairView& pair, const Difference& c, WarmCache& cache, NarrowCounts& counts, Touch& touch,
                  bool& touches) {
  const double layerA = rollingRadius(pair.a), layerB = rollingRadius(pair.b);
  if (!(layerA + layerB > 0)) return false;
  Difference core = c;
  core.erode(layerA, layerB);
  const Nearest nearest = findNearest(core, Vec3::Zero(), guessNormal(c, cache), 1e-15);
  constexpr double leastGap = 1e-3;
  if (nearest.inside || !(nearest.gap > leastGap * (layerA + layerB))) return false;

  ++(cache.kind == WarmCache::cold ? counts.cold : counts.warm);
  const double overlap = layerA + layerB - nearest.gap;
  const Vec3& n = nearest.direction;
  touches = overlap > 0;
  if (!touches) {
    reportApart(n, -overlap, cache);
    return true;
  }
  const Vec3 middle = 0.5 * (nearest.onA + layerA * n + nearest.onB - layerB * n);
  const LocalMinimum found{n, overlap, middle + 0.5 * overlap * n, middle - 0.5 * overlap * n};
  return reportTouch(pair, WarmCache::smooth, found, cache, counts, touch);
}

}  // namespace

void countProposal(Difference& c, const PenetrationAnswer& proposal, double least, NarrowCounts& counts) {
  if (!proposal.penetrating) {
    ++counts.missed;
    return;
  }
  const double along = std::min(c.depth(proposal.normal), c.depth(-proposal.normal));
  const double off = std::max(std::abs(along - proposal.overlap), along - least);
  if (off > flatProposalError * c.size()) ++counts.fallbacks;
}

SearchResult searchConvex(Difference& c, const Vec3& guess, const PenetrationAnswer* proposal, NarrowCounts& counts) {
  ++counts.searches;
  SearchResult out;
  const double tolerance = tolerance::certificate * c.size();

  // First route: the proposal, if any. Second: the descent from the guess.
  double proposed = infinity;
  const bool proposalStands = proposal && takeProposal(c, *proposal, out.minimum, proposed);
  if (!proposalStands) out.minimum = descend(c, guess);

  // Both bounds. A better direction than the one at hand is polished, and the bounds are drawn again around it.
  bool certified = false;
  bool replaced = false;
  for (int round = 0; round < 4 && !certified && out.minimum.depth > 0; ++round) {
    const DepthBounds bounds = boundOverlap(c, out.minimum.normal, out.minimum.depth, tolerance);
    certified = bounds.met;
    if (!(bounds.upper < out.minimum.depth)) break;
    const LocalMinimum polished = descend(c, bounds.normal);
    if (!(polished.depth < out.minimum.depth)) break;
    replaced = replaced || polished.depth < out.minimum.depth - tolerance;
    out.minimum = polished;
  }
  out.apart = !(out.minimum.depth > 0);
  if (out.apart) return out;

  if (!certified) ++counts.uncertified;
  if (proposal && !proposal->penetrating) ++counts.missed;
  if (proposal && proposal->penetrating && (!proposalStands || replaced)) ++counts.fallbacks;
  return out;
}

bool touchConvex(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  Difference c(pair.a, pair.frameA, pair.b, pair.frameB);

  // Warm and apart: does the last direction still separate?
  if (cache.kind == WarmCache::apart && !pair.searchAlways) {
    const double depth = c.depth(cache.direction);
    if (depth < 0) {
      ++counts.warm;
      return reportApart(cache.direction, -depth, cache);
    }
  }

  // Warm and touching: a face or a side next to the last normal.
  const bool warm = cache.touched && !pair.searchAlways;
  RoundFeature feature;
  if (warm) feature = findRoundFeature(c, cache.direction);

  // Rounded shapes: a distance between cores, warm or cold.
  bool touches = false;
  if (!feature.holds && touchByCores(pair, c, cache, counts, touch, touches)) return touches;

  // Warm and touching: the minimum next to the last normal, if nothing away from it can be shallower.
  if (warm) {
    const LocalMinimum local = feature.holds ? feature.minimum : descend(c, cache.direction);
    const bool apart = !(local.depth > 0);
    if (apart || isGlobalMinimum(pair, c, local, feature.margin)) {
      ++counts.warm;
      if (apart) return reportApart(local.normal, -local.depth, cache);
      return reportTouch(pair, WarmCache::smooth, local, cache, counts, touch);
    }
  }

  // Cold: a separating direction ends it.
  if (cache.kind == WarmCache::cold) ++counts.cold;
  const Vec3 guess = guessNormal(c, cache);
  const Nearest nearest = findNearest(c, Vec3::Zero(), guess, separationPrecision);
  if (nearest.gap > 0) return reportApart(nearest.direction, nearest.gap, cache);

  // A contact is born with Bullet's answer; a running one is searched from its own normal.
  PenetrationAnswer proposal;
  if (!cache.touched) proposal = askBullet(c, guess);
  const SearchResult found = searchConvex(c, guess, cache.touched ? nullptr : &proposal, counts);
  if (found.apart) return reportApart(found.minimum.normal, -found.minimum.depth, cache);
  return reportTouch(pair, WarmCache::smooth, found.minimum, cache, counts, touch);
}

}  // namespace granular
