// The inside of a vertical cylinder, the vessel of S. The distance from the axis is a convex function, so a convex body
// touches with its extreme points only: vertices, rims, apexes, the silhouette of an ellipsoid. Each touching point is
// a spot of its own, named by the body's geometry; together they are as stiff as one contact (spot_share.h).
//
// A vertex touches wherever it lies outside the radius, whether or not it is the furthest of its neighbours: a flat
// face keeps all its vertices while it tilts. Curved parts touch at their local maxima, at most two for a rim or an
// ellipsoid.
#include <algorithm>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"
#include "granular/point/witness.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/wall/radial_maxima.h"
#include "granular/wall/spot_share.h"
#include "granular/wall/wall.h"

namespace granular {

namespace {

struct Vessel {
  Vec2 axis;
  double radius;
  Vec2 fromAxis(const Vec3& p) const { return p.head<2>() - axis; }
};

/// The spots of one body, as they are found.
struct Spots {
  std::vector<WallTouch>& touches;
  std::vector<Claim>& claims;
  std::size_t begin;  ///< of this body in touches
};

/// Appends the touch of the surface point p (world) if it lies beyond the radius. weight: of the overlap, in [0, 1].
void pushSpot(const Vessel& vessel, const Vec3& p, std::int32_t spot, double weight, Spots& out) {
  const Vec2 r = vessel.fromAxis(p);
  const double distance = r.norm();
  const double overlap = distance - vessel.radius;
  if (!(overlap > 0)) return;
  WallTouch touch;
  touch.normal = Vec3(r.x() / distance, r.y() / distance, 0);
  touch.overlap = overlap;
  touch.spot = spot;
  placePoint(p - 0.5 * overlap * touch.normal, perpendicular(touch.normal), overlap, touch.patch);
  out.touches.push_back(touch);
  out.claims.push_back({weight * overlap, overlap});
}

/// A planar ellipse of surface points: centre + major cos t + minor sin t (world); major and minor are perpendicular to
/// each other seen along the axis, minor no longer than major. The direction of `major` is fixed to the body.
struct SurfaceEllipse {
  Vec3 centre, major, minor;
};

/// Pushes the local maxima of the distance from the axis: `spot` for a lone one, spot + 1 and spot + 2 (by their end of
/// the major axis) for two. The lesser fades out in proportion to how far it stands out of the arc between them.
void pushMaxima(const Vessel& vessel, const SurfaceEllipse& ellipse, std::int32_t spot, bool onlyFurthest, Spots& out) {
  const double s1 = ellipse.major.head<2>().norm(), s2 = ellipse.minor.head<2>().norm();
  const Vec2 e1 = ellipse.major.head<2>() / s1;
  // The minor axis may be seen end on: then any perpendicular serves.
  const Vec2 e2 = s2 > 0 ? Vec2(ellipse.minor.head<2>() / s2) : Vec2(-e1.y(), e1.x());
  const Vec2 c = vessel.fromAxis(ellipse.centre);
  const RadialMaxima maxima = findRadialMaxima(c.dot(e1), c.dot(e2), s1, s2);
  const auto at = [&](int k) -> Vec3 {
    return ellipse.centre + maxima.angle[k].x() * ellipse.major + maxima.angle[k].y() * ellipse.minor;
  };
  if (onlyFurthest || maxima.count == 1) {
    pushSpot(vessel, at(0), spot, 1, out);
    return;
  }
  const double rise = maxima.distance[0] - maxima.between;
  const double fade = rise > 0 ? std::max(0.0, maxima.distance[1] - maxima.between) / rise : 1;
  const int first = maxima.angle[0].x() >= 0 ? 0 : 1;  // in order of spot
  for (int k : {first, 1 - first})
    pushSpot(vessel, at(k), spot + (maxima.angle[k].x() >= 0 ? 1 : 2), k == 0 ? 1.0 : std::min(1.0, fade), out);
}

/// The silhouette of an ellipsoid seen along the axis, given its placed semi-axes as columns.
SurfaceEllipse silhouette(const Vec3& centre, const Mat3& axes) {
  // The shadow of the unit sphere under the upper two rows M: eigenvectors of M M^T.
  const Eigen::Matrix<double, 2, 3> m = axes.topRows<2>();
  const Mat2 square = m * m.transpose();
  const double angle = 0.5 * std::atan2(2 * square(0, 1), square(0, 0) - square(1, 1));
  const Vec2 e1(std::cos(angle), std::sin(angle));
  const Vec2 e2(-e1.y(), e1.x());
  // The points of the sphere whose images are the ends of the shadow's axes.
  const Vec3 v1 = (m.transpose() * e1).normalized();
  Vec3 v2 = m.transpose() * e2;
  v2 = (v2 - v1 * v1.dot(v2)).normalized();
  return {centre, axes * v1, axes * v2};
}

void touchSphere(const Vessel& vessel, const Shape& shape, const Frame& frame, Spots& out) {
  const Vec2 r = vessel.fromAxis(frame.x);
  const double distance = r.norm();
  const Vec2 direction = distance > 0 ? Vec2(r / distance) : Vec2::UnitX();
  Vec3 p = frame.x;
  p.head<2>() += shape.boundingRadius() * direction;
  pushSpot(vessel, p, 0, 1, out);
}

void touchEllipsoid(const Vessel& vessel, const Shape& shape, const Frame& frame, Spots& out) {
  const Vec3 semi = static_cast<const Ellipsoid&>(shape).semiAxes();
  int longest, shortest;
  const double a = semi.maxCoeff(&longest), c = semi.minCoeff(&shortest);
  const double b = semi.sum() - a - c;
  SurfaceEllipse ellipse = silhouette(frame.x, frame.R * semi.asDiagonal());

  // Which end is which: by the long axis, or, for a disc, by the side its short axis points to.
  const Vec3 sense = b * b <= a * c ? Vec3(frame.R.col(longest)) : Vec3(Vec3::UnitZ().cross(frame.R.col(shortest)));
  if (ellipse.major.head<2>().dot(sense.head<2>()) < 0) ellipse.major = -ellipse.major;

  // An ellipsoid nowhere flatter than the wall rolls freely inside it (Blaschke): it touches at one point only.
  pushMaxima(vessel, ellipse, 0, a * a <= vessel.radius * c, out);
}

/// A circle about `axis` (unit, world) through its radius: rims of cylinders and cones.
void touchRim(const Vessel& vessel, const Vec3& centre, const Vec3& axis, double radius, std::int32_t spot,
              Spots& out) {
  // The horizontal diameter is seen in full; for a level circle any diameter serves.
  const double lean = axis.head<2>().norm();
  const Vec3 across = lean > 0 ? Vec3(-axis.y() / lean, axis.x() / lean, 0) : Vec3::UnitX();
  pushMaxima(vessel, {centre, radius * across, radius * axis.cross(across)}, spot, false, out);
}

void touchCylinder(const Vessel& vessel, const Shape& shape, const Frame& frame, Spots& out) {
  const auto& cylinder = static_cast<const Cylinder&>(shape);
  const Vec3 axis = frame.R.col(2);
  touchRim(vessel, frame.x - cylinder.halfHeight() * axis, axis, cylinder.radius(), 0, out);
  touchRim(vessel, frame.x + cylinder.halfHeight() * axis, axis, cylinder.radius(), 3, out);
}

void touchCone(const Vessel& vessel, const Shape& shape, const Frame& frame, Spots& out) {
  const auto& cone = static_cast<const Cone&>(shape);
  const Vec3 axis = frame.R.col(2);
  pushSpot(vessel, frame.x + cone.apexZ() * axis, 0, 1, out);
  touchRim(vessel, frame.x + cone.baseZ() * axis, axis, cone.radius(), 1, out);
}

void touchPolyhedron(const Vessel& vessel, const Shape& shape, const Frame& frame, Spots& out) {
  const std::span<const Vec3> vertices = static_cast<const Polyhedron&>(shape).tables().vertices;
  const Eigen::Matrix<double, 2, 3> R = frame.R.topRows<2>();
  const Vec2 centre = vessel.fromAxis(frame.x);
  const double limit = vessel.radius * vessel.radius;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if ((R * vertices[v] + centre).squaredNorm() > limit)
      pushSpot(vessel, frame.toWorld(vertices[v]), static_cast<std::int32_t>(v), 1, out);
}

/// Any shape that has nothing but a support function: climb p <- support(outward at p), which never falls because the
/// distance is convex, from directions spread about the outward one. One maximum is spot 0; several are numbered by the
/// octant of the body they lie in, later ones in the same octant by steps of 8.
void touchGeneric(const Vessel& vessel, const Shape& shape, const Frame& frame, Spots& out) {
  const Vec2 r = vessel.fromAxis(frame.x);
  const double distance = r.norm();
  const Vec3 outward = distance > 0 ? Vec3(r.x() / distance, r.y() / distance, 0) : Vec3::UnitX();
  const Vec3 aside(-outward.y(), outward.x(), 0);
  const auto supportAlong = [&](const Vec3& d) { return frame.toWorld(shape.support(frame.unrotate(d))); };

  const double same = tolerance::certificate * shape.boundingRadius();
  std::array<Vec3, 9> found;
  std::size_t count = 0;
  for (int seed = 0; seed < 9; ++seed) {
    const int sideways = seed % 3 - 1, upwards = seed / 3 - 1;
    Vec3 p = supportAlong(outward + sideways * aside + upwards * Vec3::UnitZ());
    for (int climb = 0; climb < 200; ++climb) {
      const Vec2 h = vessel.fromAxis(p);
      const Vec3 next = supportAlong(Vec3(h.x(), h.y(), 0));
      const double rise = vessel.fromAxis(next).norm() - h.norm();
      if (!(rise > tolerance::tie * shape.boundingRadius())) break;
      p = next;
    }
    const bool known =
        std::any_of(found.begin(), found.begin() + count, [&](const Vec3& q) { return (p - q).norm() < same; });
    if (!known && vessel.fromAxis(p).norm() > vessel.radius) found[count++] = p;
  }

  // Number them by the body's own geometry.
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 local = frame.toBody(found[k]);
    std::int32_t spot = count == 1 ? 0 : 1 + (local.x() < 0) + 2 * (local.y() < 0) + 4 * (local.z() < 0);
    const auto begin = out.touches.begin() + static_cast<std::ptrdiff_t>(out.begin);
    while (std::any_of(begin, out.touches.end(), [spot](const WallTouch& touch) { return touch.spot == spot; }))
      spot += 8;
    pushSpot(vessel, found[k], spot, 1, out);
  }
}

using TouchVessel = void (*)(const Vessel&, const Shape&, const Frame&, Spots&);

/// One row per kind of shape, in the order of ShapeKind.
constexpr std::array<TouchVessel, shapeKindCount> vesselTable = {
    touchSphere,      // sphere
    touchEllipsoid,   // ellipsoid
    touchCylinder,    // cylinder
    touchCone,        // cone
    touchPolyhedron,  // cuboid
    touchPolyhedron,  // polyhedron
    touchGeneric,     // bullet
    nullptr,          // clump: its children are spheres
};

class VesselWall final : public Wall {
 public:
  VesselWall(const Vec2& axis, double radius) : vessel{axis, radius} {
    require(axis.allFinite() && std::isfinite(radius) && radius > 0,
            "cylinder wall: radius " + std::to_string(radius) + " m, must be > 0 and finite");
  }

  void touch(const RuleOptions&, const Shape& shape, const Frame& frame, std::vector<WallTouch>& out) const override {
    if (clearance(frame.x, shape.boundingRadius()) > 0) return;
    thread_local std::vector<Claim> claims;
    claims.clear();
    Spots spots{out, claims, out.size()};
    vesselTable[static_cast<std::size_t>(shape.kind())](vessel, shape, frame, spots);
    const std::span<WallTouch> mine(out.begin() + static_cast<std::ptrdiff_t>(spots.begin), out.end());
    shareStiffness(claims, mine);
    std::sort(mine.begin(), mine.end(), [](const WallTouch& s, const WallTouch& t) { return s.spot < t.spot; });
  }

  double clearance(const Vec3& centre, double radius) const override {
    return vessel.radius - vessel.fromAxis(centre).norm() - radius;
  }
  bool admits(const Vec3& p) const override { return vessel.fromAxis(p).norm() < vessel.radius; }
  bool isFlat() const override { return false; }
  Mat3 curvatureAt(const Vec3& p) const override {
    const Vec2 r = vessel.fromAxis(p).normalized();
    const Vec3 around(-r.y(), r.x(), 0);
    return (-1 / vessel.radius) * (around * around.transpose());
  }
  std::string describe() const override {
    return "inside of a vertical cylinder, radius " + std::to_string(vessel.radius) + " m";
  }

 private:
  Vessel vessel;
};

}  // namespace

std::unique_ptr<Wall> makeCylinderWall(const Vec2& axis, double radius) {
  return std::make_unique<VesselWall>(axis, radius);
}

}  // namespace granular
