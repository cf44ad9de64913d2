// Pairs of cuboids on their way into lanes: with each other and with flat walls.
#pragma once

#include <algorithm>
#include <new>

#include "granular/point/cuboid_overlap.h"
#include "granular/world/lane_groups.h"

namespace granular {

/// Pairs of one kind of look, a register full.
template <class Look>
struct Group {
  static constexpr std::size_t fields = sizeof(CuboidPair<Wide>) / sizeof(Wide);
  std::size_t count = 0;
  std::array<Waiting, wideSize> waiting;
  union {  // side by side, and as add() fills them in: g++ and clang let either be read
    CuboidPair<Wide> pairs;
    double lanes[fields][wideSize];
  };
  static_assert(sizeof pairs == sizeof lanes);
  Look look;
  OverlapLanes sums;

  void add(const Waiting& one, const std::array<Vec3, 9>& vectors, double tie, double inner) {
    std::size_t field = 0;
    for (const Vec3& v : vectors) {
      for (int axis = 0; axis < 3; ++axis) lanes[field++][count] = v[axis];
    }
    lanes[field++][count] = tie;
    lanes[field][count] = inner;
    waiting[count++] = one;
  }
  /// Looks at the pairs with lookAtFace or lookAtEdges; lanes beyond the last repeat it.
  template <class LookAt>
  void lookWith(LookAt&& lookAt) {
    for (auto& lane : lanes) std::fill(lane + count, lane + wideSize, lane[count - 1]);
    ::new (&look) Look(lookAt(pairs));  // made where it stays: kilobytes
  }
};

}  // namespace granular
