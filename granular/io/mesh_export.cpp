#include "granular/io/mesh_export.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Exporter.hpp>
#include <map>

#include "granular/core/errors.h"
#include "granular/io/output_file.h"

namespace granular {
namespace {

/// One triangle mesh as assimp holds it; the scene it enters owns it.
aiMesh* makeMesh(const TriangleMesh& from, const std::string& name) {
  const auto& [vertices, triangles] = from;
  auto* mesh = new aiMesh;
  mesh->mName = name;
  mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  mesh->mNumVertices = static_cast<unsigned>(vertices.size());
  mesh->mVertices = new aiVector3D[vertices.size()];
  for (std::size_t k = 0; k < vertices.size(); ++k)
    mesh->mVertices[k] = aiVector3D(static_cast<float>(vertices[k].x()), static_cast<float>(vertices[k].y()),
                                    static_cast<float>(vertices[k].z()));
  mesh->mNumFaces = static_cast<unsigned>(triangles.size());
  mesh->mFaces = new aiFace[triangles.size()];
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    mesh->mFaces[k].mNumIndices = 3;
    mesh->mFaces[k].mIndices = new unsigned[3];
    for (std::size_t c = 0; c < 3; ++c) mesh->mFaces[k].mIndices[c] = static_cast<unsigned>(triangles[k][c]);
  }
  return mesh;
}

/// A scene with these meshes and one plain material.
void fillScene(const std::vector<aiMesh*>& meshes, aiScene& scene) {
  scene.mNumMeshes = static_cast<unsigned>(meshes.size());
  scene.mMeshes = new aiMesh*[meshes.size()];
  std::copy(meshes.begin(), meshes.end(), scene.mMeshes);
  scene.mNumMaterials = 1;
  scene.mMaterials = new aiMaterial*[1];
  scene.mMaterials[0] = new aiMaterial;
  scene.mRootNode = new aiNode("bed");
}

/// The surfaces of particles as one mesh in world coordinates, m.
TriangleMesh surfaceOf(std::span<const Shape* const> shapes, std::span<const Frame> frames,
                       const MeshExportOptions& options) {
  TriangleMesh all;
  std::map<const Shape*, TriangleMesh> meshes;  // each shape is triangulated once
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const auto [found, isNew] = meshes.try_emplace(shapes[k]);
    if (isNew) found->second = shapes[k]->surface(options.resolution);
    const TriangleMesh& mesh = found->second;
    const int first = static_cast<int>(all.vertices.size());
    for (const Vec3& p : mesh.vertices) all.vertices.push_back(frames[k].toWorld((1 - options.gap) * p));
    for (const auto& t : mesh.triangles) all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return all;
}

/// All particles as one mesh.
void fillStl(std::span<const Shape* const> shapes, std::span<const Frame> frames, const MeshExportOptions& options,
             aiScene& scene) {
  fillScene({makeMesh(surfaceOf(shapes, frames, options), "bed")}, scene);
  scene.mRootNode->mNumMeshes = 1;
  scene.mRootNode->mMeshes = new unsigned[1]{0};
}

/// What assimp's exporter may copy: it makes room for each mesh by copying all those before it, three times over.
constexpr double mostCopied = 5e10;  // bytes, some ten seconds

/// Bytes of a mesh in the file: float vertices, normals and indices.
double bytesOf(const TriangleMesh& mesh) {
  return 24.0 * static_cast<double>(mesh.vertices.size()) + 12.0 * static_cast<double>(mesh.triangles.size());
}

aiNode* addNode(const std::string& name, unsigned mesh, aiNode& parent, unsigned index) {
  auto* node = new aiNode(name);
  node->mParent = &parent;
  node->mNumMeshes = 1;
  node->mMeshes = new unsigned[1]{mesh};
  parent.mChildren[index] = node;
  return node;
}
void makeRoom(std::size_t children, aiNode& parent) {
  parent.mNumChildren = static_cast<unsigned>(children);
  parent.mChildren = new aiNode*[children];
}

/// Lengths in a GLB are micrometres under a root node that scales them to metres: assimp's exporter leaves out a
/// transformation that it takes for the identity, which in metres is every translation below 10 mm.
constexpr double unit = 1e-6;

/// Places a particle; z up becomes y up.
aiMatrix4x4 place(const Frame& frame) {
  aiMatrix4x4 m;
  const int from[] = {0, 2, 1};
  const double sign[] = {1, 1, -1};
  for (unsigned row = 0; row < 3; ++row) {
    for (unsigned col = 0; col < 3; ++col)
      m[row][col] = static_cast<float>(sign[row] * frame.R(from[row], static_cast<int>(col)));
    m[row][3] = static_cast<float>(sign[row] * frame.x[from[row]] / unit);
  }
  return m;
}

/// One mesh per shape, one node per particle. surfaces: of each shape, m.
void fillGlbByShapes(std::vector<TriangleMesh>& surfaces, const std::map<const Shape*, unsigned>& meshOf,
                     std::span<const Shape* const> shapes, std::span<const Frame> frames,
                     std::span<const std::int64_t> ids, const MeshExportOptions& options, aiScene& scene) {
  std::vector<aiMesh*> meshes;
  for (TriangleMesh& surface : surfaces) {
    for (Vec3& p : surface.vertices) p *= (1 - options.gap) / unit;
    meshes.push_back(makeMesh(surface, fmt::format("shape_{}", meshes.size())));
  }
  fillScene(meshes, scene);
  makeRoom(shapes.size(), *scene.mRootNode);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    addNode(fmt::format("particle_{}", ids[k]), meshOf.at(shapes[k]), *scene.mRootNode, static_cast<unsigned>(k))
        ->mTransformation = place(frames[k]);
  }
}

/// `count` meshes and nodes of many particles each, where every particle has a shape of its own.
void fillGlbByGroups(std::size_t count, std::span<const Shape* const> shapes, std::span<const Frame> frames,
                     std::span<const std::int64_t> ids, const MeshExportOptions& options, aiScene& scene) {
  std::vector<aiMesh*> meshes;
  std::vector<std::string> names;
  const std::size_t each = (shapes.size() + count - 1) / count;
  for (std::size_t begin = 0; begin < shapes.size(); begin += each) {
    const std::size_t some = std::min(each, shapes.size() - begin);
    TriangleMesh surface = surfaceOf(shapes.subspan(begin, some), frames.subspan(begin, some), options);
    for (Vec3& p : surface.vertices) p = Vec3(p.x(), p.z(), -p.y()) / unit;
    names.push_back(fmt::format("particles_{}_to_{}", ids[begin], ids[begin + some - 1]));
    meshes.push_back(makeMesh(surface, names.back()));
  }
  fillScene(meshes, scene);
  makeRoom(meshes.size(), *scene.mRootNode);
  for (unsigned k = 0; k < names.size(); ++k) addNode(names[k], k, *scene.mRootNode, k);
}

void fillGlb(std::span<const Shape* const> shapes, std::span<const Frame> frames, std::span<const std::int64_t> ids,
             const MeshExportOptions& options, aiScene& scene) {
  std::vector<TriangleMesh> surfaces;  // of the distinct shapes
  std::map<const Shape*, unsigned> meshOf;
  double bytes = 0;
  for (const Shape* shape : shapes) {
    if (!meshOf.emplace(shape, static_cast<unsigned>(surfaces.size())).second) continue;
    surfaces.push_back(shape->surface(options.resolution));
    bytes += bytesOf(surfaces.back());
  }
  const double most = options.mostMeshes > 0 ? options.mostMeshes : std::max(1.0, 2 * mostCopied / (3 * bytes));
  if (static_cast<double>(surfaces.size()) <= most)
    fillGlbByShapes(surfaces, meshOf, shapes, frames, ids, options, scene);
  else
    fillGlbByGroups(static_cast<std::size_t>(most), shapes, frames, ids, options, scene);
  scene.mRootNode->mTransformation = aiMatrix4x4(aiVector3D(static_cast<float>(unit)), aiQuaternion(), aiVector3D(0));
}

}  // namespace

void exportBed(const std::filesystem::path& path, std::span<const Shape* const> shapes, std::span<const Frame> frames,
               std::span<const std::int64_t> ids, const MeshExportOptions& options) {
  const std::string ending = path.extension().string();
  require(ending == ".stl" || ending == ".glb", fmt::format("{}: a bed is exported as .stl or .glb", path.string()));
  require(!shapes.empty(), fmt::format("{}: there are no particles to export", path.string()));
  aiScene scene;
  if (ending == ".stl")
    fillStl(shapes, frames, options, scene);
  else
    fillGlb(shapes, frames, ids, options, scene);

  // Into memory first, so that the file is written whole or not at all.
  Assimp::Exporter exporter;
  const aiExportDataBlob* blob = exporter.ExportToBlob(&scene, ending == ".stl" ? "stlb" : "glb2");
  if (!blob) throw InputError(fmt::format("{}: can't be exported: {}", path.string(), exporter.GetErrorString()));
  OutputFile file(path);
  file.write({static_cast<const std::byte*>(blob->data), blob->size});
  file.finish();
}

}  // namespace granular
