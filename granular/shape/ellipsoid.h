// The ellipsoid, semi-axes along the body axes in any order (S table 5).
#pragma once

#include <array>

#include "granular/shape/shape.h"

namespace granular {

/// The point of an ellipsoid about the origin furthest along d: (a² dx, b² dy, c² dz) / |(a dx, b dy, c dz)|.
inline Vec3 ellipsoidSupport(const Vec3& semiAxes, const Vec3& d) {
  const Vec3 stretched = semiAxes.cwiseProduct(d);
  const double length = stretched.norm();
  return length > 0 ? Vec3(semiAxes.cwiseProduct(stretched) / length) : Vec3(semiAxes.x(), 0, 0);
}

class Ellipsoid final : public Shape {
 public:
  /// Semi-axes along x, y, z, m. Throws InputError unless each is finite and above 0.
  explicit Ellipsoid(const Vec3& semiAxes);
  const Vec3& semiAxes() const { return axes; }
  /// The longest over the shortest.
  double ratio() const { return longestOverShortest; }
  /// At the ends of the longest, of the curvature along the shortest, m: a ball of it rolls freely inside.
  double leastCurvatureRadius() const { return sharpest; }
  /// What batches load: the semi-axes, ratio, leastCurvatureRadius, boundingRadius and size.
  using Row = std::array<double, 7>;
  const Row& row() const { return numbers; }

  Vec3 support(const Vec3& d) const override { return ellipsoidSupport(axes, d); }
  void supportFeature(const Vec3& d, double slab, Feature& out) const override;
  Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const override;
  bool contains(const Vec3& p) const override;
  TriangleMesh surface(int resolution) const override;
  std::unique_ptr<btConvexShape> makeBulletShape(double scale) const override;
  std::string describe() const override;
  Aabb bounds(const Frame& frame) const override;

 private:
  Vec3 axes;
  double longestOverShortest, sharpest;
  Row numbers;
};

}  // namespace granular
