#include "granular/analysis/cross_section.h"

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {

CrossSection::CrossSection(const Vessel& vessel, const Aabb& particles) {
  round = vessel.kind == Vessel::Kind::cylinder;
  hasWall = round || vessel.kind == Vessel::Kind::box;
  if (round) {
    require(vessel.radius > 0, "vessel: a cylinder needs a radius > 0, not " + std::to_string(vessel.radius) + " m");
    centre = vessel.axis;
    radius = vessel.radius;
    return;
  }
  const bool bounded = vessel.kind != Vessel::Kind::none;
  lo = bounded ? vessel.lo.head<2>() : particles.lo.head<2>();
  hi = bounded ? vessel.hi.head<2>() : particles.hi.head<2>();
  require((lo.array() < hi.array()).all(), "vessel: its bounds in x and y leave no area");
}

double CrossSection::area() const { return round ? pi * radius * radius : (hi - lo).prod(); }

double CrossSection::curveLength(double distance) const {
  if (round) return 2 * pi * (radius - distance);
  return 2 * ((hi - lo).sum() - 4 * distance);
}

Vec2 CrossSection::curvePoint(double distance, double fraction) const {
  if (round) {
    const double angle = 2 * pi * fraction;
    return centre + (radius - distance) * Vec2(std::cos(angle), std::sin(angle));
  }

  // Along the rectangle, counter-clockwise from its lower left corner.
  const Vec2 low = lo.array() + distance, side = (hi - lo).array() - 2 * distance;
  double s = fraction * curveLength(distance);
  if (s < side.x()) return low + Vec2(s, 0);
  s -= side.x();
  if (s < side.y()) return low + Vec2(side.x(), s);
  s -= side.y();
  if (s < side.x()) return low + Vec2(side.x() - s, side.y());
  return low + Vec2(0, std::max(0.0, side.y() - (s - side.x())));
}

double CrossSection::distance(const Vec2& p) const {
  if (round) return radius - (p - centre).norm();
  return std::min((p - lo).minCoeff(), (hi - p).minCoeff());
}

Vec2 CrossSection::outward(const Vec2& p) const {
  if (round) {
    const Vec2 arm = p - centre;
    const double length = arm.norm();
    return length > 1e-12 * radius ? Vec2(arm / length) : Vec2::Zero();
  }
  const std::array<double, 4> gaps = {p.x() - lo.x(), hi.x() - p.x(), p.y() - lo.y(), hi.y() - p.y()};
  const auto nearest = std::min_element(gaps.begin(), gaps.end()) - gaps.begin();
  const double sign = nearest % 2 == 0 ? -1 : 1;
  return nearest < 2 ? Vec2(sign, 0) : Vec2(0, sign);
}

}  // namespace granular
