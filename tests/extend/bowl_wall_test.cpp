// The wall of examples/extend/bowl_wall.h against balls whose motion in a bowl is known.
#include "examples/extend/bowl_wall.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/shape/clump.h"
#include "granular/shape/sphere.h"
#include "granular/world/time_step.h"
#include "granular/world/world.h"

namespace granular {
namespace {

using extend::BowlWall;

constexpr double bowl = 0.05, ball = 0.01, density = 2500, g = 9.81;
const double mass = density * 4.0 / 3 * pi * ball * ball * ball;

std::unique_ptr<World> makeBowl(const WorldOptions& options, const ContactParameters& contact) {
  MaterialTable materials;
  materials.add("glass", contact);
  auto world = std::make_unique<World>(options, std::move(materials));
  world->walls.push_back(std::make_unique<BowlWall>(Vec3::Zero(), bowl));
  return world;
}

void addBody(World& world, std::shared_ptr<const Shape> shape, const Vec3& x) {
  NewBody body;
  body.shapeIndex = world.addShape(std::move(shape));
  body.density = density;
  body.pose.x = x;
  world.addBody(body);
}

/// Time from one passage through x = 0 to the next but one.
double findPeriod(World& world, double dt) {
  startHalfSteps(world, dt, 0, true);
  std::vector<double> passages;
  double before = world.bodies.x(0).x();
  while (passages.size() < 3 && world.time < 3) {
    step(world, dt);
    const double now = world.bodies.x(0).x();
    if (before * now <= 0) passages.push_back(world.time - dt * now / (now - before));
    before = now;
  }
  return passages.size() < 3 ? 0 : passages[2] - passages[0];
}

TEST(BowlWall, SwingsABallAsAPendulumAndSlowerByFiveSeventhsWhereItRolls) {
  ContactParameters contact;
  contact.stiffness = 1e5;
  const double angle = 0.05, overlap = mass * g / contact.stiffness, arm = bowl - ball + overlap;
  for (const bool rolls : {false, true}) {
    contact.friction = rolls ? 1 : 0;
    auto world = makeBowl(WorldOptions{}, contact);
    addBody(*world, std::make_shared<Sphere>(ball), arm * Vec3(std::sin(angle), 0, -std::cos(angle)));
    // A pendulum's period, with its first correction for the amplitude.
    const double inertia = rolls ? 7.0 / 5 : 1;
    const double period = 2 * pi * std::sqrt(inertia * arm / g) * (1 + angle * angle / 16);
    EXPECT_NEAR(findPeriod(*world, 2e-5), period, 1e-3 * period) << rolls;
  }
}

TEST(BowlWall, LetsHertzsBallSinkInByTheCurvatureOfBoth) {
  WorldOptions options;
  options.law = LawKind::hertzMindlin;
  ContactParameters contact;
  setElasticity({1e8, 0.3}, {1e8, 0.3}, contact);
  contact.restitution = 0.3;
  auto world = makeBowl(options, contact);
  const double effective = 1 / (1 / ball - 1 / bowl);
  const double rest = std::pow(mass * g / (4.0 / 3 * contact.modulus * std::sqrt(effective)), 2.0 / 3);
  addBody(*world, std::make_shared<Sphere>(ball), Vec3(0, 0, -(bowl - ball + 0.9 * rest)));
  const double dt = 1e-5;
  startHalfSteps(*world, dt, 0, true);
  for (int n = 0; n < 40000; ++n) step(*world, dt);
  EXPECT_NEAR(-world->bodies.x(0).z() - (bowl - ball), rest, 1e-6 * rest);
}

TEST(BowlWall, CarriesTheWeightOfBallsAndClumpsThatFallIn) {
  ContactParameters contact;
  contact.stiffness = 2e3;
  contact.restitution = 0.3;
  auto world = makeBowl(WorldOptions{}, contact);
  const double r = 4e-3;
  const auto single = std::make_shared<Sphere>(r);
  const auto twin =
      std::make_shared<Clump>(std::vector<ChildSphere>{{Vec3(-0.5 * r, 0, 0), r}, {Vec3(0.5 * r, 0, 0), r}});
  Random random(3);
  double weight = 0;
  for (int k = 0; k < 24; ++k) {
    const int column = k % 3, row = k / 3 % 3, layer = k / 9;
    const Vec3 cell(column - 1, row - 1, layer - 1);
    const Vec3 shake(random.uniform(), random.uniform(), random.uniform());
    if (k % 2) {
      addBody(*world, twin, 2.8 * r * (cell + 0.05 * shake));
    } else {
      addBody(*world, single, 2.8 * r * (cell + 0.05 * shake));
    }
    weight += g * world->bodies.mass.back();
  }
  const double dt =
      0.5 *
      boundBeforeRun({{single.get(), 0, density}, {twin.get(), 0, density}}, world->materials, world->options).bound;
  startHalfSteps(*world, dt, 0, false);
  while (world->time < 1.5) step(*world, dt);
  EXPECT_NEAR(-world->wallForces[0].z(), weight, 1e-3 * weight);
  for (std::size_t i = 0; i < world->bodies.size(); ++i) EXPECT_LT(world->bodies.x(i).norm() + r, 1.01 * bowl) << i;
}

TEST(BowlWall, RefusesARadiusThatIsNone) {
  for (const double radius : {0.0, -1.0, infinity}) EXPECT_THROW(BowlWall(Vec3::Zero(), radius), InputError) << radius;
}

}  // namespace
}  // namespace granular
