#include "granular/io/mesh_export.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Exporter.hpp>

#include "granular/core/errors.h"
#include "granular/io/output_file.h"

namespace granular {
namespace {

/// One triangle mesh as assimp holds it; the scene it enters owns it.
aiMesh* makeMesh(const std::vector<Vec3>& vertices, const std::vector<std::array<int, 3>>& triangles,
                 const std::string& name) {
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

/// All particles as one mesh in world coordinates.
void fillStl(std::span<const Shape* const> shapes, std::span<const Frame> frames, const MeshExportOptions& options,
             aiScene& scene) {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const TriangleMesh mesh = shapes[k]->surface(options.resolution);
    const int first = static_cast<int>(vertices.size());
    for (const Vec3& p : mesh.vertices) vertices.push_back(frames[k].toWorld((1 - options.gap) * p));
    for (const auto& t : mesh.triangles) triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  fillScene({makeMesh(vertices, triangles, "bed")}, scene);
  scene.mRootNode->mNumMeshes = 1;
  scene.mRootNode->mMeshes = new unsigned[1]{0};
}

/// One mesh and one node per particle. In world coordinates: assimp's exporter leaves out a transformation that it
/// takes for the identity, which is every translation below 10 mm.
void fillGlb(std::span<const Shape* const> shapes, std::span<const Frame> frames, std::span<const std::int64_t> ids,
             const MeshExportOptions& options, aiScene& scene) {
  std::vector<aiMesh*> meshes;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    TriangleMesh mesh = shapes[k]->surface(options.resolution);
    for (Vec3& p : mesh.vertices) {
      const Vec3 world = frames[k].toWorld((1 - options.gap) * p);
      p = {world.x(), world.z(), -world.y()};  // z up becomes y up
    }
    meshes.push_back(makeMesh(mesh.vertices, mesh.triangles, fmt::format("particle_{}", ids[k])));
  }
  fillScene(meshes, scene);

  aiNode* root = scene.mRootNode;
  root->mNumChildren = static_cast<unsigned>(shapes.size());
  root->mChildren = new aiNode*[shapes.size()];
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    auto* node = new aiNode(fmt::format("particle_{}", ids[k]));
    node->mParent = root;
    node->mNumMeshes = 1;
    node->mMeshes = new unsigned[1]{static_cast<unsigned>(k)};
    root->mChildren[k] = node;
  }
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
