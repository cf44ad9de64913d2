// A contact-point rule of one's own: the centre of the box in which the two bodies' boxes overlap, both boxes along the
// normal and two axes across it. It costs twelve support points and asks nothing else of a shape. For two spheres the
// point is on the line of centres; for two cuboids with parallel edges along these axes it is the middle of the face
// that they share.
#pragma once

#include <algorithm>

#include "granular/point/contact_point.h"

namespace extend {

using namespace granular;

inline void placeBoxCentre(const RuleOptions& /*options*/, const Shape& a, const Frame& frameA, const Shape& b,
                           const Frame& frameB, const Touch& touch, ContactPatch& out) {
  const auto reach = [](const Shape& shape, const Frame& frame, const Vec3& axis) {
    return axis.dot(frame.toWorld(shape.support(frame.unrotate(axis))));
  };
  const Vec3 u = perpendicular(touch.normal), v = touch.normal.cross(u);
  Vec3 point = Vec3::Zero();
  for (const Vec3& axis : {touch.normal, u, v}) {
    const double low = std::max(-reach(a, frameA, -axis), -reach(b, frameB, -axis));
    const double high = std::min(reach(a, frameA, axis), reach(b, frameB, axis));
    point += 0.5 * (low + high) * axis;
  }
  // A point contact: no area, and the elastic force is k_n times the overlap.
  out = ContactPatch{};
  out.point = out.centre = point;
  out.u = u;
  out.depth = touch.overlap;
  out.squaredDepth = touch.overlap * touch.overlap;
}

/// Adds the rule under the name "box_centre": once, at the start of the program. At walls, which place their contacts
/// by themselves, the centroid of the overlap serves.
inline PointRule addBoxCentreRule() {
  return addPointRule({"box_centre", placeBoxCentre, PointRule::pressureCentroid});
}

}  // namespace extend
