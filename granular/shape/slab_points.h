// The points of a shape within a slab below a supporting plane, and the convex polygon they make seen along its normal.
#pragma once

#include <algorithm>

#include "granular/shape/feature.h"

namespace granular {

/// Up to Feature::capacity points; of more, the deepest are kept (of equally deep ones, those that came first).
/// No allocation.
class SlabPoints {
 public:
  struct Item {
    Vec3 point;
    double height;        ///< along the slab's normal, m
    int index;            ///< whatever the shape calls the point by
    double u = 0, v = 0;  ///< coordinates in the plane, set by hullSeenAlong
  };

  int size() const { return count; }
  bool isFull() const { return count == Feature::capacity; }
  void clear() { count = 0; }
  const Item& operator[](int k) const { return items[static_cast<std::size_t>(k)]; }
  Item* begin() { return items.data(); }
  Item* end() { return items.data() + count; }

  bool holds(int index) const {
    return std::any_of(items.data(), items.data() + count, [index](const Item& item) { return item.index == index; });
  }
  void push(const Vec3& point, double height, int index);

 private:
  std::array<Item, Feature::capacity> items;
  int count = 0;
};

/// The convex hull of the points seen along the unit vector d, counter-clockwise, beginning with its highest
/// corner. (The highest point of all may lie inside the polygon.) The points are reordered.
void hullSeenAlong(const Vec3& d, SlabPoints& points, Feature& out);

}  // namespace granular
