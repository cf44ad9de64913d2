// V = pi R² H/3, I_z = 3/10 V R², I_x = V (3/20 R² + 3/80 H²). <r²> is R²/2 + H²/16 over the base, and the same over
// the side.
#include "granular/shape/cone.h"

#include <algorithm>

#include "granular/core/tolerances.h"
#include "granular/shape/revolution.h"
#include "granular/shape/slab_points.h"

namespace granular {

Cone::Cone(double radius, double height) : Shape(ShapeKind::cone), r(radius), h(height) {
  requireLength("cone", "radius", radius);
  requireLength("cone", "height", height);
  const double slant = std::hypot(r, h);
  MassProperties closed;
  closed.volume = pi * r * r * h / 3;
  closed.area = pi * r * (r + slant);
  const double across = closed.volume * (0.15 * r * r + 0.0375 * h * h);
  closed.inertia = Vec3(across, across, 0.3 * closed.volume * r * r);
  closed.meanSquareRadius = r * r / 2 + h * h / 16;
  // the side's plane is 3 R H / (4 slant) away; the longest chord joins two rim points or the rim and the apex
  const double bounding = std::max(0.75 * h, std::hypot(r, 0.25 * h));
  setMeasures(closed, bounding, std::min(0.25 * h, 0.75 * r * h / slant), std::max(2 * r, slant), Vec3::UnitZ());
}

void Cone::supportFeature(const Vec3& d, double slab, Feature& out) const {
  const double floor = d.dot(support(d)) - slab - tolerance::onSurface * boundingRadius();
  const Vec2 azimuth = azimuthOf(d);
  SlabPoints found;
  const Vec3 apex(0, 0, apexZ());
  if (d.dot(apex) >= floor) found.push(apex, d.dot(apex), faceSamples);
  for (int k = 0; k < faceSamples; ++k) {
    const Vec3 p = rimPoint(r, baseZ(), azimuth, k);
    const double height = d.dot(p);
    if (height >= floor) found.push(p, height, k);
  }
  hullSeenAlong(d, found, out);
}

Vec3 Cone::supportFace(const Vec3& d, double minCosine, Feature& out) const {
  out.clear();
  const Vec2 azimuth = azimuthOf(d);
  if (-d.z() >= minCosine) {
    for (int k = 0; k < faceSamples; ++k) {
      out.push(rimPoint(r, baseZ(), azimuth, (faceSamples - k) % faceSamples));
    }
    return -Vec3::UnitZ();
  }
  // the normal of the side at the azimuth of d is (H, R)/slant in the plane of d and the axis
  const double cosine = (h * std::hypot(d.x(), d.y()) + r * d.z()) / std::hypot(r, h);
  if (cosine >= minCosine) {
    out.push(Vec3(0, 0, apexZ()));
    out.push(rimPoint(r, baseZ(), azimuth, 0));
    return d;
  }
  out.push(support(d));
  return d;
}

bool Cone::contains(const Vec3& p) const {
  const double slack = tolerance::onSurface * boundingRadius();
  const double slant = std::hypot(r, h);
  // below the side's plane through p's azimuth, above the base
  return p.z() >= baseZ() - slack && (h * std::hypot(p.x(), p.y()) + r * (p.z() - apexZ())) / slant <= slack;
}

TriangleMesh Cone::surface(int resolution) const {
  const std::array<Vec2, 3> profile{Vec2(0, baseZ()), Vec2(r, baseZ()), Vec2(0, apexZ())};
  return revolve(profile, resolution);
}

std::string Cone::describe() const {
  return "cone of base radius " + describeLength(r) + ", height " + describeLength(h);
}

Aabb Cone::bounds(const Frame& frame) const {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    const double slope = frame.R(k, 2);
    const double rim = r * std::hypot(frame.R(k, 0), frame.R(k, 1));
    const double apex = slope * apexZ(), base = slope * baseZ();
    box.hi[k] = frame.x[k] + std::max(apex, base + rim);
    box.lo[k] = frame.x[k] + std::min(apex, base - rim);
  }
  return box;
}

}  // namespace granular
