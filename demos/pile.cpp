// Drops particles one by one beside a wall in a plane, or through a hopper onto a cone, and measures the pile; or the
// heap of any other scene.
#include "granular/run/pile.h"

#include <omp.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "exit_code.h"
#include "granular/core/errors.h"
#include "granular/io/checkpoint.h"
#include "granular/io/output_file.h"
#include "granular/run/packing_report.h"
#include "run_program.h"
#include "stop_signal.h"

namespace {

namespace fs = std::filesystem;
using granular::PileSettings;

enum Exit { exitRested = 0, exitTrouble = 4, exitInterrupted = 5 };

struct Options {
  PileSettings pile;
  std::string shape = "ellipsoid";
  double step = 0;
  fs::path out, resume, scene;
  std::vector<std::string> overrides;
  int threads = 1;
  bool dryRun = false, picture = true;
};

void writeScene(const PileSettings& pile, const fs::path& folder) {
  if (pile.space) granular::writeHopper(pile, folder);
  granular::OutputFile file(folder / "pile.toml");
  file.write(granular::formatPileScene(pile));
  file.finish();
}

granular::PackingRun makeRun(const Options& options) {
  if (!options.resume.empty()) return granular::PackingRun::resumed(options.resume, options.overrides);
  const fs::path scene = options.scene.empty() ? options.out / "pile.toml" : options.scene;
  return granular::PackingRun(granular::SceneSource::read(scene, options.overrides));
}

int run(const Options& options) {
  const fs::path out = options.resume.empty() ? options.out : granular::checkpointFolder(options.resume);
  if (options.resume.empty()) {
    if (options.scene.empty()) granular::checkPile(options.pile);
    granular::prepareOutputFolder(out);
    if (options.scene.empty()) writeScene(options.pile, out);
  }
  granular::PackingRun pile = makeRun(options);
  omp_set_num_threads(options.threads > 0 ? options.threads : omp_get_num_procs());
  std::fputs(pile.describePlan().c_str(), stdout);
  if (options.dryRun) return exitRested;
  std::fflush(stdout);

  listenForStop();
  const granular::RunEnd end = pile.run(out, stopAsked);
  if (end == granular::RunEnd::interrupted) {
    std::printf("interrupted at t = %.4g s; go on with: pile --resume %s\n", pile.world().time, out.c_str());
    return exitInterrupted;
  }
  granular::RunResult told;
  const granular::PileResult result = granular::writePileReport(pile, end, omp_get_max_threads(), out, &told);
  std::fputs(granular::formatSummary(told, pile).c_str(), stdout);
  std::fputs(granular::formatPile(result).c_str(), stdout);
  std::fflush(stdout);
  if (options.picture) {
    const std::string scripts = GRANULAR_PLOTS_DIR;
    runProgram({"/usr/bin/python3", scripts + "/plot_pile.py", out.string()});
    if (pile.scene().particles[0].lockTranslation.empty())
      runProgram({"/usr/bin/python3", scripts + "/render_bed.py", out.string()});
  }
  std::printf("results: %s (result.json, surface.csv, tables%s)\n", out.c_str(), options.picture ? ", pile.png" : "");
  return end == granular::RunEnd::trouble ? exitTrouble : exitRested;
}

void addOptions(CLI::App& app, Options& o) {
  PileSettings& p = o.pile;
  app.add_option("--shape", o.shape, "ellipsoid, or clump: spheres on its axis")
      ->check(CLI::IsMember({"ellipsoid", "clump"}));
  app.add_option("--spheres", p.spheres, "clump: how many, an odd number (default 17)");
  app.add_option("--count", p.count, "particles (default 1000)");
  app.add_option("--seed", p.seed, "seed of all random numbers (default 1)");
  app.add_option("--scene", o.scene, "instead of all that describes a pile: measure the heap that this scene makes");
  app.add_option("--out", o.out, "folder of the results");
  app.add_option("--resume", o.resume, "go on from this folder's newest checkpoint, or from a checkpoint file");
  app.add_option("--half-length", p.halfLength, "of the ellipsoid, m (default 2.7e-3)");
  app.add_option("--half-width", p.halfWidth, "of the ellipsoid, m (default 1.15e-3)");
  app.add_option("--mass", p.mass, "of a particle, kg (default 2e-5); inertia: the smooth ellipsoid's");
  app.add_option("--young", p.young, "Young's modulus, Pa (default 183e6)");
  app.add_option("--poisson", p.poisson, "Poisson's ratio (default 0.2)");
  app.add_option("--friction", p.friction, "of particles and walls (default 0.3)");
  app.add_option("--damping", p.damping, "eta_n = eta_t, 1/s (default 100)");
  app.add_option("--height", p.height, "of the drop, m (default 0.15)");
  app.add_option("--interval", p.interval, "between two particles, s (default 0.04)");
  app.add_option("--rest", p.rest, "longest wait for rest after the last particle, s (default 10)");
  app.add_option("--sleep", p.sleep,
                 "particles whose mean motion has an energy below this times m g d may sleep: five times as "
                 "fast; they don't feel what shakes the pile; 0: none (default)");
  app.add_option("--dt", o.step, "time step, s; default: half of the stability bound");
  app.add_flag("--three-d", p.space, "a cone in space, from a hopper");
  app.add_option("--orifice", p.orifice, "--three-d: diameter of the hopper's opening, m (default 0.03)");
  app.add_option("--outlet", p.outlet, "--three-d: height of the opening above the floor, m (default 0.06)");
  app.add_option("--threads", o.threads, "0: all cores (default 1; the result does not depend on it)");
  app.add_option("--set", o.overrides, "key.path=value, over the scene that is made; may be repeated")
      ->allow_extra_args(false);
  app.add_flag("--picture,!--no-picture", o.picture, "draw the pile with the fitted line (default)");
  app.add_flag("--dry-run", o.dryRun, "make the scene and say what would be done");
}

int parseAndRun(int argc, char** argv) {
  CLI::App app(
      "The piling problem of Markauskas et al. (2010): ellipsoids, or clumps of spheres in their place, dropped one by "
      "one beside a wall and held to a plane; or a cone in space. Measures repose angle, porosity and coordination.\n"
      "Exit codes: 0 done, 1 bad input, 2 a problem of the program, 4 stopped by trouble (named), 5 interrupted (go on "
      "with --resume).");
  Options options;
  addOptions(app, options);
  CLI11_PARSE(app, argc, argv);
  options.pile.shape = options.shape == "clump" ? PileSettings::Shape::clump : PileSettings::Shape::ellipsoid;
  if (app.count("--dt") > 0) options.pile.step = options.step;
  granular::require(options.resume.empty() != options.out.empty(),
                    "give --out with a folder for the results, or --resume with that of an interrupted run");
  for (const char* option : {"--shape", "--spheres", "--count", "--seed", "--half-length", "--half-width", "--mass",
                             "--young", "--poisson", "--friction", "--damping", "--height", "--interval", "--rest",
                             "--sleep", "--dt", "--three-d", "--orifice", "--outlet"}) {
    granular::require(options.scene.empty() || app.count(option) == 0,
                      std::string(option) + ": not beside --scene, which says all of the heap (--set changes it)");
  }
  granular::require(app.count("--spheres") == 0 || options.shape == "clump", "--spheres: only clumps have them");
  return run(options);
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("pile", [&] { return parseAndRun(argc, argv); });
}
