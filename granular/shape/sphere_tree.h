// A bounding tree over the spheres of a clump, in body axes: every node a ball around its spheres, so that a turned
// clump needs no new tree. Searches visit only what may be near.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "granular/shape/sphere_union.h"

namespace granular {

class SphereTree {
 public:
  struct Node {
    Vec3 centre;  ///< body axes, m
    double radius = 0;
    std::int32_t child = -1;  ///< leaf: index of its sphere
    std::int32_t right = -1;  ///< else: the second branch; the first is the next node
    bool isLeaf() const { return child >= 0; }
  };

  SphereTree() = default;
  /// A leaf's ball is its sphere, bit for bit.
  explicit SphereTree(std::span<const ChildSphere> spheres);

  const std::vector<Node>& nodes() const { return all; }

  /// Calls visit(index of sphere) for every sphere whose leaf and all nodes above pass near(centre, radius).
  template <class Near, class Visit>
  void visitNear(Near&& near, Visit&& visit) const {
    std::int32_t stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Node& node = all[static_cast<std::size_t>(stack[--depth])];
      if (!near(node.centre, node.radius)) continue;
      if (node.isLeaf()) {
        visit(node.child);
        continue;
      }
      stack[depth++] = node.right;
      stack[depth++] = static_cast<std::int32_t>(&node - all.data()) + 1;
    }
  }

 private:
  void build(std::span<const ChildSphere> spheres, std::span<std::int32_t> indices);

  std::vector<Node> all;
};

}  // namespace granular
