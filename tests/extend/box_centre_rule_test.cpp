// The rule of examples/extend/box_centre_rule.h: where it puts contacts that are known, and that it creates no
// momentum.
#include "examples/extend/box_centre_rule.h"

#include <gtest/gtest.h>

#include "extend/scene_of_own.h"
#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/narrow/narrow.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/world/world.h"

namespace granular {
namespace {

const PointRule boxCentre = extend::addBoxCentreRule();

Frame placeAt(const Vec3& x, const Quat& q = Quat::Identity()) { return Frame(q.toRotationMatrix(), x); }

/// The contact point of two shapes that touch.
Vec3 pointOf(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB) {
  WarmCache cache;
  NarrowCounts counts;
  Touch touch;
  EXPECT_TRUE(findTouch(a, frameA, b, frameB, true, cache, counts, touch));
  ContactPatch patch;
  placeContact({boxCentre}, a, frameA, b, frameB, touch, patch);
  EXPECT_EQ(patch.depth, touch.overlap);
  return patch.point;
}

TEST(BoxCentreRule, PutsTheContactOfTwoCubesInTheMiddleOfTheFaceThatTheyShare) {
  const Cuboid cube(Vec3(1, 1, 1));
  // Side by side along z by 1.9, shifted by .5 and -.8: they share x in [-.5, 1], y in [-1, .2], z in [.9, 1].
  EXPECT_LT((pointOf(cube, placeAt({0, 0, 0}), cube, placeAt({.5, -.8, 1.9})) - Vec3(.25, -.4, .95)).norm(), 1e-12);
}

TEST(BoxCentreRule, PutsTheContactOfTwoSpheresOnTheLineOfCentres) {
  const Sphere small(0.7), large(1.1);
  const Vec3 line = Vec3(1, -2, 0.5).normalized();
  const Vec3 expected = 0.5 * (0.7 + (1.75 - 1.1)) * line;
  EXPECT_LT((pointOf(small, placeAt({0, 0, 0}), large, placeAt(1.75 * line)) - expected).norm(), 1e-12);
}

TEST(BoxCentreRule, PutsItThereWhicheverBodyIsCalledA) {
  const Cuboid box(Vec3(1, 0.7, 1.4));
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const Frame first = placeAt({0, 0, 0}, random.rotation()),
                second = placeAt(1.2 * random.direction(), random.rotation());
    const Vec3 point = pointOf(box, first, box, second);
    EXPECT_LT((pointOf(box, second, box, first) - point).norm(), 1e-9) << k;
    // Inside both bodies' bounding spheres.
    EXPECT_LT(point.norm(), box.boundingRadius());
    EXPECT_LT((point - second.x).norm(), box.boundingRadius());
  }
}

TEST(BoxCentreRule, CreatesNeitherMomentumNorAngularMomentum) {
  WorldOptions options;
  options.rule.rule = boxCentre;
  options.gravity.setZero();
  MaterialTable materials;
  ContactParameters contact;
  contact.stiffness = 1e3;
  materials.add("stone", contact);
  World world(options, materials);
  const std::int32_t box = world.addShape(std::make_shared<Cuboid>(Vec3(1e-3, 1.3e-3, 0.8e-3)));
  const std::int32_t ball = world.addShape(std::make_shared<Sphere>(1e-3));
  Random random(8);
  for (int k = 0; k < 27; ++k) {
    NewBody body;
    body.shapeIndex = k % 3 ? box : ball;
    const int column = k % 3, row = k / 3 % 3, layer = k / 9;
    body.pose.x = 3.5e-3 * Vec3(column - 1, row - 1, layer - 1);
    body.pose.q = random.rotation();
    body.velocity = -50 * body.pose.x;
    world.addBody(body);
  }
  // Forces and torques about the origin of each step, against the largest of a single body.
  const double dt = 2e-6;
  startHalfSteps(world, dt, 0, false);
  std::uint64_t contacts = 0;
  for (int n = 0; n < 10000; ++n) {
    step(world, dt);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    double largest = 0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      force += world.bodies.force[i];
      torque += world.bodies.torque[i] + world.bodies.x(i).cross(world.bodies.force[i]);
      largest = std::max(largest, world.bodies.force[i].norm());
    }
    contacts += world.contactCount();
    ASSERT_LE(force.norm(), 1e-13 * largest) << n;
    ASSERT_LE(torque.norm(), 1e-13 * largest * 1e-2) << n;
  }
  EXPECT_GT(contacts, 1000u);
  EXPECT_TRUE(world.report.troubles.empty());
}

TEST(BoxCentreRule, CanBeChosenInASceneAndLeavesWallsToARuleOfTheLibrary) {
  const PackingRun run = runWithModel("point_rule = \"box_centre\"");
  EXPECT_EQ(run.world().options.rule.rule, boxCentre);
  EXPECT_EQ(ruleAtWalls(run.world().options.rule).rule, PointRule::pressureCentroid);
}

TEST(RulesTable, RefusesARowThatCannotServe) {
  EXPECT_THROW(addPointRule({"patch", extend::placeBoxCentre}), InputError);
  EXPECT_THROW(addPointRule({"box_centre", extend::placeBoxCentre}), InputError);
  EXPECT_THROW(addPointRule({"nowhere", nullptr}), InputError);
  EXPECT_THROW(addPointRule({"walls_as_well", extend::placeBoxCentre, boxCentre}), InputError);
}

}  // namespace
}  // namespace granular
