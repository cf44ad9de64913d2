// Bodies moved side by side in the lanes of a register against bodies moved one by one.
#include <gtest/gtest.h>

#include "granular/integrate/integrator.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "world/heap.h"

namespace granular {
namespace {

using testing::isSameBits;

/// All bits of all bodies: what a checkpoint holds, and the frames.
std::vector<double> bitsOf(World& world) {
  std::vector<double> bits;
  const auto addColumn = [&]<class Value>(const char*, const std::vector<Value>& column) {
    if constexpr (sizeof(Value) % sizeof(double) == 0) {
      const auto* from = reinterpret_cast<const double*>(column.data());
      bits.insert(bits.end(), from, from + column.size() * sizeof(Value) / sizeof(double));
    }
  };
  world.bodies.visitState(addColumn);
  addColumn("frame", world.bodies.frame);
  return bits;
}

struct Gaps {
  bool frozen = false, asleep = false, locked = false;
};

/// Spheres, cuboids and ellipsoids that fly and turn, some of them by a large angle in a step.
std::unique_ptr<World> makeFlight(const WorldOptions& options, int count, const Gaps& gaps) {
  auto world = testing::makeEmptyWorld(options);
  world->addShape(std::make_shared<Sphere>(1e-3));
  world->addShape(std::make_shared<Cuboid>(Vec3(1e-3, 2e-3, 0.5e-3)));
  world->addShape(std::make_shared<Ellipsoid>(Vec3(2e-3, 1e-3, 0.7e-3)));
  Random random(11);
  for (int k = 0; k < count; ++k) {
    NewBody body;
    body.shapeIndex = k % 3;
    body.pose = {0.1 * random.direction(), random.rotation()};
    body.velocity = random.direction();
    body.spin = (k % 11 == 5 ? 6e4 : 100) * random.direction();
    if (gaps.locked && k % 4 == 1) body.locks = static_cast<Locks>(k);
    world->addBody(body);
  }
  for (std::size_t i = 0; i < world->bodies.size(); ++i) {
    if (gaps.frozen && i % 9 == 3) world->bodies.hold(i, BodyState::frozen);
    if (gaps.asleep && i > 20 && i % 2 == 1) world->bodies.hold(i, BodyState::asleep);
  }
  startHalfSteps(*world, 1e-5, 0, false);
  return world;
}

/// Forces and torques that depend on the state.
void pull(Bodies& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies.force[i] = bodies.mass[i] * Vec3(-1e4 * bodies.x(i) - bodies.v(i));
    bodies.torque[i] = bodies.mass[i] * Vec3(-1e-4 * bodies.w(i) + 1e-3 * bodies.x(i));
  }
}

/// Moves the bodies under those forces alone.
void moveOneStep(World& world) {
  predict(1e-5, world.options, world.bodies);
  pull(world.bodies);
  applyLocks(0, world.bodies);
  advance(1e-5, world.options, world.bodies);
}

class Motion : public ::testing::TestWithParam<SchemeKind> {};

INSTANTIATE_TEST_SUITE_P(World, Motion, ::testing::Values(SchemeKind::seelen, SchemeKind::spiral),
                         [](const auto& info) { return std::string(rotationScheme(info.param).name); });

TEST_P(Motion, InLanesHasTheSameBitsAsOneByOne) {
  const Gaps all{true, true, true};
  for (const bool spheresKeepTheirs : {false, true}) {
    for (const Gaps& gaps :
         {Gaps{}, Gaps{true, false, false}, Gaps{false, true, false}, Gaps{false, false, true}, all}) {
      for (const int count : {1, 2, 3, 7, 8, 9, 16, 64, 131}) {
        std::unique_ptr<World> worlds[2];
        for (const bool oneByOne : {false, true}) {
          WorldOptions options;
          options.noBatches = oneByOne;
          options.integrator = GetParam();
          options.skips.orientation = !spheresKeepTheirs;
          worlds[oneByOne] = makeFlight(options, count, gaps);
        }
        for (int n = 0; n < 50; ++n) {
          for (auto& world : worlds) moveOneStep(*world);
          ASSERT_TRUE(isSameBits(bitsOf(*worlds[0]), bitsOf(*worlds[1]))) << count << " bodies, step " << n;
        }
        for (const MotionRow& row : worlds[0]->bodies.motion) EXPECT_TRUE(row.w.allFinite());
      }
    }
  }
}

TEST_P(Motion, HasTheSameBitsWhetherSomebodyFollowsHowBallsLieOrNot) {
  std::unique_ptr<World> worlds[2];
  for (const bool followed : {false, true}) {
    WorldOptions options;
    options.integrator = GetParam();
    options.skips.orientation = !followed;
    worlds[followed] = makeFlight(options, 60, {false, false, true});
  }
  for (int n = 0; n < 50; ++n) {
    for (auto& world : worlds) moveOneStep(*world);
  }
  const Bodies &left = worlds[0]->bodies, &followed = worlds[1]->bodies;
  EXPECT_EQ(left.stepped().balls.size(), 20u);
  EXPECT_EQ(left.stepped().orientedBalls.size(), 0u);
  EXPECT_EQ(followed.stepped().orientedBalls.size(), 20u);
  for (std::size_t i = 0; i < left.size(); ++i) {
    EXPECT_EQ(left.x(i), followed.x(i));
    EXPECT_EQ(left.w(i), followed.w(i));
    EXPECT_EQ(left.spinHalf(i), followed.spinHalf(i));
    EXPECT_EQ(left.travel[i], followed.travel[i]);
    EXPECT_EQ(left.q[i].coeffs(), (left.isBall(i) ? Quat::Identity() : followed.q[i]).coeffs());
  }
}

TEST(Motion, OfABallUnderAConstantTorqueIsExact) {
  // Leapfrog is exact for a constant acceleration; the orientation, too, where the axis stays.
  constexpr int steps = 1000;
  constexpr double dt = 1e-5, time = steps * dt;
  WorldOptions options;
  options.skips.orientation = false;
  auto world = testing::makeEmptyWorld(options);
  world->addShape(std::make_shared<Sphere>(1e-3));
  const Vec3 axis = Vec3(1, -2, 0.5).normalized();
  NewBody body;
  body.pose.q = Quat(Eigen::AngleAxisd(0.7, Vec3::UnitX()));
  body.spin = 30 * axis;
  world->addBody(body);
  body.spin = Vec3(10, 20, -40);
  world->addBody(body);
  Bodies& bodies = world->bodies;
  const double moment = bodies.inertiaOf(0).x();
  const Vec3 torque = 2000 * moment * axis;
  // The half steps begin with the torque.
  for (std::size_t i = 0; i < 2; ++i) {
    bodies.alpha[i] = torque / moment;
    bodies.wHalfOf(i) = bodies.w(i) + 0.5 * dt * bodies.alpha[i];
  }
  const Vec3 other = bodies.w(1);
  for (int n = 0; n < steps; ++n) {
    predict(dt, options, bodies);
    for (std::size_t i = 0; i < 2; ++i) bodies.torque[i] = torque;
    advance(dt, options, bodies);
  }
  EXPECT_LT((bodies.w(0) - (30 + 2000 * time) * axis).norm(), 1e-11);
  EXPECT_LT((bodies.w(1) - other - 2000 * time * axis).norm(), 1e-11);
  const Quat turn(Eigen::AngleAxisd(30 * time + 0.5 * 2000 * time * time, axis));
  EXPECT_LT(bodies.q[0].angularDistance(turn * body.pose.q), 1e-12);
  EXPECT_EQ(bodies.frame[0].R, bodies.q[0].toRotationMatrix());
}

TEST_P(Motion, OfABodyAloneIsThatOfTheTable) {
  WorldOptions options;
  options.integrator = GetParam();
  auto world = makeFlight(options, 30, {});
  Bodies& bodies = world->bodies;
  const RotationScheme& scheme = rotationScheme(GetParam());
  Bodies alone = bodies;
  for (int n = 0; n < 20; ++n) {
    predict(1e-5, options, bodies);
    pull(bodies);
    advance(1e-5, options, bodies);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (bodies.isBall(i)) continue;
      scheme.predict(1e-5, alone.qHalf[i], alone.wHalf[i], alone.alpha[i], alone.q[i], alone.w(i));
      scheme.advance(1e-5, alone.inertia[i], alone.inverseInertia[i], bodies.torque[i], alone.q[i], alone.w(i),
                     {alone.qHalf[i], alone.wHalf[i], alone.alpha[i]});
      ASSERT_EQ(bodies.q[i].coeffs(), alone.q[i].coeffs());
      ASSERT_EQ(bodies.w(i), alone.w(i));
      ASSERT_EQ(bodies.frame[i].R, bodies.q[i].toRotationMatrix());
      ASSERT_EQ(bodies.frame[i].x, bodies.x(i));
    }
  }
}

/// In whole steps, with weight and with what the step says of speeds.
TEST_P(Motion, WholeStepsInLanesHaveTheSameBitsAndTroubleAsOneByOne) {
  std::unique_ptr<World> worlds[2];
  for (const bool oneByOne : {false, true}) {
    WorldOptions options;
    options.noBatches = oneByOne;
    options.integrator = GetParam();
    options.maxSpeed = 1.5;
    worlds[oneByOne] = makeFlight(options, 61, {true, false, true});
    for (const std::size_t i : {10u, 60u}) worlds[oneByOne]->bodies.vHalf(i) *= 2;
  }
  for (int n = 0; n < 20; ++n) {
    for (auto& world : worlds) step(*world, 1e-7);
    ASSERT_TRUE(isSameBits(bitsOf(*worlds[0]), bitsOf(*worlds[1]))) << "step " << n;
  }
  worlds[0]->bodies.vHalf(20).x() = worlds[1]->bodies.vHalf(20).x() = std::nan("");
  for (auto& world : worlds) watch(*world);
  for (auto& world : worlds) {
    predict(1e-7, world->options, world->bodies);
    watch(*world);
  }
  EXPECT_EQ(worlds[0]->report.troubleCounts, worlds[1]->report.troubleCounts);
  const auto countOf = [&](Trouble::Kind kind) {
    return worlds[0]->report.troubleCounts[static_cast<std::size_t>(kind)];
  };
  EXPECT_EQ(countOf(Trouble::Kind::nonFinite), 1u);
  EXPECT_GT(countOf(Trouble::Kind::tooFast), 40u);
}

}  // namespace
}  // namespace granular
