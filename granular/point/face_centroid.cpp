// The paper's contact point (Seelen et al. 2018, section 5.2, algorithm 4): the support features of both bodies within
// a slab below their supporting planes, projected on the contact plane, one clipped by the other; the centroid of what
// is left (area of a polygon, middle of a segment, the point of a point), in the middle of the overlap.
#include "granular/point/clip.h"
#include "granular/point/moments.h"
#include "granular/point/rules.h"
#include "granular/point/surface_side.h"
#include "granular/point/witness.h"

namespace granular {
namespace {

/// A feature seen in the contact plane.
Polygon project(const ContactPlane& plane, const Frame& frame, const Feature& feature) {
  Polygon out;
  out.count = 0;
  for (int k = 0; k < feature.count; ++k) out.push(plane.project(frame.toWorld(feature[k])), noEdge);
  return out;
}

/// Counter-clockwise seen from above.
void turnOver(Polygon& polygon) {
  for (int k = 0, last = polygon.count - 1; k < last; ++k, --last) std::swap(polygon[k], polygon[last]);
}

/// How far x lies outside the feature, m; 0 inside. Of a polygon: outside one of its edges.
double distanceOutside(const Polygon& feature, const Vec2& x) {
  if (feature.count == 1) return (x - feature[0]).norm();
  if (feature.count == 2) {
    const Vec2 along = feature[1] - feature[0];
    const double share = along.dot(x - feature[0]) / along.squaredNorm();
    return (x - feature[0] - std::clamp(share, 0.0, 1.0) * along).norm();
  }
  double farthest = 0;
  for (int k = 0; k < feature.count; ++k) {
    const Linear left = findLeftSide(feature[k], feature[feature.next(k)]);
    const double length = left.slope.norm();
    if (length > 0) farthest = std::max(farthest, -left.at(x) / length);
  }
  return farthest;
}

/// The centroid of the two features' intersection; false where they miss each other by more than the lateral distance:
/// an edge that the normal is across but for its rounding may leave one of its ends alone in a thin slab.
bool findCentroid(const Polygon& a, const Polygon& b, double lateral, Vec2& out) {
  // A point, the point of a point.
  if (a.count == 1 || b.count == 1) {
    out = a.count == 1 ? a[0] : b[0];
    return distanceOutside(a.count == 1 ? b : a, out) <= lateral;
  }

  // A segment, its middle.
  if (a.count == 2 || b.count == 2) {
    const Polygon& thin = a.count == 2 ? a : b;
    const Polygon& wide = a.count == 2 ? b : a;
    Segment piece{thin[0], thin[1]};
    const bool met = wide.count == 2 ? clipSegment({wide[0], wide[1]}, lateral, piece) : clipSegment(wide, piece);
    out = 0.5 * (piece.from + piece.to);
    return met;
  }

  // A polygon, its area.
  Polygon region = a;
  clipPolygon(b, region);
  const AreaMoments moments = integrate(region, {1, Vec2::Zero()});
  if (!(moments.area > 0)) return false;
  out = moments.centroid();
  return true;
}

}  // namespace

void placeFaceCentroid(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b,
                       const Frame& frameB, const Touch& touch, ContactPatch& out) {
  // The features, both within the same slab below their supporting planes.
  const ContactPlane plane(touch);
  const double slab = options.slab * touch.overlap;
  Feature featureA, featureB;
  a.supportFeature(frameA.unrotate(plane.n), slab, featureA);
  b.supportFeature(frameB.unrotate(-plane.n), slab, featureB);
  const Polygon polygonA = project(plane, frameA, featureA);
  Polygon polygonB = project(plane, frameB, featureB);
  turnOver(polygonB);

  // Their common centroid, or the deepest point.
  Vec2 centroid;
  if (!findCentroid(polygonA, polygonB, touch.overlap, centroid)) centroid.setZero();
  placePoint(plane.lift(centroid, 0), plane.u, touch.overlap, out);
}

}  // namespace granular
