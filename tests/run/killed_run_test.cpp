// Runs killed without warning at any moment, taken up again from what lies on the disk, end in the same bits as one
// that nobody disturbed. GRANULAR_KILLS, GRANULAR_PARTICLES and GRANULAR_ROCKS make it as long as one likes
// (docs/robustness.md).
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "granular/core/random.h"
#include "granular/io/checkpoint.h"
#include "run/demo_outcome.h"
#include "run/scene_texts.h"

extern char** environ;

namespace granular {
namespace {

namespace fs = std::filesystem;

int numberFromEnvironment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
}

class KilledRun : public RunTest {
 protected:
  /// Few of them, all quickly made: most of a short run is its start.
  const std::string rubble = R"(
[[particles]]
shape = "sphere"
radius = "1.5 mm"
share = 0.3
[[particles]]
shape = "cuboid"
half_lengths = ["1.2 mm", "1.2 mm", "1.5 mm"]
share = 0.4
[[particles]]
shape = "cylinder"
radius = "1.2 mm"
height = "2.6 mm"
share = 0.3
)";
  /// Every one its own.
  const std::string rocks = R"(
[[particles]]
shape = "sand"
template = "ellipsoid"
aspect = 1.5
radius = "1.5 mm"
vertex_count = [8, 20]
)";

  void SetUp() override {
    RunTest::SetUp();
    if (!fs::exists(GRANULAR_PACKING)) GTEST_SKIP() << GRANULAR_PACKING << " is not built";
  }

  /// Starts the demo, silent.
  static pid_t start(const std::string& program, const std::vector<std::string>& words) {
    std::vector<char*> arguments{const_cast<char*>(program.c_str())};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const int stream : {1, 2}) posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    pid_t process = 0;
    const int failed = posix_spawn(&process, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    return failed == 0 ? process : -1;
  }

  /// Kills the process after so many seconds of its life, unless it ends before. True if it was killed.
  static bool killAfter(pid_t process, double seconds, int& code) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    int status = 0;
    while (std::chrono::steady_clock::now() < end) {
      if (waitpid(process, &status, WNOHANG) == process) {
        code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        return false;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    kill(process, SIGKILL);
    waitpid(process, &status, 0);
    return true;
  }

  static std::string read(const fs::path& path) {
    std::ostringstream out;
    out << std::ifstream(path, std::ios::binary).rdbuf();
    return out.str();
  }

  /// Everything of a finished run's checkpoint but the time it took.
  static std::map<std::string, DataSet> stateIn(const fs::path& out) {
    std::map<std::string, DataSet> state = loadCheckpoint(out).content();
    for (const char* clock : {"run/wall", "world/report/stage_seconds"}) EXPECT_EQ(state.erase(clock), 1u) << clock;
    return state;
  }
};

TEST_F(KilledRun, PackingEndsInTheSameBitsHoweverOftenItIsKilled) {
  const int kills = numberFromEnvironment("GRANULAR_KILLS", 6);
  const int particles = numberFromEnvironment("GRANULAR_PARTICLES", 16);
  const bool onlyRocks = numberFromEnvironment("GRANULAR_ROCKS", 0) != 0;
  // A wider vessel for more of them; checkpoints often, so that many a kill meets one.
  const double width = std::max(15.0, 2.2 * std::cbrt(particles) * 3);
  const std::string text =
      fmt::format("[vessel]\nkind = \"box\"\nsize = [\"{0} mm\", \"{0} mm\", \"{1} mm\"]\n", width, 10 * width) +
      commonText + "checkpoint_interval = \"2 ms\"\nframes = \"20 ms\"\n" + (onlyRocks ? rocks : rubble) +
      fmt::format("[insertion]\nkind = \"batches\"\ncount = {}\nbatch = {}\n[settle]\nkind = \"sleep\"\n", particles,
                  std::max(8, particles / 8));
  const std::string scene = write(text).file.string();
  const fs::path whole = folder / "whole", parts = folder / "parts";

  const auto began = std::chrono::steady_clock::now();
  int code = -1;
  ASSERT_FALSE(killAfter(start(GRANULAR_PACKING, {scene, "--out", whole.string(), "--threads", "1"}), 1e6, code));
  ASSERT_EQ(code, 0);
  const std::chrono::duration<double> length = std::chrono::steady_clock::now() - began;

  // Each part may run for up to twice its share of the time that the whole took; it may be killed before its first
  // checkpoint, in the middle of one, or while it reads the last.
  Random random(static_cast<std::uint64_t>(numberFromEnvironment("GRANULAR_KILL_SEED", 1)));
  int killed = 0, resumed = 0;
  bool running = true;
  while (running && killed < kills) {
    const bool hasCheckpoint = fs::exists(parts / "checkpoint.h5");
    // Another number of threads each time.
    std::vector<std::string> words{"--threads", std::to_string(1 + killed % 2)};
    const std::vector<std::string> fresh{scene, "--out", parts.string()}, again{"--resume", parts.string()};
    words.insert(words.begin(), hasCheckpoint ? again.begin() : fresh.begin(),
                 hasCheckpoint ? again.end() : fresh.end());
    resumed += hasCheckpoint;
    running = killAfter(start(GRANULAR_PACKING, words), random.uniform(0, 2 * length.count() / kills), code);
    killed += running;
  }
  RecordProperty("killed", killed);
  RecordProperty("resumed", resumed);
  if (running) {
    const std::vector<std::string> last = fs::exists(parts / "checkpoint.h5")
                                              ? std::vector<std::string>{"--resume", parts.string()}
                                              : std::vector<std::string>{scene, "--out", parts.string()};
    ASSERT_FALSE(killAfter(start(GRANULAR_PACKING, last), 1e6, code));
  }
  ASSERT_EQ(code, 0) << "after " << killed << " kills";
  EXPECT_GT(killed, 0);

  EXPECT_EQ(read(whole / "particles.csv"), read(parts / "particles.csv"));
  EXPECT_EQ(read(whole / "contacts.csv"), read(parts / "contacts.csv"));
  EXPECT_EQ(read(whole / "frames" / "particles.pvd"), read(parts / "frames" / "particles.pvd"));
  const auto a = stateIn(whole), b = stateIn(parts);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, set] : a) {
    if (name == "scene/overrides") continue;  // how many threads there were last
    ASSERT_TRUE(b.contains(name)) << name;
    EXPECT_TRUE(set.bytes == b.at(name).bytes) << name << " differs after " << killed << " kills";
  }
}

}  // namespace
}  // namespace granular
