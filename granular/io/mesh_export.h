// The final bed as triangle meshes for other programs, written by assimp.
//
// STL: one mesh in m, z up, as it lies in the simulation; for CFD meshing and printing. GLB (binary glTF 2.0): a node
// per particle, named particle_<id>, and a mesh per shape, in m and with glTF's y up, so that viewers show the bed
// upright. So many different shapes that assimp would need minutes for them are put together, particles_<id>_to_<id>.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "granular/shape/shape.h"

namespace granular {

struct MeshExportOptions {
  int resolution = 24;  ///< segments around a full circle of a curved surface
  int mostMeshes = 0;   ///< of a GLB; 0: as many as are written in some ten seconds
  double gap = 0;       ///< every particle is scaled about its centre by 1 - gap, so that touching ones come apart
};

/// Writes by the ending of the path: .stl (binary) or .glb. Throws InputError for another ending, no particles, or a
/// file that can't be written.
void exportBed(const std::filesystem::path& path, std::span<const Shape* const> shapes, std::span<const Frame> frames,
               std::span<const std::int64_t> ids, const MeshExportOptions& options = {});

}  // namespace granular
