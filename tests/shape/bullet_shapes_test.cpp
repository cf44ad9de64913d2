// Bullet's shapes answer with our support points, without margin, at every scale.
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

TEST(BulletShapes, SupportIsOursTimesTheScale) {
  Random random(71);
  std::vector<Vec3> points;
  for (int k = 0; k < 80; ++k) points.push_back(1e-3 * random.direction().cwiseProduct(Vec3(1, 2, 1)));
  const std::vector<std::shared_ptr<const Shape>> shapes{std::make_shared<Sphere>(1e-3),
                                                         std::make_shared<Ellipsoid>(Vec3(1e-3, 2e-3, 5e-4)),
                                                         std::make_shared<Cylinder>(1e-3, 3e-3),
                                                         std::make_shared<Cone>(1e-3, 3e-3),
                                                         std::make_shared<Cuboid>(Vec3(1e-3, 2e-3, 3e-3)),
                                                         std::make_shared<Polyhedron>(points)};
  for (double scale : {1e-3, 1.0, 1e3, 2e5}) {
    for (const auto& shape : shapes) {
      const auto bullet = shape->makeBulletShape(scale);
      const double size = scale * shape->boundingRadius();
      for (int again = 0; again < 2; ++again) {
        EXPECT_EQ(bullet->getMargin(), 0);
        for (int trial = 0; trial < 300; ++trial) {
          const Vec3 d = random.direction();
          const Vec3 ours = scale * shape->support(d);
          const btVector3 direction(d.x(), d.y(), d.z());
          for (const btVector3& p :
               {bullet->localGetSupportingVertexWithoutMargin(direction), bullet->localGetSupportingVertex(direction),
                bullet->localGetSupportVertexWithoutMarginNonVirtual(direction)}) {
            EXPECT_LT((Vec3(p.x(), p.y(), p.z()) - ours).norm(), 1e-14 * size) << shape->describe();
          }
        }
        bullet->setMargin(0);
      }
      btVector3 lo, hi;
      bullet->getAabb(btTransform::getIdentity(), lo, hi);
      const Aabb box = shape->bounds(Frame());
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(lo[k], scale * box.lo[k], 1e-13 * size) << shape->describe();
        EXPECT_NEAR(hi[k], scale * box.hi[k], 1e-13 * size) << shape->describe();
      }
      if (shape->kind() == ShapeKind::polyhedron) continue;  // Bullet takes the box around a hull for its inertia
      btVector3 inertia;
      bullet->calculateLocalInertia(1, inertia);
      for (int k = 0; k < 3; ++k) {
        const double exact = shape->massProperties().inertia[k] / shape->massProperties().volume * scale * scale;
        EXPECT_NEAR(inertia[k], exact, 1e-13 * exact) << shape->describe();
      }
    }
  }
}

}  // namespace
}  // namespace granular
