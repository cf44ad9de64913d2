#include "granular/wall/plane_patch.h"

namespace granular {

void placeOnPlane(const RuleOptions&, const Shape&, const Frame&, const Plane& plane, const Vec3& deepest,
                  ContactPatch& out) {
  out.area = out.uu = out.vv = out.uv = 0;
  out.point = out.centre = deepest + 0.5 * plane.depth(deepest) * plane.normal;
  out.u = perpendicular(plane.normal);
}

}  // namespace granular
