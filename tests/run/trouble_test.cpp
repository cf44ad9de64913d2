// Trouble is seen soon after it comes, and answered as the scene says.
#include <limits>

#include "run/resume_fixture.h"

namespace granular {
namespace {

class TroubleTest : public ResumeTest {
 protected:
  /// Two layers of spheres above the floor, and one high above them; falls, lands, rests.
  std::string makePoses(double highest) const {
    std::ofstream poses(folder / "poses.txt");
    for (int k = 0; k < 18; ++k) {
      const int column = k % 3, row = k / 3 % 3, layer = k / 9;
      poses << 4e-3 * (column - 1) + 1e-4 * layer << ' ' << 4e-3 * (row - 1) << ' ' << 1.6e-3 + 3.2e-3 * layer
            << " 1 0 0 0\n";
    }
    poses << "0 0 " << highest << " 1 0 0 0\n";
    return narrowBox + commonText + spheres + "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
  }
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  /// Steps until the report names something, and what kind that is; -1: nothing in a hundred steps.
  static int stepsUntilTold(PackingRun& run, Trouble::Kind& kind) {
    World& world = run.world();
    for (int k = 1; k <= 100; ++k) {
      step(world, run.timeStep());
      if (world.report.troubles.empty()) continue;
      kind = world.report.troubles.front().kind;
      return k;
    }
    return -1;
  }

  PackingRun makeSettled(const std::vector<std::string>& overrides = {}) {
    PackingRun run(write(makePoses(9e-3), overrides));
    while (run.world().time < 0.05) step(run.world(), run.timeStep());
    EXPECT_TRUE(run.world().report.troubles.empty());
    return run;
  }
};
using TroubleSeen = TroubleTest;
using TroubleAnswered = TroubleTest;

TEST_F(TroubleSeen, WhatIsNoNumberInTheStepInWhichABodyMovesByIt) {
  Trouble::Kind kind{};
  PackingRun velocity = makeSettled();
  velocity.world().bodies.vHalf(4).y() = nan;
  EXPECT_EQ(stepsUntilTold(velocity, kind), 1);
  EXPECT_EQ(kind, Trouble::Kind::nonFinite);
  PackingRun spin = makeSettled();
  spin.world().bodies.wHalfOf(4).y() = infinity;
  EXPECT_EQ(stepsUntilTold(spin, kind), 1);
  EXPECT_EQ(kind, Trouble::Kind::nonFinite);
  // The force of a step moves the body in the next.
  PackingRun force = makeSettled();
  force.world().bodies.acceleration[4].z() = nan;
  EXPECT_LE(stepsUntilTold(force, kind), 2);
  EXPECT_EQ(kind, Trouble::Kind::nonFinite);
}

TEST_F(TroubleSeen, SpeedAndOverlapBeyondTheLimitsInTheSameStep) {
  Trouble::Kind kind{};
  PackingRun fast = makeSettled();
  fast.world().bodies.vHalf(18).z() = 0.6 * 1.5e-3 / fast.timeStep();  // the topmost, upwards
  EXPECT_EQ(stepsUntilTold(fast, kind), 1);
  EXPECT_EQ(kind, Trouble::Kind::tooFast);
  PackingRun deep = makeSettled();
  deep.world().bodies.x(4) = deep.world().bodies.x(3) + Vec3(2e-3, 0, 0);
  deep.world().search.invalidate();
  EXPECT_EQ(stepsUntilTold(deep, kind), 1);
  EXPECT_EQ(kind, Trouble::Kind::deepOverlap);
}

TEST_F(TroubleSeen, ABodyOutsideAtTheNextLookAtTheBed) {
  // Half a millimetre behind the wall is a deep overlap too, which this scene accepts.
  PackingRun run = makeSettled({"limits.max_overlap=10"});
  const double before = run.world().time;
  run.world().bodies.x(18).x() = 7.5e-3 + 0.5e-3;
  run.world().search.invalidate();
  EXPECT_EQ(run.run(makeFolder("out"), never), RunEnd::trouble);
  ASSERT_FALSE(run.world().report.troubles.empty());
  EXPECT_EQ(run.world().report.troubles.front().kind, Trouble::Kind::escaped);
  EXPECT_LT(run.world().time - before, 1.2e-4);
}

TEST_F(TroubleSeen, EnergyFromNothingAtTheNextLookAtTheBed) {
  // A bed that has been watched for a while is shaken by nobody.
  const std::vector<std::string> overrides{"rest.time=100", "time.max_time=0.3"};
  PackingRun run(write(makePoses(9e-3), overrides));
  const auto out = makeFolder("out");
  ASSERT_EQ(run.run(out, never), RunEnd::outOfTime);
  PackingRun shaken = PackingRun::resumed(out, {"time.max_time=1"});
  const double before = shaken.world().time;
  for (std::size_t i = 0; i < shaken.world().bodies.size(); ++i) {
    shaken.world().bodies.vHalf(i).z() += 0.2;
    shaken.world().bodies.v(i).z() += 0.2;
  }
  EXPECT_EQ(shaken.run(out, never), RunEnd::trouble);
  ASSERT_FALSE(shaken.world().report.troubles.empty());
  EXPECT_EQ(shaken.world().report.troubles.front().kind, Trouble::Kind::energyGain);
  EXPECT_LT(shaken.world().time - before, 1.2e-4);
}

TEST_F(TroubleSeen, NoneInAnElasticBounceThatKeepsItsEnergy) {
  PackingRun run(write(makePoses(60e-3), {"contact_default.restitution=1", "contact_default.restitution_tangential=1",
                                          "contact_default.friction=0", "time.max_time=0.5", "rest.time=100"}));
  EXPECT_EQ(run.run(makeFolder("out"), never), RunEnd::outOfTime);
  EXPECT_TRUE(run.world().report.troubles.empty());
}

TEST_F(TroubleAnswered, AStopLeavesTheLastGoodState) {
  // The highest comes down at 1.4 m/s.
  const std::string scene = makePoses(98e-3);
  PackingRun run(write(scene, {"limits.max_speed=1.2"}));
  const auto out = makeFolder("out");
  ASSERT_EQ(run.run(out, never), RunEnd::trouble);
  PackingRun again = PackingRun::resumed(out, {"limits.max_speed=100"});
  EXPECT_TRUE(again.world().report.troubles.empty());
  EXPECT_LT(again.world().steps, run.world().steps);
  EXPECT_GE(again.world().steps, run.world().steps - 1100);
  EXPECT_EQ(again.run(out, never), RunEnd::rested);
  // To the same bits as a run without the limit.
  PackingRun free(write(scene));
  ASSERT_EQ(free.run(makeFolder("free"), never), RunEnd::rested);
  expectSameState(free, again);
}

TEST_F(TroubleAnswered, WithoutTheParticleNamedTheOthersComeToRest) {
  PackingRun run(write(makePoses(98e-3), {"limits.max_speed=1.2", "limits.on_trouble=remove"}));
  ASSERT_EQ(run.run(makeFolder("out"), never), RunEnd::rested);
  EXPECT_EQ(run.world().bodies.size(), 18u);
  EXPECT_EQ(run.progress().removed, std::vector<std::int64_t>{18});
  ASSERT_EQ(run.progress().answers.size(), 1u);
  expectMentions(run.progress().answers[0], {"body 18", "1.2", "m/s", "back to t =", "particle 18 taken out"});
  EXPECT_TRUE(run.world().report.troubles.empty());
}

TEST_F(TroubleAnswered, WithHalfTheStepASpeedThatItResolvesIsNoTrouble) {
  const double whole = PackingRun(write(makePoses(98e-3))).timeStep();
  // Between the travel of a step and that of half of it, at 1.4 m/s.
  const std::string travel = fmt::format("limits.max_travel={}", 1.0 * whole / 1.5e-3);
  PackingRun run(write(makePoses(98e-3), {travel, "limits.on_trouble=smaller_step"}));
  ASSERT_EQ(run.run(makeFolder("out"), never), RunEnd::rested);
  EXPECT_EQ(run.timeStep(), 0.5 * whole);
  EXPECT_EQ(run.world().bodies.size(), 19u);
  ASSERT_EQ(run.progress().answers.size(), 1u);
  expectMentions(run.progress().answers[0], {"body 18", "back to t =", "half the time step"});
}

TEST_F(TroubleAnswered, StopsWhereNoAnswerHelps) {
  for (const char* answer : {"remove", "smaller_step"}) {
    // Every contact is trouble.
    PackingRun run(write(makePoses(9e-3), {"limits.max_overlap=1e-9", fmt::format("limits.on_trouble={}", answer)}));
    EXPECT_EQ(run.run(makeFolder("out"), never), RunEnd::trouble) << answer;
    // One of nineteen particles; six halvings.
    EXPECT_EQ(run.progress().answers.size(), std::string(answer) == "remove" ? 1u : 6u) << answer;
  }
}

TEST_F(TroubleAnswered, InterruptedOnTheWayEndsInTheSameBits) {
  for (const char* answer : {"remove", "smaller_step"}) {
    const double whole = PackingRun(write(makePoses(98e-3))).timeStep();
    const std::vector<std::string> limits{fmt::format("limits.max_travel={}", 1.0 * whole / 1.5e-3),
                                          fmt::format("limits.on_trouble={}", answer)};
    PackingRun undisturbed(write(makePoses(98e-3), limits));
    ASSERT_EQ(undisturbed.run(makeFolder("whole"), never), RunEnd::rested);
    // Shortly before the trouble, shortly after it, and later.
    const auto out = makeFolder("parts");
    auto until = limits;
    until.push_back("time.max_time=0.095");
    ASSERT_EQ(PackingRun(write(makePoses(98e-3), until)).run(out, never), RunEnd::outOfTime);
    for (const double time : {0.1, 0.105, 0.13}) {
      PackingRun part = PackingRun::resumed(out, {fmt::format("time.max_time={}", time)});
      ASSERT_EQ(part.run(out, never), RunEnd::outOfTime) << answer;
    }
    PackingRun last = PackingRun::resumed(out, {"time.max_time=10"});
    ASSERT_EQ(last.run(out, never), RunEnd::rested);
    EXPECT_EQ(last.progress().answers, undisturbed.progress().answers);
    expectSameState(undisturbed, last);
  }
}

}  // namespace
}  // namespace granular
