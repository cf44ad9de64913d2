// The circular cylinder about z (S table 5), flat caps at z = -h and h.
#pragma once

#include "granular/shape/shape.h"

namespace granular {

/// The point of a cylinder about z furthest along d; on a tie the upper cap, the azimuth of x.
inline Vec3 cylinderSupport(double radius, double halfHeight, const Vec3& d) {
  const double across = std::sqrt(d.x() * d.x() + d.y() * d.y());
  const double z = d.z() < 0 ? -halfHeight : halfHeight;
  if (!(across > 0)) return {radius, 0, z};
  return {radius * (d.x() / across), radius * (d.y() / across), z};
}

class Cylinder final : public Shape {
 public:
  /// Radius and full height, m. Throws InputError unless both are finite and above 0.
  Cylinder(double radius, double height);
  double radius() const { return r; }
  double halfHeight() const { return half; }
  double height() const { return 2 * half; }

  Vec3 support(const Vec3& d) const override { return cylinderSupport(r, half, d); }
  /// Of the two rims, faceSamples points each from the azimuth of d on, those within the slab, as a polygon seen along
  /// d: a whole cap, a segment of it, a generator, or a point.
  void supportFeature(const Vec3& d, double slab, Feature& out) const override;
  Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const override;
  bool supportDisk(const Vec3& d, double minCosine, Disk& out) const override {
    const Vec3 up(0, 0, d.z() > 0 ? 1 : -1);
    out = {half * up, up, r};
    return std::abs(d.z()) >= minCosine;
  }
  bool contains(const Vec3& p) const override;
  TriangleMesh surface(int resolution) const override;
  std::unique_ptr<btConvexShape> makeBulletShape(double scale) const override;
  std::string describe() const override;
  Aabb bounds(const Frame& frame) const override;

 private:
  double r;
  double half;
};

}  // namespace granular
