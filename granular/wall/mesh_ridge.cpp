// Ridges and corners of a mesh wall: see mesh_contact.h.
#include <algorithm>

#include "granular/core/tolerances.h"
#include "granular/narrow/narrow.h"
#include "granular/point/witness.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/wall/mesh_contact.h"

namespace granular {

namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// The fan of normals of a ridge, from those of the left facet to those of the right one.
struct NormalFan {
  const MeshQuery& query;
  const Ridge& ridge;
  Vec3 first, across;  ///< unit, perpendicular to the ridge and to each other: the normal at angle t is first cos t +
                       ///< across sin t
  double opening;      ///< rad

  NormalFan(const MeshQuery& q, const Ridge& r)
      : query(q), ridge(r), first(q.mesh.facets[at(r.left)].normal), across(-r.intoLeft) {
    const Vec3 last = r.right < 0 ? across : q.mesh.facets[at(r.right)].normal;
    opening = std::atan2(std::max(0.0, last.dot(across)), last.dot(first));
  }
  Vec3 normalAt(double t) const { return std::cos(t) * first + std::sin(t) * across; }
  Vec3 turn(double t) const { return std::cos(t) * across - std::sin(t) * first; }
  const Vec3& start() const { return query.mesh.vertices[at(ridge.a)]; }
};

/// A normal of the fan and the body's lowest point for it. The depth h falls with t where the point lies ahead.
struct FanSample {
  double angle, depth;
  bool falls;
  Vec3 lowest;
};
FanSample sampleFan(const NormalFan& fan, double angle) {
  const Vec3 n = fan.normalAt(angle), lowest = fan.query.support(-n);
  return {angle, n.dot(fan.start() - lowest), fan.turn(angle).dot(lowest - fan.start()) > 0, lowest};
}

/// The minimum between two samples, h falling at the first and rising at the second. Seen along the ridge, their lowest
/// points p and q lie on either side of it. Normals perpendicular to the chord p-q find lower points, until none is
/// left: there p and q are equally deep, and the ridge lies between them.
void closeIn(const NormalFan& fan, const FanSample& falling, const FanSample& rising, RidgeDepth& best) {
  const Vec3& e = fan.ridge.direction;
  const Vec3 outwards = fan.normalAt(0.5 * (falling.angle + rising.angle));
  Vec3 p = falling.lowest, q = rising.lowest, n, along;
  for (int iteration = 0; iteration < 100; ++iteration) {
    Vec3 chord = q - p;
    chord -= e * e.dot(chord);
    const double length = chord.norm();
    if (!(length > 0)) return;
    along = chord / length;
    n = along.cross(e);
    if (n.dot(outwards) < 0) n = -n;
    const Vec3 lower = fan.query.support(-n);
    const double gain = n.dot(p - lower);
    if (!(gain > tolerance::onSurface * fan.query.shape.boundingRadius())) break;
    (along.dot(lower - fan.start()) < 0 ? p : q) = lower;
  }

  // The point between p and q straight below the ridge.
  const double tp = along.dot(p - fan.start()), tq = along.dot(q - fan.start());
  if (!(tp <= 0 && tq >= 0 && tp < tq)) return;
  const Vec3 deepest = p + tp / (tp - tq) * (q - p);
  const double overlap = n.dot(fan.start() - deepest);
  best.least = std::min(best.least, overlap);
  if (n.dot(fan.ridge.intoLeft) > 0 || n.dot(fan.ridge.intoRight) > 0) return;
  if (best.found && best.overlap <= overlap) return;
  best.found = true;
  best.normal = n;
  best.overlap = overlap;
  best.deepest = deepest;
}

/// A sphere: the normal runs from the ridge to the centre.
void closeInOnSphere(const NormalFan& fan, RidgeDepth& best) {
  const Vec3 from = fan.query.frame.x - fan.start();
  const Vec3 away = from - fan.ridge.direction * fan.ridge.direction.dot(from);
  const double distance = away.norm(), radius = fan.query.shape.boundingRadius();
  if (!(distance > 0)) return;
  const Vec3 n = away / distance;
  if (n.dot(fan.ridge.intoLeft) > 0 || n.dot(fan.ridge.intoRight) > 0) return;
  best.found = distance < radius;
  best.normal = n;
  best.least = best.overlap = radius - distance;
  best.deepest = fan.query.frame.x - radius * n;
}

/// True if the segment (body axes) lies within all faces somewhere.
bool meetsFaces(const PolyhedronTables& tables, const Vec3& a, const Vec3& b) {
  double first = 0, last = 1;
  for (std::size_t k = 0; k < tables.faces.size(); ++k) {
    const double from = tables.faces[k].offset - tables.faces[k].normal.dot(a);
    const double to = tables.faces[k].offset - tables.faces[k].normal.dot(b);
    if (from < 0 && to < 0) return false;
    if (from < 0) first = std::max(first, from / (from - to));
    if (to < 0) last = std::min(last, from / (from - to));
  }
  return first <= last;
}

/// The part of the segment between two heights along z, false if there is none.
bool cutToHeights(double lo, double hi, Vec3& a, Vec3& b) {
  const Vec3 from = a, along = b - a;
  double first = 0, last = 1;
  if (along.z() == 0) return a.z() >= lo && a.z() <= hi;
  const double s = (lo - a.z()) / along.z(), t = (hi - a.z()) / along.z();
  first = std::max(first, std::min(s, t));
  last = std::min(last, std::max(s, t));
  a = from + first * along;
  b = from + last * along;
  return first <= last;
}

/// Distance of the segment from the origin (the z axis for two components).
template <class V>
double distanceOf(const V& a, const V& b) {
  const V along = b - a;
  const double length = along.squaredNorm();
  return length > 0 ? (a + std::clamp(-a.dot(along) / length, 0.0, 1.0) * along).norm() : a.norm();
}

/// True if a function that is convex on [0, 1] goes down to 0 there.
template <class F>
bool reachesZero(const F& value) {
  double lo = 0, hi = 1;
  for (int k = 0; k < 80; ++k) {
    const double p = lo + (hi - lo) / 3, q = hi - (hi - lo) / 3, atP = value(p), atQ = value(q);
    if (atP <= 0 || atQ <= 0) return true;
    (atP > atQ ? lo : hi) = atP > atQ ? p : q;
  }
  return false;
}

/// True if a point of the segment (body axes) lies in the shape.
bool meetsSegment(const Shape& shape, Vec3 a, Vec3 b) {
  switch (shape.kind()) {
    case ShapeKind::cuboid:
    case ShapeKind::polyhedron:
      return meetsFaces(static_cast<const Polyhedron&>(shape).tables(), a, b);
    case ShapeKind::sphere:
      return distanceOf(a, b) <= shape.boundingRadius();
    case ShapeKind::ellipsoid: {
      const Vec3& axes = static_cast<const Ellipsoid&>(shape).semiAxes();
      return distanceOf<Vec3>(a.cwiseQuotient(axes), b.cwiseQuotient(axes)) <= 1;
    }
    case ShapeKind::cylinder: {
      const auto& cylinder = static_cast<const Cylinder&>(shape);
      return cutToHeights(-cylinder.halfHeight(), cylinder.halfHeight(), a, b) &&
             distanceOf<Vec2>(a.head<2>(), b.head<2>()) <= cylinder.radius();
    }
    case ShapeKind::cone: {
      const auto& cone = static_cast<const Cone&>(shape);
      const double slope = cone.radius() / cone.height();
      return cutToHeights(cone.baseZ(), cone.apexZ(), a, b) && reachesZero([&](double s) {
               const Vec3 p = a + s * (b - a);
               return p.head<2>().norm() - slope * (cone.apexZ() - p.z());
             });
    }
    case ShapeKind::bullet:
    case ShapeKind::clump:
      break;
  }
  // The factor by which the shape would have to grow about its centre to hold a point is convex along the segment.
  return reachesZero([&](double s) {
    const Vec3 p = a + s * (b - a);
    if (shape.contains(p)) return 0.0;
    double lo = 0, hi = 1;  // p times lo is inside, times hi is not
    for (int k = 0; k < 40; ++k) (shape.contains(0.5 * (lo + hi) * p) ? lo : hi) = 0.5 * (lo + hi);
    return 1 / hi - 1 + tolerance::tie;
  });
}

/// True if the body's own box reaches the ridge.
bool reachesRidge(const MeshQuery& query, const Aabb& bodyBox, const Ridge& ridge) {
  const Vec3 a = query.frame.toBody(query.mesh.vertices[at(ridge.a)]);
  const Vec3 b = query.frame.toBody(query.mesh.vertices[at(ridge.b)]);
  double first = 0, last = 1;
  for (int k = 0; k < 3; ++k) {
    const double toLo = bodyBox.lo[k] - a[k], toHi = bodyBox.hi[k] - a[k], along = b[k] - a[k];
    if (along == 0) {
      if (toLo > 0 || toHi < 0) return false;
      continue;
    }
    first = std::max(first, std::min(toLo / along, toHi / along));
    last = std::min(last, std::max(toLo / along, toHi / along));
  }
  return first <= last;
}

/// The part of a flat face that a contact with normal n may lie on, held by a larger part of the wall at an angle of
/// this cosine to it: all within the angle at which the larger part lets go, nothing beyond some 8 degrees.
double heldBy(const PartTouch& larger, double cosine) {
  constexpr double beyond = 0.99;
  const double same = std::clamp((cosine - beyond) / (fadeCosine - beyond), 0.0, 1.0);
  return larger.broad ? same * larger.claim.weight / larger.claim.full : 0;
}

/// How much of a contact with normal n is left to a ridge, or its end, beside the facets it borders.
double besideFacets(const MeshQuery& query, const Ridge& ridge, const Vec3& n, std::span<const PartTouch> facets) {
  double weight = 1;
  for (std::int32_t facet : {ridge.left, ridge.right}) {
    const PartTouch* touch = facet < 0 ? nullptr : findPart(facets, facet);
    if (touch) weight = std::min(weight, 1 - heldBy(*touch, n.dot(query.mesh.facets[at(facet)].normal)));
  }
  return weight;
}

/// How deep a point lies below a body's surface, and the outward normal there; not positive outside.
double findDepth(const MeshQuery& query, const Vec3& point, Vec3& outward) {
  const Vec3 local = query.frame.toBody(point);
  const Shape& shape = query.shape;
  if (const PolyhedronTables* tables = tablesOf(shape)) {
    double least = infinity;
    std::size_t face = 0;
    for (std::size_t k = 0; k < tables->faces.size() && least > 0; ++k) {
      const double depth = tables->faces[k].offset - tables->faces[k].normal.dot(local);
      if (depth >= least) continue;
      least = depth;
      face = k;
    }
    outward = query.frame.rotate(tables->faces[face].normal);
    return least;
  }
  if (shape.kind() == ShapeKind::sphere) {
    const double distance = local.norm();
    outward = distance > 0 ? Vec3((point - query.frame.x) / distance) : Vec3::UnitZ();
    return shape.boundingRadius() - distance;
  }

  // A small ball about the point is deeper by its radius, along the same normal.
  if (!shape.contains(local)) return 0;
  const Sphere probe(0.1 * shape.innerRadius());
  WarmCache cache;
  NarrowCounts counts;
  Touch touch;
  if (!findTouch(shape, query.frame, probe, Frame(Mat3::Identity(), point), true, cache, counts, touch)) return 0;
  outward = touch.normal;
  return touch.overlap - probe.radius();
}

/// The stretch of a ridge that flat faces or a straight piece of the body share with it.
SunkenPart measureStretch(const MeshQuery& query, const RidgeDepth& depth, SunkenSurface& surface) {
  SunkenPart part;
  const Ridge& ridge = query.mesh.ridges[at(depth.ridge)];
  const Vec3 &a = query.mesh.vertices[at(ridge.a)], &b = query.mesh.vertices[at(ridge.b)];
  surface.look(query.rule, {depth.normal, depth.normal.dot(a)}, depth.deepest, query.shape, query.frame);
  if (surface.dimension() > 1) surface.addAlong({surface.view().project(a), surface.view().project(b)}, part);
  return part;
}

}  // namespace

RidgeDepth findRidgeDepth(const MeshQuery& query, const Aabb& bodyBox, std::int32_t number) {
  const Ridge& ridge = query.mesh.ridges[at(number)];
  RidgeDepth best{number, 0, 0, reachesRidge(query, bodyBox, ridge), false, Vec3::Zero(), 0, Vec3::Zero()};
  const NormalFan fan(query, ridge);
  const FanSample first = sampleFan(fan, 0), last = sampleFan(fan, fan.opening);
  best.least = std::min(first.depth, last.depth);
  if (!(best.least > 0)) return best;
  // Too far to touch, its wedge may still be the way out for a facet, along the normal of the other one.
  if (!best.near) return best;
  if (query.shape.kind() == ShapeKind::sphere) {
    closeInOnSphere(fan, best);
  } else if (first.falls && !last.falls) {
    closeIn(fan, first, last, best);
  } else {
    // The least depth lies at a facet; there may be another minimum in between.
    constexpr int parts = 8;
    FanSample before = first;
    for (int k = 1; k <= parts; ++k) {
      const FanSample here = k == parts ? last : sampleFan(fan, fan.opening * k / parts);
      best.least = std::min(best.least, here.depth);
      if (before.falls && !here.falls) closeIn(fan, before, here, best);
      before = here;
    }
  }
  best.found = best.found && best.least > 0;
  return best;
}

void compareRidges(const FacetMesh& mesh, std::span<const CornerDepth> corners, std::span<RidgeDepth> depths) {
  const auto before = [](const RidgeDepth& depth, std::int32_t ridge) { return depth.ridge < ridge; };
  for (RidgeDepth& depth : depths) {
    depth.around = depth.least;
    const Ridge& ridge = mesh.ridges[at(depth.ridge)];
    for (std::int32_t end : {ridge.cornerA, ridge.cornerB}) {
      if (end < 0 || !mesh.corners[at(end)].convex) continue;
      const auto corner = std::lower_bound(corners.begin(), corners.end(), end,
                                           [](const CornerDepth& c, std::int32_t number) { return c.corner < number; });
      if (corner != corners.end() && corner->corner == end) depth.around = std::min(depth.around, corner->overlap);
      for (std::int32_t k = mesh.corners[at(end)].ridgeBegin; k < mesh.corners[at(end)].ridgeEnd; ++k) {
        const auto rival = std::lower_bound(depths.begin(), depths.end(), mesh.cornerRidges[at(k)], before);
        if (rival != depths.end() && rival->ridge == mesh.cornerRidges[at(k)])
          depth.around = std::min(depth.around, rival->least);
      }
    }
  }
}

bool touchRidge(const MeshQuery& query, const RidgeDepth& depth, std::span<const PartTouch> facets,
                SunkenSurface& surface, PartTouch& out) {
  const double leastWay = depth.found && depth.near ? leastWeight(depth.around, depth.overlap) : 0;
  if (!(leastWay > 0)) return false;

  // The ridge itself must be inside the body, not only its line.
  const Ridge& ridge = query.mesh.ridges[at(depth.ridge)];
  const Vec3 &a = query.mesh.vertices[at(ridge.a)], &b = query.mesh.vertices[at(ridge.b)];
  const double along = ridge.direction.dot(depth.deepest - a);
  const Vec3 below = a + std::clamp(along, 0.0, ridge.length) * ridge.direction;
  if (!query.shape.contains(query.frame.toBody(below)) &&
      !meetsSegment(query.shape, query.frame.toBody(a), query.frame.toBody(b)))
    return false;

  // Where along it: at the deepest point, or over the stretch that a flat face shares with it.
  const bool within = along >= 0 && along <= ridge.length;
  SunkenPart part;
  if (query.shape.kind() != ShapeKind::sphere) part = measureStretch(query, depth, surface);
  if (!within && !part.isBroad()) return false;

  WallTouch& touch = out.touch;
  touch.normal = -depth.normal;
  touch.overlap = within ? depth.overlap : part.deepest;
  const PointRule rule = query.rule.rule;
  const bool deepestRule = rule == PointRule::witness || rule == PointRule::manifold;
  RuleOptions broadRule = query.rule;
  broadRule.rule = PointRule::pressureCentroid;
  if (part.isBroad() && !(deepestRule && within))
    surface.place(deepestRule ? broadRule : query.rule, part.moments, touch.overlap, touch.patch);
  else
    placePoint(depth.deepest + 0.5 * depth.overlap * depth.normal, perpendicular(touch.normal), touch.overlap,
               touch.patch);
  out.part = depth.ridge;
  out.broad = part.isBroad();
  const double beside = besideFacets(query, ridge, depth.normal, facets) * (within ? 1 : part.flatness());
  out.claim = {touch.overlap * leastWay * beside, touch.overlap};
  return out.claim.weight > 0;
}

bool findCornerDepth(const MeshQuery& query, std::int32_t number, CornerDepth& out) {
  const FacetMesh& mesh = query.mesh;
  const Corner& corner = mesh.corners[at(number)];
  const Vec3& vertex = mesh.vertices[at(corner.vertex)];
  if ((vertex - query.frame.x).norm() >= query.shape.boundingRadius()) return false;
  out.corner = number;
  out.overlap = findDepth(query, vertex, out.normal);
  if (!(out.overlap > 0)) return false;
  for (std::int32_t k = corner.spokeBegin; k < corner.spokeEnd; ++k)
    if (mesh.spokes[at(k)].dot(out.normal) < -tolerance::certificate) return false;
  return true;
}

bool touchCorner(const MeshQuery& query, const CornerDepth& depth, std::span<const PartTouch> facets,
                 std::span<const PartTouch> ridges, PartTouch& out) {
  // Facets and ridges that hold the same face leave nothing to their ends.
  const FacetMesh& mesh = query.mesh;
  const Corner& corner = mesh.corners[at(depth.corner)];
  double weight = 1;
  for (std::int32_t k = corner.ridgeBegin; k < corner.ridgeEnd; ++k) {
    const std::int32_t r = mesh.cornerRidges[at(k)];
    const Ridge& ridge = mesh.ridges[at(r)];
    weight = std::min(weight, besideFacets(query, ridge, -depth.normal, facets));
    const PartTouch* touch = findPart(ridges, r);
    const double sine = depth.normal.dot(ridge.direction);
    if (touch) weight = std::min(weight, 1 - heldBy(*touch, std::sqrt(std::max(0.0, 1 - sine * sine))));
  }

  WallTouch& touch = out.touch;
  touch.normal = depth.normal;
  touch.overlap = depth.overlap;
  placePoint(mesh.vertices[at(corner.vertex)] + 0.5 * depth.overlap * depth.normal, perpendicular(depth.normal),
             depth.overlap, touch.patch);
  out.part = depth.corner;
  out.broad = false;
  out.claim = {depth.overlap * weight, depth.overlap};
  return weight > 0;
}

}  // namespace granular
