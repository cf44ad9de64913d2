// A run that was stopped and taken up again ends in the same bits as one that never stopped.
#include "run/resume_fixture.h"

namespace granular {
namespace {

class Resume : public ResumeTest {
 protected:
  /// Stops at every one of the times, resumes with another number of threads each time, and compares the end.
  void expectSameEnd(const std::string& text, const std::vector<double>& stops) {
    const SceneSource source = write(text, {"threads=1"});
    omp_set_num_threads(1);
    PackingRun whole(source);
    ASSERT_EQ(whole.run(makeFolder("whole"), never), RunEnd::rested);

    const auto out = makeFolder("parts");
    const auto until = [](double time) { return fmt::format("time.max_time={}", time); };
    SceneSource shortened = source;
    shortened.overrides.push_back(until(stops.front()));
    EXPECT_EQ(PackingRun(shortened).run(out, never), RunEnd::outOfTime);
    for (std::size_t k = 1; k < stops.size(); ++k) {
      ASSERT_LT(stops[k], whole.world().time);
      // Once with several threads, shortly: on a busy machine they wait for each other.
      omp_set_num_threads(k + 2 == stops.size() ? 4 : 1);
      PackingRun part = PackingRun::resumed(out, {until(stops[k])});
      EXPECT_EQ(part.run(out, never), RunEnd::outOfTime);
    }
    omp_set_num_threads(1);
    PackingRun last = PackingRun::resumed(out, {until(1e9)});
    EXPECT_EQ(last.run(out, never), RunEnd::rested);
    expectSameState(whole, last);
  }

  const std::string cubes = "[[particles]]\nshape = \"cuboid\"\nhalf_lengths = [\"1.2 mm\", \"1.2 mm\", \"1.5 mm\"]\n";

  const std::string batches = "[insertion]\nkind = \"batches\"\ncount = 24\nbatch = [6, 9]\n";
  const std::vector<double> stops{0.0002, 0.013, 0.031, 0.0613, 0.063, 0.09};
};

TEST_F(Resume, BatchesOfAMixtureEndInTheSameBits) {
  expectSameEnd(narrowBox + commonText + mixture + batches + settle("none"), stops);
}

TEST_F(Resume, BatchesOfAMixtureWithSleepersEndInTheSameBits) {
  expectSameEnd(narrowBox + commonText + mixture + batches + settle("sleep"), stops);
}

TEST_F(Resume, FrozenBatchesOfAMixtureEndInTheSameBits) {
  expectSameEnd(narrowBox + commonText + mixture + batches + settle("freeze"), stops);
}

TEST_F(Resume, RainOfAMixtureWithSleepersEndsInTheSameBits) {
  const std::string rain = "[insertion]\nkind = \"rain\"\ncount = 24\nrate = \"200 1/s\"\n";
  const std::string vessel = "[vessel]\nkind = \"cylinder\"\nradius = \"8 mm\"\n";
  expectSameEnd(vessel + commonText + mixture + rain + settle("sleep"), stops);
}

TEST_F(Resume, PostponedParticlesComeAtTheSameTime) {
  // So many at once that most find no place: the next attempt is due at a time that must be remembered.
  const std::string rain = "[insertion]\nkind = \"rain\"\ncount = 40\nrate = \"1e5 1/s\"\n";
  const std::string vessel = "[vessel]\nkind = \"box\"\nsize = [\"8 mm\", \"8 mm\", \"200 mm\"]\n";
  expectSameEnd(vessel + commonText + spheres + rain, {0.0021, 0.0063, 0.0117, 0.0127, 0.023});
}

TEST_F(Resume, APeriodicBedEndsInTheSameBits) {
  const std::string vessel = "[vessel]\nkind = \"periodic\"\nsize = [\"12 mm\", \"12 mm\", \"100 mm\"]\n";
  expectSameEnd(vessel + commonText + mixture + batches + settle("sleep"), stops);
}

TEST_F(Resume, PosesEndInTheSameBits) {
  std::ofstream(folder / "poses.txt") << "0 0 2e-3 1 0 0 0 0\n1e-3 0 6e-3 .8 .6 0 0 1\n-1e-3 1e-3 1e-2 .6 0 .8 0 1\n";
  const std::string groups =
      spheres + "[[particles]]\nshape = \"cuboid\"\nhalf_lengths = [\"1.2 mm\", \"1.2 mm\", \"1.5 mm\"]\n";
  const std::string poses = "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
  expectSameEnd(narrowBox + commonText + groups + poses + settle("sleep"), {0.0002, 0.02, 0.033, 0.034, 0.04});
}

TEST_F(Resume, SpiralEndsInTheSameBits) {
  expectSameAt(0.03, 0.0271, narrowBox + commonText + cubes + few, {"model.integrator=spiral"});
}

TEST_F(Resume, WithNothingSkippedEndsInTheSameBits) {
  expectSameAt(0.03, 0.0271, narrowBox + commonText + mixture + few, {"skip=[\"none\"]"});
}

TEST_F(Resume, OnAMeshWallEndsInTheSameBits) {
  // A roof over the floor, its ridge along y.
  std::ofstream(folder / "roof.obj")
      << "v -0.02 -0.02 0\nv -0.02 0.02 0\nv 0 -0.02 0.004\nv 0 0.02 0.004\nv 0.02 -0.02 0\nv 0.02 0.02 0\n"
         "f 1 3 4\nf 1 4 2\nf 3 5 6\nf 3 6 4\n";
  const std::string roof = "[[wall]]\nkind = \"mesh\"\nfile = \"roof.obj\"\nunit = \"m\"\n";
  expectSameAt(0.03, 0.0271, narrowBox + roof + commonText + mixture + few);
}

TEST_F(Resume, UnderMovingWallsEndsInTheSameBits) {
  const std::string walls = R"(
[[wall]]
name = "piston"
kind = "plane"
point = ["0 mm", "0 mm", "30 mm"]
normal = [0, 0, -1]
direction = [0, 0, -1]
force = "0.2 N"
max_speed = "1 m/s"
[[wall]]
name = "paddle"
kind = "plane"
point = ["-7 mm", "0 mm", "0 mm"]
normal = [1, 0, 0]
amplitude = ["0.5 mm", "0 mm", "0 mm"]
frequency = "40 Hz"
spin = ["0 rad/s", "2 rad/s", "0 rad/s"]
start = "10 ms"
stop = "50 ms"
)";
  expectSameAt(0.06, 0.0371, narrowBox + walls + commonText + mixture + few + settle("sleep"));
}

TEST_F(Resume, ABedFilledToItsRimEndsInTheSameBits) {
  const std::string box = "[vessel]\nkind = \"box\"\nsize = [\"8 mm\", \"8 mm\", \"7 mm\"]\n";
  const std::string lots = "[insertion]\nkind = \"batches\"\ncount = 40\nbatch = 12\n";
  expectSameEnd(box + commonText + spheres + lots, {0.02, 0.035, 0.05});
}

TEST_F(Resume, ARunStartedFromABedEndsInTheSameBits) {
  PackingRun first(write(narrowBox + commonText + mixture + few));
  ASSERT_EQ(first.run(makeFolder("first"), never), RunEnd::rested);
  const std::string bed = "[insertion]\nkind = \"bed\"\nfile = \"first\"\n";
  // Tilted, so that the bed moves.
  const std::string tilted = "gravity = [5, 0, -8.5]\n";
  expectSameAt(0.02, 0.0113, tilted + narrowBox + commonText + spheres + bed + settle("none"));
}

TEST_F(Resume, ClumpsAmongOthersEndInTheSameBits) {
  const std::string clumps = R"(
[[particles]]
shape = "clump"
radii = ["1 mm", "1.2 mm", "0.8 mm"]
centres = [["0 mm", "0 mm", "0 mm"], ["1.5 mm", "0 mm", "0 mm"], ["2 mm", "1.4 mm", "0.3 mm"]]
share = 0.4
[[particles]]
shape = "clump"
construction = "ellipsoid"
half_length = "2 mm"
half_width = "1 mm"
spheres = 7
mass = "smooth"
share = 0.3
[[particles]]
shape = "cuboid"
half_lengths = ["1.2 mm", "1.2 mm", "1.5 mm"]
share = 0.3
)";
  expectSameEnd(narrowBox + commonText + clumps + batches + settle("sleep"), stops);
}

TEST_F(Resume, TheEnergyLedgerEndsInTheSameBits) {
  expectSameAt(0.06, 0.0471, narrowBox + commonText + mixture + few + settle("sleep"), {"output.energy=true"});
}

TEST_F(Resume, TheCheckpointsOnTheWayAreAsGoodAsTheLast) {
  const std::string text = narrowBox + commonText + mixture + batches + settle("sleep");
  omp_set_num_threads(1);
  PackingRun whole(write(text));
  ASSERT_EQ(whole.run(makeFolder("whole"), never), RunEnd::rested);
  // The checkpoint before the last one of a run that saved often.
  PackingRun often(write(text, {"output.checkpoint_interval=0.02"}));
  const auto out = makeFolder("often");
  ASSERT_EQ(often.run(out, never), RunEnd::rested);
  std::filesystem::remove(out / "checkpoint.h5");
  PackingRun again = PackingRun::resumed(out / "checkpoint_previous.h5");
  EXPECT_LT(again.world().time, whole.world().time);
  EXPECT_EQ(again.run(out, never), RunEnd::rested);
  expectSameState(whole, again);
}

TEST_F(Resume, AStopLeavesACheckpointAfterAFewSteps) {
  PackingRun run(write(narrowBox + commonText + mixture + batches));
  const auto out = makeFolder("out");
  EXPECT_EQ(run.run(out, atOnce), RunEnd::interrupted);
  PackingRun again = PackingRun::resumed(out);
  EXPECT_EQ(again.world().steps, run.world().steps);
  expectSameState(run, again);
}

TEST_F(Resume, TroubleKeepsItsNames) {
  // Every overlap above a ten-thousandth is trouble.
  const std::vector<std::string> touchy{"limits.max_overlap=1e-4", "limits.on_trouble=continue", "time.max_time=0.06"};
  PackingRun run(write(narrowBox + commonText + spheres + batches, touchy));
  const auto out = makeFolder("out");
  run.run(out, never);
  ASSERT_FALSE(run.world().report.troubles.empty());
  PackingRun again = PackingRun::resumed(out);
  ASSERT_EQ(again.world().report.troubles.size(), run.world().report.troubles.size());
  for (std::size_t k = 0; k < run.world().report.troubles.size(); ++k) {
    EXPECT_EQ(describe(again.world().report.troubles[k]), describe(run.world().report.troubles[k]));
  }
}

TEST_F(Resume, WhatWouldChangeTheMotionIsRefused) {
  PackingRun run(write(narrowBox + commonText + spheres + batches));
  const auto out = makeFolder("out");
  run.run(out, atOnce);
  for (const std::string entry : {"seed=2", "time.step=1e-7", "insertion.count=30", "gravity=[0, 0, -1]"}) {
    try {
      PackingRun::resumed(out, {entry});
      FAIL() << entry;
    } catch (const InputError& error) {
      expectMentions(error.what(), {entry, "resumed", "time.max_time"});
    }
  }
}

}  // namespace
}  // namespace granular
