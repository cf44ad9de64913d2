// Pours a packing from a scene file, lets it come to rest, measures it.
#include <omp.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "exit_code.h"
#include "granular/core/errors.h"
#include "granular/io/checkpoint.h"
#include "granular/io/output_file.h"
#include "granular/io/scene_file.h"
#include "granular/run/packing_report.h"
#include "granular/run/packing_run.h"
#include "run_program.h"
#include "stop_signal.h"

namespace {

namespace fs = std::filesystem;

enum Exit { exitRested = 0, exitNotRested = 3, exitTrouble = 4, exitInterrupted = 5 };

struct Options {
  fs::path scene, out, resume;
  std::vector<std::string> overrides;
  bool dryRun = false, reference = false;
};

// Plots and picture are drawn from the written data; without the tools the data stand.
void draw(const granular::OutputSettings& output, const fs::path& out) {
  std::fflush(stdout);
  const std::string scripts = GRANULAR_PLOTS_DIR;
  if (output.plots) runProgram({"/usr/bin/python3", scripts + "/plot_packing.py", out.string()});
  if (output.picture) runProgram({"/usr/bin/python3", scripts + "/render_bed.py", out.string()});
}

int exitOf(granular::RunEnd end) {
  switch (end) {
    case granular::RunEnd::rested:
    case granular::RunEnd::completed:
      return exitRested;
    case granular::RunEnd::trouble:
      return exitTrouble;
    case granular::RunEnd::interrupted:
      return exitInterrupted;
    default:
      return exitNotRested;
  }
}

granular::PackingRun makeRun(const Options& options) {
  if (!options.resume.empty()) return granular::PackingRun::resumed(options.resume, options.overrides);
  return granular::PackingRun(granular::SceneSource::read(options.scene, options.overrides));
}

int run(const Options& options) {
  granular::PackingRun packing = makeRun(options);
  const int threads = packing.scene().threads > 0 ? packing.scene().threads : omp_get_num_procs();
  omp_set_num_threads(threads);
  std::fputs(packing.describePlan().c_str(), stdout);
  if (options.dryRun) return 0;
  const fs::path out = options.resume.empty() ? options.out : granular::checkpointFolder(options.resume);
  granular::prepareOutputFolder(out);
  std::fflush(stdout);

  listenForStop();
  const granular::RunEnd end = packing.run(out, stopAsked);
  if (end == granular::RunEnd::interrupted) {
    std::printf("interrupted at t = %.4g s; go on with: packing --resume %s\n", packing.world().time, out.c_str());
    return exitInterrupted;
  }
  const granular::RunResult result = granular::writeReport(packing, end, threads, out);
  std::fputs(granular::formatSummary(result, packing).c_str(), stdout);
  draw(packing.scene().output, out);
  std::printf("results: %s (result.json, tables, frames, pictures)\n", out.c_str());
  return exitOf(end);
}

int parseAndRun(int argc, char** argv) {
  CLI::App app(
      "Pours particles into a vessel as a scene file says, lets the bed come to rest, and measures it.\n"
      "Exit codes: 0 at rest, 1 bad input, 2 a problem of the program, 3 not at rest in the time given, 4 stopped by "
      "trouble (named), 5 interrupted (go on with --resume).");
  Options options;
  int threads = -1;
  std::string seed;
  std::vector<std::string> skips;
  app.add_option("scene", options.scene, "scene file (TOML)");
  app.add_option("--out", options.out, "folder of the results");
  app.add_option("--resume", options.resume,
                 "go on from this folder's newest checkpoint, or from a checkpoint file, to the same result as if "
                 "never stopped; --threads, and "
                 "--set of time.max_time, rest, output and limits may differ");
  app.add_option("--threads", threads, "threads; 0: all cores (the result does not depend on it)");
  app.add_option("--seed", seed, "seed of all random numbers");
  app.add_option("--set", options.overrides,
                 "key.path=value, over the scene file (\"key.path=\" takes the key out); may be repeated")
      ->allow_extra_args(false);
  app.add_option("--skip", skips,
                 "what to skip: all, none, or names (broad_phase,gjk,epa,orientation,flight,scatter,sleep)")
      ->delimiter(',');
  app.add_flag("--dry-run", options.dryRun, "check the scene and say what would be done");
  app.add_flag("--help-scene", options.reference, "print every key of a scene file and exit");
  CLI11_PARSE(app, argc, argv);

  if (threads >= 0) options.overrides.push_back("threads=" + std::to_string(threads));
  if (!seed.empty()) options.overrides.push_back("seed=" + seed);
  if (!skips.empty()) {
    std::string list;
    for (const std::string& name : skips) list += (list.empty() ? "\"" : ", \"") + name + "\"";
    options.overrides.push_back("skip=[" + list + "]");
  }
  if (options.reference) {
    granular::printSceneReference(std::cout);
    return 0;
  }
  granular::require(!options.scene.empty() != !options.resume.empty(), "give a scene file, or --resume with a folder");
  granular::require(options.out.empty() || options.resume.empty(),
                    "--resume goes on in its own folder: leave out --out");
  granular::require(!options.out.empty() || options.dryRun || !options.resume.empty(),
                    "--out: where do the results go?");
  return run(options);
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("packing", [&] { return parseAndRun(argc, argv); });
}
