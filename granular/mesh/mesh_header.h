// What a mesh file claims to hold, checked against its size before any loader allocates memory by it.
// A loader believes the counts in a header: a file of a hundred bytes may ask for tens of gigabytes. Here each count is
// compared with the smallest number of bytes that such content takes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace granular {

enum class MeshFormat { obj, stl, ply, off, gltf, glb };

/// "OBJ", "STL", ...
std::string formatName(MeshFormat format);

/// Vertices as the file lists them, where the loader does not keep that list (OBJ).
struct FileVertices {
  std::int64_t listed = 0;        ///< all
  std::int64_t unreferenced = 0;  ///< used by no face
  std::int64_t nonFinite = 0;     ///< with a coordinate that is NaN, infinite or beyond single precision
  std::int64_t usable = 0;        ///< used by a face, and finite
};

struct MeshHeader {
  MeshFormat format = MeshFormat::obj;
  std::int64_t bytes = 0;
  std::int64_t vertices = 0;  ///< announced or listed; three per triangle for STL
  std::int64_t faces = 0;     ///< announced or listed
  std::optional<FileVertices> file;
};

/// Largest files and meshes that are accepted.
inline constexpr std::int64_t maxMeshBytes = std::int64_t{1} << 29;  ///< 512 MiB
inline constexpr std::int64_t maxMeshFaces = 5'000'000;
inline constexpr std::int64_t maxMeshVertices = 3 * maxMeshFaces;

/// Reads the header (OBJ: the whole text) and checks it. Throws InputError naming the file and the reason: missing, not
/// a file, empty, too big, unsupported format, not a mesh at all, truncated, counts that the file cannot hold, indices
/// out of range, glTF buffers outside the mesh's folder.
MeshHeader checkMeshHeader(const std::string& path);

/// True if a file lies in a folder or below it. Both canonical.
bool isBelow(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace granular
