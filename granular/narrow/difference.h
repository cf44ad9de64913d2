// The Minkowski difference C = A - B of two placed shapes, in A's body axes: they touch when the origin lies in C, and
// the overlap is the origin's least depth below C's supporting planes, min over unit n of h(n) = max over C of n . w.
// Everything here is relative to A, so that a rotation or translation of both bodies changes no digit that matters.
#pragma once

#include "granular/shape/polyhedron.h"

namespace granular {

/// Lays B's frame down in A's body axes: R turns B's axes into A's, x is B's centre seen from A.
inline Frame relativeFrame(const Frame& frameA, const Frame& frameB) {
  return {frameA.R.transpose() * frameB.R, frameA.R.transpose() * (frameB.x - frameA.x)};
}

/// A point w = a - b of C with its makings, A's body axes; vertex indices where a shape has them, otherwise -1.
struct SupportPoint {
  Vec3 w, a, b;
  std::int32_t vertexA = -1, vertexB = -1;
};

/// Support of C. Remembers the last vertices as seeds of the next search, hence not const; one per pair and thread.
class Difference {
 public:
  Difference(const Shape& shapeA, const Frame& frameA, const Shape& shapeB, const Frame& frameB)
      : a(shapeA), b(shapeB), relative(relativeFrame(frameA, frameB)) {
    if (a.kind() == ShapeKind::polyhedron) tablesA = &static_cast<const Polyhedron&>(a).tables();
    if (b.kind() == ShapeKind::polyhedron) tablesB = &static_cast<const Polyhedron&>(b).tables();
    if (a.kind() == ShapeKind::cuboid) halfA = &static_cast<const Cuboid&>(a).halfLengths();
    if (b.kind() == ShapeKind::cuboid) halfB = &static_cast<const Cuboid&>(b).halfLengths();
  }

  const Shape& shapeA() const { return a; }
  const Shape& shapeB() const { return b; }
  /// B's frame in A's body axes.
  const Frame& frame() const { return relative; }
  /// The smaller of the two sizes: the pair's unit of length.
  double size() const { return std::min(a.size(), b.size()); }
  /// Takes a layer off either shape (m), which must not exceed the radius of a ball that rolls freely inside it: what
  /// is left is convex, and the layers' sum is the radius of a ball that C is rounded by.
  void erode(double layerA, double layerB) { layer = {layerA, layerB}; }

  /// Puts the segment of its axis (z, half-length in m) in the place of A or B.
  void reduceToAxisOfA(double halfLength) { axisHalf[0] = halfLength; }
  void reduceToAxisOfB(double halfLength) { axisHalf[1] = halfLength; }

  /// Largest length that enters a support point: its round-off is this times the machine precision.
  double extent() const { return a.boundingRadius() + b.boundingRadius() + relative.x.norm(); }

  /// Vertices to begin the search of polyhedra from.
  void seed(std::int32_t vertexA, std::int32_t vertexB) {
    seedA = vertexA;
    seedB = vertexB;
  }

  /// The vertices the last search ended at, of polyhedra.
  std::int32_t lastVertexOfA() const { return std::max(seedA, 0); }
  std::int32_t lastVertexOfB() const { return std::max(seedB, 0); }

  /// The point of C furthest along d (any length > 0).
  SupportPoint support(const Vec3& d) {
    SupportPoint p;
    const Vec3 dB = -relative.unrotate(d);
    p.a = axisHalf[0] > 0 ? endOfAxis(axisHalf[0], d) : supportOf(a, tablesA, halfA, d, seedA);
    p.b = relative.toWorld(axisHalf[1] > 0 ? endOfAxis(axisHalf[1], dB) : supportOf(b, tablesB, halfB, dB, seedB));
    p.vertexA = seedA;
    p.vertexB = seedB;
    if (layer[0] + layer[1] > 0) {
      const Vec3 n = d.normalized();
      p.a -= layer[0] * n;
      p.b += layer[1] * n;
    }
    p.w = p.a - p.b;
    return p;
  }

  /// h(n) for the unit direction n.
  double depth(const Vec3& n) { return support(n).w.dot(n); }

 private:
  static Vec3 endOfAxis(double half, const Vec3& d) { return {0, 0, d.z() < 0 ? -half : half}; }

  static Vec3 supportOf(const Shape& shape, const PolyhedronTables* tables, const Vec3* half, const Vec3& d,
                        std::int32_t& seed) {
    if (tables) {
      seed = tables->climb(d, std::max(seed, 0));
      return tables->vertices[static_cast<std::size_t>(seed)];
    }
    if (half) {
      // A cuboid's corner is numbered by the signs of its coordinates.
      seed = (d.x() > 0) + 2 * (d.y() > 0) + 4 * (d.z() > 0);
      return {d.x() > 0 ? half->x() : -half->x(), d.y() > 0 ? half->y() : -half->y(),
              d.z() > 0 ? half->z() : -half->z()};
    }
    return shape.support(d);
  }

  const Shape& a;
  const Shape& b;
  Frame relative;
  const PolyhedronTables* tablesA = nullptr;
  const PolyhedronTables* tablesB = nullptr;
  std::array<double, 2> layer{0, 0};
  std::array<double, 2> axisHalf{0, 0};
  const Vec3* halfA = nullptr;
  const Vec3* halfB = nullptr;
  std::int32_t seedA = -1, seedB = -1;
};

}  // namespace granular
