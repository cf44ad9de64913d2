// Every way in and every way to rest ends with a bed at rest.
#include <gtest/gtest.h>

#include <algorithm>

#include "run/scene_texts.h"

namespace granular {
namespace {

class Settle : public RunTest {
 protected:
  const std::string batches = "[insertion]\nkind = \"batches\"\ncount = 24\nbatch = [6, 9]\n";

  static std::string settle(const std::string& kind) { return "[settle]\nkind = \"" + kind + "\"\n"; }

  /// A bed at rest: nothing moves fast, nothing is deep, nothing has left the box.
  static void expectBed(const PackingRun& run, std::size_t particles) {
    const World& world = run.world();
    ASSERT_EQ(world.bodies.size(), particles);
    EXPECT_LT(run.restlessness(), run.scene().rest.energy);
    EXPECT_EQ(world.report.narrow.uncertified, 0u);
    EXPECT_TRUE(world.report.troubles.empty());
    // Contacts among the frozen are not looked at.
    const auto frozen = std::count(world.bodies.state.begin(), world.bodies.state.end(), BodyState::frozen);
    EXPECT_GE(world.contactCount(), particles - static_cast<std::size_t>(frozen));
    for (std::size_t i = 0; i < particles; ++i) {
      EXPECT_GT(world.bodies.x(i).z(), 0);
      EXPECT_NE(world.bodies.state[i], BodyState::asleep) << "rest must hold with every body awake";
    }
  }

  PackingRun expectRest(const std::string& text, std::size_t particles) {
    PackingRun run(write(text));
    EXPECT_EQ(run.run(makeFolder("out"), never), RunEnd::rested);
    expectBed(run, particles);
    return run;
  }
};

TEST_F(Settle, BatchesRestWithNoneHeld) { expectRest(narrowBox + commonText + mixture + batches + settle("none"), 24); }

TEST_F(Settle, SleepersWakeWhenTheNextBatchHitsThem) {
  // The first batch sleeps before the second comes, and is hit by it. Of some seeds only few sleep by then.
  const PackingRun run = expectRest("seed = 3\n" + narrowBox + commonText + mixture + batches + settle("sleep"), 24);
  EXPECT_GT(run.world().sleep.fallen, 6u);
  EXPECT_GT(run.world().sleep.woken, 0u);
}

TEST_F(Settle, FrozenBodiesDoNotMove) {
  const std::string text = narrowBox + commonText + mixture + batches + settle("freeze");
  PackingRun run(write(text, {"time.max_time=0.08"}));
  const auto out = makeFolder("out");
  ASSERT_EQ(run.run(out, never), RunEnd::outOfTime);
  const Bodies before = run.world().bodies;
  PackingRun later = PackingRun::resumed(out, {"time.max_time=1e9"});
  ASSERT_EQ(later.run(out, never), RunEnd::rested);
  expectBed(later, 24);
  std::size_t frozen = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before.state[i] != BodyState::frozen) continue;
    ++frozen;
    EXPECT_EQ(later.world().bodies.state[i], BodyState::frozen);
    EXPECT_EQ(later.world().bodies.x(i), before.x(i));
    EXPECT_EQ(later.world().bodies.orientation(i).coeffs(), before.orientation(i).coeffs());
  }
  EXPECT_GT(frozen, 0u);
  EXPECT_LT(frozen, before.size());
}

TEST_F(Settle, ABatchThatBeginsToFallIsNotTakenForOneAtRest) {
  // Slower than the bound for the first 7 ms of the fall, and asked to be so for 1 ms.
  const PackingRun run = expectRest(narrowBox + commonText + mixture + batches +
                                        "energy = 0.1\ntime = \"1 ms\"\nheight = \"20 mm\"\n" + settle("freeze"),
                                    24);
  const Bodies& bodies = run.world().bodies;
  double top = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) top = std::max(top, bodies.x(i).z());
  // None hangs where it was inserted, 20 mm above the bed.
  EXPECT_LT(top, 0.020);
}

TEST_F(Settle, RainRests) {
  const std::string rain = "[insertion]\nkind = \"rain\"\ncount = 24\nrate = \"300 1/s\"\n";
  expectRest(narrowBox + commonText + mixture + rain + settle("sleep"), 24);
}

TEST_F(Settle, ABedSleepsWhileParticlesRainOnIt) {
  const std::string rain = "[insertion]\nkind = \"rain\"\ncount = 150\nrate = \"150 1/s\"\n";
  PackingRun run(write(narrowBox + commonText + spheres + rain + settle("sleep"), {"time.max_time=0.9"}));
  ASSERT_EQ(run.run(makeFolder("out"), never), RunEnd::outOfTime);
  const World& world = run.world();
  // Of the 135 so far, all but the topmost layers of 20 and those in flight.
  const auto asleep = std::count(world.bodies.state.begin(), world.bodies.state.end(), BodyState::asleep);
  EXPECT_EQ(world.bodies.size(), 135u);
  EXPECT_GT(asleep, 70);
}

TEST_F(Settle, PosesOfTwoGroupsRest) {
  std::ofstream(folder / "poses.txt") << "0 0 2e-3 1 0 0 0 0\n1e-3 0 6e-3 .8 .6 0 0 1\n-1e-3 1e-3 1e-2 .6 0 .8 0 1\n";
  const std::string cubes = "[[particles]]\nshape = \"cuboid\"\nhalf_lengths = [\"1.2 mm\", \"1.2 mm\", \"1.5 mm\"]\n";
  const std::string poses = "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
  expectRest(narrowBox + commonText + spheres + cubes + poses + settle("none"), 3);
}

TEST_F(Settle, ABedOfAnEarlierRunStaysWhereItRested) {
  PackingRun first(write(narrowBox + commonText + mixture + batches + settle("sleep")));
  ASSERT_EQ(first.run(makeFolder("first"), never), RunEnd::rested);
  const std::string bed = "[insertion]\nkind = \"bed\"\nfile = \"first\"\n";
  const PackingRun second = expectRest(narrowBox + commonText + spheres + bed + settle("sleep"), 24);
  for (std::size_t i = 0; i < 24; ++i) {
    const Bodies &before = first.world().bodies, &after = second.world().bodies;
    EXPECT_EQ(before.mass[i], after.mass[i]);
    EXPECT_LT((before.x(i) - after.x(i)).norm(), 0.1 * before.shape[i]->size()) << i;
  }
}

}  // namespace
}  // namespace granular
