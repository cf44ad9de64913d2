// Cells of the overlaps of cuboids, many at a time: a face of one box over a face of the other, seen along the normal a
// rectangle over a parallelogram, and a depth that is linear on both. Where a cell goes beyond the rectangle it is
// clipped here; without a branch, so that lanes do not part.
#pragma once

#include "granular/point/overlap_lanes.h"

namespace granular {

/// Cells of one lane each. x and y along the sides of the rectangle; the deepest place lies in both, or at their rim.
struct BoxCell {
  Wide lowX, highX, lowY, highY;  ///< the rectangle, m
  Place corner, along, across;    ///< of the parallelogram, and its edges from there, m
  Wide depth;                     ///< at the deepest place, m
  Place slope;                    ///< of the depth
};

class BoxCells {
 public:
  /// Adds the cells of the lanes chosen; their integrals are added to `sums` when they and the triangles are
  /// integrated, until which it must stay where it is.
  void add(const BoxCell& cell, const Mask<Wide>& chosen, OverlapLanes& sums);
  /// True if there may be no room for `cells` more calls of add().
  bool isFull(std::size_t cells) const { return count + cells * wideSize > capacity; }
  /// Powers of the depth go to `triangles`, if they are wanted.
  void integrate(PowerTriangles& triangles);

 private:
  static constexpr std::size_t capacity = 96;  // the lanes stay in the first cache
  static constexpr std::size_t fields = sizeof(BoxCell) / sizeof(Wide);

  std::size_t count = 0;
  alignas(64) double field[fields][capacity];
  std::array<OverlapLane, capacity> target;
};

}  // namespace granular
