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

/// No principal radius of two bodies' contact counts as larger, m.
double flattestRadius(const World& world, const Contact& contact) {
  return tolerance::flattest * std::min(lookAt(world.bodies, contact.a, contact.spot.childA).size,
                                        lookAt(world.bodies, contact.b, contact.spot.childB).size);
}

/// n: outward unit normal of that body, u: perpendicular to it, world axes; the answer in u and n x u.
Curvature curvatureAt(const Bodies& bodies, std::int32_t index, const Surface& surface, const Vec3& n, const Vec3& u) {
  if (surface.ball > 0) return ballCurvature(surface.ball);
  const auto i = static_cast<std::size_t>(index);
  return curvatureOf(*bodies.shape[i], bodies.frame[i].unrotate(n), bodies.frame[i].unrotate(u));
}

}  // namespace

bool isBetweenEllipsoids(const World& world, const Contact& contact) {
  const auto isOne = [&](std::int32_t body) {
    return world.bodies.shape[static_cast<std::size_t>(body)]->kind() == ShapeKind::ellipsoid;
  };
  return contact.b >= 0 && isOne(contact.a) && isOne(contact.b);
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
  if (isBetweenEllipsoids(world, contact)) {
    const auto place = [&](std::int32_t body) -> PlacedEllipsoid<double> {
      const auto i = static_cast<std::size_t>(body);
      return {placeAxes(world.bodies.frame[i]),
              toTriple(static_cast<const Ellipsoid&>(*world.bodies.shape[i]).semiAxes())};
    };
    return effectiveRadius(curvatureBetween(place(contact.a), place(contact.b), toTriple(n)),
                           flattestRadius(world, contact));
  }
  // Seen from B, v = -n x u points the other way: the mixed term changes its sign.
  const Vec3 u = perpendicular(n);
  Curvature other = curvatureAt(world.bodies, contact.b, b, -n, u);
  other.uv = -other.uv;
  return effectiveRadius(curvatureAt(world.bodies, contact.a, a, n, u) + other, flattestRadius(world, contact));
}

void findEllipsoidRadii(const World& world, Contact* const* contacts, double* radii) {
  const Bodies& bodies = world.bodies;
  std::array<const Vec3*, wideSize> normals;
  std::array<double, wideSize> limits;
  for (std::size_t k = 0; k < wideSize; ++k) {
    normals[k] = &contacts[k]->touch.normal;
    limits[k] = flattestRadius(world, *contacts[k]);
  }
  const auto place = [&](std::int32_t Contact::*party) {
    std::array<const Frame*, wideSize> frames;
    std::array<const Vec3*, wideSize> semiAxes;
    for (std::size_t k = 0; k < wideSize; ++k) {
      const auto i = static_cast<std::size_t>(contacts[k]->*party);
      frames[k] = &bodies.frame[i];
      semiAxes[k] = &static_cast<const Ellipsoid&>(*bodies.shape[i]).semiAxes();
    }
    return PlacedEllipsoid<Wide>{loadAxes(frames), loadVectors(semiAxes)};
  };
  const auto sum = curvatureBetween(place(&Contact::a), place(&Contact::b), loadVectors(normals));
  storeWide(radiusOfRound(sum), radii);
  const Mask<Wide> round = isRound(sum, loadWide(limits.data()));
  if (all(round)) return;
  for (std::size_t k = 0; k < wideSize; ++k) {
    if (round[k] == 0) radii[k] = contactRadius(world, *contacts[k]);
  }
}

}  // namespace granular
