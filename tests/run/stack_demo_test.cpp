// The demo stack from outside: interrupted, and gone on with.
#include "run/demo_outcome.h"
#include "run/scene_texts.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

class StackDemo : public RunTest {
 protected:
  void SetUp() override {
    RunTest::SetUp();
    if (!fs::exists(GRANULAR_STACK)) GTEST_SKIP() << GRANULAR_STACK << " is not built";
  }
  static DemoOutcome run(const std::string& arguments) { return runDemo(GRANULAR_STACK, arguments); }
  static std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }
};

TEST_F(StackDemo, InterruptedExitsWithFiveAndGoesOnToTheSameSamples) {
  const std::string tower = " --count 8 --time 0.1 --perturb 1e-3 --skip --out ";
  const fs::path whole = folder / "whole", parts = folder / "parts";
  ASSERT_EQ(run(tower + whole.string()).code, 0);
  // The first checkpoint comes with the first sample.
  const std::string start =
      std::string(GRANULAR_STACK) + tower + parts.string() + " --checkpoint-every 1e-9 & run=$!; ";
  const std::string wait = "while kill -0 $run && ! test -f " + (parts / "checkpoint.h5").string() + "; do :; done; ";
  const DemoOutcome stopped = runDemo("sh", "-c '" + start + wait + "kill -TERM $run; wait $run'");
  EXPECT_EQ(stopped.code, 5) << stopped.text;
  expectMentions(stopped.text, {"interrupted at t =", "--resume " + parts.string()});
  EXPECT_FALSE(fs::exists(parts / "samples.csv"));
  const DemoOutcome done = run("--resume " + parts.string() + " --out " + parts.string());
  EXPECT_EQ(done.code, 0) << done.text;
  EXPECT_EQ(read(parts / "samples.csv"), read(whole / "samples.csv"));
  EXPECT_EQ(read(parts / "poses.csv"), read(whole / "poses.csv"));
}

TEST_F(StackDemo, RefusesToMakeAResumedTowerAnother) {
  const DemoOutcome other = run("--resume " + folder.string() + " --count 3");
  EXPECT_EQ(other.code, 1);
  expectMentions(other.text, {"--count", "can't be given with --resume"});
  const DemoOutcome none = run("--resume " + folder.string());
  EXPECT_EQ(none.code, 1);
  expectMentions(none.text, {"no such checkpoint"});
  const DemoOutcome bullet = run("--engine bullet --dt 1e-3 --checkpoints " + folder.string());
  EXPECT_EQ(bullet.code, 1);
  expectMentions(bullet.text, {"--checkpoints", "Bullet"});
}

}  // namespace
}  // namespace granular
