// The demo `collisions` from outside, and the study behind it.
#include <gtest/gtest.h>
#include <omp.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "granular/core/errors.h"
#include "granular/run/collision_report.h"
#include "io/scratch_folder.h"
#include "run/demo_outcome.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

class CollisionsDemo : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    if (!fs::exists(GRANULAR_COLLISIONS)) GTEST_SKIP() << GRANULAR_COLLISIONS << " is not built";
  }
  static DemoOutcome run(const std::string& arguments) { return runDemo(GRANULAR_COLLISIONS, arguments); }
  static void expectRefusal(const std::string& arguments, const std::vector<std::string>& words) {
    const DemoOutcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 1) << arguments;
    for (const std::string& word : words) EXPECT_NE(outcome.text.find(word), std::string::npos) << outcome.text;
  }
};

TEST_F(CollisionsDemo, BadInputIsRefusedWithTheValueAndWhatIsAllowed) {
  expectRefusal("--pair cube-cone", {"cube-cone", "cube-sphere"});
  expectRefusal("--pair cube-cube --law hooke", {"hooke", "tensor"});
  expectRefusal("--pair cube-cube --rule corner", {"corner", "witness"});
  expectRefusal("--pair cube-cube --ensemble calm", {"calm", "thermal"});
  expectRefusal("--pair cube-cube --samples 0", {"samples", "0", "at least 1"});
  expectRefusal("--pair cube-cube --steps-per-contact 3", {"steps per contact", "3", "at least 4"});
  expectRefusal("--pair cube-cube --dt -1", {"dt", "-1", "> 0"});
  expectRefusal("--pair cube-cube --dt 1", {"steps per contact", "at least 4"});
  expectRefusal("--pair cube-cube --kn 0", {"stiffness", "0", "> 0"});
  expectRefusal("--pair cube-cube --speed -2", {"speed", "-2", "> 0"});
  expectRefusal("--pair sphere-sphere --samples 1 --json /absent/folder/out.json", {"/absent/folder"});
}

TEST_F(CollisionsDemo, WritesWhatItFoundUnderStableKeys) {
  const std::string file = (folder / "out.json").string();
  const DemoOutcome outcome =
      run("--pair sphere-cube --samples 50 --rule witness --law tensor --steps-per-contact 100 --json " + file);
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  std::ifstream in(file);
  const nlohmann::json json = nlohmann::json::parse(in);
  EXPECT_EQ(json.at("pair"), "cube-sphere");
  EXPECT_EQ(json.at("samples"), 50);
  EXPECT_EQ(json.at("unfinished"), 0);
  EXPECT_EQ(json.at("uncertified"), 0);
  EXPECT_LT(json.at("residual_spring_energy_percent").get<double>(), 0.1);
  EXPECT_LT(json.at("total_energy_error_percent").get<double>(), 0.1);
  EXPECT_LT(json.at("angular_momentum_error").get<double>(), 1e-6);
}

TEST_F(CollisionsDemo, SeveralStudiesBecomeRows) {
  const std::string json = (folder / "out.json").string(), csv = (folder / "out.csv").string();
  ASSERT_EQ(run("--pair all --samples 3 --law linear,tensor --json " + json + " --csv " + csv).code, 0);
  std::ifstream in(json), table(csv);
  EXPECT_EQ(nlohmann::json::parse(in).at("rows").size(), 16u);
  int lines = 0;
  for (std::string line; std::getline(table, line);) ++lines;
  EXPECT_EQ(lines, 17);
}

TEST(Collisions, DoNotDependOnTheNumberOfThreads) {
  CollisionOptions options;
  options.ensemble = findEnsemble("gaussian");
  options.samples = 20;
  std::vector<double> left;
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    left.push_back(studyCollisions(findColliderKind("cube"), findColliderKind("cube"), options).residual.mean);
  }
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_EQ(left[0], left[1]);
  EXPECT_EQ(left[0], left[2]);
}

}  // namespace
}  // namespace granular
