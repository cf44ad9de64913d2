// The hull in the plane is Andrew's monotone chain (1979), exact in its comparisons, without allocation.
#include "granular/shape/slab_points.h"

#include <tuple>

namespace granular {

namespace {

using Item = SlabPoints::Item;

double turn(const Item& o, const Item& a, const Item& b) {
  return (a.u - o.u) * (b.v - o.v) - (a.v - o.v) * (b.u - o.u);
}

}  // namespace

void SlabPoints::push(const Vec3& point, double height, int index) {
  const Item item{point, height, index};
  if (!isFull()) {
    items[static_cast<std::size_t>(count++)] = item;
    return;
  }
  const auto lowest =
      std::min_element(items.begin(), items.end(), [](const Item& s, const Item& t) { return s.height < t.height; });
  if (height > lowest->height) *lowest = item;
}

void hullSeenAlong(const Vec3& d, SlabPoints& points, Feature& out) {
  const Vec3 u = perpendicular(d);
  const Vec3 v = d.cross(u);
  for (Item& item : points) {
    item.u = u.dot(item.point);
    item.v = v.dot(item.point);
  }

  // of points that coincide in the plane the highest comes first and stays
  std::sort(points.begin(), points.end(), [](const Item& s, const Item& t) {
    return std::tuple(s.u, s.v, -s.height, s.index) < std::tuple(t.u, t.v, -t.height, t.index);
  });
  const Item* last =
      std::unique(points.begin(), points.end(), [](const Item& s, const Item& t) { return s.u == t.u && s.v == t.v; });
  const int n = static_cast<int>(last - points.begin());

  // lower chain from left to right, then the upper one back
  std::array<int, 2 * Feature::capacity + 1> chain;
  int count = 0;
  const auto extend = [&](int k, int base) {
    const auto entry = [&](int j) -> const Item& { return points[chain[static_cast<std::size_t>(j)]]; };
    while (count >= base + 2 && turn(entry(count - 2), entry(count - 1), points[k]) <= 0) --count;
    chain[static_cast<std::size_t>(count++)] = k;
  };
  for (int k = 0; k < n; ++k) extend(k, 0);
  const int lower = count - 1;
  for (int k = n - 2; k >= 0; --k) extend(k, lower);
  const int corners = std::max(1, count - 1);

  // from the highest corner on; ties go to the one the shape named first
  int first = 0;
  for (int k = 1; k < corners; ++k) {
    const Item &best = points[chain[static_cast<std::size_t>(first)]],
               &item = points[chain[static_cast<std::size_t>(k)]];
    if (std::tuple(-item.height, item.index) < std::tuple(-best.height, best.index)) first = k;
  }
  out.clear();
  for (int k = 0; k < corners; ++k) {
    out.push(points[chain[static_cast<std::size_t>((first + k) % corners)]].point);
  }
}

}  // namespace granular
