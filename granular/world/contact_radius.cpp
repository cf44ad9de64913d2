#include "granular/world/contact_radius.h"

#include "granular/core/tolerances.h"
#include "granular/shape/curvature.h"
#include "granular/shape/ellipsoid.h"

namespace granular {
namespace {

/// One surface of a contact.
struct Surface {
  double ball = 0;  ///< radius of what counts as a ball, m; 0: the body curves as it does
  double size = infinity;
};

Surface lookAt(const Bodies& bodies, std::int32_t index, std::int32_t child) {
  const Shape& shape = *bodies.shape[static_cast<std::size_t>(index)];
  if (child >= 0) {
    const double radius = static_cast<const Clump&>(shape).children()[static_cast<std::size_t>(child)].radius;
    return {radius, radius};
  }
  switch (shape.kind()) {
    case ShapeKind::ellipsoid:
      return {0, shape.size()};
    case ShapeKind::sphere:
      return {shape.boundingRadius(), shape.size()};  // to the bit, unlike its size
    default:
      return {shape.size(), shape.size()};
  }
}

/// n: outward unit normal of that body, u: perpendicular to it, world axes; the answer in u and n x u.
Curvature curvatureAt(const Bodies& bodies, std::int32_t index, const Surface& surface, const Vec3& n, const Vec3& u) {
  if (surface.ball > 0) return ballCurvature(surface.ball);
  const auto i = static_cast<std::size_t>(index);
  return curvatureOf(*bodies.shape[i], bodies.frameOf(i).unrotate(n), bodies.frameOf(i).unrotate(u));
}

}  // namespace

double ellipsoidRadius(const Bodies& bodies, std::int32_t a, std::int32_t b, const Vec3& n) {
  const auto shapeOf = [&](std::int32_t body) -> const Ellipsoid& {
    return static_cast<const Ellipsoid&>(*bodies.shape[static_cast<std::size_t>(body)]);
  };
  const auto place = [&](std::int32_t body) -> PlacedEllipsoid<double> {
    return {placeAxes(bodies.frame[static_cast<std::size_t>(body)]), toTriple(shapeOf(body).semiAxes())};
  };
  return effectiveRadius(curvatureBetween(place(a), place(b), toTriple(n)),
                         tolerance::flattest * std::min(shapeOf(a).size(), shapeOf(b).size()));
}

double contactRadius(const World& world, const Contact& contact) {
  const Vec3& n = contact.touch.normal;
  const Surface a = lookAt(world.bodies, contact.a, contact.spot.childA);
  if (contact.b < 0) {
    const Wall& wall = *world.walls[static_cast<std::size_t>(-1 - contact.b)];
    if (wall.isFlat() && a.ball > 0) return a.ball;
    const Vec3 u = perpendicular(n), v = n.cross(u);
    Curvature sum = curvatureAt(world.bodies, contact.a, a, n, u);
    if (!wall.isFlat()) {
      const Mat3 hollow = wall.curvatureAt(contact.patch.point);
      sum = sum + Curvature{u.dot(hollow * u), v.dot(hollow * v), u.dot(hollow * v)};
    }
    return effectiveRadius(sum, tolerance::flattest * a.size);
  }
  const Surface b = lookAt(world.bodies, contact.b, contact.spot.childB);
  if (a.ball > 0 && b.ball > 0) return a.ball * b.ball / (a.ball + b.ball);
  const auto isEllipsoid = [&](std::int32_t body) {
    return world.bodies.shape[static_cast<std::size_t>(body)]->kind() == ShapeKind::ellipsoid;
  };
  if (isEllipsoid(contact.a) && isEllipsoid(contact.b)) return ellipsoidRadius(world.bodies, contact.a, contact.b, n);
  // Seen from B, v = -n x u points the other way: the mixed term changes its sign.
  const Vec3 u = perpendicular(n);
  Curvature other = curvatureAt(world.bodies, contact.b, b, -n, u);
  other.uv = -other.uv;
  return effectiveRadius(curvatureAt(world.bodies, contact.a, a, n, u) + other,
                         tolerance::flattest * std::min(a.size, b.size));
}

}  // namespace granular
