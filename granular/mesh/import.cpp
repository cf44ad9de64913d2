#include "granular/mesh/import.h"

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <fstream>
#include <map>
#include <set>

#include "granular/core/child_process.h"
#include "granular/core/errors.h"
#include "granular/mesh/repair.h"

namespace granular {
namespace {

// What the child sends ahead of its data.
struct Announcement {
  std::int64_t failed = 0;
  std::int64_t vertices = 0;
  std::int64_t triangles = 0;
  std::int64_t otherPrimitives = 0;
  std::int64_t messageBytes = 0;
};

// --- in the child ---

// Keeps the loaders of the supported formats.
void unregisterOtherLoaders(Assimp::Importer& importer) {
  const std::set<std::string> kept = {"obj", "stl", "ply", "off", "gltf", "glb"};
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    Assimp::BaseImporter* loader = importer.GetImporter(k);
    std::set<std::string> extensions;
    loader->GetExtensionList(extensions);
    const bool wanted =
        std::any_of(extensions.begin(), extensions.end(), [&](const std::string& e) { return kept.count(e) > 0; });
    if (wanted) continue;
    importer.UnregisterLoader(loader);
    delete loader;  // the importer has let go of it
  }
}

// What a loader may open: the mesh itself, and what lies beside or below it where the format keeps numbers in files of
// their own (glTF's buffers). A material library, which OBJ names, is not even looked for.
class MeshFolder final : public Assimp::DefaultIOSystem {
 public:
  MeshFolder(const std::string& path, MeshFormat format)
      : mesh(std::filesystem::weakly_canonical(path)), hasBuffers(format == MeshFormat::gltf) {}

  bool Exists(const char* file) const override { return mayOpen(file) && DefaultIOSystem::Exists(file); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    // Reading only.
    return mode[0] == 'r' && mayOpen(file) ? DefaultIOSystem::Open(file, "rb") : nullptr;
  }

 private:
  bool mayOpen(const char* file) const {
    std::error_code error;
    const std::filesystem::path asked = std::filesystem::weakly_canonical(file, error);
    return !error && (asked == mesh || (hasBuffers && isBelow(asked, mesh.parent_path())));
  }

  std::filesystem::path mesh;
  bool hasBuffers;
};

// Appends the meshes of a node and of all nodes below it, placed by the transformations on the way.
void collect(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& parent, RawMesh& out) {
  Eigen::Matrix4d local;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) local(row, column) = node.mTransformation[row][column];
  }
  const Eigen::Matrix4d transform = parent * local;
  for (unsigned k = 0; k < node.mNumMeshes; ++k) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[k]];
    const int first = static_cast<int>(out.vertices.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      out.vertices.push_back((transform * Eigen::Vector4d(p.x, p.y, p.z, 1)).head<3>());
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      const bool valid = std::all_of(face.mIndices, face.mIndices + face.mNumIndices,
                                     [&](unsigned i) { return i < mesh.mNumVertices; });
      if (!valid) throw std::runtime_error("a face uses a vertex that is missing");
      if (face.mNumIndices == 0) throw std::runtime_error("a face has no corners");
      if (face.mNumIndices != 3) {
        ++out.otherPrimitives;
        continue;
      }
      out.triangles.push_back({first + static_cast<int>(face.mIndices[0]), first + static_cast<int>(face.mIndices[1]),
                               first + static_cast<int>(face.mIndices[2])});
    }
    if (static_cast<std::int64_t>(out.vertices.size()) > maxMeshVertices) throw std::runtime_error("too many vertices");
  }
  for (unsigned k = 0; k < node.mNumChildren; ++k) collect(scene, *node.mChildren[k], transform, out);
}

void sendFailure(int pipe, const std::string& message) {
  Announcement announcement;
  announcement.failed = 1;
  announcement.messageBytes = static_cast<std::int64_t>(message.size());
  writeToParent(pipe, &announcement, sizeof announcement);
  writeToParent(pipe, message.data(), message.size());
}

// Everything the loader finds; throws std::runtime_error with the loader's reason.
RawMesh load(const std::string& path, MeshFormat format) {
  Assimp::Importer importer;
  unregisterOtherLoaders(importer);
  importer.SetIOHandler(new MeshFolder(path, format));  // the importer owns it
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) throw std::runtime_error(importer.GetErrorString());
  RawMesh mesh;
  collect(*scene, *scene->mRootNode, Eigen::Matrix4d::Identity(), mesh);
  return mesh;
}

void loadAndSend(const std::string& path, MeshFormat format, int pipe) try {
  const RawMesh mesh = load(path, format);
  Announcement announcement;
  announcement.vertices = static_cast<std::int64_t>(mesh.vertices.size());
  announcement.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  announcement.otherPrimitives = mesh.otherPrimitives;
  writeToParent(pipe, &announcement, sizeof announcement);
  writeToParent(pipe, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
  writeToParent(pipe, mesh.triangles.data(), mesh.triangles.size() * sizeof(std::array<int, 3>));
} catch (const std::bad_alloc&) {
  sendFailure(pipe, "out of memory");
} catch (const std::exception& error) {
  sendFailure(pipe, error.what());
}

// --- in the parent ---

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw InputError("mesh " + path + ": " + reason);
}

[[noreturn]] void refuseUnreadable(const std::string& path, const MeshHeader& header, const std::string& reason) {
  refuse(path, "is not a readable " + formatName(header.format) + " mesh: " + reason);
}

// What the loader found against what the file announces, before memory is taken for it.
void checkCounts(const std::string& path, const MeshHeader& header, const Announcement& found) {
  if (found.triangles == 0) refuse(path, "is empty: no triangle");
  // A face gives one triangle at least, or is a point or a line: fewer means that the loader stopped early.
  if (found.triangles + found.otherPrimitives < header.faces) {
    refuse(path, "is truncated or malformed: it announces " + std::to_string(header.faces) + " faces, and only " +
                     std::to_string(found.triangles) + " triangles could be read");
  }
  if (found.vertices < 0 || found.vertices > maxMeshVertices || found.triangles < 0 || found.triangles > maxMeshFaces) {
    refuse(path,
           "is too big: " + std::to_string(found.triangles) + " triangles; at most " + std::to_string(maxMeshFaces));
  }
}

RawMesh loadInChild(const std::string& path, const MeshHeader& header, const ImportLimits& limits) try {
  const std::int64_t automatic = std::min((std::int64_t{512} << 20) + 64 * header.bytes, std::int64_t{8} << 30);
  ChildProcess child("the loader", {limits.memoryBytes > 0 ? limits.memoryBytes : automatic, limits.seconds},
                     [&](int pipe) { loadAndSend(path, header.format, pipe); });

  Announcement announcement;
  if (!child.read(&announcement, sizeof announcement)) refuse(path, child.finish());
  if (announcement.failed != 0) {
    std::string message(static_cast<std::size_t>(std::clamp<std::int64_t>(announcement.messageBytes, 0, 4096)), '\0');
    if (!child.read(message.data(), message.size())) message = "unknown";
    refuseUnreadable(path, header, message);
  }
  checkCounts(path, header, announcement);
  RawMesh mesh;
  mesh.vertices.resize(static_cast<std::size_t>(announcement.vertices));
  mesh.triangles.resize(static_cast<std::size_t>(announcement.triangles));
  mesh.otherPrimitives = announcement.otherPrimitives;
  if (!child.read(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3)) ||
      !child.read(mesh.triangles.data(), mesh.triangles.size() * sizeof(std::array<int, 3>))) {
    refuse(path, child.finish());
  }
  return mesh;
} catch (const InputError&) {
  throw;
} catch (const std::runtime_error& error) {
  refuse(path, error.what());
}

RawMesh loadHere(const std::string& path, const MeshHeader& header) {
  RawMesh mesh;
  try {
    mesh = load(path, header.format);
  } catch (const std::exception& error) {
    refuseUnreadable(path, header, error.what());
  }
  Announcement found;
  found.vertices = static_cast<std::int64_t>(mesh.vertices.size());
  found.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  found.otherPrimitives = mesh.otherPrimitives;
  checkCounts(path, header, found);
  return mesh;
}

}  // namespace

RawMesh importMesh(const std::string& path, const ImportLimits& limits) {
  const MeshHeader header = checkMeshHeader(path);
  RawMesh mesh = limits.inChild ? loadInChild(path, header, limits) : loadHere(path, header);
  mesh.format = header.format;
  mesh.bytes = header.bytes;
  mesh.perCorner = header.format == MeshFormat::stl || header.format == MeshFormat::obj;
  mesh.file = header.file;
  return mesh;
}

double metresPerUnit(const std::string& unit) {
  static const std::map<std::string, double> known = {{"m", 1},     {"dm", 0.1},    {"cm", 0.01},
                                                      {"mm", 1e-3}, {"um", 1e-6},   {"nm", 1e-9},
                                                      {"km", 1000}, {"in", 0.0254}, {"ft", 0.3048}};
  const auto found = known.find(unit);
  if (found == known.end())
    throw InputError("unit of length '" + unit + "' is unknown; allowed: m, dm, cm, mm, um, nm, km, in, ft");
  return found->second;
}

TriangleMesh importTriangles(const std::string& path, const std::string& unit, double scale) {
  require(scale > 0 && std::isfinite(scale),
          "mesh " + path + ": scale " + std::to_string(scale) + " must be positive and finite");
  const double factor = scale * metresPerUnit(unit);
  MeshDefects defects;
  TriangleMesh mesh = weldMesh(importMesh(path), defects);
  require(defects.nonFiniteVertices == 0, "mesh " + path + ": " + std::to_string(defects.nonFiniteVertices) +
                                              " vertices have a coordinate that is NaN or infinite");
  require(!mesh.triangles.empty(), "mesh " + path + ": no triangle with an area");
  for (Vec3& vertex : mesh.vertices) vertex *= factor;
  return mesh;
}

}  // namespace granular
