// The bed as a field of voxels: the solid share of each, for a solver that meshes the voids or a picture.
#pragma once

#include <array>
#include <vector>

#include "granular/analysis/occupancy.h"

namespace granular {

struct VoxelField {
  Vec3 origin = Vec3::Zero();  ///< lower corner of the first voxel, m
  double edge = 0;             ///< m
  std::array<int, 3> count{};  ///< voxels along x, y, z
  std::vector<float> solid;    ///< share of the voxel's volume inside particles, 0 ... 1; x runs fastest
  std::vector<float> vessel;   ///< share of it inside the vessel; porosity = 1 - solid / vessel
  bool empty() const { return solid.empty(); }
};

/// Cubic voxels over the vessel from its floor to the highest particle (no vessel: over the particles' bounds), each
/// sampled by samples^3 points. Throws InputError for an edge <= 0, samples < 1 or more than 1e8 voxels.
VoxelField measureVoxels(const Bed& bed, const Occupancy& occupancy, double edge, int samples);

}  // namespace granular
