// Contacts of cuboids with flat walls in batches: a plane is the face of a cuboid so large that only that face is met,
// and the rest is as between cuboids (cuboid_contacts.cpp). What is not proven there, a face or an edge parallel to the
// wall, goes the general way.
#include "granular/narrow/kernels.h"
#include "granular/shape/polyhedron.h"
#include "granular/wall/plane_patch.h"
#include "granular/world/cuboid_groups.h"
#include "granular/world/looks.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

class CuboidsAtWalls {
 public:
  CuboidsAtWalls(World& chosen, World::Chunk& into)
      : world(chosen), chunk(into), rule(ruleAtWalls(chosen.options.rule)), overlaps(rule) {}

  /// Looks at a body near a plane; its contact, if there is one, is the chunk's next.
  void take(std::int32_t index) {
    const Bodies& bodies = world.bodies;
    WallPair& pair = world.pairs.wallPairs[at(index)];
    const std::size_t i = at(pair.body);
    pair.held.clear();
    if (world.options.skips.separation && travelOf(pair) < pair.quietUntil) return;
    const Plane& plane = *world.walls[at(pair.wall)]->asPlane();
    const double height = -plane.depth(bodies.x(i)), reach = bodies.boundingRadius(i);
    if (height > reach) return waitForGap(pair, height - reach);

    Contact& contact = chunk.contacts.emplace_back();
    contact.pair = index;
    contact.a = pair.body;
    contact.b = -1 - pair.wall;
    contact.shift = Vec3::Zero();
    const auto& cuboid = static_cast<const Cuboid&>(*bodies.shape[i]);
    const Mat3& guest = bodies.frame[i].R;
    const Vec3 u = perpendicular(plane.normal);
    group.add({chunk.contacts.size() - 1, index, false},
              {u, plane.normal.cross(u), plane.normal, guest.col(0), guest.col(1), guest.col(2),
               Vec3::Constant(seatHalf(i)), cuboid.halfLengths(), (seatHalf(i) + height) * plane.normal},
              {cuboidTie(cuboid, cuboid), seatHalf(i) + cuboid.innerRadius()});
    if (group.count == wideSize) finish();
  }

  /// Ends the looks begun. After that contacts whose `a` is -1 are none.
  void finish() {
    if (group.count == 0) return;
    group.lookWith(lookAtFace<Wide>);
    const FaceLook<Wide>& look = group.look;
    beginOverlap(look, touchingLanes(group), overlaps, group.sums);
    overlaps.finish();
    const PatchLanes patch = endOverlap(look, group.sums, rule);
    const auto point = spreadOut(patch.point), centre = spreadOut(patch.centre), x = spreadOut(look.x);
    for (std::size_t k = 0; k < group.count; ++k) {
      const Waiting& one = group.waiting[k];
      Contact& contact = chunk.contacts[one.contact];
      WallPair& pair = world.pairs.wallPairs[at(one.index)];
      const bool apart = !(look.depth[k] > 0);
      if (look.holds[k] == 0 || look.proven[k] == 0 || (!apart && patch.good[k] == 0)) {
        takeAlone(pair, contact);
      } else if (apart) {
        contact.a = -1;
        waitForGap(pair, -look.depth[k]);
      } else {
        const std::size_t i = at(pair.body);
        const Plane& plane = *world.walls[at(pair.wall)]->asPlane();
        const double height = -plane.depth(world.bodies.x(i));
        const Vec3 seat = world.bodies.x(i) - (seatHalf(i) + height) * plane.normal;
        placeFromLane(patch, point, centre, x, look.depth[k], false, seat, k, contact);
        contact.touch.normal = -plane.normal;
        contact.touch.overlap = look.depth[k];
        contact.touch.placeAbout(contact.patch.point);
      }
    }
    group.count = 0;
  }

 private:
  /// Half the edge of the cube whose face stands for the plane below body i: its other faces are out of reach.
  double seatHalf(std::size_t i) const { return 2 * world.bodies.boundingRadius(i); }

  double travelOf(const WallPair& pair) const { return world.bodies.travel[at(pair.body)] + world.wallTravel; }

  void waitForGap(WallPair& pair, double gap) {
    pair.quietUntil = travelOf(pair) + gap;
    pair.spots.clear();
  }

  void takeAlone(WallPair& pair, Contact& contact) {
    const std::size_t i = at(pair.body);
    chunk.wallTouches.clear();
    world.walls[at(pair.wall)]->touch(rule, *world.bodies.shape[i], world.bodies.frame[i], chunk.wallTouches);
    if (chunk.wallTouches.empty()) {
      contact.a = -1;
      return waitForGap(pair, 0);
    }
    const WallTouch& found = chunk.wallTouches.front();  // a plane has no other
    contact.touch.normal = found.normal;
    contact.touch.overlap = found.overlap;
    contact.patch = found.patch;
    contact.touch.placeAbout(contact.patch.point);
  }

  World& world;
  World::Chunk& chunk;
  const RuleOptions rule;
  CuboidFaceGroup group;
  OverlapsInLanes overlaps;
};

}  // namespace

void findCuboidsAtWalls(std::size_t c, World& world) {
  World::Chunk& chunk = world.chunks[c];
  const Range range = chunkRange(c - world.wallChunkBegin, world.activeWallPairs.size());
  CuboidsAtWalls looks(world, chunk);
  for (std::size_t p = range.first; p < range.last; ++p) looks.take(world.activeWallPairs[p]);
  looks.finish();
  keepTouching(nullptr, world, chunk);
}

}  // namespace granular
