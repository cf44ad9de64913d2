// The sphere. Its support is the radius along d; everything is closed form.
#pragma once

#include "granular/shape/shape.h"

namespace granular {

/// The point of a sphere about the origin furthest along d; for d = 0 any point of it.
inline Vec3 sphereSupport(double radius, const Vec3& d) {
  const double length = d.norm();
  return length > 0 ? Vec3(radius / length * d) : Vec3(radius, 0, 0);
}

class Sphere final : public Shape {
 public:
  /// Radius, m. Throws InputError unless it is finite and above 0.
  explicit Sphere(double radius);
  double radius() const { return r; }

  Vec3 support(const Vec3& d) const override { return sphereSupport(r, d); }
  void supportFeature(const Vec3& d, double slab, Feature& out) const override;
  Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const override;
  bool contains(const Vec3& p) const override;
  TriangleMesh surface(int resolution) const override;
  std::unique_ptr<btConvexShape> makeBulletShape(double scale) const override;
  std::string describe() const override;
  Aabb bounds(const Frame& frame) const override;

 private:
  double r;
};

}  // namespace granular
