// (d) Blocks and balls on slopes. The slope is the floor under a tilted gravity.
#include <fmt/format.h>

#include <cstring>

#include "granular/law/linear.h"
#include "verification/record.h"
#include "verification/scenes.h"

namespace granular {
namespace {

constexpr double gravity = 9.81;

WorldOptions slopeOptions(double angle) {
  WorldOptions options = plainOptions();
  options.gravity = gravity * Vec3(std::sin(angle), 0, -std::cos(angle));
  return options;
}

/// A block that has sunk in by what its weight asks for, so that nothing swings.
std::unique_ptr<World> makeBlock(double angle, const Vec3& half, const ContactParameters& contact) {
  auto world = makeWorld(slopeOptions(angle), contact);
  addFloor(*world);
  const double mass = 2500 * 8 * half.prod();
  place(*world, cuboidOf(half), {0, 0, half.z() - mass * gravity * std::cos(angle) / contact.stiffness});
  return world;
}

double stepOf(const World& world, double fraction) {
  return fraction * pi * std::sqrt(world.bodies.mass[0] / world.materials.constants(0, 0).parameters.stiffness);
}

const Vec3 flat(4e-3, 4e-3, 1e-3);

TEST(Slopes, BlockSticksBelowTheAngleOfFrictionOnItsStretchedSpring) {
  const double mu = .4, angle = std::atan(.98 * mu);
  auto world = makeBlock(angle, flat, {1e5, .3, .3, mu});
  runFor(*world, stepOf(*world, .02), .3);
  verifyBelow('d', "block at .98 of the friction angle: speed after .3 s, m/s", 1e-12, world->bodies.v(0).norm(),
              "exact: at rest; round-off of forces");
  Vec3 spring = Vec3::Zero();
  for (const SpotHistory& spot : world->pairs.wallPairs[0].spots) spring += spot.history.spring;
  ContactBody body;
  body.inverseMass = world->bodies.inverseMass(0);
  body.radiusRatio = world->bodies.radiusRatio(0);
  const double k =
      stiffnessOf(LawKind::linear, world->materials.constants(0, 0), {}, body, {}, Vec3::UnitZ()).tangential;
  const double shift = world->bodies.mass[0] * gravity * std::sin(angle) / k;
  verify('d', "block at .98 of the friction angle: spring/(m g sin t/k_t)", 1, spring.x() / shift, 1e-9,
         "exact at rest; decayed motion");
}

TEST(Slopes, BlockSlidesAboveTheAngleOfFriction) {
  const double mu = .4;
  for (const double factor : {1.02, 1.5}) {
    const double angle = std::atan(factor * mu);
    auto world = makeBlock(angle, flat, {1e5, .3, .3, mu});
    const double dt = stepOf(*world, .02);
    runFor(*world, dt, .3);
    const double before = world->bodies.vHalf(0).x();
    const double start = world->time;
    for (int n = 0; n < 20000; ++n) step(*world, dt);
    const double got = (world->bodies.vHalf(0).x() - before) / (world->time - start);
    const double expected = gravity * (std::sin(angle) - mu * std::cos(angle));
    verify('d', fmt::format("block at {} of tan = mu: acceleration/(g (sin t - mu cos t))", factor), 1, got / expected,
           1e-3, "exact; .1 %");
  }
}

TEST(Slopes, BlockTopplesBeyondItsDiagonal) {
  // b/h = .5; the contact's own give, m g/(k_n b), is 1e-4 of it.
  const Vec3 tall(1e-3, 4e-3, 2e-3);
  for (const double factor : {.98, 1.02}) {
    const double angle = std::atan(.5 * factor);
    auto world = makeBlock(angle, tall, {1e6, .3, .3, 5});
    runFor(*world, stepOf(*world, .05), .25);
    const double tilt = world->bodies.orientation(0).angularDistance(Quat::Identity());
    verifyThat('d', fmt::format("block b/h = .5 at tan t = {} b/h topples: {}", factor, factor > 1 ? "yes" : "no"),
               (tilt > .1) == (factor > 1), "statics");
  }
}

TEST(Slopes, SecondBlockThatTouchesNothingChangesNothing) {
  std::vector<double> states[2];
  for (const bool second : {false, true}) {
    auto world = makeBlock(std::atan(.39), flat, {1e5, .3, .3, .4});
    if (second) place(*world, cuboidOf(flat), {0, .2, 1e-3 + 1e-4});
    runFor(*world, stepOf(*world, .02), .05);
    for (int k = 0; k < 3; ++k) states[second].push_back(world->bodies.x(0)[k]);
    for (int k = 0; k < 4; ++k) states[second].push_back(world->bodies.orientation(0).coeffs()[k]);
  }
  verifyThat('d', "a second block far away leaves every bit of the first", states[0] == states[1], "same forces");
}

std::unique_ptr<World> makeBall(double angle, double mu) {
  auto world = makeWorld(slopeOptions(angle), {1e5, .5, .5, mu});
  addFloor(*world);
  const double radius = 3e-3, mass = 2500 * 4.0 / 3 * pi * std::pow(radius, 3);
  place(*world, sphereOf(radius), {0, 0, radius - mass * gravity * std::cos(angle) / 1e5});
  return world;
}

TEST(Slopes, SlidingBallStartsToRollAtTheClosedForm) {
  const double mu = .1, v0 = .5, time = 2 * v0 / (7 * mu * gravity);
  auto world = makeBall(0, mu);
  move(*world, 0, {v0, 0, 0});
  const double dt = stepOf(*world, .02);
  runFor(*world, dt, time);
  // Position exactly at the closed form's time: the runs end within a step of it.
  const double x = world->bodies.x(0).x() + (time - world->time) * world->bodies.v(0).x();
  verify('d', "ball from sliding to rolling: v/(5/7 v0) after 2 v0/(7 mu g)", 1,
         world->bodies.v(0).x() / (5.0 / 7 * v0), 1e-3, "exact; .1 %");
  verify('d', "ball from sliding to rolling: x/(12 v0^2/(49 mu g))", 1, x / (12 * v0 * v0 / (49 * mu * gravity)), 1e-3,
         "exact; .1 %");
  for (int n = 0; n < 20000; ++n) step(*world, dt);
  verify('d', "ball rolls on: v/(R w)", 1, world->bodies.v(0).x() / (3e-3 * world->bodies.w(0).y()), 1e-3,
         "exact; .1 %");
}

TEST(Slopes, BallRollsDownWithFiveSevenths) {
  const double angle = .3;
  // Friction just above 2/7 tan t.
  auto world = makeBall(angle, 1.02 * 2.0 / 7 * std::tan(angle));
  runFor(*world, stepOf(*world, .02), .3);
  verify('d', "ball on an incline: v/(5/7 g sin t T)", 1,
         world->bodies.v(0).x() / (5.0 / 7 * gravity * std::sin(angle) * world->time), 1e-3, "exact; .1 %");
}

}  // namespace
}  // namespace granular
