// A convex polyhedron: vertices, faces, edges and the vertex graph, as flat tables that kernels walk.
// Cuboids carry the same tables, so that one kernel serves both.
#pragma once

#include <cstdint>
#include <span>

#include "granular/shape/shape.h"

namespace granular {

/// Topology and geometry of a convex polyhedron. Coplanar hull triangles are merged into one polygonal face.
struct PolyhedronTables {
  std::vector<Vec3> vertices;
  /// Vertex graph in CSR form: neighbours of v are neighbours[neighbourBegin[v] ... neighbourBegin[v + 1] - 1].
  std::vector<std::int32_t> neighbourBegin, neighbours;
  /// Faces: outward unit normal, offset (normal . x = offset on the face), corners counter-clockwise from outside, CSR.
  std::vector<Vec3> faceNormals;
  std::vector<double> faceOffsets;
  std::vector<std::int32_t> faceBegin, faceCorners;
  /// Edges: end vertices (a < b) and the two faces that meet there.
  struct Edge {
    std::int32_t a, b, faceLeft, faceRight;
  };
  std::vector<Edge> edges;
  /// Faces around each vertex, CSR.
  std::vector<std::int32_t> vertexFaceBegin, vertexFaces;
  /// Edge that starts at each corner of faceCorners (same indexing), so that face walks find their edges.
  std::vector<std::int32_t> cornerEdges;

  int vertexCount() const { return static_cast<int>(vertices.size()); }
  int faceCount() const { return static_cast<int>(faceNormals.size()); }

  /// Index of the vertex furthest along d: a linear scan up to 20 vertices, hill climbing from `start` above.
  std::int32_t supportVertex(const Vec3& d, std::int32_t start = 0) const;
};

class Polyhedron : public Shape {
 public:
  /// The convex hull of the points, moved to its centre of mass and turned to its principal axes. Throws InputError for
  /// fewer than four points, points in a plane, or non-finite coordinates. When given, toBody receives the frame of the body in the input
  /// coordinates: input point = toBody->toWorld(body point).
  explicit Polyhedron(std::span<const Vec3> points, Frame* toBody = nullptr);

  const PolyhedronTables& tables() const { return topology; }

  Vec3 support(const Vec3& d) const override;
  void supportFeature(const Vec3& d, double slab, Feature& out) const override;
  Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const override;
  bool contains(const Vec3& p) const override;
  TriangleMesh surface(int resolution) const override;
  std::unique_ptr<btConvexShape> makeBulletShape(double scale) const override;
  std::string describe() const override;
  Aabb bounds(const Frame& frame) const override;

 protected:
  Polyhedron(ShapeKind kind, std::span<const Vec3> points, Frame* toBody);
  PolyhedronTables topology;
};

/// A cuboid: the polyhedron whose support needs no search. Corner k has sign bits (k & 1, k & 2, k & 4) for x, y, z,
/// 0 being the negative side.
class Cuboid final : public Polyhedron {
 public:
  /// Half-lengths along x, y, z, m, each > 0.
  explicit Cuboid(const Vec3& halfLengths);
  const Vec3& halfLengths() const { return half; }

  Vec3 support(const Vec3& d) const override;
  bool contains(const Vec3& p) const override;
  std::string describe() const override;
  Aabb bounds(const Frame& frame) const override;

 private:
  Vec3 half;
};

}  // namespace granular
