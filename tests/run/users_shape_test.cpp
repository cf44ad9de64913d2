// A convex shape of a user's own, known to Bullet and to nobody here, poured like any other.
#include <gtest/gtest.h>
#include <omp.h>

#include "examples/extend/superellipsoid.h"
#include "granular/core/random.h"
#include "granular/shape/bullet_convex.h"
#include "granular/world/time_step.h"
#include "granular/world/world.h"

namespace granular {
namespace {

TEST(UsersShape, TwoHundredPourIntoABox) {
  omp_set_num_threads(1);
  MaterialTable materials;
  ContactParameters contact;
  contact.stiffness = 1000;
  contact.restitution = 0.5;
  materials.add("resin", contact);
  WorldOptions options;
  options.rule.rule = PointRule::patch;  // a longer step
  World world(options, materials);
  const int perSide = 5, layers = 8;
  const double pitch = 3.25e-3, half = 0.5 * pitch * perSide;
  world.walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  for (const double sign : {-1.0, 1.0}) {
    world.walls.push_back(makePlaneWall({sign * half, 0, 0}, {-sign, 0, 0}));
    world.walls.push_back(makePlaneWall({0, sign * half, 0}, {0, -sign, 0}));
  }

  // A loose lattice, turned at random and shrinking downwards: all of it meets within a few milliseconds.
  const auto shape =
      std::make_shared<BulletConvex>(std::make_shared<extend::Superellipsoid>(Vec3(1, 1.2, 1.5), 3.0), 1e-3);
  const std::int32_t index = world.addShape(shape);
  Random random(11);
  for (int k = 0; k < perSide * perSide * layers; ++k) {
    NewBody body;
    body.shapeIndex = index;
    body.density = 1200;
    const int row = k / perSide % perSide, layer = k / perSide / perSide;
    const Vec3 cell(k % perSide, row, layer);
    body.pose.x = pitch * (cell + Vec3(0.5, 0.5, 0.5)) - Vec3(half, half, 0);
    body.pose.q = random.rotation();
    body.velocity = Vec3(0.05 * random.normal(), 0.05 * random.normal(), -30 * body.pose.x.z());
    world.addBody(body);
  }
  ASSERT_EQ(world.bodies.size(), 200u);

  const double dt = 0.5 * boundBeforeRun({{shape.get(), 0, 1200}}, world.materials, world.options).bound;
  startHalfSteps(world, dt, 0, true);
  for (int n = 0; n < 3000; ++n) step(world, dt);

  // A body has been in contact for at least 500 steps, on average.
  EXPECT_GT(world.report.contactSteps, 500 * world.bodies.size());
  EXPECT_EQ(world.report.narrow.uncertified, 0u);
  EXPECT_LT(world.report.deepestOverlap, 0.08);
  EXPECT_TRUE(world.report.troubles.empty());
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Vec3& x = world.bodies.x(i);
    ASSERT_TRUE(x.allFinite() && world.bodies.orientation(i).coeffs().allFinite() && world.bodies.v(i).allFinite());
    EXPECT_GT(x.z(), 0);
    EXPECT_LT(x.head<2>().cwiseAbs().maxCoeff(), half);
  }
}

}  // namespace
}  // namespace granular
