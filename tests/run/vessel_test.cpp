// What a scene's vessel means to the run and to its analysis.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace granular
