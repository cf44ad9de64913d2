#include "granular/world/contact_radius.h"

#include "granular/core/tolerances.h"
#include "granular/shape/curvature.h"

namespace granular {
namespace {

/// One surface of a contact: a ball of this radius, or any other, with its curvature in world axes.
struct Surface {
  double ball = 0;  ///< 0: none
  double size = infinity;
  Mat3 curvature = Mat3::Zero();
};

/// n: outward unit normal, world axes.
void lookAt(const Bodies& bodies, std::int32_t index, std::int32_t child, const Vec3& n, Surface& out) {
  const auto i = static_cast<std::size_t>(index);
  const Shape& shape = *bodies.shape[i];
  if (child >= 0) {
    out.ball = out.size = static_cast<const Clump&>(shape).children()[static_cast<std::size_t>(child)].radius;
    return;
  }
  out.size = shape.size();
  if (shape.kind() != ShapeKind::ellipsoid) {
    out.ball = shape.size();
    return;
  }
  const Frame& frame = bodies.frame[i];
  out.curvature = frame.R * curvatureOf(shape, frame.unrotate(n)) * frame.R.transpose();
}

}  // namespace

double contactRadius(const World& world, const Contact& contact) {
  const Vec3& n = contact.touch.normal;
  Surface a, b;
  lookAt(world.bodies, contact.a, contact.spot.childA, n, a);
  if (contact.b >= 0) {
    lookAt(world.bodies, contact.b, contact.spot.childB, -n, b);
    if (a.ball > 0 && b.ball > 0) return a.ball * b.ball / (a.ball + b.ball);
  } else {
    b.curvature = world.walls[static_cast<std::size_t>(-1 - contact.b)]->curvatureAt(contact.patch.point);
  }
  Mat3 sum = a.curvature + b.curvature;
  const double balls = (a.ball > 0 ? 1 / a.ball : 0) + (b.ball > 0 ? 1 / b.ball : 0);
  if (balls > 0) sum += balls * (Mat3::Identity() - n * n.transpose());
  return effectiveRadius(sum, tolerance::flattest * std::min(a.size, b.size));
}

}  // namespace granular
