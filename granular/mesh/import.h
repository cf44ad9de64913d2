// Triangles from a mesh file, through assimp in a limited child process.
// assimp allocates by what a file claims and crashes on some malformed ones: so the counts are checked first
// (mesh_header.h), only the loaders of the supported formats stay registered, the loader sees no file but the mesh and,
// for glTF, buffers beside or below it, and it runs in a forked child with bounds on memory and time. The child sends
// plain numbers through a pipe; whatever happens to it, the caller gets triangles or an InputError.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "granular/mesh/mesh_header.h"
#include "granular/shape/shape.h"

namespace granular {

/// Triangles as the loader gives them: nothing joined, nothing checked but the indices. Coordinates in the file's own
/// unit, rounded to single precision by the loader.
struct RawMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  MeshFormat format = MeshFormat::ply;
  std::int64_t bytes = 0;
  /// Vertices are listed once per corner: by the format (STL) or by the loader (OBJ). Then a repeated position is no
  /// defect.
  bool perCorner = false;
  std::optional<FileVertices> file;  ///< the file's own list where the loader does not keep it
  std::int64_t otherPrimitives = 0;  ///< points and lines, left out
};

/// Bounds of the child process.
struct ImportLimits {
  /// false: the loader runs in this process, without bounds, and takes it down with itself. For debuggers and fuzzers.
  bool inChild = true;
  std::int64_t memoryBytes =
      0;                ///< beyond what the parent holds; 0: 512 MiB and 64 bytes per byte of the file, at most 8 GiB
  double seconds = 60;  ///< of processor time, and twice as many by the clock
};

/// Throws InputError naming the file and the reason: all of checkMeshHeader, a loader that fails, crashes or meets its
/// limits, no triangles.
RawMesh importMesh(const std::string& path, const ImportLimits& limits = {});

/// Metres per unit: "m", "dm", "cm", "mm", "um", "nm", "km", "in", "ft". Throws InputError for any other name.
double metresPerUnit(const std::string& unit);

/// Triangles for a mesh wall: metres (file coordinates times scale times the unit), vertices welded, duplicate and
/// degenerate triangles dropped, orientation as in the file, open edges allowed. Throws InputError as importMesh does,
/// for vertices that are not finite, for scale <= 0 and when no triangle is left.
TriangleMesh importTriangles(const std::string& path, const std::string& unit = "m", double scale = 1);

}  // namespace granular
