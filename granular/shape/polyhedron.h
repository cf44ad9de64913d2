// A convex polyhedron: vertices, faces, edges and the vertex graph, as flat tables that kernels walk.
// Cuboids carry the same tables, so that one kernel serves both.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "granular/shape/shape.h"

namespace granular {

/// Topology and geometry of a convex polyhedron. Coplanar hull triangles are merged into one polygonal face. All tables
/// lie in one block of memory, which copies share: kernels can fetch it ahead as a whole.
struct PolyhedronTables {
  PolyhedronTables() = default;

  /// A face's plane: outward unit normal, offset (normal . x = offset on the face).
  struct Face {
    Vec3 normal;
    double offset;
  };
  /// End vertices (a < b) and the two faces that meet there; the corners of the left face before a and after b, and of
  /// the right face before b and after a, counter-clockwise from outside.
  struct Edge {
    std::int32_t a, b, faceLeft, faceRight;
    std::array<std::int32_t, 4> wings{-1, -1, -1, -1};
  };
  /// An edge as one of its ends sees it: the vertex at the other end, and the face between this edge and the next
  /// spoke around the vertex, counter-clockwise from outside (the face left of the way out).
  struct Spoke {
    std::int32_t vertex, face;
  };
  /// A corner of a face: its vertex, the edge from it to the next corner, and the face beyond that edge.
  struct Corner {
    std::int32_t vertex, edge, beyond;
  };

  std::span<const Vec3> vertices;
  std::span<const Face> faces;
  std::span<const Edge> edges;
  /// Around the vertex, counter-clockwise from outside.
  std::span<const Spoke> spokesOf(std::int32_t vertex) const { return slice(spokes, spokeBegin, vertex); }
  /// Around the face, counter-clockwise from outside.
  std::span<const Corner> cornersOf(std::int32_t face) const { return slice(corners, cornerBegin, face); }

  int vertexCount() const { return static_cast<int>(vertices.size()); }
  int faceCount() const { return static_cast<int>(faces.size()); }

  /// Index of the vertex furthest along d: a linear scan up to 20 vertices, hill climbing from `start` above.
  std::int32_t supportVertex(const Vec3& d, std::int32_t start = 0) const;
  /// The same by hill climbing alone.
  std::int32_t climb(const Vec3& d, std::int32_t start) const;

  /// Of all faces, m: a ball of this radius about the origin fits inside.
  double leastOffset() const;

  /// The same polyhedron with all lengths multiplied by factor (> 0).
  PolyhedronTables scaled(double factor) const;

  /// Starts to bring the tables into the cache, as far as a contact is likely to read them.
  void fetchAhead() const {
    constexpr std::size_t line = 8, most = 512;  // doubles
    const std::size_t end = std::min(blockSize, most);
    for (std::size_t k = 0; k < end; k += line) __builtin_prefetch(block.get() + k);
  }

 private:
  struct Parts;  // while they are made
  friend PolyhedronTables makePolyhedronTables(std::vector<Vec3>, std::span<const std::vector<std::int32_t>>);
  explicit PolyhedronTables(const Parts& parts);

  template <class T>
  static std::span<const T> slice(std::span<const T> all, std::span<const std::int32_t> begin, std::int32_t k) {
    const auto from = static_cast<std::size_t>(begin[static_cast<std::size_t>(k)]);
    return {all.data() + from, static_cast<std::size_t>(begin[static_cast<std::size_t>(k) + 1]) - from};
  }

  std::span<const std::int32_t> spokeBegin, cornerBegin;
  std::span<const Spoke> spokes;
  std::span<const Corner> corners;
  std::shared_ptr<const double[]> block;
  std::size_t blockSize = 0;  // in doubles
};

/// Tables of a closed convex polyhedron from its faces, corners counter-clockwise seen from outside. Normals are
/// computed from the corners; an offset is the furthest of its face's corners along the normal, so that no vertex lies
/// outside.
PolyhedronTables makePolyhedronTables(std::vector<Vec3> vertices, std::span<const std::vector<std::int32_t>> faces);

class Polyhedron : public Shape {
 public:
  /// The convex hull of the points, moved to its centre of mass and turned to its principal axes. Throws InputError for
  /// fewer than four points, points in a plane, or non-finite coordinates. When given, toBody receives the frame of the
  /// body in the input coordinates: input point = toBody->toWorld(body point).
  explicit Polyhedron(std::span<const Vec3> points, Frame* toBody = nullptr);

  /// The source multiplied by factor (> 0): same topology, same body axes, no new hull.
  Polyhedron(const Polyhedron& source, double factor);

  const PolyhedronTables& tables() const { return topology; }
  /// Index of the vertex furthest along d (any length > 0).
  std::int32_t supportVertex(const Vec3& d) const { return topology.supportVertex(d, climbStart(d)); }

  Vec3 support(const Vec3& d) const override;
  /// Of more than Feature::capacity vertices in the slab the deepest are kept.
  void supportFeature(const Vec3& d, double slab, Feature& out) const override;
  /// Of a face with more than Feature::capacity corners evenly spaced ones are kept: a convex subset of the face.
  Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const override;
  bool contains(const Vec3& p) const override;
  TriangleMesh surface(int resolution) const override;
  std::unique_ptr<btConvexShape> makeBulletShape(double scale) const override;
  std::string describe() const override;
  Aabb bounds(const Frame& frame) const override;

 protected:
  /// For kinds that fill the tables and set the measures themselves.
  explicit Polyhedron(ShapeKind kind) : Shape(kind) {}
  /// Where the climb for direction d starts: the support vertex of the middle of d's octant.
  std::int32_t climbStart(const Vec3& d) const {
    return octantVertex[static_cast<std::size_t>((d.x() > 0) + 2 * (d.y() > 0) + 4 * (d.z() > 0))];
  }
  void findOctantVertices();

  PolyhedronTables topology;
  std::array<std::int32_t, 8> octantVertex{};
};

/// The tables of a polyhedron or cuboid; null for other shapes.
inline const PolyhedronTables* tablesOf(const Shape& shape) {
  const bool flat = shape.kind() == ShapeKind::polyhedron || shape.kind() == ShapeKind::cuboid;
  return flat ? &static_cast<const Polyhedron&>(shape).tables() : nullptr;
}

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
