// Whole steps of dense scenes: particle-steps per second, time per contact, the share of each stage, memory, and the
// contact certificate beside them. Measures; asserts nothing.
#include <omp.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "demos/exit_code.h"
#include "dense_beds.h"
#include "granular/core/errors.h"
#include "granular/core/instruction_set.h"
#include "heap_count.h"

namespace {

using namespace granular;
using namespace granular::benchmarks;

struct Settings {
  BedSettings bed;
  std::string poses;  ///< file of packed cubes
  std::string rule = "patch";
  std::string law = "linear";
  std::vector<std::string> skip = {"all"};
  std::string json, csv;
  int threads = 1;
  int relax = 2000;  ///< steps before the clock starts
  int steps = 1000;  ///< steps of each repeat
  int repeats = 3;   ///< of which the fastest counts
  double dt = 2e-6;  ///< s
};

/// The processor time of this process where one thread works, so that other work on the machine counts little;
/// otherwise the time that passed. s.
double readClock(const Settings& settings) {
  if (settings.threads > 1) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One repeat of the timed steps.
struct Timed {
  double seconds = 0;
  double contactSteps = 0;                                   ///< contacts summed over the steps
  std::uint64_t searches = 0;                                ///< steps that refreshed the pairs
  std::uint64_t allocations = 0, allocationsOfSearches = 0;  ///< of steps that did not, and of those that did
  Report report;
};

Timed timeSteps(const Settings& settings, World& world) {
  Timed timed;
  world.report = Report{};
  const double began = readClock(settings);
  for (int k = 0; k < settings.steps; ++k) {
    const std::uint64_t searches = world.search.refreshes, before = allocationCount();
    step(world, settings.dt);
    const bool searched = world.search.refreshes != searches;
    timed.searches += searched;
    (searched ? timed.allocationsOfSearches : timed.allocations) += allocationCount() - before;
  }
  land(world);
  timed.seconds = readClock(settings) - began;
  timed.report = world.report;
  timed.contactSteps = static_cast<double>(world.report.contactSteps);
  return timed;
}

nlohmann::ordered_json describe(const Settings& settings, const World& world, const Timed& best,
                                std::vector<double> all, double bytes) {
  const Report& r = best.report;
  const auto steps = static_cast<double>(settings.steps);
  const auto particles = static_cast<double>(world.bodies.size());
  std::sort(all.begin(), all.end());
  nlohmann::ordered_json json;
  json["scene"] = settings.bed.scene;
  json["particles"] = world.bodies.size();
  json["threads"] = settings.threads;
  json["instruction_set"] = instructionSet();
  json["rule"] = settings.rule;
  json["law"] = settings.law;
  json["skip"] = settings.skip;
  json["batches"] = !settings.bed.options.noBatches;
  json["dt_s"] = settings.dt;
  json["steps"] = settings.steps;
  json["clock"] = settings.threads > 1 ? "wall" : "processor";
  json["seconds"] = best.seconds;
  json["slowest_over_fastest"] = all.back() / all.front();
  json["particle_steps_per_s"] = particles * steps / best.seconds;
  json["moving"] = static_cast<double>(r.bodySteps) / steps;
  json["contacts"] = best.contactSteps / steps;
  json["us_per_contact"] = best.contactSteps > 0 ? 1e6 * best.seconds / best.contactSteps : 0;
  json["pairs"] = world.pairs.pairs.size();
  json["searches"] = best.searches;
  double sum = 0;
  for (const double each : r.seconds) sum += each;
  for (int k = 0; k < stageCount; ++k) {
    json["stages"][std::string(stageName(static_cast<Stage>(k)))] = r.seconds[static_cast<std::size_t>(k)] / sum;
  }
  json["bytes_per_particle"] = bytes / particles;
  const double plain = steps - static_cast<double>(best.searches);
  json["allocations_per_step"] = plain > 0 ? static_cast<double>(best.allocations) / plain : 0;
  json["allocations_per_search"] =
      best.searches > 0 ? static_cast<double>(best.allocationsOfSearches) / static_cast<double>(best.searches) : 0;
  json["certificate"] = {{"cold", r.narrow.cold},           {"searches", r.narrow.searches},
                         {"warm", r.narrow.warm},           {"uncertified", r.narrow.uncertified},
                         {"fallbacks", r.narrow.fallbacks}, {"normal_flips", r.narrow.normalFlips},
                         {"coarse", r.narrow.coarse}};
  json["max_overlap_over_size"] = r.deepestOverlap;
  json["kinetic_energy_j"] = kineticEnergy(world.bodies);
  if (settings.bed.options.energy) json["ledger_residual_relative"] = world.ledger.relativeResidual();
  return json;
}

/// Appends the flat entries as a line; nested ones as name.part. A new file begins with their names.
void appendCsv(const nlohmann::ordered_json& json, const std::string& path) {
  const bool isNew = !std::ifstream(path).good();
  std::string names, values;
  const auto add = [&](const std::string& name, const nlohmann::ordered_json& value) {
    names += (names.empty() ? "" : ",") + name;
    values += (values.empty() ? "" : ",") + (value.is_string() ? value.get<std::string>() : value.dump());
  };
  for (const auto& [name, value] : json.items()) {
    if (!value.is_object()) add(name, value);
    if (!value.is_object()) continue;
    for (const auto& [part, each] : value.items()) add(name + "." + part, each);
  }
  std::ofstream file(path, std::ios::app);
  if (isNew) file << names << "\n";
  file << values << "\n";
  require(file.good(), "can't write " + path);
}

void run(Settings& settings) {
  omp_set_num_threads(settings.threads);
  WorldOptions& options = settings.bed.options;
  options.rule.rule = pointRuleFromName(settings.rule);
  options.law = lawFromName(settings.law);
  const auto skips = [&](const char* name) {
    return std::ranges::count(settings.skip, "all") + std::ranges::count(settings.skip, name) > 0;
  };
  options.skips = {skips("broad_phase"), skips("gjk"), skips("epa"), skips("orientation"), skips("flight")};
  options.keepSlots = !skips("scatter");
  if (!settings.poses.empty()) settings.bed.scene = "cubes";
  const std::size_t before = heapBytes();
  const std::unique_ptr<World> world =
      settings.poses.empty() ? makeBed(settings.bed) : loadCubes(settings.poses, options);

  // Relax, then time; the fastest repeat counts.
  startHalfSteps(*world, settings.dt, 0,
                 settings.bed.scene != "hopper" && !settings.bed.scene.starts_with("free_fall"));
  for (int k = 0; k < settings.relax; ++k) step(*world, settings.dt);
  Timed best;
  std::vector<double> seconds;
  for (int k = 0; k < settings.repeats; ++k) {
    const Timed timed = timeSteps(settings, *world);
    if (k == 0 || timed.seconds < best.seconds) best = timed;
    seconds.push_back(timed.seconds);
  }
  const auto json = describe(settings, *world, best, seconds, static_cast<double>(heapBytes() - before));
  std::printf("%s\n", json.dump(2).c_str());
  if (!settings.json.empty()) std::ofstream(settings.json) << json.dump(2) << "\n";
  if (!settings.csv.empty()) appendCsv(json, settings.csv);
}

int parseAndRun(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Times whole steps of dense scenes."};
  app.add_option("--scene", settings.bed.scene, "what moves")->check(CLI::IsMember(bedScenes()));
  app.add_option("--count", settings.bed.count, "bodies; large beds repeat a patch, and round this")
      ->check(CLI::PositiveNumber);
  app.add_option("--poses", settings.poses, "cubes from a file instead: a comment, '# n base side', then poses");
  app.add_option("--seed", settings.bed.seed, "of the bed");
  app.add_option("--rule", settings.rule, "contact-point rule");
  app.add_option("--law", settings.law, "linear, linear_local or tensor");
  app.add_option("--skip", settings.skip,
                 "what to skip: all, none, or names (broad_phase,gjk,epa,orientation,flight,scatter)")
      ->delimiter(',')
      ->check(CLI::IsMember({"all", "none", "broad_phase", "gjk", "epa", "orientation", "flight", "scatter"}));
  app.add_flag("--shuffled", settings.bed.shuffled, "dense beds: bodies in an order at random, as they were poured");
  app.add_flag("--no-batches", settings.bed.options.noBatches, "work on every body, pair and contact one by one");
  app.add_option("--threads", settings.threads, "OpenMP threads")->check(CLI::PositiveNumber);
  app.add_option("--relax", settings.relax, "steps before the clock starts")->check(CLI::NonNegativeNumber);
  app.add_option("--steps", settings.steps, "steps timed, in each repeat")->check(CLI::PositiveNumber);
  app.add_option("--repeats", settings.repeats, "of which the fastest counts")->check(CLI::PositiveNumber);
  app.add_option("--dt", settings.dt, "time step, s")->check(CLI::PositiveNumber);
  app.add_flag("--energy", settings.bed.options.energy, "keep the energy ledger");
  app.add_option("--json", settings.json, "write the figures here too");
  app.add_option("--csv", settings.csv, "append them as a line of this table");
  CLI11_PARSE(app, argc, argv);
  run(settings);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("scenes", [&] { return parseAndRun(argc, argv); });
}
