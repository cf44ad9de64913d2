// Convex polygons in the contact plane, of fixed capacity: nothing is allocated in the force loop.
#pragma once

#include <array>
#include <cassert>
#include <cstdint>

#include "granular/shape/feature.h"

namespace granular {

/// Corners counter-clockwise, m, and for the edge from each corner to the next the name its maker gave it. Clipping one
/// polygon of a Feature's capacity by another may add a corner for each line: room for more than both.
struct Polygon {
  static constexpr int capacity = 3 * Feature::capacity;
  std::array<Vec2, capacity> points;
  std::array<std::int32_t, capacity> edges;
  int count = 0;

  void push(const Vec2& p, std::int32_t edge) {
    assert(count < capacity);
    points[static_cast<std::size_t>(count)] = p;
    edges[static_cast<std::size_t>(count++)] = edge;
  }
  int next(int k) const { return k + 1 == count ? 0 : k + 1; }
  std::int32_t edge(int k) const { return edges[static_cast<std::size_t>(k)]; }
  const Vec2& operator[](int k) const { return points[static_cast<std::size_t>(k)]; }
  Vec2& operator[](int k) { return points[static_cast<std::size_t>(k)]; }
};

/// The name of an edge that nothing lies beyond.
inline constexpr std::int32_t noEdge = -1;

/// A straight piece of the contact plane, m.
struct Segment {
  Vec2 from, to;
};

/// An affine function of the contact plane: offset + slope . x. Sides of lines, heights and depths are such.
/// Not set at birth: arrays of it live in the force loop.
struct Linear {
  double offset;
  Vec2 slope;

  double at(const Vec2& x) const { return offset + slope.dot(x); }
  Linear operator-(const Linear& other) const { return {offset - other.offset, slope - other.slope}; }
};

inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace granular
