// Clumps are a second, smaller search inside each pair. The children near each other are listed with a reach of their
// own and the list stands until the bodies have travelled that far; within it every pair of children has its own proven
// gap, and is not looked at before that is used up. So a step of a resting or slowly moving pair compares a few
// numbers.
#include "granular/world/clump_contacts.h"

#include <algorithm>

#include "granular/narrow/clump_pair.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Lists the children near each other anew; warm caches of those listed before are kept.
void relistChildren(const ClumpPairView& view, double reach, double travel, bool balls, ClumpMemory& memory) {
  thread_local std::vector<ChildPair> found;
  findNearChildren(view, reach, found);
  if (!balls) {
    // Both lists are sorted: one pass.
    std::vector<WarmCache> caches(found.size());
    const std::vector<ChildPair>& before = memory.children.near;
    std::size_t old = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const auto isBefore = [&](const ChildPair& p) {
        return p.childA != found[k].childA ? p.childA < found[k].childA : p.childB < found[k].childB;
      };
      while (old < before.size() && isBefore(before[old])) ++old;
      const bool same =
          old < before.size() && before[old].childA == found[k].childA && before[old].childB == found[k].childB;
      if (same) caches[k] = memory.caches[old];
    }
    memory.caches.swap(caches);
  }
  memory.children.near.assign(found.begin(), found.end());
  memory.children.validUntil = travel + reach;
}

/// How far the search for children reaches: as a pair's bounds do.
double reachOf(const World& world, double size) { return world.options.skin * size; }

}  // namespace

void refreshChildren(const World& world, const ClumpPairView& view, double travel, ClumpMemory& memory) {
  if (world.options.skips.separation && travel < memory.children.validUntil) return;
  relistChildren(view, reachOf(world, std::min(view.a.size(), view.b.size())), travel, meetsBalls(view.a, view.b),
                 memory);
}

void lookAtClumpPair(World& world, std::int32_t index, double travel, World::Chunk& chunk) {
  const Bodies& bodies = world.bodies;
  Pair& pair = world.pairs.pairs[at(index)];
  const Shape &shapeA = *bodies.shape[at(pair.a)], &shapeB = *bodies.shape[at(pair.b)];
  ClumpMemory& memory = world.pairs.memory.clumps[at(pair.slot)];
  const Vec3 shift = world.options.periods.shift(pair.image);
  Frame frameB = bodies.frame[at(pair.b)];
  frameB.x += shift;
  const ClumpPairView view{shapeA, bodies.frame[at(pair.a)], shapeB, frameB};
  const bool balls = meetsBalls(shapeA, shapeB);
  const double size = std::min(shapeA.size(), shapeB.size());
  refreshChildren(world, view, travel, memory);

  const std::uint64_t uncertified = chunk.counts.uncertified;
  const std::size_t before = chunk.contacts.size();
  const double quiet = visitNearChildren(world, travel, memory.children, [&](std::size_t k) {
    const ChildPair& children = memory.children.near[k];
    Touch touch;
    double overlap = 0;
    if (balls) {
      ++chunk.counts.warm;
      overlap = touchBallChildren(view, children, touch);
    } else {
      overlap =
          touchChildAndConvex(view, children, !world.options.skips.feature, memory.caches[k], chunk.counts, touch);
    }
    if (!(overlap > 0)) return overlap;
    Contact& contact = chunk.contacts.emplace_back();
    contact.pair = index;
    contact.a = pair.a;
    contact.b = pair.b;
    contact.spot = {0, children.childA, children.childB};
    contact.share = 1;
    contact.shift = shift;
    contact.touch = touch;
    chunk.noteDepth(overlap, size);
    return overlap;
  });
  if (chunk.counts.uncertified > uncertified && chunk.uncertifiedPair < 0) chunk.uncertifiedPair = index;
  if (chunk.contacts.size() > before) return;
  pair.quietUntil = quiet;
  memory.spots.clear();
}

void lookAtClumpAtWall(World& world, std::int32_t index, double travel, World::Chunk& chunk) {
  const Bodies& bodies = world.bodies;
  WallPair& pair = world.pairs.wallPairs[at(index)];
  const Frame& frame = bodies.frame[at(pair.body)];
  const auto& clump = static_cast<const Clump&>(*bodies.shape[at(pair.body)]);
  const Wall& wall = *world.walls[at(pair.wall)];
  ChildList& list = pair.children;
  if (!world.options.skips.separation || travel >= list.validUntil) {
    const double reach = reachOf(world, clump.size());
    findChildrenNearWall(wall, clump, frame, reach, list.near);
    list.validUntil = travel + reach;
  }

  chunk.wallTouches.clear();
  const RuleOptions rule = ruleAtWalls(world.options.rule);
  const double quiet = visitNearChildren(world, travel, list, [&](std::size_t k) {
    const std::int32_t child = list.near[k].childA;
    const ChildSphere& sphere = clump.children()[at(child)];
    const std::size_t before = chunk.wallTouches.size();
    const double gap = wall.clearance(frame.toWorld(sphere.centre), sphere.radius);
    if (!(gap > 0)) touchWallWithChild(wall, rule, clump, frame, child, chunk.wallTouches);
    return chunk.wallTouches.size() > before ? chunk.wallTouches.back().overlap : -std::max(0.0, gap);
  });
  if (chunk.wallTouches.empty()) {
    pair.quietUntil = quiet;
    pair.spots.clear();
    return;
  }
  addWallContacts(pair, index, clump.size(), chunk);
}

}  // namespace granular
