// Meshes for the tests, and defects to put into them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "granular/mesh/repair.h"

namespace granular::testing {

using Triangle = std::array<int, 3>;

/// An icosahedron, each triangle cut into four so many times, every vertex on the unit sphere and then moved radially
/// by smooth waves of the given amplitude.
inline TriangleMesh makeBall(int cuts, double amplitude = 0) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  mesh.vertices = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                   {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& v : mesh.vertices) v.normalize();
  for (int cut = 0; cut < cuts; ++cut) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, isNew] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
      if (isNew) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& f : mesh.triangles) {
      const int ab = middle(f[0], f[1]), bc = middle(f[1], f[2]), ca = middle(f[2], f[0]);
      for (const Triangle& g : {Triangle{f[0], ab, ca}, {f[1], bc, ab}, {f[2], ca, bc}, {ab, bc, ca}})
        finer.push_back(g);
    }
    mesh.triangles = finer;
  }
  for (Vec3& v : mesh.vertices)
    v *= 1 + amplitude * (std::sin(3 * v.x() + 1) + std::sin(4 * v.y() + 2) * std::cos(5 * v.z()));
  return mesh;
}

/// A cuboid of twelve triangles.
inline TriangleMesh makeBox(const Vec3& lo, const Vec3& hi) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back({(k & 1) ? hi.x() : lo.x(), (k & 2) ? hi.y() : lo.y(), (k & 4) ? hi.z() : lo.z()});
  for (const std::array<int, 4>& q :
       {std::array<int, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

inline void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

inline RawMesh asRaw(const TriangleMesh& mesh) {
  RawMesh raw;
  raw.vertices = mesh.vertices;
  raw.triangles = mesh.triangles;
  return raw;
}

/// A file in the test's own folder.
inline std::string scratchFile(const std::string& name) {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string folder = std::string(info->test_suite_name()) + "." + info->name();
  for (char& c : folder) c = c == '/' ? '_' : c;
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / ("granular_mesh_" + folder);
  std::filesystem::create_directories(path);
  return (path / name).string();
}

/// One kind of defect: puts it into the mesh, adds to the counts it must lead to.
struct Defect {
  const char* name;
  void (*inject)(TriangleMesh& mesh, MeshDefects& expected);
};

/// The triangle furthest in a direction: defects in different directions stay apart.
inline int triangleTowards(const TriangleMesh& mesh, const Vec3& direction) {
  int best = 0;
  double most = -infinity;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& f = mesh.triangles[t];
    const double height = direction.dot(mesh.vertices[f[0]] + mesh.vertices[f[1]] + mesh.vertices[f[2]]);
    if (height > most && mesh.vertices[f[0]].norm() < 3) {
      most = height;
      best = static_cast<int>(t);
    }
  }
  return best;
}

inline const std::vector<Defect>& allDefects() {
  static const std::vector<Defect> defects = {
      {"duplicateVertices",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         for (int k = 0; k < 7; ++k) {
           int& corner = mesh.triangles[static_cast<std::size_t>(40 + 5 * k)][1];
           mesh.vertices.push_back(Vec3(mesh.vertices[corner]));
           corner = static_cast<int>(mesh.vertices.size()) - 1;
         }
         expected.duplicateVertices += 7;
       }},
      {"nearDuplicateVertices",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         int& corner = mesh.triangles[static_cast<std::size_t>(triangleTowards(mesh, {1, 0, 0}))][0];
         mesh.vertices.push_back(mesh.vertices[corner] + Vec3(1e-6, 0, 0));
         corner = static_cast<int>(mesh.vertices.size()) - 1;
         expected.duplicateVertices += 1;
       }},
      {"unreferencedVertices",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         for (int k = 0; k < 5; ++k) mesh.vertices.push_back(Vec3(0.1 * k, 5, 0));
         expected.unreferencedVertices += 5;
       }},
      {"degenerateTriangles",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         const Triangle f = mesh.triangles[static_cast<std::size_t>(triangleTowards(mesh, {0, 1, 0}))];
         mesh.triangles.push_back({f[0], f[0], f[1]});
         mesh.triangles.push_back({f[2], f[1], f[2]});
         mesh.triangles.push_back({f[1], f[1], f[1]});
         // on an edge, with a corner of its own in the middle
         mesh.vertices.push_back(0.5 * (mesh.vertices[f[0]] + mesh.vertices[f[1]]));
         mesh.triangles.push_back({f[0], static_cast<int>(mesh.vertices.size()) - 1, f[1]});
         expected.degenerateTriangles += 4;
       }},
      {"zeroAreaKept",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         const auto t = static_cast<std::size_t>(triangleTowards(mesh, {0, 1, 1}));
         const Triangle f = mesh.triangles[t];
         const int m = static_cast<int>(mesh.vertices.size());
         mesh.vertices.push_back(0.5 * (mesh.vertices[f[0]] + mesh.vertices[f[1]]));
         mesh.triangles[t] = {f[0], m, f[2]};
         mesh.triangles.push_back({m, f[1], f[2]});
         mesh.triangles.push_back({f[0], f[1], m});
         expected.zeroAreaKept += 1;
       }},
      {"duplicateTriangles",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         const Triangle f = mesh.triangles[static_cast<std::size_t>(triangleTowards(mesh, {0, -1, 0}))],
                        g = mesh.triangles[30];
         for (const Triangle& copy : {f, Triangle{f[1], f[2], f[0]}, g, Triangle{g[1], g[0], g[2]}})
           mesh.triangles.push_back(copy);
         expected.duplicateTriangles += 4;
       }},
      {"slivers",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         for (const Vec3& direction : {Vec3(0, 0, -1), Vec3(0.3, 0, -1)}) {
           const auto t = static_cast<std::size_t>(triangleTowards(mesh, direction));
           const Triangle f = mesh.triangles[t];
           const int p = static_cast<int>(mesh.vertices.size());
           mesh.vertices.push_back(0.4985 * mesh.vertices[f[0]] + 0.4985 * mesh.vertices[f[1]] +
                                   0.003 * mesh.vertices[f[2]]);
           mesh.triangles[t] = {f[0], f[1], p};
           mesh.triangles.push_back({f[1], f[2], p});
           mesh.triangles.push_back({f[2], f[0], p});
         }
         expected.slivers += 2;
       }},
      {"openEdges",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         mesh.triangles.erase(mesh.triangles.begin() + triangleTowards(mesh, {-1, 0, 0}));
         expected.openEdges += 3;
         expected.euler -= 1;
       }},
      {"nonManifoldEdges",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         // A fin: its edge has three triangles, its other two edges are open.
         const Triangle f = mesh.triangles[static_cast<std::size_t>(triangleTowards(mesh, {-1, 1, 0}))];
         mesh.vertices.push_back(1.1 * mesh.vertices[f[0]]);
         mesh.triangles.push_back({f[0], f[1], static_cast<int>(mesh.vertices.size()) - 1});
         expected.nonManifoldEdges += 1;
         expected.finTriangles += 1;
         expected.openEdges += 2;
       }},
      {"flippedTriangles",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         for (int k = 0; k < 6; ++k) {
           Triangle& f = mesh.triangles[static_cast<std::size_t>(200 + k * (k + 1))];
           std::swap(f[0], f[1]);
         }
         expected.flippedTriangles += 6;
       }},
      {"parts",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         for (const double x : {4.0, 5.0}) append(mesh, makeBox({x, 4, 0}, {x + 0.1, 4.1, 0.1}));
         expected.parts += 2;
         expected.droppedParts += 2;
         expected.droppedTriangles += 24;
         expected.euler += 4;
       }},
      {"nonFiniteVertices",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         for (const Vec3& v : {Vec3(0, std::nan(""), 1), Vec3(infinity, 0, 2)}) {
           mesh.vertices.push_back(v);
           mesh.triangles.push_back({static_cast<int>(mesh.vertices.size()) - 1, 3, 4});
         }
         expected.nonFiniteVertices += 2;
       }},
      {"insideOut",
       [](TriangleMesh& mesh, MeshDefects& expected) {
         for (Triangle& f : mesh.triangles) std::swap(f[1], f[2]);
         expected.insideOut = true;
       }},
  };
  return defects;
}

/// The clean mesh that defects go into, and its counts.
inline TriangleMesh makeCleanMesh(MeshDefects& expected) {
  expected = MeshDefects{};
  expected.parts = 1;
  expected.euler = 2;
  return makeBall(4, 0.04);
}

inline void expectCounts(const MeshDefects& found, const MeshDefects& expected, const std::string& where) {
  SCOPED_TRACE(where);
  EXPECT_EQ(found.nonFiniteVertices, expected.nonFiniteVertices);
  EXPECT_EQ(found.unreferencedVertices, expected.unreferencedVertices);
  EXPECT_EQ(found.duplicateVertices, expected.duplicateVertices);
  EXPECT_EQ(found.degenerateTriangles, expected.degenerateTriangles);
  EXPECT_EQ(found.zeroAreaKept, expected.zeroAreaKept);
  EXPECT_EQ(found.duplicateTriangles, expected.duplicateTriangles);
  EXPECT_EQ(found.slivers, expected.slivers);
  EXPECT_EQ(found.openEdges, expected.openEdges);
  EXPECT_EQ(found.nonManifoldEdges, expected.nonManifoldEdges);
  EXPECT_EQ(found.finTriangles, expected.finTriangles);
  EXPECT_EQ(found.flippedTriangles, expected.flippedTriangles);
  EXPECT_EQ(found.unorientableEdges, expected.unorientableEdges);
  EXPECT_EQ(found.insideOut, expected.insideOut);
  EXPECT_EQ(found.parts, expected.parts);
  EXPECT_EQ(found.droppedParts, expected.droppedParts);
  EXPECT_EQ(found.droppedTriangles, expected.droppedTriangles);
  EXPECT_EQ(found.euler, expected.euler);
}

}  // namespace granular::testing
