// A shape of one's own: a support function in Bullet's interface, and nothing else. BulletConvex
// (shape/bullet_convex.h) makes a body of it, which finds volume, inertia, flat faces and contacts by asking that
// function.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>

#include <cmath>

#include "granular/core/math.h"

namespace extend {

using namespace granular;

/// The superellipsoid |x/a|^p + |y/b|^p + |z/c|^p = 1, by its support function alone.
class Superellipsoid : public btConvexInternalShape {
 public:
  Superellipsoid(const Vec3& semiAxes, double exponent) : axes(semiAxes), power(exponent) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
  }
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& d) const override {
    const double dual = power / (power - 1);
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += std::pow(std::abs(axes[k] * d[k]), dual);
    const double size = std::pow(sum, 1 / power);
    btVector3 p(0, 0, 0);
    for (int k = 0; k < 3; ++k) {
      p[k] = std::copysign(axes[k] * std::pow(std::abs(axes[k] * d[k]), dual - 1) / size, d[k]);
    }
    return p;
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* d, btVector3* p, int n) const override {
    for (int k = 0; k < n; ++k) p[k] = localGetSupportingVertexWithoutMargin(d[k]);
  }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
  const char* getName() const override { return "superellipsoid"; }

 private:
  Vec3 axes;
  double power;
};

}  // namespace extend
