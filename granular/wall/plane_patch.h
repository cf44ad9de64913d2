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
    if (shape.isRound()) return frame.x - shape.boundingRadius() * normal;  // however it lies, to the bit
    return frame.toWorld(shape.support(frame.unrotate(-normal)));
  }
};

/// 1 for a face that lies flat on a part of a wall (cosine 1), falling to 0 at `fadeCosine`: 2.6 degrees.
inline constexpr double fadeCosine = 0.999;
inline double flatWeight(double cosine) { return std::max(0.0, (cosine - fadeCosine) / (1 - fadeCosine)); }

/// What of a sunken surface lies over a part of a wall.
struct SunkenPart {
  AreaMoments moments;
  double flatVolume = 0;  ///< volume weighted by how flat each face lies, m^3
  double deepest = 0;     ///< largest depth, m

  bool isBroad() const { return moments.area > 0 && moments.volume > 0; }
  double flatness() const { return moments.volume > 0 ? flatVolume / moments.volume : 0; }
  void add(const AreaMoments& piece, double flat) {
    moments += piece;
    flatVolume += flat * piece.volume;
  }
};

/// The part of a body's surface below a plane, seen along the contact normal (from the body into the wall). Made anew
/// for each contact in the same memory.
class SunkenSurface {
 public:
  /// Looks at the surface below the plane: flat faces (from the deepest one outwards), a straight piece, or a point.
  /// deepest: the deepest point of the shape, world axes, below the plane.
  void look(const RuleOptions& rule, const Plane& plane, const Vec3& deepest, const Shape& shape, const Frame& frame);
  /// Looks at the support feature within the slab (m) instead, as the paper does; its depth counts as 1 everywhere.
  void lookAtFeature(const Plane& plane, const Vec3& deepest, double slab, const Shape& shape, const Frame& frame);

  /// 1: a point, 2: a straight piece, 3: flat faces.
  int dimension() const { return kind; }
  const ContactPlane& view() const { return plane; }

  /// The integrals over all of it. Straight pieces count as strips as wide as the overlap is deep.
  AreaMoments integrateWhole() const;
  /// Adds the part above a convex polygon of the contact plane.
  void addInside(const Polygon& polygon, SunkenPart& part) const;
  /// Adds the strips above a straight line of the contact plane, a ridge.
  void addAlong(const Segment& ridge, SunkenPart& part) const;

  /// Places the contact, given the integrals over its part of the surface (nothing of volume: the deepest point) and
  /// the largest depth of this part, m.
  void place(const RuleOptions& rule, const AreaMoments& moments, double deepestPart, ContactPatch& out) const;

 private:
  void lookAtFaces(const SurfaceSide& side);
  void addStretch(const Segment& stretch, const Linear& depth, double flat, SunkenPart& part) const;

  struct Piece {
    Polygon region;
    Linear depth;
    double flat;  ///< flatWeight of its cosine
  };
  ContactPlane plane{Touch{Vec3::UnitZ(), 0, Vec3::Zero(), Vec3::Zero()}};
  double overlap = 0, size = 0;
  PowerChoice power;
  int kind = 1;
  std::vector<Piece> pieces;
  Segment line;
  Linear lineDepth;
  double lineFlat = 1;
};

/// Places the contact of a body whose deepest point (world) lies below an unbounded plane.
void placeOnPlane(const RuleOptions& options, const Shape& shape, const Frame& frame, const Plane& plane,
                  const Vec3& deepest, SunkenSurface& surface, ContactPatch& out);

}  // namespace granular
