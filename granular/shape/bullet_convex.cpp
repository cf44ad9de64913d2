// Mass properties: inscribed polytopes of three finenesses; what a polytope misses of any measure is in proportion to
// the sum of its faces' areas times gaps (curved parts: both go with the square of the facets' width), so two polytopes
// extrapolate to none missing, and two extrapolations tell the error.
#include "granular/shape/bullet_convex.h"

#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>

#include <algorithm>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"
#include "granular/shape/bullet_vectors.h"
#include "granular/shape/slab_points.h"
#include "granular/shape/support_polytope.h"

namespace granular {

namespace {

/// A user's shape in the body frame at another scale; holds on to the original.
class MovedShape final : public btConvexInternalShape {
 public:
  MovedShape(std::shared_ptr<const btConvexShape> original, const Frame& frame, double factor, const Vec3& inertia)
      : source(std::move(original)), bodyToSource(frame), scale(factor), inertiaPerMass(toBullet(inertia)) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    m_collisionMargin = 0;
  }
  /// frame: body to source axes in units of the result; a source point times factor is in those units.
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& d) const override {
    const Vec3 direction = bodyToSource.rotate(fromBullet(d * m_localScaling));
    const Vec3 p = fromBullet(source->localGetSupportingVertexWithoutMargin(toBullet(direction))) * scale;
    return toBullet(bodyToSource.toBody(p)) * m_localScaling;
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* points,
                                                         int count) const override {
    for (int k = 0; k < count; ++k) points[k] = localGetSupportingVertexWithoutMargin(directions[k]);
  }
  void calculateLocalInertia(btScalar mass, btVector3& inertia) const override { inertia = mass * inertiaPerMass; }
  const char* getName() const override { return "granular"; }

 private:
  std::shared_ptr<const btConvexShape> source;
  Frame bodyToSource;
  double scale;
  btVector3 inertiaPerMass;
};

/// Every measure of a polytope that is extrapolated: volume, first moment, full inertia about the origin, area, area
/// <r²> about the origin. All are sums over the solid or its surface, so they extrapolate without regard to the frame.
using Measures = Eigen::Vector<double, 15>;

Measures measuresOf(const ConvexHull& hull) {
  const SolidProperties solid = solidProperties(hull.vertices, fanTriangles(hull));
  const MassProperties& p = solid.principal;
  const Vec3& c = solid.centroid;
  Measures m;
  const Mat3 about = solid.inertia + p.volume * (c.squaredNorm() * Mat3::Identity() - c * c.transpose());
  m << p.volume, p.volume * c, Eigen::Map<const Eigen::Vector<double, 9>>(about.data()), p.area, p.meanSquareRadius;
  return m;
}

/// Measures at nothing missing, from two polytopes.
Measures extrapolate(const Measures& coarse, double coarseMissing, const Measures& fine, double fineMissing) {
  if (fineMissing <= 0 || coarseMissing <= fineMissing * (1 + 1e-6)) return fine;
  return fine + (fine - coarse) * (fineMissing / (coarseMissing - fineMissing));
}

/// Back to a solid: centroid, principal axes.
SolidProperties solidFrom(const Measures& m) {
  SolidProperties solid;
  solid.principal.volume = m[0];
  solid.centroid = m.segment<3>(1) / m[0];
  const Vec3& c = solid.centroid;
  const Mat3 about = Eigen::Map<const Mat3>(m.data() + 4);
  solid.inertia = about - m[0] * (c.squaredNorm() * Mat3::Identity() - c * c.transpose());
  const PrincipalAxes principal = principalAxes(solid.inertia);
  solid.axes = principal.axes;
  solid.principal.inertia = principal.moments;
  solid.principal.area = m[13];
  solid.principal.meanSquareRadius = m[14];
  return solid;
}

/// Largest relative difference of two solids' measures.
double relativeDifference(const SolidProperties& a, const SolidProperties& b) {
  const MassProperties &p = a.principal, &q = b.principal;
  return std::max({std::abs(p.volume / q.volume - 1), std::abs(p.area / q.area - 1),
                   std::abs(p.meanSquareRadius / q.meanSquareRadius - 1),
                   (a.inertia - b.inertia).norm() / b.inertia.norm()});
}

/// Climbs from direction d to a local maximum of the norm of step(d): |support(d)| or |support(d) - support(-d)|.
template <class Step>
double climb(Vec3 d, Step step) {
  double length = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec3 next = step(d);
    const double grown = next.norm();
    if (!(grown > length * (1 + 1e-15))) break;
    length = grown;
    d = next / grown;
  }
  return length;
}

}  // namespace

BulletConvex::BulletConvex(std::shared_ptr<const btConvexShape> given, double unitLength, Frame* toBody)
    : Shape(ShapeKind::bullet), shape(std::move(given)), metresPerUnit(unitLength) {
  require(shape != nullptr, "Bullet shape: none given");
  require(std::isfinite(metresPerUnit) && metresPerUnit > 0,
          "Bullet shape: " + std::to_string(metresPerUnit) + " m per unit; it must be finite and above 0");

  // three finenesses, each going on from the one before, in the shape's own axes
  const SupportFunction ask = [this](const Vec3& d) { return support(d); };
  std::vector<Vec3> points = firstSupportPoints(ask);
  Aabb box;
  for (const Vec3& p : points) {
    require(p.allFinite(), "Bullet shape: its support function returned a point that is not finite");
    box.include(p);
  }
  const double extent = (box.hi - box.lo).maxCoeff() / 2;
  require(extent > 0,
          "Bullet shape: its support function (without margin) always returns the same point, so it has no "
          "volume; a btSphereShape is all margin: use a sphere");
  constexpr std::array<double, 3> fineness{8e-3, 2e-3, 5e-4};
  std::array<Measures, 3> measures;
  std::array<SupportPolytope, 3> polytopes;
  for (std::size_t k = 0; k < 3; ++k) {
    polytopes[k] = refineSupportPolytope(ask, fineness[k] * extent, 6000, points);
    measures[k] = measuresOf(polytopes[k].hull);
  }
  const SolidProperties before =
      solidFrom(extrapolate(measures[0], polytopes[0].missing, measures[1], polytopes[1].missing));
  const SolidProperties solid =
      solidFrom(extrapolate(measures[1], polytopes[1].missing, measures[2], polytopes[2].missing));
  relativeError = std::max(relativeDifference(before, solid), 1e-14);

  // into the body frame
  frame = solid.frame();
  if (toBody) *toBody = frame;
  const ConvexHull& coarse = polytopes[0].hull;
  for (const Vec3& v : coarse.vertices) inscribed.vertices.push_back(frame.toBody(v));
  inscribed.triangles = fanTriangles(coarse);
  findFlatFaces(polytopes[2], extent);
  measure(solid.principal);
}

BulletConvex::BulletConvex(const BulletConvex& source, double factor)
    : Shape(ShapeKind::bullet),
      shape(source.shape),
      metresPerUnit(source.metresPerUnit * factor),
      frame(source.frame.R, source.frame.x * factor),
      relativeError(source.relativeError),
      inscribed(source.inscribed),
      flatFaces(source.flatFaces) {
  for (Vec3& v : inscribed.vertices) v *= factor;
  for (FlatFace& face : flatFaces) {
    for (Vec3& corner : face.corners) corner *= factor;
  }
  setScaledMeasures(source, factor);
}

void BulletConvex::findFlatFaces(const SupportPolytope& polytope, double extent) {
  // a curved surface has no face that is both as wide as this and as close to its supporting plane: a facet of width w
  // on a radius R is w²/(8 R) below it
  const double wide = 1e-2 * extent;
  const double close = 1e-8 * extent;
  const ConvexHull& hull = polytope.hull;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    if (polytope.gaps[f] > close) continue;
    FlatFace face;
    face.normal = frame.unrotate(hull.normals[f]);
    double perimeter = 0, area = 0;
    for (std::int32_t c : hull.faces[f])
      face.corners.push_back(frame.toBody(hull.vertices[static_cast<std::size_t>(c)]));
    const std::size_t n = face.corners.size();
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 a = face.corners[k] - face.corners[0], b = face.corners[(k + 1) % n] - face.corners[0];
      perimeter += (b - a).norm();
      area += face.normal.dot(a.cross(b)) / 2;
    }
    // the radius of the circle in a polygon is at least its area over its perimeter
    if (area / perimeter > wide / 2) flatFaces.push_back(std::move(face));
  }
}

void BulletConvex::measure(const MassProperties& properties) {
  // radii and extent: climb from the best of the polytope's vertices, whose neighbourhoods it has sampled
  std::vector<Vec3> byRadius = inscribed.vertices;
  std::sort(byRadius.begin(), byRadius.end(), [](const Vec3& a, const Vec3& b) { return a.norm() > b.norm(); });
  double bounding = 0, longestLength = 0;
  for (std::size_t k = 0; k < byRadius.size(); ++k) {
    const Vec3 d = byRadius[k].normalized();
    if (k < 64) bounding = std::max(bounding, climb(d, [this](const Vec3& u) { return support(u); }));
    longestLength = std::max(longestLength, climb(d, [this](const Vec3& u) { return Vec3(support(u) - support(-u)); }));
  }
  double inner = infinity;
  for (const auto& t : inscribed.triangles) {
    const Vec3& a = inscribed.vertices[static_cast<std::size_t>(t[0])];
    const Vec3 ab = inscribed.vertices[static_cast<std::size_t>(t[1])] - a;
    const Vec3 ac = inscribed.vertices[static_cast<std::size_t>(t[2])] - a;
    const Vec3 across = ab.cross(ac);
    if (across.norm() > 0) inner = std::min(inner, across.normalized().dot(a));
  }
  setMeasures(properties, bounding * (1 + tolerance::onSurface), inner, longestLength,
              distinctAxis(properties.inertia, false));
}

Vec3 BulletConvex::support(const Vec3& d) const {
  const Vec3 direction = frame.rotate(d.stableNormalized());
  return frame.toBody(fromBullet(shape->localGetSupportingVertexWithoutMargin(toBullet(direction))) * metresPerUnit);
}

namespace {

/// Directions tilted from d by angle, evenly around it.
constexpr int tiltsAround = 16;
Vec3 tilted(const Vec3& d, const Vec3& u, double angle, int k) {
  const double azimuth = 2 * pi * k / tiltsAround;
  return std::cos(angle) * d + std::sin(angle) * (std::cos(azimuth) * u + std::sin(azimuth) * d.cross(u));
}

}  // namespace

void BulletConvex::supportFeature(const Vec3& d, double slab, Feature& out) const {
  const Vec3 top = support(d);
  const double highest = d.dot(top);
  const double floor = highest - slab - tolerance::onSurface * boundingRadius();
  SlabPoints found;
  found.push(top, highest, 0);
  // of a surface of the body's radius the slab cuts off a cap of this angle; a third of it and far less show corners of
  // faces that are tilted, or hardly, against the plane
  const double cap = std::min(0.5, std::sqrt(2 * slab / size()) + 1e-7);
  const Vec3 u = perpendicular(d);
  int index = 0;
  for (const double angle : {cap, cap / 3, 1e-7}) {
    for (int k = 0; k < tiltsAround; ++k) {
      const Vec3 p = support(tilted(d, u, angle, k));
      const double height = d.dot(p);
      ++index;
      if (height < floor) continue;
      const bool known = std::any_of(found.begin(), found.end(), [&](const SlabPoints::Item& item) {
        return (item.point - p).squaredNorm() <= 1e-24 * size() * size();
      });
      if (!known) found.push(p, height, index);
    }
  }
  hullSeenAlong(d, found, out);
}

Vec3 BulletConvex::supportFace(const Vec3& d, double minCosine, Feature& out) const {
  out.clear();
  const auto best = std::max_element(flatFaces.begin(), flatFaces.end(), [&](const FlatFace& a, const FlatFace& b) {
    return d.dot(a.normal) < d.dot(b.normal);
  });
  if (best != flatFaces.end() && d.dot(best->normal) >= minCosine) {
    const std::size_t count = std::min<std::size_t>(best->corners.size(), Feature::capacity);
    for (std::size_t k = 0; k < count; ++k) out.push(best->corners[k * best->corners.size() / count]);
    return best->normal;
  }

  // an edge within the angle shows its two ends when d is tilted by it to and fro
  const double angle = std::acos(std::clamp(minCosine, 0.0, 1.0)) + 1e-9;
  const Vec3 u = perpendicular(d);
  const Vec3 top = support(d);
  Vec3 p = top, q = top;
  for (int k = 0; k < tiltsAround / 2; ++k) {
    const Vec3 one = support(tilted(d, u, angle, k)), other = support(tilted(d, u, angle, k + tiltsAround / 2));
    if ((one - other).squaredNorm() > (p - q).squaredNorm()) {
      p = one;
      q = other;
    }
  }
  // it is straight if both ends lie in the supporting plane of the direction square to it
  const double length = (p - q).norm();
  if (length > 1e-2 * size()) {
    const Vec3 along = (p - q) / length;
    const Vec3 square = (d - d.dot(along) * along).normalized();
    const double plane = square.dot(support(square)) - 1e-8 * size();
    if (square.dot(p) >= plane && square.dot(q) >= plane && std::abs(along.dot(d)) <= std::sin(angle)) {
      out.push(p);
      out.push(q);
      return d;
    }
  }
  out.push(top);
  return d;
}

bool BulletConvex::contains(const Vec3& p) const {
  const double slack = tolerance::onSurface * boundingRadius();
  if (!(p.norm() <= boundingRadius() + slack)) return false;
  if (p.norm() <= innerRadius()) return true;

  // the inscribed triangle that the ray from the centre to p passes through
  std::array<Vec3, 3> portal;
  double best = -infinity;
  for (const auto& t : inscribed.triangles) {
    std::array<Vec3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = inscribed.vertices[static_cast<std::size_t>(t[k])];
    double least = infinity;
    for (std::size_t k = 0; k < 3; ++k) {
      least = std::min(least, corner[k].cross(corner[(k + 1) % 3]).stableNormalized().dot(p));
    }
    if (least > best) {
      best = least;
      portal = corner;
    }
  }

  // push the portal outward until p is behind it, or beyond a supporting plane (portal refinement, as in XenoCollide)
  for (int step = 0; step < 200; ++step) {
    const Vec3 normal = (portal[1] - portal[0]).cross(portal[2] - portal[0]).stableNormalized();
    const double height = normal.dot(p - portal[0]);
    if (height <= slack) return true;
    const Vec3 beyond = support(normal);
    const double gap = normal.dot(beyond - portal[0]);
    if (height > gap + slack) return false;
    if (gap <= slack) return true;
    // of the three triangles over the portal, the one the ray passes through
    std::size_t chosen = 0;
    double most = -infinity;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = portal[k], &b = portal[(k + 1) % 3];
      const double inside =
          std::min(b.cross(beyond).stableNormalized().dot(p), beyond.cross(a).stableNormalized().dot(p));
      if (inside > most) {
        most = inside;
        chosen = k;
      }
    }
    portal = {portal[chosen], portal[(chosen + 1) % 3], beyond};
  }
  return true;
}

TriangleMesh BulletConvex::surface(int) const { return inscribed; }

std::unique_ptr<btConvexShape> BulletConvex::makeBulletShape(double scale) const {
  const Vec3 inertia = massProperties().inertia / massProperties().volume;
  return std::make_unique<MovedShape>(shape, Frame(frame.R, frame.x * scale), metresPerUnit * scale,
                                      inertia * (scale * scale));
}

std::string BulletConvex::describe() const {
  return std::string("Bullet shape \"") + shape->getName() + "\", longest extent " + describeLength(longestExtent());
}

}  // namespace granular
