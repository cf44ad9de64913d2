// result.json tells two runs with the same bodies, to the bit, from two that differ.
#include "granular/io/state_hash.h"

#include <omp.h>

#include <nlohmann/json.hpp>

#include "granular/run/packing_report.h"
#include "run/scene_texts.h"

namespace granular {
namespace {

class StateHashOfRuns : public RunTest {
 protected:
  std::string hashOf(const std::vector<std::string>& overrides, int threads) {
    omp_set_num_threads(threads);
    std::vector<std::string> all{"insertion.count=20", "time.max_time=0.06"};
    all.insert(all.end(), overrides.begin(), overrides.end());
    PackingRun run(write(narrowBox + commonText + mixture + "[insertion]\nkind = \"batches\"\ncount = 20\n", all));
    const auto out = makeFolder("out" + std::to_string(++runs));
    const RunEnd end = run.run(out, never);
    const RunResult result = writeReport(run, end, threads, out);
    omp_set_num_threads(omp_get_num_procs());
    EXPECT_EQ(result.stateHash, hashState(run.world().bodies));
    std::ifstream file(out / "result.json");
    return nlohmann::json::parse(file).at("state_hash");
  }
  int runs = 0;
};

TEST_F(StateHashOfRuns, IsThatOfTheSeedAndNotOfTheNumberOfThreads) {
  const std::string reference = hashOf({}, 1);
  EXPECT_EQ(reference.size(), 64u);
  EXPECT_EQ(hashOf({}, 2), reference);
  EXPECT_EQ(hashOf({}, 4), reference);
  EXPECT_NE(hashOf({"seed=2"}, 1), reference);
}

}  // namespace
}  // namespace granular
