// Random pairs of hard shapes in hard poses against the exhaustive search, by the million: every kind with every kind,
// every contact-point rule. Measures; prints each pair that is wrong so that `--first K --pairs 1` shows it again.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "demos/exit_code.h"
#include "granular/core/errors.h"
#include "stress/pair_trial.h"

namespace {

using namespace granular;
using namespace granular::stress;

struct Settings {
  std::uint64_t seed = 1, first = 0, pairs = 100000, oracleEvery = 1;
  int corners = 2000;
  std::string json;
};

struct Sums {
  std::uint64_t touching = 0, wrong = 0, asked = 0;
  std::array<std::uint64_t, 7> ruleWrong{};
  NarrowCounts counts;
  double coldWorst = 0, warmWorst = 0, slowest = 0;
};

void tell(const Settings& settings, const PairSample& pair, std::uint64_t k, const std::string& fault) {
  std::printf("seed %llu pair %llu: %s: %s\n", static_cast<unsigned long long>(settings.seed),
              static_cast<unsigned long long>(k), pair.describe().c_str(), fault.c_str());
  std::fflush(stdout);
}

Sums run(const Settings& settings) {
  HardShapes shapes(settings.corners);
  Sums sums;
  for (std::uint64_t k = settings.first; k < settings.first + settings.pairs; ++k) {
    const PairSample pair = drawPair(shapes, settings.seed, k);
    const bool oracle = k % settings.oracleEvery == 0;
    const TrialOutcome out = tryPair(pair, settings.seed, k, oracle);
    sums.touching += out.touches;
    sums.asked += oracle;
    sums.counts += out.counts;
    sums.coldWorst = std::max(sums.coldWorst, out.coldExcess);
    sums.warmWorst = std::max(sums.warmWorst, out.warmExcess);
    if (out.slowest > sums.slowest) {
      sums.slowest = out.slowest;
      if (out.slowest > 0.05) tell(settings, pair, k, quote("a look took, s,", out.slowest));
    }
    if (!out.fault.empty()) {
      ++sums.wrong;
      tell(settings, pair, k, out.fault);
    }
    for (std::size_t rule = 0; rule < out.ruleFaults.size(); ++rule) {
      if (out.ruleFaults[rule].empty()) continue;
      ++sums.ruleWrong[rule];
      tell(settings, pair, k, std::string(pointRuleName(static_cast<PointRule>(rule))) + ": " + out.ruleFaults[rule]);
    }
  }
  return sums;
}

nlohmann::json describe(const Settings& settings, const Sums& sums, double seconds) {
  nlohmann::json json;
  json["seed"] = settings.seed;
  json["first"] = settings.first;
  json["pairs"] = settings.pairs;
  json["compared_with_the_oracle"] = sums.asked;
  json["touching"] = sums.touching;
  json["wrong"] = sums.wrong;
  json["worst_excess_over_size"] = {{"cold", sums.coldWorst}, {"warm", sums.warmWorst}};
  json["slowest_look_s"] = sums.slowest;
  for (std::size_t rule = 0; rule < sums.ruleWrong.size(); ++rule)
    json["rule_wrong"][std::string(pointRuleName(static_cast<PointRule>(rule)))] = sums.ruleWrong[rule];
  json["certificate"] = {{"cold", sums.counts.cold},           {"searches", sums.counts.searches},
                         {"warm", sums.counts.warm},           {"uncertified", sums.counts.uncertified},
                         {"fallbacks", sums.counts.fallbacks}, {"missed", sums.counts.missed},
                         {"coarse", sums.counts.coarse}};
  json["processor_s"] = seconds;
  json["pairs_per_s"] = static_cast<double>(settings.pairs) / seconds;
  return json;
}

constexpr int exitWrong = 3;

int parseAndRun(int argc, char** argv) {
  Settings settings;
  CLI::App app{
      "Random pairs of hard shapes against the exhaustive search. Exit codes: 0 all right; 1 bad input; "
      "2 a problem of the program; 3 some are wrong."};
  app.add_option("--seed", settings.seed, "of the samples");
  app.add_option("--first", settings.first, "number of the first sample");
  app.add_option("--pairs", settings.pairs, "how many");
  app.add_option("--oracle-every", settings.oracleEvery, "compare every n-th pair with the exhaustive search")
      ->check(CLI::PositiveNumber);
  app.add_option("--corners", settings.corners, "of the largest hulls; 0: without them");
  app.add_option("--json", settings.json, "write the figures here too");
  CLI11_PARSE(app, argc, argv);
  const double began = threadTime();
  const Sums sums = run(settings);
  const double seconds = threadTime() - began;
  const nlohmann::json json = describe(settings, sums, seconds);
  std::printf("%s\n", json.dump(2).c_str());
  if (!settings.json.empty()) std::ofstream(settings.json) << json.dump(2) << "\n";
  std::uint64_t wrong = sums.wrong;
  for (const std::uint64_t each : sums.ruleWrong) wrong += each;
  return wrong == 0 ? 0 : exitWrong;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("random_pairs", [&] { return parseAndRun(argc, argv); });
}
