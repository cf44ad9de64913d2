// The rules that integrate over the overlap: which integrals each needs, and the contact that comes of its pressure.
#include <algorithm>
#include <cassert>

#include "granular/point/overlap.h"
#include "granular/point/rules.h"
#include "granular/point/witness.h"

namespace granular {
namespace {

Pressure press(const RuleOptions& options, const AreaMoments& moments, double overlap, double size) {
  switch (options.rule) {
    case PointRule::stiffPatch:
      return pressStiffPatch(moments, options.sharpness, overlap);
    case PointRule::foundation:
      return pressFoundation(moments, referenceArea(size));
    case PointRule::patch:
      return pressPatch(moments, overlap);
    default:
      return pressCentroid(moments, overlap);
  }
}

}  // namespace

PowerChoice powersFor(const RuleOptions& options, double overlap) {
  return options.rule == PointRule::stiffPatch ? PowerChoice{options.sharpness, overlap} : PowerChoice{};
}

void placePressure(const RuleOptions& options, const ContactPlane& plane, const AreaMoments& moments, double overlap,
                   double height, double size, ContactPatch& out) {
  const Pressure pressure = press(options, moments, overlap, size);
  placePoint(plane.lift(pressure.centre, height), plane.u, overlap, out);
  // The plane of a face merged from nearly coplanar ones lies over its corners by a little, which give the overlap.
  out.depth = std::min(pressure.depth, overlap);
  out.squaredDepth = pressure.squaredDepth;
  out.share = pressure.share;
  if (!pressure.isPatch) return;

  // Second moments about the centroid, per area.
  const Vec2 c = moments.centroid();
  out.centre = plane.lift(c, height);
  out.area = moments.area;
  out.uu = moments.xx / moments.area - c.x() * c.x();
  out.vv = moments.yy / moments.area - c.y() * c.y();
  out.uv = moments.xy / moments.area - c.x() * c.y();
}

void placeOnOverlap(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b,
                    const Frame& frameB, const Touch& touch, ContactPatch& out) {
  const ContactPlane plane(touch);
  OverlapArea area;
  if (!measureOverlap(plane, a, frameA, b, frameB, touch.overlap, powersFor(options, touch.overlap), area)) {
    return placePoint(plane.origin, plane.u, touch.overlap, out);
  }
  placePressure(options, plane, area.moments, touch.overlap, area.height, std::min(a.size(), b.size()), out);
}

}  // namespace granular
