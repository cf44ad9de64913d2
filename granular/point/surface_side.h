// One body's surface as the contact sees it: flat faces as polygons in the contact plane with a height over it, a
// straight piece, or a point. Polyhedra show all their faces by their tables; other shapes the one feature that
// supports.
#pragma once

#include "granular/pair/touch.h"
#include "granular/point/polygon.h"
#include "granular/shape/polyhedron.h"

namespace granular {

/// The plane through the middle of the deepest overlap, normal to the contact: in-plane axes u and v = n x u.
struct ContactPlane {
  Vec3 origin, u, v, n;
  TouchingFeature feature;

  explicit ContactPlane(const Touch& touch)
      : origin(0.5 * (touch.onA + touch.onB)),
        u(perpendicular(touch.normal)),
        v(touch.normal.cross(u)),
        n(touch.normal),
        feature(touch.feature) {}
  Vec2 project(const Vec3& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }
  Vec3 lift(const Vec2& x, double height) const { return origin + x.x() * u + x.y() * v + height * n; }
};

/// Faces steeper than this cosine to the normal are left out: the overlap reaches under them by less than a tenth of
/// itself.
inline constexpr double steepestCosine = 0.1;

/// A round body's flat end and its side share the contacts of its rim: the flatter of the two takes them. Cosine of the
/// normal to the axis.
inline constexpr double flatterCosine = 0.70710678118654752;

/// A round face as the contact sees it: centre + cos t first + sin t second, counter-clockwise in the contact plane.
struct Oval {
  Vec2 centre, first, second;
};

/// Body A is seen from above (sign 1), body B from below (sign -1).
class SurfaceSide {
 public:
  SurfaceSide(const ContactPlane& plane, const Shape& shape, const Frame& frame, double sign);

  /// 1: a point, 2: a segment, 3: flat faces.
  int dimension() const { return kind; }

  /// The face under the origin of the contact plane, of several within slack (m) of it the flattest, or -1: nothing
  /// here faces the other body.
  std::int32_t findStartFace(double slack) const;
  /// True if the face is not too steep to count.
  bool isSeen(std::int32_t face) const {
    return sign * normal.dot(tables->faces[static_cast<std::size_t>(face)].normal) >= steepestCosine;
  }
  /// The corners of a face in the contact plane, counter-clockwise. An edge is named by the face f beyond it: f for
  /// body A, -2 - f for body B, noEdge where there is none.
  void projectFace(std::int32_t face, Polygon& out) const;
  /// True only if the face is round and the region lies in it: told without its corners.
  bool surelyHolds(const Polygon& region) const {
    for (int k = 0; k < region.count; ++k) {
      if (!surelyHolds(region[k])) return false;
    }
    return round != nullptr;
  }
  bool isRound() const { return round != nullptr; }
  /// Of a round face; it begins at the azimuth of the contact's normal, as supportFace does.
  Oval oval() const;
  /// Keeps the part of the segment in the round face, in place; false when nothing is left.
  bool clipToDisk(Segment& segment) const;
  /// Height of a face over the contact plane; of a segment: along it, the same at all places beside it.
  Linear findHeight(std::int32_t face) const;
  /// All faces around the deepest point that are seen, into out; returns their number.
  int findFacesAround(std::array<std::int32_t, Feature::capacity>& out) const;

  /// Dimension 2 alone.
  const Segment& segment() const { return line; }

  /// Polyhedra alone: the tables (null for others), the deepest vertex, and points in body axes seen in the contact
  /// plane, in it and over it.
  const PolyhedronTables* polyhedron() const { return tables; }
  std::int32_t deepestVertex() const { return deepest; }
  Vec2 projectPoint(const Vec3& p) const {
    const Vec3 from = p - origin;
    return {u.dot(from), v.dot(from)};
  }
  double heightOf(const Vec3& p) const { return normal.dot(p - origin); }

 private:
  void showFeature(const Shape& shape);
  void showPolygon(const Feature& feature) const;
  bool surelyHolds(const Vec2& x) const;
  /// From the centre of the round face to where it lies over a place, in it.
  Vec3 findInDisk(const Vec2& x) const {
    const Vec3 from = origin + x.x() * u + x.y() * v + height.at(x) * normal - disk.centre;
    return from - disk.normal.dot(from) * disk.normal;
  }
  /// A vertex of this body's part of the feature, all of whose vertices are deepest.
  std::int32_t vertexOf(const TouchingFeature& feature) const;

  /// The plane faceNormal . p = offset (body axes) as a height over the contact plane.
  Linear findPlaneHeight(const Vec3& faceNormal, double offset) const {
    const double inverse = 1 / normal.dot(faceNormal);
    return {(offset - faceNormal.dot(origin)) * inverse, {-u.dot(faceNormal) * inverse, -v.dot(faceNormal) * inverse}};
  }

  Vec3 origin, u, v, normal;  // the contact plane in body axes
  double sign;
  int kind = 3;
  const PolyhedronTables* tables = nullptr;  // null: one feature
  std::int32_t deepest = 0;                  // vertex of the tables
  const Shape* round = nullptr;              // one feature, a round face
  Disk disk;                                 // it
  mutable Polygon polygon;                   // one feature: its corners, of a round one when they are asked for
  Linear height;
  Segment line;
};

}  // namespace granular
