// What a scene's vessel means to the run and to its analysis.
#include <gtest/gtest.h>

#include "granular/run/packing_report.h"
#include "run/scene_texts.h"

namespace granular {
namespace {

class VesselOfARun : public RunTest {
 protected:
  const std::string pour = "[insertion]\nkind = \"batches\"\ncount = 8\n";
};

TEST_F(VesselOfARun, RepeatsAlongTheNamedDirectionsOnly) {
  const std::string vessel =
      "[vessel]\nkind = \"periodic\"\nsize = [\"15 mm\", \"15 mm\", \"60 mm\"]\nperiodic = [\"y\"]\n";
  const PackingRun run(write(vessel + commonText + spheres + pour));
  EXPECT_EQ(run.vessel().repeats(), (std::array<bool, 3>{false, true, false}));
  EXPECT_EQ(run.world().vesselWalls, 3u);  // the floor and two sides
}

TEST_F(VesselOfARun, IsFilledToItsRimAndNoFurther) {
  const std::string lots = "[insertion]\nkind = \"batches\"\ncount = 60\nbatch = 12\n";
  const std::string box = "[vessel]\nkind = \"box\"\nsize = [\"8 mm\", \"8 mm\", \"10 mm\"]\n";
  const std::string tube = "[vessel]\nkind = \"cylinder\"\nradius = \"5 mm\"\nheight = \"10 mm\"\n";
  for (const std::string& vessel : {box, tube}) {
    PackingRun run(write(vessel + commonText + spheres + lots));
    const auto out = makeFolder("out");
    ASSERT_EQ(run.run(out, never), RunEnd::rested);
    const Bodies& bodies = run.world().bodies;
    // Spheres fill about half of a narrow vessel: some 20 of them.
    EXPECT_GT(bodies.size(), 10u);
    EXPECT_LT(bodies.size(), 40u);
    for (std::size_t i = 0; i < bodies.size(); ++i) EXPECT_LE(bodies.x(i).z() + 1.5e-3, 10.1e-3);
    const RunResult result = writeReport(run, RunEnd::rested, 1, out);
    ASSERT_FALSE(result.notes.empty());
    expectMentions(result.notes.front(), {"full", "of 60 particles", "rim at 0.01 m"});
  }
}

TEST_F(VesselOfARun, TooLowForAnyParticleIsRefused) {
  const std::string vessel = "[vessel]\nkind = \"cylinder\"\nradius = \"8 mm\"\nheight = \"2 mm\"\n";
  PackingRun run(write(vessel + commonText + spheres + pour));
  try {
    run.run(makeFolder("out"), never);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    expectMentions(error.what(), {"scene.toml", "no particle fits", "0.002 m"});
  }
}

TEST_F(VesselOfARun, RefusesPosesAboveItsRim) {
  std::ofstream(folder / "poses.txt") << "0 0 2e-3 1 0 0 0\n0 0 9e-3 1 0 0 0\n";
  const std::string poses = "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
  const std::string vessel = "[vessel]\nkind = \"cylinder\"\nradius = \"8 mm\"\nheight = \"10 mm\"\n";
  expectMentions(complaintOf(vessel + commonText + spheres + poses), {"poses.txt", "particle 1", "rim at 0.01 m"});
}

}  // namespace
}  // namespace granular
