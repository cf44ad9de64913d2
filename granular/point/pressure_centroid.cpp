// Beyond the paper: the centroid of the overlap weighted by its local depth. It moves continuously, from the centre of
// a face without tilt over its third point, where the far edge lifts off, to the edge.
#include "granular/point/overlap.h"
#include "granular/point/rules.h"
#include "granular/point/witness.h"

namespace granular {

void placePressureCentroid(const RuleOptions&, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                           const Touch& touch, ContactPatch& out) {
  const ContactPlane plane(touch);
  OverlapArea area;
  if (!measureOverlap(plane, a, frameA, b, frameB, touch.overlap, area)) return placePoint(plane.origin, plane.u, out);
  placePoint(plane.lift(area.moments.centroidOfVolume(), area.height), plane.u, out);
}

}  // namespace granular
