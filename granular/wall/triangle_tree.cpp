#include "granular/wall/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace granular {

namespace {

constexpr std::int32_t leafSize = 4;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

double distanceSquaredTo(const Aabb& box, const Vec3& p) {
  return (box.lo - p).cwiseMax(p - box.hi).cwiseMax(0.0).squaredNorm();
}

}  // namespace

Vec3 nearestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  // Each vertex and each edge owns the points whose coordinates along its neighbours are negative.
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

TriangleTree::TriangleTree(std::span<const Vec3> vertices, std::span<const std::array<std::int32_t, 3>> triangles) {
  for (const auto& triangle : triangles) {
    Aabb box;
    std::array<Vec3, 3>& corner = corners.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = vertices[at(triangle[k])];
      box.include(corner[k]);
    }
    boxes.push_back(box);
  }
  order.resize(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  build(0, static_cast<std::int32_t>(triangles.size()));
}

void TriangleTree::build(std::int32_t first, std::int32_t last) {
  if (first == last) return;
  const std::size_t node = nodes.size();
  nodes.emplace_back();
  Aabb bounds, centres;
  const auto centre = [&](std::int32_t t) -> Vec3 { return 0.5 * (boxes[at(t)].lo + boxes[at(t)].hi); };
  for (std::int32_t k = first; k < last; ++k) {
    bounds.include(boxes[at(order[at(k)])].lo);
    bounds.include(boxes[at(order[at(k)])].hi);
    centres.include(centre(order[at(k)]));
  }
  const bool leaf = last - first <= leafSize;
  if (!leaf) {
    int axis;
    (centres.hi - centres.lo).maxCoeff(&axis);
    const std::int32_t middle = first + (last - first) / 2;
    std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                     [&](std::int32_t a, std::int32_t b) {
                       const double ca = centre(a)[axis], cb = centre(b)[axis];
                       return ca < cb || (ca == cb && a < b);
                     });
    build(first, middle);
    build(middle, last);
  }
  nodes[node] = {bounds, static_cast<std::int32_t>(nodes.size()), first, leaf ? last - first : 0};
}

void TriangleTree::findOverlapping(const Aabb& box, std::vector<std::int32_t>& out) const {
  const auto begin = static_cast<std::ptrdiff_t>(out.size());
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes.size());) {
    const Node& node = nodes[at(n)];
    if (!node.bounds.overlaps(box)) {
      n = node.skip;
      continue;
    }
    for (std::int32_t k = node.first; k < node.first + node.count; ++k)
      if (boxes[at(order[at(k)])].overlaps(box)) out.push_back(order[at(k)]);
    ++n;
  }
  std::sort(out.begin() + begin, out.end());
}

void TriangleTree::searchNearest(std::int32_t n, const Vec3& p, double& distanceSquared, std::int32_t& nearest) const {
  const Node& node = nodes[at(n)];
  for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
    const std::int32_t t = order[at(k)];
    const double d = (p - findNearestOn(t, p)).squaredNorm();
    if (d < distanceSquared || (d == distanceSquared && t < nearest)) {
      distanceSquared = d;
      nearest = t;
    }
  }
  if (node.count > 0) return;

  // The nearer half first: mostly it spares the other.
  std::array<std::int32_t, 2> child{n + 1, nodes[at(n + 1)].skip};
  std::array<double, 2> distance{distanceSquaredTo(nodes[at(child[0])].bounds, p),
                                 distanceSquaredTo(nodes[at(child[1])].bounds, p)};
  if (distance[1] < distance[0]) {
    std::swap(child[0], child[1]);
    std::swap(distance[0], distance[1]);
  }
  for (std::size_t k = 0; k < 2; ++k)
    if (distance[k] <= distanceSquared) searchNearest(child[k], p, distanceSquared, nearest);
}

std::int32_t TriangleTree::findNearest(const Vec3& p, double& distanceSquared) const {
  std::int32_t nearest = -1;
  distanceSquared = infinity;
  searchNearest(0, p, distanceSquared, nearest);
  return nearest;
}

}  // namespace granular
