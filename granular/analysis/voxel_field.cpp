#include "granular/analysis/voxel_field.h"

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {

namespace {

/// The bounds of the field.
Aabb boundField(const Vessel& vessel, const Aabb& particles) {
  Aabb box = particles;
  if (vessel.kind == Vessel::Kind::none) return box;
  if (vessel.kind == Vessel::Kind::cylinder) {
    box.lo.head<2>() = vessel.axis.array() - vessel.radius;
    box.hi.head<2>() = vessel.axis.array() + vessel.radius;
  } else {
    box.lo.head<2>() = vessel.lo.head<2>();
    box.hi.head<2>() = vessel.hi.head<2>();
  }
  if (vessel.kind == Vessel::Kind::periodic && vessel.periodicHeight) {
    box.lo.z() = vessel.lo.z();
    box.hi.z() = vessel.hi.z();
  } else {
    box.lo.z() = vessel.floor;
  }
  return box;
}

bool isInside(const Vessel& vessel, const Aabb& box, const Vec3& p) {
  if (vessel.kind == Vessel::Kind::cylinder && (p.head<2>() - vessel.axis).norm() > vessel.radius) return false;
  return (p.array() >= box.lo.array()).all() && (p.array() <= box.hi.array()).all();
}

}  // namespace

VoxelField measureVoxels(const Bed& bed, const Occupancy& occupancy, double edge, int samples) {
  require(edge > 0, "voxels: the edge must be > 0, not " + std::to_string(edge) + " m");
  require(samples >= 1, "voxels: at least 1 sample per axis, not " + std::to_string(samples));
  const Aabb box = boundField(bed.vessel, occupancy.bounds());
  VoxelField field;
  field.origin = box.lo;
  field.edge = edge;
  double total = 1;
  for (int k = 0; k < 3; ++k) {
    const double along = std::max(1.0, std::ceil((box.hi[k] - box.lo[k]) / edge - 1e-9));
    total *= along;
    require(total <= 1e8, "voxels: more than 1e8 of edge " + std::to_string(edge) + " m; use a longer edge");
    field.count[static_cast<std::size_t>(k)] = static_cast<int>(along);
  }
  field.solid.resize(static_cast<std::size_t>(total));
  field.vessel.resize(field.solid.size());

  const double step = edge / samples;
  const auto rows = static_cast<std::int64_t>(field.count[1]) * field.count[2];
#pragma omp parallel for schedule(dynamic, 8)
  for (std::int64_t row = 0; row < rows; ++row) {
    const std::int64_t y = row % field.count[1], z = row / field.count[1];
    for (int x = 0; x < field.count[0]; ++x) {
      const Vec3 corner = field.origin + edge * Vec3(x, static_cast<double>(y), static_cast<double>(z));
      int solid = 0, inside = 0;
      for (int n = 0; n < samples * samples * samples; ++n) {
        const int layer = n / (samples * samples), line = n / samples % samples;
        const Vec3 p = corner + step * Vec3(n % samples + 0.5, line + 0.5, layer + 0.5);
        if (!isInside(bed.vessel, box, p)) continue;
        ++inside;
        if (occupancy.contains(p)) ++solid;
      }
      const auto at = static_cast<std::size_t>(row * field.count[0] + x);
      const double points = static_cast<double>(samples) * samples * samples;
      field.solid[at] = static_cast<float>(solid / points);
      field.vessel[at] = static_cast<float>(inside / points);
    }
  }
  return field;
}

}  // namespace granular
