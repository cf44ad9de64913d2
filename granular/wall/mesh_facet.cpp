// Facets of a mesh wall: see mesh_contact.h.
#include <algorithm>

#include "granular/core/tolerances.h"
#include "granular/wall/mesh_contact.h"

namespace granular {

namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// One facet under a body: its plane, the body's deepest point below it, and the triangles that may matter.
struct FacetQuery {
  const MeshQuery& query;
  std::int32_t facet;
  std::span<const std::int32_t> triangles;
  const Plane& plane;
  Vec3 deepest;
  double depth;

  Vec3 corner(std::int32_t triangle, std::size_t k) const {
    return query.mesh.vertices[at(query.mesh.triangles[at(triangle)][k])];
  }
};

/// True if p lies over (or under) the triangle; sides belong to both of their triangles, so that none lets p through.
bool isOverTriangle(const FacetQuery& f, std::int32_t triangle, const Vec3& p) {
  const double slack = tolerance::tie * f.query.mesh.extent;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 a = f.corner(triangle, k), along = f.corner(triangle, (k + 1) % 3) - a;
    if (f.plane.normal.cross(along).dot(p - a) < -slack * along.norm()) return false;
  }
  return true;
}

/// True if the solid goes on below the neighbour beyond a concave ridge, as far down as the deepest point: it lies
/// below the neighbour's plane as well, and over the neighbour or beyond its side of the ridge too.
bool goesOnBeyond(const FacetQuery& f, const Ridge& ridge) {
  if (ridge.convex) return false;
  const double slack = tolerance::tie * f.query.mesh.extent;
  const bool isLeft = ridge.left == f.facet;
  const std::int32_t other = isLeft ? ridge.right : ridge.left;
  const Plane& plane = f.query.mesh.facets[at(other)];
  if (plane.depth(f.deepest) < -slack) return false;
  const Vec3& inwards = isLeft ? ridge.intoRight : ridge.intoLeft;
  if (inwards.dot(f.deepest - f.query.mesh.vertices[at(ridge.a)]) <= slack) return true;
  const FacetQuery there{f.query, other, {}, plane, f.deepest, 0};
  return std::any_of(f.query.triangles.begin(), f.query.triangles.end(), [&](std::int32_t t) {
    return f.query.mesh.triangleFacet[at(t)] == other && isOverTriangle(there, t, f.deepest);
  });
}

/// True if the deepest point lies over the facet, or beyond concave ridges of it, under the neighbours.
bool isOverFacet(const FacetQuery& f) {
  for (std::int32_t t : f.triangles)
    if (isOverTriangle(f, t, f.deepest)) return true;

  // The nearest stretch of the rim decides; at a corner, every stretch that the point lies beyond.
  const Vec3 p = f.deepest + f.depth * f.plane.normal;
  const double slack = tolerance::tie * f.query.mesh.extent;
  double nearest = reach * f.query.shape.boundingRadius();
  bool over = false;
  for (std::int32_t t : f.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t number = f.query.mesh.triangleRidges[at(t)][k];
      if (number < 0) continue;
      const Vec3 a = f.corner(t, k), along = f.corner(t, (k + 1) % 3) - a;
      if (f.plane.normal.cross(along).dot(p - a) > -slack * along.norm()) continue;
      const double s = std::clamp(along.dot(p - a) / along.squaredNorm(), 0.0, 1.0);
      const double distance = (p - a - s * along).norm();
      if (distance > nearest + slack) continue;
      const bool under = goesOnBeyond(f, f.query.mesh.ridges[at(number)]);
      over = distance < nearest - slack ? under : over && under;
      nearest = std::min(nearest, distance);
    }
  return over;
}

/// What of a body's surface lies over a facet.
struct FacetPart {
  double overlap;       ///< the largest depth there, m
  double fraction = 1;  ///< of the area of the sunken surface
  SunkenPart sunken;
  Vec3 middle;  ///< world axes
};

/// The convex ridges of the facet that the body reaches: is there any, and how deep is the body below their wedges?
struct RimCheck {
  bool near = false;
  double least = infinity;  ///< of the wedges on whose inner side the part lies, m
  double any = infinity;    ///< of all, m
};
RimCheck checkRims(const FacetQuery& f, const FacetPart& part) {
  const FacetMesh& mesh = f.query.mesh;
  RimCheck check;
  for (const RidgeDepth& depth : f.query.ridges) {
    const Ridge& ridge = mesh.ridges[at(depth.ridge)];
    if (ridge.left != f.facet && ridge.right != f.facet) continue;
    check.near = check.near || depth.near;
    check.any = std::min(check.any, depth.around);
    // A facet that is not convex goes on beyond the line of its ridge.
    const Vec3& inwards = ridge.left == f.facet ? ridge.intoLeft : ridge.intoRight;
    if (inwards.dot(part.middle - mesh.vertices[at(ridge.a)]) >= 0) check.least = std::min(check.least, depth.around);
  }
  return check;
}

/// True if the way from the point below the facet straight up to it leaves the solid through another facet: a thin
/// wall's other side.
bool leavesSolid(const FacetQuery& f, const Vec3& foot, double depth) {
  const FacetMesh& mesh = f.query.mesh;
  const Vec3 way = -depth * f.plane.normal;
  for (std::int32_t t : f.query.triangles) {
    const std::int32_t other = mesh.triangleFacet[at(t)];
    const Plane& plane = mesh.facets[at(other)];
    const double speed = plane.normal.dot(way);
    if (other == f.facet || !(speed > tolerance::tie * depth)) continue;
    const double s = plane.depth(foot) / speed;
    if (!(s > tolerance::certificate && s < 1)) continue;
    FacetQuery there{f.query, other, {}, plane, foot + s * way, 0};
    if (isOverTriangle(there, t, there.deepest)) return true;
  }
  return false;
}

/// The part of the surface that lies over the facet.
SunkenPart cutOut(const FacetQuery& f, const SunkenSurface& surface) {
  SunkenPart part;
  thread_local Polygon triangle;
  for (std::int32_t t : f.triangles) {
    // Seen from inside the wall, counter-clockwise runs backwards.
    triangle.count = 0;
    for (std::size_t k : {2, 1, 0}) triangle.push(surface.view().project(f.corner(t, k)), noEdge);
    surface.addInside(triangle, part);
  }
  return part;
}

void measurePart(const FacetQuery& f, SunkenSurface& surface, FacetPart& part) {
  surface.look(f.query.rule, f.plane, f.deepest, f.query.shape, f.query.frame);
  if (surface.dimension() == 1) return;
  const double whole = surface.integrateWhole().area;
  part.sunken = cutOut(f, surface);
  part.fraction = whole > 0 ? part.sunken.moments.area / whole : 1;
  part.overlap = std::max(part.overlap, part.sunken.deepest);
  if (part.sunken.isBroad()) part.middle = surface.view().lift(part.sunken.moments.centroidOfVolume(), 0);
}

/// Places a contact that rims cut.
void placePart(const FacetQuery& f, bool over, const FacetPart& part, SunkenSurface& surface, ContactPatch& out) {
  const PointRule rule = f.query.rule.rule;
  if (rule == PointRule::faceCentroid) {
    surface.lookAtFeature(f.plane, f.deepest, f.query.rule.slab * f.depth, f.query.shape, f.query.frame);
    const AreaMoments moments = cutOut(f, surface).moments;
    if (moments.volume > 0) return surface.place(f.query.rule, moments, part.overlap, out);
    surface.look(f.query.rule, f.plane, f.deepest, f.query.shape, f.query.frame);
  }
  // The deepest point may lie beside the facet.
  const bool deepestRule = rule == PointRule::witness || rule == PointRule::manifold;
  RuleOptions options = f.query.rule;
  if (deepestRule && !over) options.rule = PointRule::pressureCentroid;
  surface.place(options, part.sunken.moments, part.overlap, out);
}

}  // namespace

const PartTouch* findPart(std::span<const PartTouch> touches, std::int32_t part) {
  const auto found = std::lower_bound(touches.begin(), touches.end(), part,
                                      [](const PartTouch& touch, std::int32_t p) { return touch.part < p; });
  return found != touches.end() && found->part == part ? &*found : nullptr;
}

void shareAreas(std::span<PartTouch> facets) {
  // Claims are read by every facet: scale them afterwards.
  thread_local std::vector<double> sums;
  sums.clear();
  const auto areaOf = [](double claim, const PartTouch& touch) { return claim / touch.touch.overlap; };
  for (const PartTouch& s : facets) {
    double sum = areaOf(s.claim.full, s);
    for (const PartTouch& t : facets)
      if (&t != &s) sum += areaOf(t.claim.weight, t) * std::max(0.0, s.touch.normal.dot(t.touch.normal));
    sums.push_back(sum);
  }
  for (std::size_t k = 0; k < facets.size(); ++k) {
    facets[k].claim.full /= sums[k];
    facets[k].claim.weight /= sums[k];
  }
}

bool touchFacet(const MeshQuery& query, std::int32_t facet, std::span<const std::int32_t> triangles,
                SunkenSurface& surface, PartTouch& out) {
  const Plane& plane = query.mesh.facets[at(facet)];
  FacetQuery f{query, facet, triangles, plane, plane.deepest(query.shape, query.frame), 0};
  f.depth = plane.depth(f.deepest);
  if (!(f.depth > 0) || plane.depth(query.support(plane.normal)) >= 0) return false;

  // What lies over the facet: the whole where no rim is near, else what its triangles cut out, or just the deepest
  // point.
  const bool over = isOverFacet(f);
  FacetPart part;
  part.overlap = over ? f.depth : 0;
  part.middle = f.deepest + 0.5 * f.depth * plane.normal;
  RimCheck rims = checkRims(f, part);
  if (query.mesh.facetIsConvex[at(facet)] && !(rims.any > 0)) return false;
  bool entire = over && !rims.near;
  if (!entire) {
    measurePart(f, surface, part);
    if (!over && !part.sunken.isBroad()) return false;
    entire = over && part.fraction > 1 - tolerance::certificate;
    rims = checkRims(f, part);
  }

  // Is this facet the one that holds the body?
  double fade = leastWeight(rims.least, part.overlap);
  // Beside the deepest point, only a flat face that is about as deep here as anywhere.
  if (!over) fade *= part.sunken.flatness() * leastWeight(part.overlap, rims.least);
  // A deepest point beyond a concave ridge may have all that is sunken over the neighbour.
  const double fraction = entire ? 1 : part.fraction;
  if (!(fade * fraction > 0)) return false;
  if (leavesSolid(f, part.middle + plane.depth(part.middle) * plane.normal, part.overlap)) return false;

  WallTouch& touch = out.touch;
  touch.normal = -plane.normal;
  touch.overlap = part.overlap;
  if (entire)
    placeOnPlane(query.rule, query.shape, query.frame, plane, f.deepest, surface, touch.patch);
  else
    placePart(f, over, part, surface, touch.patch);
  out.part = facet;
  out.claim.full = part.overlap * fraction;
  out.claim.weight = fade * out.claim.full;
  out.broad = entire || part.sunken.isBroad();
  return true;
}

}  // namespace granular
