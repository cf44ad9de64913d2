// Beyond the paper: the elastic force at the pressure centroid, and the area and second moments of the overlap, over
// which the law spreads its dashpot.
#include "granular/point/overlap.h"
#include "granular/point/rules.h"
#include "granular/point/witness.h"

namespace granular {

void placePatch(const RuleOptions&, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                const Touch& touch, ContactPatch& out) {
  const ContactPlane plane(touch);
  OverlapArea overlap;
  if (!measureOverlap(plane, a, frameA, b, frameB, touch.overlap, overlap))
    return placePoint(plane.origin, plane.u, out);

  // Second moments about the centroid, per area.
  const AreaMoments& m = overlap.moments;
  const Vec2 c = m.centroid();
  out.point = plane.lift(m.centroidOfVolume(), overlap.height);
  out.centre = plane.lift(c, overlap.height);
  out.area = m.area;
  out.u = plane.u;
  out.uu = m.xx / m.area - c.x() * c.x();
  out.vv = m.yy / m.area - c.y() * c.y();
  out.uv = m.xy / m.area - c.x() * c.y();
}

}  // namespace granular
