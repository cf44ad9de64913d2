// Cells of the overlaps of cuboids, many at a time: a face of one box over a face of the other, seen along the normal a
// rectangle over a parallelogram, and a depth that is linear on both. Each cell is integrated in closed form without
// clipping a polygon (box_cells.cpp): the integrals of integrate(Polygon, Linear) to round-off.
#pragma once

#include <array>

#include "granular/core/wide.h"

namespace granular {

/// The integrals of one contact per lane, as AreaMoments, without `square`.
struct alignas(64) MomentLanes {
  using Lane = double[wideSize];
  Lane area, x, y, xx, xy, yy, volume, volumeX, volumeY;
  /// The second moment that spikes may have added and taken away, m^4: times the round-off it is the error of the
  /// others.
  Lane spikes;
};

/// Cells of one lane each. In the contact plane; x and y along the sides of the rectangle.
struct BoxCell {
  Wide lowX, highX, lowY, highY;          ///< the rectangle, m
  Wide cornerX, cornerY;                  ///< of the parallelogram, m
  Wide alongX, alongY, acrossX, acrossY;  ///< its edges from there, in either order, m
  Wide depth, slopeX, slopeY;             ///< at the origin, m; its slope
};

class BoxCells {
 public:
  /// Adds the cells of the lanes chosen; their integrals are added to `sums` by one of the next calls of integrate(),
  /// until which it must stay where it is.
  void add(const BoxCell& cell, const Mask<Wide>& chosen, MomentLanes& sums);
  /// True if there may be no room for `cells` more calls of add().
  bool isFull(std::size_t cells) const { return count + cells * wideSize > capacity; }
  void integrate();

 private:
  static constexpr std::size_t capacity = 96;  // the lanes stay in the first cache
  static constexpr std::size_t fields = sizeof(BoxCell) / sizeof(Wide);
  using Lane = double[capacity];

  std::size_t count = 0;
  alignas(64) Lane field[fields];
  std::array<MomentLanes*, capacity> target;
  std::array<std::uint8_t, capacity> targetLane;
};

}  // namespace granular
