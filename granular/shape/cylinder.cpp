// V = pi R² H, I_z = V R²/2, I_x = V (R²/4 + H²/12). <r²>: R²/2 + H²/4 over the caps, R² + H²/12 over the side.
#include "granular/shape/cylinder.h"

#include <algorithm>

#include "granular/core/tolerances.h"
#include "granular/shape/revolution.h"
#include "granular/shape/slab_points.h"

namespace granular {

Cylinder::Cylinder(double radius, double height) : Shape(ShapeKind::cylinder), r(radius), half(height / 2) {
  requireLength("cylinder", "radius", radius);
  requireLength("cylinder", "height", height);
  const double r2 = r * r, h2 = height * height;
  const double caps = 2 * pi * r2, side = 2 * pi * r * height;
  MassProperties closed;
  closed.volume = pi * r2 * height;
  closed.area = caps + side;
  const double across = closed.volume * (r2 / 4 + h2 / 12);
  closed.inertia = Vec3(across, across, closed.volume * r2 / 2);
  closed.meanSquareRadius = (caps * (r2 / 2 + h2 / 4) + side * (r2 + h2 / 12)) / closed.area;
  const double reach = std::hypot(r, half);
  setMeasures(closed, reach, std::min(r, half), 2 * reach, Vec3::UnitZ());
}

void Cylinder::supportFeature(const Vec3& d, double slab, Feature& out) const {
  // a rim point at angle t from the azimuth of d lies R |d_xy| (1 - cos t) below the highest one
  const double floor = d.dot(support(d)) - slab - tolerance::onSurface * boundingRadius();
  const Vec2 azimuth = azimuthOf(d);
  const double upper = d.z() < 0 ? -half : half;
  SlabPoints found;
  for (const double z : {upper, -upper}) {
    for (int k = 0; k < faceSamples; ++k) {
      const Vec3 p = rimPoint(r, z, azimuth, k);
      const double height = d.dot(p);
      if (height >= floor) found.push(p, height, z == upper ? k : faceSamples + k);
      // the rim's highest point is too low: so are the others
      else if (k == 0)
        break;
    }
  }
  hullSeenAlong(d, found, out);
}

Vec3 Cylinder::supportFace(const Vec3& d, double minCosine, Feature& out) const {
  out.clear();
  const Vec2 azimuth = azimuthOf(d);
  if (std::abs(d.z()) >= minCosine) {
    // counter-clockwise from outside: about +z on the upper cap, about -z on the lower
    const bool up = d.z() > 0;
    for (int k = 0; k < faceSamples; ++k) {
      out.push(rimPoint(r, up ? half : -half, azimuth, up ? k : (faceSamples - k) % faceSamples));
    }
    return up ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ());
  }
  const Vec3 top = support(d);
  out.push(top);
  if (d.x() * d.x() + d.y() * d.y() >= minCosine * minCosine) out.push(Vec3(top.x(), top.y(), -top.z()));
  return d;
}

bool Cylinder::contains(const Vec3& p) const {
  const double slack = tolerance::onSurface * boundingRadius();
  return std::hypot(p.x(), p.y()) <= r + slack && std::abs(p.z()) <= half + slack;
}

TriangleMesh Cylinder::surface(int resolution) const {
  const std::array<Vec2, 4> profile{Vec2(0, -half), Vec2(r, -half), Vec2(r, half), Vec2(0, half)};
  return revolve(profile, resolution);
}

std::string Cylinder::describe() const {
  return "cylinder of radius " + describeLength(r) + ", height " + describeLength(2 * half);
}

Aabb Cylinder::bounds(const Frame& frame) const {
  Vec3 reach;
  for (int k = 0; k < 3; ++k) {
    reach[k] = half * std::abs(frame.R(k, 2)) + r * std::hypot(frame.R(k, 0), frame.R(k, 1));
  }
  Aabb box;
  box.lo = frame.x - reach;
  box.hi = frame.x + reach;
  return box;
}

}  // namespace granular
