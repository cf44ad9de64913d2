// Where a body's contact with a plane acts, by each contact-point rule. The plane wall and the flat facets of meshes
// share it.
#pragma once

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

/// Places the contact of a body whose deepest point (world) lies below the plane.
void placeOnPlane(const RuleOptions& options, const Shape& shape, const Frame& frame, const Plane& plane,
                  const Vec3& deepest, ContactPatch& out);

}  // namespace granular
