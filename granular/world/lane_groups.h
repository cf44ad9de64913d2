// Pairs on their way into lanes and back.
#pragma once

#include <algorithm>
#include <array>
#include <new>

#include "granular/point/patch_lanes.h"
#include "granular/point/witness.h"
#include "granular/world/world.h"

namespace granular {

/// A pair on its way.
struct Waiting {
  std::size_t contact;  ///< in the chunk, to be filled
  std::int32_t index;   ///< of the pair
  bool seatIsA;
};

/// Pairs of one kind of look, a register full. Pairs: vectors, then numbers.
template <class Pairs, class Look>
struct LaneGroup {
  static constexpr std::size_t fields = sizeof(Pairs) / sizeof(Wide);
  std::size_t count = 0;
  std::array<Waiting, wideSize> waiting;
  union {  // side by side, and as add() fills them in: g++ and clang let either be read
    Pairs pairs;
    double lanes[fields][wideSize];
  };
  static_assert(sizeof pairs == sizeof lanes);
  Look look;
  OverlapLanes sums;

  template <std::size_t vectorCount>
  void add(const Waiting& one, const Vec3 (&vectors)[vectorCount], const double (&numbers)[fields - 3 * vectorCount]) {
    std::size_t field = 0;
    for (const Vec3& v : vectors) {
      for (int axis = 0; axis < 3; ++axis) lanes[field++][count] = v[axis];
    }
    for (const double number : numbers) lanes[field++][count] = number;
    waiting[count++] = one;
  }
  /// Looks at the pairs; lanes beyond the last repeat it.
  template <class LookAt>
  void lookWith(LookAt&& lookAt) {
    for (auto& lane : lanes) std::fill(lane + count, lane + wideSize, lane[count - 1]);
    ::new (&look) Look(lookAt(pairs));  // made where it stays: kilobytes
  }
};

/// The lanes of a group that touch, without those beyond the last pair, so that nothing is integrated twice.
template <class Group>
Mask<Wide> touchingLanes(const Group& group) {
  Mask<Wide> chosen = both(both(group.look.holds, group.look.proven), group.look.depth > 0);
  for (std::size_t k = group.count; k < wideSize; ++k) chosen[k] = 0;
  return chosen;
}

/// In memory, to be taken out one by one.
inline TripleLanes<wideSize> spreadOut(const Triple<Wide>& v) {
  TripleLanes<wideSize> lanes;
  lanes.store(0, v);
  return lanes;
}

/// Writes what was found of lane k into a contact. seat: the seat's centre, world, m.
inline void placeFromLane(const PatchLanes& patch, const TripleLanes<wideSize>& point,
                          const TripleLanes<wideSize>& centre, const TripleLanes<wideSize>& x, double depth,
                          bool seatIsA, const Vec3& seat, std::size_t k, Contact& contact) {
  placePoint(seat + point.take(k), x.take(k), depth, contact.patch);
  contact.patch.depth = patch.depth[k];
  contact.patch.squaredDepth = patch.squaredDepth[k];
  contact.patch.centre = seat + centre.take(k);
  contact.patch.area = patch.area[k];
  contact.patch.uu = patch.xx[k];
  contact.patch.vv = patch.yy[k];
  contact.patch.uv = seatIsA ? patch.xy[k] : -patch.xy[k];
  contact.placed = true;
}

/// Takes the contacts without bodies (a = -1) out of a chunk, and looks for the deepest of those that stay. dueOf: for
/// each contact which of the due pairs it belongs to, which learns that it is apart; null: at walls.
void keepTouching(const std::uint16_t* dueOf, const World& world, World::Chunk& chunk);

}  // namespace granular
