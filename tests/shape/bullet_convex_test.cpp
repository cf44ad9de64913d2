// Bullet's own shapes and a user's subclass, known by support alone, against the shapes known in closed form.
#include "granular/shape/bullet_convex.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "examples/extend/superellipsoid.h"
#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/shape_table.h"

namespace granular {
namespace {

/// What a user might write, about an odd centre, odd margin left alone.
class Superellipsoid : public extend::Superellipsoid {
 public:
  Superellipsoid(const Vec3& semiAxes, double exponent, const Vec3& centre)
      : extend::Superellipsoid(semiAxes, exponent), middle(centre.x(), centre.y(), centre.z()) {}
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& d) const override {
    return extend::Superellipsoid::localGetSupportingVertexWithoutMargin(d) + middle;
  }

 private:
  btVector3 middle;
};

void expectSameMeasures(const BulletConvex& found, const Shape& exact, double tolerance) {
  const MassProperties &p = found.massProperties(), &q = exact.massProperties();
  EXPECT_NEAR(p.volume / q.volume, 1, tolerance) << exact.describe();
  EXPECT_NEAR(p.area / q.area, 1, tolerance) << exact.describe();
  EXPECT_NEAR(p.meanSquareRadius / q.meanSquareRadius, 1, tolerance) << exact.describe();
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(p.inertia[k] / q.inertia[k], 1, tolerance) << exact.describe();
}

TEST(BulletConvex, FlatFacedBodiesAreMeasuredToRounding) {
  const Cuboid cuboid(Vec3(1e-3, 2e-3, 3e-3));
  for (double scale : {1.0, 1e3}) {
    const BulletConvex found(std::shared_ptr<const btConvexShape>(cuboid.makeBulletShape(scale)), 1 / scale);
    expectSameMeasures(found, cuboid, 1e-12);
    EXPECT_LT(found.massError(), 1e-12);
    EXPECT_NEAR(found.boundingRadius(), cuboid.boundingRadius(), 1e-16);
    EXPECT_NEAR(found.longestExtent(), cuboid.longestExtent(), 1e-16);
    EXPECT_NEAR(found.innerRadius(), cuboid.innerRadius(), 1e-16);
  }
}

TEST(BulletConvex, RoundBodiesAreMeasuredWithinTheErrorStated) {
  const std::vector<std::shared_ptr<const Shape>> shapes{
      std::make_shared<Ellipsoid>(Vec3(1e-3, 1e-3, 1e-3)), std::make_shared<Ellipsoid>(Vec3(1e-3, 1.5e-3, 3e-3)),
      std::make_shared<Cylinder>(1e-3, 2.5e-3), std::make_shared<Cone>(1e-3, 3e-3)};
  for (const auto& shape : shapes) {
    const BulletConvex found(std::shared_ptr<const btConvexShape>(shape->makeBulletShape(1000)), 1e-3);
    EXPECT_LT(found.massError(), 5e-3);
    expectSameMeasures(found, *shape, 2 * found.massError());
    EXPECT_NEAR(found.boundingRadius(), shape->boundingRadius(), 1e-3 * shape->boundingRadius());
    EXPECT_NEAR(found.longestExtent(), shape->longestExtent(), 1e-3 * shape->longestExtent());
    EXPECT_NEAR(found.innerRadius(), shape->innerRadius(), 1e-2 * shape->innerRadius());
    EXPECT_LE(found.innerRadius(), shape->innerRadius() * (1 + 1e-3));
  }
}

TEST(BulletConvex, AUsersShapeMovesToItsCentreAndPrincipalAxes) {
  // exponent 2 is an ellipsoid, off centre: known in closed form
  const auto user = std::make_shared<Superellipsoid>(Vec3(1, 2, 3), 2.0, Vec3(4, -5, 6));
  Frame frame;
  const BulletConvex found(user, 1e-3, &frame);
  expectSameMeasures(found, Ellipsoid(Vec3(1e-3, 2e-3, 3e-3)), 5e-3);
  EXPECT_LT((frame.x - Vec3(4e-3, -5e-3, 6e-3)).norm(), 1e-5);
  EXPECT_LT((frame.R - Mat3::Identity()).norm(), 1e-2);
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 d = random.direction();
    const btVector3 p = user->localGetSupportingVertexWithoutMargin(btVector3(d.x(), d.y(), d.z()));
    EXPECT_LT((frame.toWorld(found.support(frame.unrotate(d))) - 1e-3 * Vec3(p.x(), p.y(), p.z())).norm(), 1e-16);
    EXPECT_LE(found.support(d).norm(), found.boundingRadius());
  }
}

TEST(BulletConvex, ASuperellipsoidHasTheVolumeOfItsClosedForm) {
  // V = 8 abc Gamma(1 + 1/p)³ / Gamma(1 + 3/p)
  for (double power : {1.5, 3.0, 6.0}) {
    const auto user = std::make_shared<Superellipsoid>(Vec3(1, 1.2, 1.5), power, Vec3::Zero());
    const BulletConvex found(user, 1e-3);
    const double volume = 8 * 1.8e-9 * std::pow(std::tgamma(1 + 1 / power), 3) / std::tgamma(1 + 3 / power);
    EXPECT_NEAR(found.massProperties().volume / volume, 1, std::max(2 * found.massError(), 1e-3)) << power;
  }
}

TEST(BulletConvex, ContainmentIsThatOfTheBodyWrapped) {
  Random random(7);
  const std::vector<std::shared_ptr<const Shape>> shapes{std::make_shared<Ellipsoid>(Vec3(1e-3, 1.5e-3, 3e-3)),
                                                         std::make_shared<Cylinder>(1e-3, 3e-3),
                                                         std::make_shared<Cuboid>(Vec3(1e-3, 2e-3, 3e-3))};
  for (const auto& shape : shapes) {
    Frame frame;
    const BulletConvex found(std::shared_ptr<const btConvexShape>(shape->makeBulletShape(1000)), 1e-3, &frame);
    const Aabb box = shape->bounds(Frame());
    for (int trial = 0; trial < 2000; ++trial) {
      Vec3 p;
      for (int k = 0; k < 3; ++k) p[k] = random.uniform(box.lo[k], box.hi[k]);
      if (trial % 2) p = shape->support(random.direction()) * (1 + 1e-6 * (trial % 4 - 2));
      EXPECT_EQ(found.contains(frame.toBody(p)), shape->contains(p)) << shape->describe() << " " << p.transpose();
    }
  }
}

TEST(BulletConvex, FlatFacesEdgesAndCapsAreFoundByAsking) {
  Frame frame;
  const Cuboid cuboid(Vec3(1e-3, 2e-3, 3e-3));
  const BulletConvex box(std::shared_ptr<const btConvexShape>(cuboid.makeBulletShape(1000)), 1e-3, &frame);
  Feature feature;
  EXPECT_LT((box.supportFace(Vec3(.05, .02, 1).normalized(), .99, feature) - Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_EQ(feature.count, 4);
  box.supportFace(Vec3(1, 1e-3, 1).normalized(), .9999, feature);
  EXPECT_EQ(feature.count, 2);
  box.supportFace(Vec3(1, 1, 1).normalized(), .9999, feature);
  EXPECT_EQ(feature.count, 1);
  box.supportFeature(Vec3::UnitZ(), 1e-6, feature);
  EXPECT_EQ(feature.count, 4);
  box.supportFeature(Vec3(1, 0, 1).normalized(), 1e-6, feature);
  EXPECT_EQ(feature.count, 2);

  const Cylinder cylinder(1e-3, 2e-3);
  const BulletConvex drum(std::shared_ptr<const btConvexShape>(cylinder.makeBulletShape(1000)), 1e-3);
  const Vec3 cap = drum.supportFace(Vec3(.01, .02, 1).normalized(), .99, feature);
  EXPECT_NEAR(cap.z(), 1, 1e-9);
  EXPECT_GT(feature.count, 16);
  const Ellipsoid ellipsoid(Vec3(1e-3, 2e-3, 3e-3));
  const BulletConvex egg(std::shared_ptr<const btConvexShape>(ellipsoid.makeBulletShape(1000)), 1e-3);
  egg.supportFace(Vec3::UnitZ(), .99, feature);
  EXPECT_EQ(feature.count, 1);
}

TEST(BulletConvex, ScaledCopiesAndTheirBulletShapesAgree) {
  const auto user = std::make_shared<Superellipsoid>(Vec3(1, 2, 3), 3.0, Vec3(1, 0, 0));
  const BulletConvex found(user, 1e-3);
  const auto doubled = scaledShape(found, 2);
  const auto bullet = found.makeBulletShape(2000);
  EXPECT_EQ(bullet->getMargin(), 0);
  Random random(9);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 d = random.direction();
    const Vec3 p = found.support(d);
    EXPECT_LT((doubled->support(d) - 2 * p).norm(), 1e-16);
    const btVector3 q = bullet->localGetSupportingVertex(btVector3(d.x(), d.y(), d.z()));
    EXPECT_LT((Vec3(q.x(), q.y(), q.z()) - 2000 * p).norm(), 1e-12);
  }
  EXPECT_NEAR(doubled->massProperties().volume, 8 * found.massProperties().volume, 1e-20);
}

TEST(BulletConvex, UselessShapesAreRefused) {
  EXPECT_THROW(BulletConvex(nullptr), InputError);
  EXPECT_THROW(BulletConvex(std::make_shared<btSphereShape>(1)), InputError);
  EXPECT_THROW(BulletConvex(std::make_shared<btBoxShape>(btVector3(1, 1, 1)), 0), InputError);
  auto flat = std::make_shared<btConvexHullShape>();
  for (int k = 0; k < 4; ++k) flat->addPoint(btVector3(k & 1, k >> 1, 0));
  EXPECT_THROW(BulletConvex{flat}, InputError);
}

}  // namespace
}  // namespace granular
