// A static tree of boxes over the triangles of a mesh wall: which of them can a body touch?
// Split at the median of the longest side, a few triangles per leaf, stored depth first: a box test that fails skips
// ahead.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "granular/core/math.h"

namespace granular {

/// The point of the triangle nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
Vec3 nearestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

class TriangleTree {
 public:
  TriangleTree() = default;
  TriangleTree(std::span<const Vec3> vertices, std::span<const std::array<std::int32_t, 3>> triangles);

  /// Appends the triangles whose own bounds overlap the box, in ascending order.
  void findOverlapping(const Aabb& box, std::vector<std::int32_t>& out) const;

  /// Squared distance from p to the nearest triangle, which is returned. The tree must not be empty.
  std::int32_t findNearest(const Vec3& p, double& distanceSquared) const;

  /// The point of a triangle nearest to p.
  Vec3 findNearestOn(std::int32_t triangle, const Vec3& p) const {
    const auto& corner = corners[static_cast<std::size_t>(triangle)];
    return nearestOnTriangle(p, corner[0], corner[1], corner[2]);
  }

 private:
  struct Node {
    Aabb bounds;
    std::int32_t skip;          ///< the node after this one and all below it
    std::int32_t first, count;  ///< leaf: its part of `order`; count 0 otherwise
  };
  void build(std::int32_t first, std::int32_t last);
  void searchNearest(std::int32_t node, const Vec3& p, double& distanceSquared, std::int32_t& nearest) const;

  std::vector<Node> nodes;
  std::vector<std::int32_t> order;
  std::vector<Aabb> boxes;                   ///< by triangle
  std::vector<std::array<Vec3, 3>> corners;  ///< by triangle
};

}  // namespace granular
