// Which kernel serves which pair of kinds, in one table. Rows: the kind of A; columns: the kind of B, in the order of
// ShapeKind. Only A's kind <= B's is filled; the other half is served by swapping the bodies. Clumps have no kernel:
// their children meet one by one (clump_pair.h).
#include <algorithm>
#include <cassert>
#include <utility>

#include "granular/narrow/clump_pair.h"
#include "granular/narrow/kernels.h"
#include "granular/shape/clump.h"

namespace granular {
namespace {

constexpr PairKernel none = nullptr;
constexpr PairKernel convex = touchConvex;
constexpr PairKernel ellips = touchEllipsoids;
constexpr PairKernel flat = touchPolyhedra;
constexpr PairKernel boxes = touchCuboids;

constexpr std::array<std::array<PairKernel, shapeKindCount>, shapeKindCount> kernelTable{{
    // sphere       ellipsoid cylinder             cone             cuboid             polyhedron             bullet
    // clump
    {touchSpheres, ellips, touchSphereCylinder, touchSphereCone, touchSphereCuboid, touchSpherePolyhedron, convex,
     none},
    {none, ellips, convex, convex, convex, convex, convex, none},  // ellipsoid
    {none, none, convex, convex, convex, convex, convex, none},    // cylinder
    {none, none, none, convex, convex, convex, convex, none},      // cone
    {none, none, none, none, boxes, flat, convex, none},           // cuboid
    {none, none, none, none, none, flat, convex, none},            // polyhedron
    {none, none, none, none, none, none, convex, none},            // bullet
    {none, none, none, none, none, none, none, none},              // clump
}};

PairKernel kernelOf(const Shape& a, const Shape& b) {
  return kernelTable[static_cast<std::size_t>(a.kind())][static_cast<std::size_t>(b.kind())];
}

/// The deepest overlap of any two children; without `overlap` the first found will do.
bool childrenOverlap(const ClumpPairView& pair, double* overlap) {
  thread_local std::vector<ChildPair> near;
  findNearChildren(pair, 0, near);
  NarrowCounts counts;
  double deepest = 0;
  for (const ChildPair& children : near) {
    WarmCache cache;
    Touch touch;
    deepest = std::max(deepest, touchChildAndConvex(pair, children, false, cache, counts, touch));
    if (deepest > 0 && !overlap) return true;
  }
  if (overlap && deepest > 0) *overlap = deepest;
  return deepest > 0;
}

}  // namespace

NarrowCounts& NarrowCounts::operator+=(const NarrowCounts& other) {
  cold += other.cold;
  searches += other.searches;
  warm += other.warm;
  uncertified += other.uncertified;
  coarse += other.coarse;
  fallbacks += other.fallbacks;
  missed += other.missed;
  normalFlips += other.normalFlips;
  return *this;
}

bool findTouch(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, bool searchAlways,
               WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  assert(a.kind() != ShapeKind::clump && b.kind() != ShapeKind::clump);
  if (a.kind() <= b.kind()) return kernelOf(a, b)({a, frameA, b, frameB, searchAlways}, cache, counts, touch);

  // The kernel takes the bodies in the table's order; its answer is turned round. The cache keeps the table's order.
  if (!kernelOf(b, a)({b, frameB, a, frameA, searchAlways}, cache, counts, touch)) return false;
  touch.normal = -touch.normal;
  std::swap(touch.onA, touch.onB);
  touch.feature = touch.feature.turnedRound();
  return true;
}

bool overlaps(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, double* overlap) {
  // Far apart by their bounding spheres: the commonest case of insertion.
  const double reach = a.boundingRadius() + b.boundingRadius();
  if ((frameB.x - frameA.x).squaredNorm() > reach * reach) return false;
  if (asClump(a) || asClump(b)) return childrenOverlap({a, frameA, b, frameB}, overlap);
  WarmCache cache;
  NarrowCounts counts;
  Touch touch;
  if (!findTouch(a, frameA, b, frameB, false, cache, counts, touch)) return false;
  if (overlap) *overlap = touch.overlap;
  return true;
}

double depthAlong(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, const Vec3& n) {
  const Vec3 pointA = a.support(frameA.unrotate(n));
  const Vec3 pointB = b.support(-frameB.unrotate(n));
  return frameA.rotate(pointA).dot(n) - frameB.rotate(pointB).dot(n) - (frameB.x - frameA.x).dot(n);
}

}  // namespace granular
