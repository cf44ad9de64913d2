// The circular cone, apex on +z (S table 5). The origin is its centre of mass, a quarter of the height above the base.
#pragma once

#include "granular/shape/shape.h"

namespace granular {

/// The point of a cone furthest along d: the apex where it is the further, else the rim; on a tie the apex.
inline Vec3 coneSupport(double radius, double height, const Vec3& d) {
  const double across = std::sqrt(d.x() * d.x() + d.y() * d.y());
  if (height * d.z() >= radius * across && d.z() > 0) return {0, 0, 0.75 * height};
  if (!(across > 0)) return {radius, 0, -0.25 * height};
  return {radius * (d.x() / across), radius * (d.y() / across), -0.25 * height};
}

class Cone final : public Shape {
 public:
  /// Base radius and height, m. Throws InputError unless both are finite and above 0.
  Cone(double radius, double height);
  double radius() const { return r; }
  double height() const { return h; }
  double apexZ() const { return 0.75 * h; }
  double baseZ() const { return -0.25 * h; }

  Vec3 support(const Vec3& d) const override { return coneSupport(r, h, d); }
  /// Of the apex and faceSamples rim points from the azimuth of d on, those within the slab, as a polygon seen along d.
  void supportFeature(const Vec3& d, double slab, Feature& out) const override;
  Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const override;
  bool supportDisk(const Vec3& d, double minCosine, Disk& out) const override {
    out = {Vec3(0, 0, baseZ()), -Vec3::UnitZ(), r};
    return -d.z() >= minCosine;
  }
  bool contains(const Vec3& p) const override;
  TriangleMesh surface(int resolution) const override;
  std::unique_ptr<btConvexShape> makeBulletShape(double scale) const override;
  std::string describe() const override;
  Aabb bounds(const Frame& frame) const override;

 private:
  double r;
  double h;
};

}  // namespace granular
