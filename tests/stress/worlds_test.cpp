// Small worlds at the ends of every range: sizes, masses, spins, speeds, overlaps, stiffness and friction. What a run
// cannot hold it must name; nothing may become other than finite in silence.
#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/world/time_step.h"
#include "verification/scenes.h"

namespace granular {
namespace {

std::shared_ptr<const Shape> shapeOf(const char* name, double a, double b, double c, double scale) {
  std::vector<double> lengths{a * scale, b * scale};
  if (c > 0) lengths.push_back(c * scale);
  return makeShape(name, lengths);
}

bool isFinite(const World& world) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (!world.bodies.x(i).allFinite() || !world.bodies.v(i).allFinite() || !world.bodies.w(i).allFinite() ||
        !world.bodies.orientation(i).coeffs().allFinite())
      return false;
  }
  return true;
}

std::uint64_t countOf(const World& world, Trouble::Kind kind) {
  return world.report.troubleCounts[static_cast<std::size_t>(kind)];
}

std::unique_ptr<World> makeTwo(const WorldOptions& options, const ContactParameters& contact,
                               const std::shared_ptr<const Shape>& a, const std::shared_ptr<const Shape>& b,
                               const Vec3& apart) {
  auto world = makeWorld(options, contact);
  place(*world, a, Vec3::Zero(), rotationFromVector(Vec3(.3, .2, .1)));
  place(*world, b, apart, rotationFromVector(Vec3(-.2, .5, .4)));
  return world;
}

/// Two bodies of the scale in m meet head on, with all times the same at every scale. Velocities after, per scale.
std::vector<Vec3> meetAtScale(const char* nameA, const char* nameB, double scale) {
  const auto a = shapeOf(nameA, 1, .8, std::string(nameA) == "cylinder" ? 0 : .6, scale);
  const auto b = shapeOf(nameB, .7, .9, std::string(nameB) == "cylinder" ? 0 : 1, scale);
  const double rate = 1e3, mass = 2500 * a->massProperties().volume;
  auto world = makeTwo(plainOptions(), {mass * rate * rate, .8, .6, .3}, a, b, scale * Vec3(3, .2, -.1));
  move(*world, 0, scale * Vec3(2, 0, 0), Vec3(.5, 1, -1));
  move(*world, 1, scale * Vec3(-2, 0, 0), Vec3(-1, 0, .3));
  EXPECT_TRUE(runThroughContact(*world, 2e-5, 200000));
  return {velocityOf(*world, 0) / scale, spinOf(*world, 0), velocityOf(*world, 1) / scale, spinOf(*world, 1)};
}

TEST(Sizes, AnEncounterIsTheSameFromMicrometresToKilometres) {
  const char* pairs[][2] = {{"cuboid", "cuboid"}, {"ellipsoid", "cylinder"}, {"cuboid", "ellipsoid"}};
  for (const auto& [a, b] : pairs) {
    const std::vector<Vec3> reference = meetAtScale(a, b, 1);
    EXPECT_GT((reference[0] - Vec3(2, 0, 0)).norm(), .1);
    for (const double scale : {1e-6, 1e-3, 1e3}) {
      const std::vector<Vec3> found = meetAtScale(a, b, scale);
      for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((found[k] - reference[k]).norm(), 1e-8) << a << b << scale << k;
    }
  }
}

TEST(Sizes, AHundredfoldLargerBodyThrowsTheSmallOneBackAndKeepsTheMomentum) {
  for (const bool round : {true, false}) {
    const auto small = round ? sphereOf(1e-3) : cuboidOf(Vec3::Constant(1e-3));
    const auto large = round ? sphereOf(.1) : cuboidOf(Vec3::Constant(.1));
    const double mass = 2500 * small->massProperties().volume, speed = .1, depth = 1e-4;
    const double stiffness = mass * std::pow(speed / (depth * 1e-3), 2);
    auto world = makeWorld(plainOptions(), {stiffness, .7, .7, 0});
    place(*world, large, Vec3(0, 0, -.1));
    place(*world, small, Vec3(0, 0, 1e-3 * (1 + 1e-6)));
    move(*world, 1, Vec3(0, 0, -speed));
    ASSERT_TRUE(runThroughContact(*world, pi * std::sqrt(mass / stiffness) / 2000, 20000));
    const double ratio = 1e6;
    const double relative = velocityOf(*world, 1).z() - velocityOf(*world, 0).z();
    EXPECT_NEAR(relative / speed, .7, 2e-3);
    EXPECT_NEAR((velocityOf(*world, 1).z() + ratio * velocityOf(*world, 0).z()) / speed, -1, 1e-9);
  }
}

TEST(Masses, AMillionfoldLoadRestsOnALightCube) {
  // From static equilibrium under the rule `patch`; the step is half the bound of the light cube.
  WorldOptions options = plainOptions();
  options.gravity = {0, 0, -9.81};
  const double half = .5e-3, light = 2500 * std::pow(2 * half, 3), load = 1e6 * light * 9.81, overlap = 1e-2 * half;
  const double stiffness = load / overlap, below = (load + light * 9.81) / stiffness;
  auto world = makeWorld(options, {stiffness, .5, .5, .5});
  addFloor(*world);
  place(*world, cuboidOf(Vec3::Constant(half)), Vec3(0, 0, half - below));
  place(*world, cuboidOf(Vec3::Constant(half)), Vec3(0, 0, 3 * half - below - overlap), Quat::Identity(), 2.5e9);
  startHalfSteps(*world, 1e-12, 0, true);
  const double dt = .5 * boundOfContacts(*world).bound;
  startHalfSteps(*world, dt, 0, true);
  for (int n = 0; n < 20000; ++n) step(*world, dt);
  EXPECT_NEAR(world->bodies.x(1).z(), 3 * half - below - overlap, 1e-4 * overlap);
  EXPECT_LT((world->bodies.orientation(1).vec()).norm() + world->bodies.orientation(0).vec().norm(), 1e-6);
  EXPECT_EQ(world->report.narrow.uncertified, 0u);
}

TEST(Spins, ThatASchemeCannotHoldAreNamed) {
  for (const SchemeKind scheme : {SchemeKind::seelen, SchemeKind::spiral}) {
    for (const double turn : {.01, .1, .3, 1.0}) {
      WorldOptions options = plainOptions();
      options.integrator = scheme;
      const double dt = 1e-4;
      const auto shape = cuboidOf({1e-3, 2e-3, 3e-3});
      options.maxSpeed = 3 * turn / dt * shape->boundingRadius();
      auto world = makeWorld(options, ContactParameters{});
      place(*world, shape, Vec3::Zero());
      move(*world, 0, Vec3::Zero(), turn / dt * Vec3(.3, .9, .3).normalized());
      const double before = kineticEnergy(world->bodies);
      startHalfSteps(*world, dt, 0, true);
      for (int n = 0; n < 3000; ++n) step(*world, dt);
      const double growth = kineticEnergy(world->bodies) / before;
      const bool named = countOf(*world, Trouble::Kind::tooFast) + countOf(*world, Trouble::Kind::nonFinite) > 0;
      EXPECT_TRUE(named || (growth > 0 && growth < 9)) << turn << " " << growth;
      if (turn <= .01) {
        EXPECT_NEAR(growth, 1, 1e-4);
      }
      if (isFinite(*world) && !named) {
        EXPECT_NEAR(world->bodies.orientation(0).norm(), 1, 1e-12);
      }
    }
  }
}

TEST(Speeds, AHundredTimesWhatTheStiffnessAllowsAreNamedWithBothBodies) {
  const auto cube = cuboidOf(Vec3::Constant(1e-3));
  const auto egg = shapeOf("ellipsoid", 1, .7, .5, 1e-3), can = shapeOf("cylinder", 1, 2, 0, 1e-3);
  const std::shared_ptr<const Shape> pairs[][2] = {{sphereOf(1e-3), sphereOf(1e-3)}, {cube, cube}, {egg, can}};
  for (const auto& [a, b] : pairs) {
    WorldOptions options = plainOptions();
    options.deepOverlap = .08;
    const double mass = 2500 * a->massProperties().volume, stiffness = 1e4;
    const double rate = std::sqrt(2 * stiffness / mass), speed = 100 * .08 * a->size() * rate;
    auto world = makeTwo(options, {stiffness, .8, .6, .1}, a, b, Vec3(4e-3, 1e-4, 0));
    move(*world, 0, Vec3(speed / 2, 0, 0));
    move(*world, 1, Vec3(-speed / 2, 0, 0));
    runFor(*world, pi / rate / 50, 8e-3 / speed);
    EXPECT_TRUE(isFinite(*world));
    ASSERT_GT(countOf(*world, Trouble::Kind::deepOverlap), 0u) << a->describe();
    EXPECT_EQ(world->report.troubles[0].bodyA + world->report.troubles[0].bodyB, 1);
    EXPECT_GT(world->report.troubles[0].value, .08);
    EXPECT_EQ(world->report.narrow.uncertified, 0u);
  }
}

TEST(Overlaps, OfTheStartAreNamedAndReleaseNoMoreThanTheyHold) {
  const auto cube = cuboidOf(Vec3::Constant(1e-3));
  const auto egg = shapeOf("ellipsoid", 1, .7, .5, 1e-3), can = shapeOf("cylinder", 1, 2, 0, 1e-3);
  const std::shared_ptr<const Shape> pairs[][2] = {
      {sphereOf(1e-3), sphereOf(1e-3)}, {cube, cube}, {egg, can}, {can, can}};
  for (const auto& [a, b] : pairs) {
    for (const double distance : {0.0, 1e-12, 1e-4, 1e-3}) {
      WorldOptions options = plainOptions();
      options.deepOverlap = .08;
      const double stiffness = 1e4;
      auto world = makeTwo(options, {stiffness, .8, .6, .1}, a, b, distance * Vec3(1, .2, .1).normalized());
      const double dt = 2e-7;
      double held = 0, most = 0;
      startHalfSteps(*world, dt, 0, true);
      for (int n = 0; n < 300; ++n) {
        step(*world, dt);
        if (n == 0) world->visitContacts([&](const Contact& c) { held += .5 * stiffness * c.patch.squaredDepth; });
        most = std::max(most, kineticEnergy(world->bodies));
      }
      EXPECT_TRUE(isFinite(*world));
      EXPECT_GT(countOf(*world, Trouble::Kind::deepOverlap), 0u);
      EXPECT_LT(most, 1.02 * held) << a->describe() << " and " << b->describe() << " " << distance;
    }
  }
}

TEST(Stiffness, FromAMillionthToTenToTheTwelveKeepsTheRestitutionAndZeroIsRefused) {
  EXPECT_THROW(prepareLaw({0, .8, .6, .1}), InputError);
  for (const double stiffness : {1e-6, 1.0, 1e4, 1e12}) {
    const auto cube = cuboidOf(Vec3::Constant(1e-3));
    const double mass = 2500 * cube->massProperties().volume, rate = std::sqrt(stiffness / mass);
    auto world = makeWorld(plainOptions(), {stiffness, .8, .6, .1});
    addFloor(*world);
    place(*world, cube, Vec3(0, 0, 1e-3 * (1 + 1e-9)));
    const double speed = 1e-6 * rate;
    move(*world, 0, Vec3(0, 0, -speed));
    ASSERT_TRUE(runThroughContact(*world, pi / rate / 500, 20000));
    EXPECT_NEAR(velocityOf(*world, 0).z() / speed, .8, .35 / 500 + 1e-3) << stiffness;
  }
}

TEST(Friction, FromNoneToTenToTheTwelveGoesFromSlidingFreelyToSticking) {
  const double radius = 3e-3, mass = 2500 * 4.0 / 3 * pi * std::pow(radius, 3), depth = 1e-5, normal = .1;
  const double stiffness = mass * std::pow(normal / (depth * radius), 2), steps = 2000;
  const auto turned = [&](double friction) {
    auto world = makeWorld(plainOptions(), {stiffness, 1, 1, friction});
    addFloor(*world);
    place(*world, sphereOf(radius), {0, 0, radius * (1 + 1e-9)});
    move(*world, 0, {.1, 0, -normal});
    EXPECT_TRUE(runThroughContact(*world, pi * std::sqrt(mass / stiffness) / steps, 8000));
    return (velocityOf(*world, 0).x() - radius * spinOf(*world, 0).y()) / .1;
  };
  EXPECT_EQ(turned(0), 1);
  EXPECT_NEAR(turned(1e-12), 1, 1e-11);
  // v_ct'/v_ct = -1 for spheres; a step of phase.
  EXPECT_NEAR(turned(1e6), -1, 5e-4 + pi / steps);
  EXPECT_EQ(turned(1e6), turned(1e12));
}

TEST(Alignment, ABlockOfCubesWithCommonFacesEdgesAndCornersStands) {
  // 27 cubes that just touch, at exact multiples of their side, under gravity: every pair of neighbours shares a face,
  // an edge or a corner.
  for (const PointRule rule : {PointRule::witness, PointRule::faceCentroid, PointRule::patch, PointRule::stiffPatch}) {
    WorldOptions options = plainOptions();
    options.gravity = {0, 0, -9.81};
    options.rule.rule = rule;
    auto world = makeWorld(options, {1e4, .8, .6, .5});
    addFloor(*world);
    const double half = 1.5e-3;
    const auto cube = cuboidOf(Vec3::Constant(half));
    for (int k = 0; k < 27; ++k) {
      const int row = k / 3 % 3, layer = k / 9;
      place(*world, cube, half * Vec3(2 * (k % 3), 2 * row, 1 + 2 * layer));
    }
    const std::vector<BoundingSphere> before = world->bodies.bounds;
    runFor(*world, 5e-6, 5e-3);
    EXPECT_TRUE(isFinite(*world));
    EXPECT_EQ(world->report.narrow.uncertified, 0u);
    EXPECT_LT(world->report.deepestOverlap, 1e-3) << pointRuleName(rule);
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_LT((world->bodies.x(i) - before[i].x).norm(), 1e-2 * half) << pointRuleName(rule);
  }
}

}  // namespace
}  // namespace granular
