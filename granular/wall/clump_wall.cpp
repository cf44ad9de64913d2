// Clumps at walls: each child is a sphere of its own there. The wall never sees the clump.
#include <algorithm>

#include "granular/wall/wall.h"

namespace granular {

void touchWallWithChild(const Wall& wall, const RuleOptions& rule, const Clump& clump, const Frame& frame,
                        std::int32_t child, std::vector<WallTouch>& out) {
  const std::size_t first = out.size();
  const PlacedChild placed = placeChild(clump, frame, child);
  wall.touch(rule, *placed.shape, placed.frame, out);
  for (std::size_t k = first; k < out.size(); ++k) out[k].child = child;
}

void findChildrenNearWall(const Wall& wall, const Clump& clump, const Frame& frame, double reach,
                          std::vector<ChildPair>& out) {
  out.clear();
  clump.tree().visitNear(
      [&](const Vec3& centre, double radius) { return wall.clearance(frame.toWorld(centre), radius) <= reach; },
      [&](std::int32_t child) {
        out.push_back({child, -1, -infinity});
      });
  std::sort(out.begin(), out.end(), [](const ChildPair& p, const ChildPair& q) { return p.childA < q.childA; });
}

void touchWall(const Wall& wall, const RuleOptions& rule, const Shape& shape, const Frame& frame,
               std::vector<WallTouch>& out) {
  const Clump* clump = asClump(shape);
  if (clump == nullptr) return wall.touch(rule, shape, frame, out);
  thread_local std::vector<ChildPair> near;
  findChildrenNearWall(wall, *clump, frame, 0, near);
  for (const ChildPair& each : near) touchWallWithChild(wall, rule, *clump, frame, each.childA, out);
}

}  // namespace granular
