// Frames and fields for ParaView: VTK XML files with appended raw binary data (UInt64 block headers, little endian).
//
// .vtp: surfaces of all particles, or the network of contact forces; .pvd: a collection of them over time;
// .vti: the voxel field of the porosity. Lengths in m.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "granular/analysis/bed.h"
#include "granular/analysis/voxel_field.h"
#include "granular/shape/shape.h"

namespace granular {

/// A named array of numbers, `components` per point or cell.
struct VtkArray {
  std::string name;
  std::variant<std::vector<float>, std::vector<double>, std::vector<std::int32_t>, std::vector<std::int64_t>> values;
  int components = 1;
  std::size_t tuples() const;
};

/// Points, segments and triangles. Cell arrays hold the segments first.
struct VtkPolyData {
  std::vector<Vec3> points;
  std::vector<std::array<int, 2>> lines;
  std::vector<std::array<int, 3>> triangles;
  std::vector<VtkArray> pointArrays, cellArrays;
};

/// Throws InputError if the file can't be written; so do all below. Arrays must fit the number of points or cells.
void writePolyData(const std::filesystem::path& path, const VtkPolyData& data);

/// The surfaces of particles with arrays of one tuple per particle, repeated for each of its triangles.
/// resolution: segments around a full circle; scale: of every particle about its centre.
VtkPolyData makeSurfaces(std::span<const Shape* const> shapes, std::span<const Frame> frames,
                         std::span<const VtkArray> particleArrays, int resolution, double scale = 1);

/// Contact forces: a segment from centre to centre, or from centre to contact point at a wall, with force_N,
/// normal_force_N and overlap_m.
VtkPolyData makeForceNetwork(const Bed& bed);

/// Cells with solid share, vessel share and porosity (1 outside the vessel's voxels).
void writeVoxels(const std::filesystem::path& path, const VoxelField& field);

/// A .pvd collection that is whole after every frame.
class FrameSeries {
 public:
  explicit FrameSeries(std::filesystem::path target) : path(std::move(target)) {}
  /// Adds a file, in the collection's folder or below, at a simulated time in s, and writes the collection.
  void add(double time, const std::filesystem::path& file);

  struct Entry {
    double time;
    std::string file;
  };
  /// What a resumed run needs to go on.
  const std::vector<Entry>& entries() const { return frames; }
  void restore(std::vector<Entry> saved) { frames = std::move(saved); }

 private:
  std::filesystem::path path;
  std::vector<Entry> frames;
};

}  // namespace granular
