// The demo from outside: exit codes and messages.
#include "granular/core/sanitizer.h"
#include "run/demo_outcome.h"
#include "run/scene_texts.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

class PackingDemo : public RunTest {
 protected:
  void SetUp() override {
    RunTest::SetUp();
    if (!fs::exists(GRANULAR_PACKING)) GTEST_SKIP() << GRANULAR_PACKING << " is not built";
  }

  using Outcome = DemoOutcome;
  static Outcome run(const std::string& arguments) { return runDemo(GRANULAR_PACKING, arguments); }
  const std::string pour = "[insertion]\nkind = \"batches\"\ncount = 8\n";
};

TEST_F(PackingDemo, EverySceneShippedIsAccepted) {
  int scenes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(std::string(GRANULAR_SOURCE_DIR) + "/demos/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    ++scenes;
    const Outcome outcome = run(entry.path().string() + " --dry-run");
    EXPECT_EQ(outcome.code, 0) << entry.path() << "\n" << outcome.text;
    expectMentions(outcome.text, {"particles:", "time step:", "skips:"});
  }
  EXPECT_GT(scenes, 0);
}

TEST_F(PackingDemo, DocumentHoldsTheKeysAsPrinted) {
  const Outcome reference = run("--help-scene");
  ASSERT_EQ(reference.code, 0);
  std::ifstream file(std::string(GRANULAR_SOURCE_DIR) + "/docs/scenes.md");
  const std::string document{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(document.find(reference.text), std::string::npos)
      << "docs/scenes.md is behind: put the output of packing --help-scene in again";
}

TEST_F(PackingDemo, BadInputExitsWithOneAndTheMessage) {
  const Outcome missing = run("absent.toml --dry-run");
  EXPECT_EQ(missing.code, 1);
  expectMentions(missing.text, {"absent.toml", "can't be read"});
  std::ofstream(folder / "plain") << "x";
  const std::string scene = write(narrowBox + commonText + spheres + pour).file.string();
  const Outcome unwritable = run(scene + " --out " + (folder / "plain" / "out").string());
  EXPECT_EQ(unwritable.code, 1);
  expectMentions(unwritable.text, {"plain/out", "output folder"});
  EXPECT_EQ(run(scene).code, 1) << "--out is missing";
}

TEST_F(PackingDemo, ExitCodesTellRestFromTimeAndTrouble) {
  const std::string scene = write(narrowBox + commonText + spheres + pour).file.string();
  const std::string out = (folder / "out").string();
  const std::string arguments = scene + " --out " + out + " --threads 1 --set ";
  EXPECT_EQ(run(arguments + "time.max_time=0.01").code, 3);
  // Taken up again with more time it comes to rest.
  const Outcome rested = run("--resume " + out + " --threads 1 --set time.max_time=10");
  EXPECT_EQ(rested.code, 0) << rested.text;
  EXPECT_TRUE(fs::exists(folder / "out" / "result.json"));
  const Outcome trouble = run(arguments + "limits.max_overlap=1e-4");
  EXPECT_EQ(trouble.code, 4);
  expectMentions(trouble.text, {"trouble", "overlap"});
  const Outcome refused = run("--resume " + out + " --seed 7");
  EXPECT_EQ(refused.code, 1);
  expectMentions(refused.text, {"seed=7", "resumed"});
}

TEST_F(PackingDemo, InterruptedExitsWithFiveAndGoesOnToRest) {
  const std::string scene = write(narrowBox + commonText + spheres + pour).file.string();
  const std::string out = (folder / "out").string();
  // The folder of frames appears when the run begins.
  const std::string start = std::string(GRANULAR_PACKING) + " " + scene + " --out " + out + " --threads 1 & run=$!; ";
  const std::string wait = "while kill -0 $run && ! test -d " + out + "/frames; do sleep 0.01; done; ";
  const Outcome stopped = runDemo("sh", "-c '" + start + wait + "kill -TERM $run; wait $run'");
  EXPECT_EQ(stopped.code, 5) << stopped.text;
  expectMentions(stopped.text, {"interrupted at t =", "--resume " + out});
  EXPECT_FALSE(fs::exists(folder / "out" / "result.json"));
  const Outcome rested = run("--resume " + out + " --threads 1");
  EXPECT_EQ(rested.code, 0) << rested.text;
}

TEST_F(PackingDemo, DamagedCheckpointNamesTheOneBeforeWhichLeadsToTheSameEnd) {
  const std::string scene =
      write(narrowBox + commonText + "checkpoint_interval = \"10 ms\"\n" + spheres + pour).file.string();
  const fs::path out = folder / "out";
  ASSERT_EQ(run(scene + " --out " + out.string() + " --threads 1").code, 0);
  const auto read = [](const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string particles = read(out / "particles.csv");
  std::string whole = read(out / "checkpoint.h5");

  // Each part in turn: the first block, HDF5's own, the data.
  for (const std::size_t at : {std::size_t{3}, std::size_t{30}, std::size_t{520}, whole.size() / 2}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    std::ofstream(out / "checkpoint.h5", std::ios::binary) << damaged;
    const Outcome refused = run("--resume " + out.string());
    EXPECT_EQ(refused.code, 1);
    expectMentions(refused.text, {"checkpoint.h5", "can't be used", "checkpoint_previous.h5"});
  }
  fs::remove(out / "particles.csv");
  const Outcome rested = run("--resume " + (out / "checkpoint_previous.h5").string() + " --threads 2");
  EXPECT_EQ(rested.code, 0) << rested.text;
  EXPECT_EQ(read(out / "particles.csv"), particles);
}

TEST_F(PackingDemo, FilesThatMayNotGrowEndTheRunWithTheReasonAndLeaveTheLastCheckpoint) {
  if (threadSanitizer) GTEST_SKIP() << "the sanitizer of threads needs files to grow";
  const std::string scene = write(narrowBox + commonText + spheres + pour).file.string();
  const fs::path out = folder / "out";
  ASSERT_EQ(run(scene + " --out " + out.string() + " --threads 1 --set time.max_time=0.01").code, 3);
  // In units of 512 bytes: less than a checkpoint.
  const Outcome full = runDemo("sh", "-c 'ulimit -f 40; " + std::string(GRANULAR_PACKING) + " --resume " +
                                         out.string() + " --set time.max_time=0.02'");
  EXPECT_EQ(full.code, 1) << full.text;
  expectMentions(full.text, {"checkpoint.h5", "can't be written", "File too large", "the one before stands"});
  EXPECT_EQ(run("--resume " + out.string() + " --threads 1 --set time.max_time=10").code, 0);
}

}  // namespace
}  // namespace granular
