// The same scenes under Bullet alone and under the granular layer with every contact-point rule, against theory.
#include <omp.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "exit_code.h"
#include "granular/core/errors.h"
#include "granular/run/comparison_table.h"

namespace {

struct Options {
  granular::ComparisonChoice choice;
  std::filesystem::path out;
  int threads = 1;
  bool list = false, scenes = false, again = false;
};

void addOptions(CLI::App& app, Options& o) {
  granular::ComparisonChoice& c = o.choice;
  app.add_option("--out", o.out, "folder of contacts.json, contacts.csv and states/; rows that are there are kept");
  app.add_option("--scene", c.scenes, "scenes (all)")->delimiter(',');
  app.add_option("--engine", c.engines, "bullet, granular (both)")->delimiter(',');
  app.add_option("--rule", c.rules, "contact-point rules of granular (all)")->delimiter(',');
  app.add_option("--unit", c.units, "sizes: length of a cube's side, m (1, .003)")->delimiter(',');
  app.add_option("--softness", c.softnesses, "of granular: overlap under a body's own weight, over a (1e-4, 1e-5)")
      ->delimiter(',');
  app.add_option("--fraction", c.fraction, "of granular: time step over its bound")->capture_default_str();
  app.add_option("--dt", c.steps, "of Bullet: time steps, s (1/60, 1/240, 1/1000)")->delimiter(',');
  app.add_option("--iterations", c.iterations, "of Bullet's solver (10, 50)")->delimiter(',');
  app.add_option("--threads", o.threads, "of granular")->check(CLI::Range(1, 256))->capture_default_str();
  app.add_flag("--again", o.again, "run cases again that have a row");
  app.add_flag("--list", o.list, "only list the cases");
  app.add_flag("--scenes", o.scenes, "only tell the scenes, what theory says of each, and where it is known from");
}

int run(const Options& o) {
  if (o.scenes) {
    std::fputs(granular::describeScenes().c_str(), stdout);
    return 0;
  }
  const std::vector<granular::ComparisonCase> cases = granular::listCases(o.choice);
  if (o.list) {
    for (const auto& each : cases) std::printf("%s\n", each.key().c_str());
    return 0;
  }
  granular::require(!o.out.empty(), "--out is missing: the folder of the results");
  omp_set_num_threads(o.threads);
  granular::ComparisonTable table(o.out);
  std::size_t done = 0;
  for (const auto& each : cases) {
    ++done;
    if (!o.again && table.has(each)) continue;
    const granular::ComparisonResult result = granular::runCase(each);
    table.add(each, result);
    std::printf("[%zu/%zu] %s\n", done, cases.size(), granular::describeResult(each, result).c_str());
    std::fflush(stdout);
  }
  std::printf("results    %s (contacts.json, contacts.csv, states/): %zu rows\n", o.out.c_str(), table.size());
  return 0;
}

int parseAndRun(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Runs the same scenes under Bullet alone and under the granular layer with every contact-point rule, and says "
      "of\n"
      "each whether it does what theory says, its error, and its run time. Rows are written as they come: a run that "
      "was\n"
      "stopped goes on where it was. plots/plot_contacts.py draws the folder.\n"
      "Exit codes: 0 all cases are done; 1 settings that can't be used; 2 a problem of the program.");
  addOptions(app, options);
  CLI11_PARSE(app, argc, argv);
  return run(options);
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("compare_contacts", [&] { return parseAndRun(argc, argv); });
}
