// A static tree of boxes over the triangles of a mesh wall: which of them can a body touch?
// Split at the median of the longest side, a few triangles per leaf, stored depth first: a box test that fails skips
// ahead.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "granular/core/math.h"

namespace granular {

class TriangleTree {
 public:
  TriangleTree() = default;
  TriangleTree(std::span<const Vec3> vertices, std::span<const std::array<std::int32_t, 3>> triangles);

  /// Appends the triangles whose own bounds overlap the box, in ascending order.
  void findOverlapping(const Aabb& box, std::vector<std::int32_t>& out) const;

  /// Distance from p to the nearest box of a triangle, at most `limit` (m): a lower bound of the distance to the mesh.
  double distanceBound(const Vec3& p, double limit) const;

  /// Squared distance from p to the nearest triangle, which is returned. The tree must not be empty.
  std::int32_t findNearest(const Vec3& p, double& distanceSquared) const;

 private:
  struct Node {
    Aabb bounds;
    std::int32_t skip;          ///< the node after this one and all below it
    std::int32_t first, count;  ///< leaf: its part of `order`; count 0 otherwise
  };
  void build(std::int32_t first, std::int32_t last);

  std::vector<Node> nodes;
  std::vector<std::int32_t> order;
  std::vector<Aabb> boxes;                   ///< by triangle
  std::vector<std::array<Vec3, 3>> corners;  ///< by triangle
};

/// The point of the triangle nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
Vec3 nearestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace granular
