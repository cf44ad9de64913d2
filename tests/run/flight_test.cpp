// A packing in which bodies that meet nobody fly, against the same packing step by step.
#include "run/resume_fixture.h"

namespace granular {
namespace {

class FlightOfRun : public ResumeTest {
 protected:
  /// Rain onto a wide floor, from high enough to meet nobody for a while.
  const std::string text = "[vessel]\nkind = \"cylinder\"\nradius = \"30 mm\"\n" + commonText + mixture +
                           "[insertion]\nkind = \"rain\"\ncount = 24\nrate = \"200 1/s\"\nheight = \"4 mm\"\n" +
                           settle("none");
  const std::string stiff = "contact_default.stiffness=5000 N/m";
};

TEST_F(FlightOfRun, EndsInTheSameBitsAsStepByStep) {
  const std::string end = "time.max_time=0.2";
  PackingRun flying(write(text, {"threads=1", stiff, end}));
  PackingRun stepped(write(text, {"threads=1", stiff, end, R"(skip=["broad_phase", "gjk", "epa", "orientation"])"}));
  ASSERT_EQ(flying.run(makeFolder("flying"), never), RunEnd::outOfTime);
  ASSERT_EQ(stepped.run(makeFolder("stepped"), never), RunEnd::outOfTime);
  expectSameState(flying, stepped);
  EXPECT_GT(flying.world().report.contactSteps, 1000u);
  EXPECT_GT(flying.world().aloft.bodySteps, 1000u);
  EXPECT_EQ(stepped.world().aloft.bodySteps, 0u);
}

TEST_F(FlightOfRun, GoesOnToTheSameBitsWhenItWasStopped) { expectSameAt(0.2, 0.0213, text, {"threads=1", stiff}); }

}  // namespace
}  // namespace granular
