#include "granular/narrow/clump_pair.h"

#include <algorithm>

#include "granular/narrow/ball_touch.h"
#include "granular/shape/clump.h"

namespace granular {
namespace {

/// Two trees, B's nodes seen in A's axes: whichever node is larger is opened first.
void searchTrees(const SphereTree& treeA, const SphereTree& treeB, const Frame& fromBToA, double reach,
                 std::vector<ChildPair>& out) {
  struct Nodes {
    std::int32_t a, b;
  };
  // Each turn takes one entry and adds two, one level further down in one of the trees.
  std::array<Nodes, 128> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, 0};
  while (depth > 0) {
    const auto [a, b] = stack[--depth];
    const SphereTree::Node& nodeA = treeA.nodes()[static_cast<std::size_t>(a)];
    const SphereTree::Node& nodeB = treeB.nodes()[static_cast<std::size_t>(b)];
    const double touching = nodeA.radius + nodeB.radius + reach;
    if ((fromBToA.toWorld(nodeB.centre) - nodeA.centre).squaredNorm() > touching * touching) continue;
    if (nodeA.isLeaf() && nodeB.isLeaf()) {
      out.push_back({nodeA.child, nodeB.child, -infinity});
    } else if (nodeB.isLeaf() || (!nodeA.isLeaf() && nodeA.radius >= nodeB.radius)) {
      stack[depth++] = {nodeA.right, b};
      stack[depth++] = {a + 1, b};
    } else {
      stack[depth++] = {a, nodeB.right};
      stack[depth++] = {a, b + 1};
    }
  }
}

/// One tree against the box of a convex body in that body's own axes, or against its ball if it is one.
template <class Visit>
void searchTree(const Clump& clump, const Frame& frame, const Shape& other, const Frame& frameOther, double reach,
                Visit&& visit) {
  const Aabb box = other.bounds(Frame{});
  const bool round = other.kind() == ShapeKind::sphere;
  const auto isNear = [&](const Vec3& centre, double radius) {
    const Vec3 seen = frameOther.toBody(frame.toWorld(centre));
    const Vec3 outside = round ? seen : Vec3(seen - seen.cwiseMax(box.lo).cwiseMin(box.hi));
    const double touching = radius + reach + (round ? other.boundingRadius() : 0);
    return outside.squaredNorm() <= touching * touching;
  };
  clump.tree().visitNear(isNear, visit);
}

}  // namespace

void findNearChildren(const ClumpPairView& pair, double reach, std::vector<ChildPair>& out) {
  out.clear();
  const Clump* clumpA = asClump(pair.a);
  const Clump* clumpB = asClump(pair.b);
  if (clumpA && clumpB) {
    const Frame fromBToA(pair.frameA.R.transpose() * pair.frameB.R, pair.frameA.toBody(pair.frameB.x));
    searchTrees(clumpA->tree(), clumpB->tree(), fromBToA, reach, out);
  } else if (clumpA) {
    searchTree(*clumpA, pair.frameA, pair.b, pair.frameB, reach, [&](std::int32_t child) {
      out.push_back({child, -1, -infinity});
    });
  } else {
    searchTree(*clumpB, pair.frameB, pair.a, pair.frameA, reach, [&](std::int32_t child) {
      out.push_back({-1, child, -infinity});
    });
  }
  std::sort(out.begin(), out.end(), [](const ChildPair& p, const ChildPair& q) {
    return p.childA != q.childA ? p.childA < q.childA : p.childB < q.childB;
  });
}

double touchBallChildren(const ClumpPairView& pair, const ChildPair& children, Touch& touch) {
  const PlacedBall a = placeBall(pair.a, pair.frameA, children.childA);
  const PlacedBall b = placeBall(pair.b, pair.frameB, children.childB);
  const BallLook look = lookAtBalls(a.centre, a.radius, b.centre, b.radius);
  if (look.overlap > 0) fillBallTouch(look, a.centre, a.radius, touch);
  return look.overlap;
}

double touchChildAndConvex(const ClumpPairView& pair, const ChildPair& children, bool searchAlways, WarmCache& cache,
                           NarrowCounts& counts, Touch& touch) {
  const PlacedChild a = placeChild(pair.a, pair.frameA, children.childA);
  const PlacedChild b = placeChild(pair.b, pair.frameB, children.childB);
  if (findTouch(*a.shape, a.frame, *b.shape, b.frame, searchAlways, cache, counts, touch)) return touch.overlap;
  return -std::max(0.0, cache.budget);
}

void findTouches(const ClumpPairView& pair, std::vector<ChildTouch>& out) {
  out.clear();
  NarrowCounts counts;
  std::vector<ChildPair> near{ChildPair{}};
  if (asClump(pair.a) || asClump(pair.b)) findNearChildren(pair, 0, near);
  for (const ChildPair& children : near) {
    WarmCache cache;
    Touch touch;
    if (touchChildAndConvex(pair, children, true, cache, counts, touch) > 0) out.push_back({children, touch});
  }
}

}  // namespace granular
