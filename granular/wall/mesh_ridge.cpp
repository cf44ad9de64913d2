// Ridges and corners of a mesh wall: see mesh_contact.h.
#include <algorithm>

#include "granular/core/tolerances.h"
#include "granular/narrow/narrow.h"
#include "granular/point/witness.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/wall/mesh_contact.h"

namespace granular {

namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// The least depth of a body below a ridge: n points out of the wall, towards the grains.
struct RidgeDepth {
  Vec3 normal;
  double overlap;
  Vec3 deepest;  ///< of the body, straight below the ridge's line, world axes
};

/// A sphere: the normal runs from the ridge to the centre.
bool findSphereDepth(const MeshQuery& query, const Ridge& ridge, RidgeDepth& out) {
  const Vec3 from = query.frame.x - query.mesh.vertices[at(ridge.a)];
  const Vec3 across = from - ridge.direction * ridge.direction.dot(from);
  const double distance = across.norm(), radius = query.shape.boundingRadius();
  if (!(distance > 0 && distance < radius)) return false;
  out.normal = across / distance;
  out.overlap = radius - distance;
  out.deepest = query.frame.x - radius * out.normal;
  return out.normal.dot(ridge.intoLeft) <= 0 && out.normal.dot(ridge.intoRight) <= 0;
}

/// Any shape. Seen along the ridge, the body's lowest points for the normals of the two facets, p and q, lie beyond the
/// ridge on either side. Normals perpendicular to the chord p-q find lower points, until none is left: there p and q
/// are equally deep, and the ridge lies between them.
bool findGenericDepth(const MeshQuery& query, const Ridge& ridge, RidgeDepth& out) {
  const Vec3& e = ridge.direction;
  const Vec3& start = query.mesh.vertices[at(ridge.a)];
  const Vec3 first = query.mesh.facets[at(ridge.left)].normal;
  const Vec3 last = ridge.right < 0 ? Vec3(-ridge.intoLeft) : query.mesh.facets[at(ridge.right)].normal;
  const Vec3 outwards = first + last - ridge.intoLeft - ridge.intoRight;
  Vec3 p = query.support(-first), q = query.support(-last);
  if (!(first.dot(start - p) > 0 && last.dot(start - q) > 0)) return false;
  if (!(ridge.intoLeft.dot(p - start) < 0 && ridge.intoRight.dot(q - start) < 0)) return false;

  Vec3 n, along;
  for (int iteration = 0; iteration < 100; ++iteration) {
    // Perpendicular to ridge and chord, outwards. As n turns from the first facet to the last, the lowest point moves
    // from p to q, against the turn.
    Vec3 chord = q - p;
    chord -= e * e.dot(chord);
    const double length = chord.norm();
    if (!(length > 0)) return false;
    along = chord / length;
    n = along.cross(e);
    if (n.dot(outwards) < 0) n = -n;
    const Vec3 lower = query.support(-n);
    const double gain = n.dot(p - lower);
    if (!(gain > tolerance::onSurface * query.shape.boundingRadius())) break;
    (along.dot(lower - start) < 0 ? p : q) = lower;
  }

  // The point between p and q straight below the ridge.
  const double tp = along.dot(p - start), tq = along.dot(q - start);
  if (!(tp <= 0 && tq >= 0 && tp < tq)) return false;
  out.deepest = p + tp / (tp - tq) * (q - p);
  out.normal = n;
  out.overlap = n.dot(start - out.deepest);
  return out.overlap > 0 && n.dot(ridge.intoLeft) <= 0 && n.dot(ridge.intoRight) <= 0;
}

/// How much of a contact with normal n is left to a lesser part beside the facets it borders.
double besideFacets(const MeshQuery& query, const Ridge& ridge, const Vec3& n, std::span<const PartTouch> facets) {
  double weight = 1;
  for (std::int32_t facet : {ridge.left, ridge.right}) {
    const PartTouch* touch = facet < 0 ? nullptr : findPart(facets, facet);
    if (touch && touch->broad) weight = std::min(weight, 1 - flatWeight(n.dot(query.mesh.facets[at(facet)].normal)));
  }
  return weight;
}

/// How deep a point lies below a body's surface, and the outward normal there; not positive outside.
double findDepth(const MeshQuery& query, const Vec3& point, Vec3& outward) {
  const Vec3 local = query.frame.toBody(point);
  const Shape& shape = query.shape;
  if (shape.kind() == ShapeKind::cuboid || shape.kind() == ShapeKind::polyhedron) {
    const PolyhedronTables& tables = static_cast<const Polyhedron&>(shape).tables();
    double least = infinity;
    std::size_t face = 0;
    for (std::size_t k = 0; k < tables.faceNormals.size() && least > 0; ++k) {
      const double depth = tables.faceOffsets[k] - tables.faceNormals[k].dot(local);
      if (depth >= least) continue;
      least = depth;
      face = k;
    }
    outward = query.frame.rotate(tables.faceNormals[face]);
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

/// The stretch of a ridge that a flat face or a straight piece of the body shares with it.
AreaMoments measureStretch(const MeshQuery& query, const Ridge& ridge, const RidgeDepth& depth, SunkenSurface& surface,
                           double& deepest) {
  thread_local std::vector<SunkenPoint> corners;
  corners.clear();
  const Plane plane{depth.normal, depth.normal.dot(query.mesh.vertices[at(ridge.a)])};
  surface.look(plane, depth.deepest, query.shape, query.frame);
  AreaMoments moments;
  if (surface.dimension() > 1) {
    const ContactPlane& view = surface.view();
    surface.integrateAlong(
        {view.project(query.mesh.vertices[at(ridge.a)]), view.project(query.mesh.vertices[at(ridge.b)])}, moments,
        corners);
    for (const SunkenPoint& corner : corners) deepest = std::max(deepest, corner.depth);
  }
  return moments;
}

}  // namespace

bool touchRidge(const MeshQuery& query, std::int32_t number, std::span<const PartTouch> facets, SunkenSurface& surface,
                PartTouch& out) {
  const Ridge& ridge = query.mesh.ridges[at(number)];
  const bool sphere = query.shape.kind() == ShapeKind::sphere;
  RidgeDepth depth;
  if (!(sphere ? findSphereDepth(query, ridge, depth) : findGenericDepth(query, ridge, depth))) return false;

  // Where along the ridge: at the deepest point, or over the stretch that a flat face shares with it.
  const Vec3& a = query.mesh.vertices[at(ridge.a)];
  const double along = ridge.direction.dot(depth.deepest - a);
  const bool within = along >= 0 && along <= ridge.length;
  double overlap = within ? depth.overlap : 0;
  AreaMoments moments;
  if (!sphere) moments = measureStretch(query, ridge, depth, surface, overlap);
  const bool broad = moments.area > 0 && moments.volume > 0;
  if (!within && !broad) return false;

  // The ridge itself must be inside the body, not only its line.
  const Vec3 place = broad ? surface.view().lift(moments.centroidOfVolume(), 0) : depth.deepest;
  const Vec3 onRidge = a + std::clamp(ridge.direction.dot(place - a), 0.0, ridge.length) * ridge.direction;
  if (!sphere && !query.shape.contains(query.frame.toBody(onRidge))) return false;

  WallTouch& touch = out.touch;
  touch.normal = -depth.normal;
  touch.overlap = overlap;
  touch.share =
      overlap * besideFacets(query, ridge, depth.normal, facets) * (within ? 1 : flatWeight(surface.flatness()));
  const PointRule rule = query.rule.rule;
  const bool deepestRule = rule == PointRule::witness || rule == PointRule::manifold;
  if (broad && !(deepestRule && within))
    surface.place(deepestRule ? PointRule::pressureCentroid : rule, moments, touch.patch);
  else
    placePoint(depth.deepest + 0.5 * overlap * depth.normal, perpendicular(touch.normal), touch.patch);
  out.part = number;
  out.broad = broad;
  return touch.share > 0;
}

bool touchCorner(const MeshQuery& query, std::int32_t number, std::span<const PartTouch> facets,
                 std::span<const PartTouch> ridges, PartTouch& out) {
  const FacetMesh& mesh = query.mesh;
  const Corner& corner = mesh.corners[at(number)];
  const Vec3& vertex = mesh.vertices[at(corner.vertex)];
  if ((vertex - query.frame.x).norm() >= query.shape.boundingRadius()) return false;
  Vec3 normal;
  const double overlap = findDepth(query, vertex, normal);
  if (!(overlap > 0)) return false;

  // The normal must lie within the corner's cone.
  for (std::int32_t k = corner.spokeBegin; k < corner.spokeEnd; ++k)
    if (mesh.spokes[at(k)].dot(normal) < -tolerance::certificate) return false;

  // Facets and ridges that hold the same face leave nothing to their ends.
  double weight = 1;
  for (std::int32_t k = corner.ridgeBegin; k < corner.ridgeEnd; ++k) {
    const std::int32_t r = mesh.cornerRidges[at(k)];
    const Ridge& ridge = mesh.ridges[at(r)];
    weight = std::min(weight, besideFacets(query, ridge, -normal, facets));
    const PartTouch* touch = findPart(ridges, r);
    const double sine = normal.dot(ridge.direction);
    if (touch && touch->broad) weight = std::min(weight, 1 - flatWeight(std::sqrt(std::max(0.0, 1 - sine * sine))));
  }

  WallTouch& touch = out.touch;
  touch.normal = normal;
  touch.overlap = overlap;
  touch.share = overlap * weight;
  placePoint(vertex + 0.5 * overlap * normal, perpendicular(normal), touch.patch);
  out.part = number;
  out.broad = false;
  return touch.share > 0;
}

}  // namespace granular
