// What it means that a run goes on to the same bits, for tests of resuming.
#pragma once

#include <gtest/gtest.h>
#include <omp.h>

#include <map>

#include "granular/run/world_archive.h"
#include "run/scene_texts.h"

namespace granular {

/// Everything of the world that goes into a checkpoint, but the time it took.
inline std::map<std::string, DataSet> stateOf(PackingRun& run) {
  Archive archive;
  describe(archive, run.world());
  std::map<std::string, DataSet> state = archive.content();
  state.erase("report/stage_seconds");
  return state;
}

inline void expectSameState(PackingRun& a, PackingRun& b) {
  const auto first = stateOf(a), second = stateOf(b);
  ASSERT_EQ(first.size(), second.size());
  for (const auto& [name, set] : first) {
    ASSERT_TRUE(second.contains(name)) << name;
    EXPECT_TRUE(set.bytes == second.at(name).bytes) << name << " differs";
  }
  EXPECT_EQ(a.progress().calm, b.progress().calm);
  EXPECT_EQ(a.progress().pouredAt, b.progress().pouredAt);
  EXPECT_EQ(a.progress().smallestBound, b.progress().smallestBound);
  EXPECT_EQ(a.inserter().state().postponed, b.inserter().state().postponed);
  EXPECT_EQ(a.inserter().state().attempts, b.inserter().state().attempts);
}

class ResumeTest : public RunTest {
 protected:
  /// Runs a scene on one thread to a given time, once whole and once with a stop on the way, from which it is resumed
  /// with another number of threads; compares the ends.
  void expectSameAt(double end, double stop, const std::string& text, const std::vector<std::string>& overrides = {}) {
    const auto until = [](double time) { return fmt::format("time.max_time={}", time); };
    const SceneSource source = write(text, overrides);
    SceneSource full = source, shortened = source;
    full.overrides.push_back(until(end));
    shortened.overrides.push_back(until(stop));
    PackingRun whole(full);
    ASSERT_EQ(whole.run(makeFolder("whole"), never), RunEnd::outOfTime);
    EXPECT_GT(whole.world().contactCount(), 0u);
    const auto out = makeFolder("parts");
    EXPECT_EQ(PackingRun(shortened).run(out, never), RunEnd::outOfTime);
    omp_set_num_threads(2);
    PackingRun last = PackingRun::resumed(out, {until(end)});
    EXPECT_EQ(last.run(out, never), RunEnd::outOfTime);
    omp_set_num_threads(1);
    expectSameState(whole, last);
  }

  static std::string settle(const std::string& kind) { return "[settle]\nkind = \"" + kind + "\"\n"; }
  const std::string few = "[insertion]\nkind = \"batches\"\ncount = 10\nbatch = 10\n";
};

}  // namespace granular
