// What the pair kernels share: one signature for all, the answers they give, and the rules by which an answer that was
// found from the last one may stand without a search.
#pragma once

#include "granular/narrow/bullet_gjk_epa.h"
#include "granular/narrow/descent.h"
#include "granular/narrow/narrow.h"
#include "granular/shape/polyhedron.h"

namespace granular {

/// A pair as a kernel sees it.
struct PairView {
  const Shape& a;
  const Frame& frameA;
  const Shape& b;
  const Frame& frameB;
  bool searchAlways;
};

/// Fills touch and returns true when the two overlap; keeps the cache and the counts.
using PairKernel = bool (*)(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);

bool touchSpheres(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);
bool touchCuboids(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);
bool touchEllipsoids(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);
bool touchSphereCuboid(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);
bool touchSpherePolyhedron(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);
bool touchSphereCylinder(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);
bool touchSphereCone(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);
bool touchPolyhedra(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);
bool touchConvex(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch);

/// A normal that turns by more than this from one look to the next is counted: cosine of 30 degrees.
inline constexpr double flipCosine = 0.86602540378443865;

/// Relative precision of a gap: it is proven whatever this is, and only serves as the pair's motion budget.
inline constexpr double separationPrecision = 0.05;

/// Writes a touch with this normal, A's body axes, into the cache, and counts a flipped one.
inline void rememberTouch(WarmCache::Kind kind, const Vec3& normal, WarmCache& cache, NarrowCounts& counts) {
  if (cache.touched && cache.direction.dot(normal) < flipCosine) ++counts.normalFlips;
  cache.kind = kind;
  cache.touched = 1;
  cache.direction = normal;
  cache.budget = 0;
}
/// The same, and the touch in world axes.
inline bool reportTouch(const PairView& pair, WarmCache::Kind kind, const LocalMinimum& found, WarmCache& cache,
                        NarrowCounts& counts, Touch& touch) {
  rememberTouch(kind, found.normal, cache, counts);
  touch.normal = pair.frameA.rotate(found.normal);
  touch.overlap = found.depth;
  touch.onA = pair.frameA.toWorld(found.onA);
  touch.onB = pair.frameA.toWorld(found.onB);
  touch.feature = {};
  return true;
}

/// What touches by the last feature of two polyhedra.
TouchingFeature namePolyhedronFeature(const WarmCache& cache);
/// Names a vertex of either polyhedron's feature in its place, for a pair that touched and is apart now.
void nameVertices(const PolyhedronTables& a, const PolyhedronTables& b, WarmCache& cache);

/// What touches along the last axis of two cuboids, as the tables of cuboids name it, for a normal in either's axes out
/// of A and out of B.
TouchingFeature nameCuboidFeature(const WarmCache& cache, const Vec3& outOfA, const Vec3& outOfB);
/// Depths of two cuboids closer than this are a tie, m.
double cuboidTie(const Shape& a, const Shape& b);

/// Writes a proven separation (unit direction in A's body axes, gap >= 0 in m) into the cache.
inline bool reportApart(const Vec3& direction, double gap, WarmCache& cache) {
  cache.kind = WarmCache::apart;
  cache.touched = 0;
  cache.direction = direction;
  cache.budget = gap;
  return false;
}

/// A first guess of the normal in A's body axes: the last one, else the line of centres.
inline Vec3 guessNormal(const Difference& c, const WarmCache& cache) {
  if (cache.kind != WarmCache::cold) return cache.direction;
  const double distance = c.frame().x.norm();
  return distance > 0 ? Vec3(c.frame().x / distance) : Vec3(Vec3::UnitX());
}

/// Counts a proposal of Bullet's for two polyhedra that the least depth, found by a search of our own, refutes: it
/// called the pair separate, its depth is not the depth along its own normal, or a shallower direction exists.
void countProposal(Difference& c, const PenetrationAnswer& proposal, double least, NarrowCounts& counts);

/// The whole search for shapes of any kind: separated, or the certified global minimum. `proposal` is Bullet's answer,
/// or null where none was asked for; it is checked against both bounds and counted when it fails.
struct SearchResult {
  bool apart = false;
  LocalMinimum minimum;  ///< apart: the normal separates, depth is minus the gap
};
SearchResult searchConvex(Difference& c, const Vec3& guess, const PenetrationAnswer* proposal, NarrowCounts& counts);

}  // namespace granular
