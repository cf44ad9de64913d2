// Where a body's contact with a plane acts, by each contact-point rule. The plane wall and the flat facets of meshes
// share it: what lies below the plane is looked at once, then integrated as a whole or piece by piece over the
// triangles of a facet.
#pragma once

#include <vector>

#include "granular/point/moments.h"
#include "granular/point/surface_side.h"
#include "granular/wall/wall.h"

namespace granular {

/// normal . x = offset on the plane; the granular side is normal . x > offset. Unit normal.
struct Plane {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0;  ///< m

  /// How far p (world) lies below the plane, m.
  double depth(const Vec3& p) const { return offset - normal.dot(p); }
  /// The deepest point of the placed shape, world axes.
  Vec3 deepest(const Shape& shape, const Frame& frame) const {
    return frame.toWorld(shape.support(frame.unrotate(-normal)));
  }
};

/// A point of a sunken surface: its place in the contact plane and its depth, m.
struct SunkenPoint {
  Vec2 place;
  double depth;
};

/// The part of a body's surface below a plane, seen along the contact normal (from the body into the wall). Made anew
/// for each contact in the same memory.
class SunkenSurface {
 public:
  /// Looks at the surface below the plane: flat faces (from the deepest one outwards), a straight piece, or a point.
  /// deepest: the deepest point of the shape, world axes, below the plane.
  void look(const Plane& plane, const Vec3& deepest, const Shape& shape, const Frame& frame);
  /// Looks at the support feature within the slab (m) instead, as the paper does; its depth counts as 1 everywhere.
  void lookAtFeature(const Plane& plane, const Vec3& deepest, double slab, const Shape& shape, const Frame& frame);

  /// 1: a point, 2: a straight piece, 3: flat faces.
  int dimension() const { return kind; }
  const ContactPlane& view() const { return plane; }
  /// Cosine of the deepest face or of the straight piece to the plane, 1 when flat on it.
  double flatness() const { return cosine; }

  /// The integrals over all of it. Straight pieces count as strips as wide as the overlap is deep.
  AreaMoments integrateWhole() const;
  /// Adds the integrals over the part above a convex polygon of the contact plane, and its corners.
  void integrateInside(const Polygon& polygon, AreaMoments& moments, std::vector<SunkenPoint>& corners) const;
  /// The same above a straight line of the contact plane, a ridge: strips along what the two share.
  void integrateAlong(const Segment& ridge, AreaMoments& moments, std::vector<SunkenPoint>& corners) const;

  /// Places the contact, given the integrals over its part of the surface (nothing of volume: the deepest point).
  void place(PointRule rule, const AreaMoments& moments, ContactPatch& out) const;

 private:
  void lookAtFaces(const SurfaceSide& side);
  void addStretch(const Segment& part, const Linear& depth, AreaMoments& moments,
                  std::vector<SunkenPoint>& corners) const;

  struct Piece {
    Polygon region;
    Linear depth;
  };
  ContactPlane plane{Touch{Vec3::UnitZ(), 0, Vec3::Zero(), Vec3::Zero()}};
  double overlap = 0;
  double cosine = 1;
  int kind = 1;
  std::vector<Piece> pieces;
  Segment line;
  Linear lineDepth;
};

/// Places the contact of a body whose deepest point (world) lies below an unbounded plane.
void placeOnPlane(const RuleOptions& options, const Shape& shape, const Frame& frame, const Plane& plane,
                  const Vec3& deepest, SunkenSurface& surface, ContactPatch& out);

}  // namespace granular
