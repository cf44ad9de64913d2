// A support feature: the vertex, edge or face in which a supporting plane meets a shape.
#pragma once

#include <array>
#include <cassert>

#include "granular/core/math.h"

namespace granular {

/// One point, the two ends of a segment, or the corners of a convex polygon, counter-clockwise seen from outside.
/// Fixed size: features are made in the force loop, where nothing may be allocated.
struct Feature {
  static constexpr int capacity = 64;
  std::array<Vec3, capacity> points;
  int count = 0;

  void clear() { count = 0; }
  void push(const Vec3& p) {
    assert(count < capacity);
    points[static_cast<std::size_t>(count++)] = p;
  }
  const Vec3& operator[](int k) const { return points[static_cast<std::size_t>(k)]; }
  Vec3& operator[](int k) { return points[static_cast<std::size_t>(k)]; }
};

}  // namespace granular
