// A horizontal section of a vessel as nested curves at equal distance from the side wall: circles in a cylinder (S fig.
// A.20), rectangles in a box. Profiles against the distance from the wall are sampled along them.
#pragma once

#include "granular/analysis/bed.h"

namespace granular {

class CrossSection {
 public:
  /// The vessel's own section; without one, or with periodic sides, the rectangle of its bounds or of the given bounds
  /// of the particles (then `walled` is false). Throws InputError for a section without area.
  CrossSection(const Vessel& vessel, const Aabb& particles);

  /// True if the curves run along side walls, so that a distance from them has a meaning.
  bool walled() const { return hasWall; }
  /// Largest distance from the side wall, m.
  double depth() const { return round ? radius : 0.5 * (hi - lo).minCoeff(); }
  double area() const;
  /// Length of the curve at a distance from the wall, m; distance within 0 ... depth().
  double curveLength(double distance) const;
  /// The point of that curve at a fraction within [0, 1) of its length.
  Vec2 curvePoint(double distance, double fraction) const;
  /// Distance of a point from the side wall, m, positive inside.
  double distance(const Vec2& p) const;
  /// Unit vector from the axis (box: from the middle towards the nearest side wall); zero on the axis.
  Vec2 outward(const Vec2& p) const;
  /// Bounds in the plane, m.
  Vec2 lower() const { return round ? Vec2(centre.array() - radius) : lo; }
  Vec2 upper() const { return round ? Vec2(centre.array() + radius) : hi; }

 private:
  bool round = false;
  bool hasWall = false;
  Vec2 centre = Vec2::Zero();
  double radius = 0;
  Vec2 lo = Vec2::Zero(), hi = Vec2::Zero();
};

}  // namespace granular
