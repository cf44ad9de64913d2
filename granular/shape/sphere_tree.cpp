// Spheres are halved at the median along the longest side of the box of their centres: depth log2 N.
#include "granular/shape/sphere_tree.h"

#include <algorithm>
#include <numeric>

#include "granular/core/tolerances.h"

namespace granular {

SphereTree::SphereTree(std::span<const ChildSphere> spheres) {
  std::vector<std::int32_t> indices(spheres.size());
  std::iota(indices.begin(), indices.end(), 0);
  all.reserve(2 * spheres.size());
  build(spheres, indices);
}

void SphereTree::build(std::span<const ChildSphere> spheres, std::span<std::int32_t> indices) {
  const auto sphere = [&](std::int32_t k) -> const ChildSphere& { return spheres[static_cast<std::size_t>(k)]; };
  const std::size_t own = all.size();
  all.emplace_back();
  if (indices.size() == 1) {
    all[own].centre = sphere(indices[0]).centre;
    all[own].radius = sphere(indices[0]).radius;
    all[own].child = indices[0];
    return;
  }

  // The ball about the middle of the box around the spheres.
  Vec3 lo = Vec3::Constant(infinity), hi = -lo, first = lo, last = hi;
  for (const std::int32_t k : indices) {
    lo = lo.cwiseMin((sphere(k).centre.array() - sphere(k).radius).matrix());
    hi = hi.cwiseMax((sphere(k).centre.array() + sphere(k).radius).matrix());
    first = first.cwiseMin(sphere(k).centre);
    last = last.cwiseMax(sphere(k).centre);
  }
  const Vec3 middle = 0.5 * (lo + hi);
  double radius = 0;
  for (const std::int32_t k : indices) radius = std::max(radius, (sphere(k).centre - middle).norm() + sphere(k).radius);
  all[own].centre = middle;
  all[own].radius = radius * (1 + tolerance::onSurface);

  int axis = 0;
  (last - first).maxCoeff(&axis);
  std::sort(indices.begin(), indices.end(), [&](std::int32_t k, std::int32_t l) {
    const double a = sphere(k).centre[axis], b = sphere(l).centre[axis];
    return a != b ? a < b : k < l;
  });
  const std::size_t half = indices.size() / 2;
  build(spheres, indices.first(half));
  all[own].right = static_cast<std::int32_t>(all.size());
  build(spheres, indices.subspan(half));
}

}  // namespace granular
