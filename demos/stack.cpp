// Builds a tower of cuboids and watches whether it stands.
#include <omp.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "exit_code.h"
#include "granular/core/errors.h"
#include "granular/io/checkpoint.h"
#include "granular/io/output_file.h"
#include "granular/io/progress.h"
#include "granular/run/stack_report.h"
#include "run_program.h"
#include "stop_signal.h"

namespace {

namespace fs = std::filesystem;

enum Exit { exitDone = 0, exitInterrupted = 5 };

struct Options {
  granular::StackSettings stack;
  std::string rule = "stiff_patch", law = "linear", engine = "granular";
  fs::path json, out, resume;
  granular::StackCheckpoints checkpoints;
};

void addOptions(CLI::App& app, Options& o) {
  granular::StackSettings& s = o.stack;
  app.add_option("--count", s.count, "cuboids")->capture_default_str();
  app.add_option("--time", s.time, "simulated time, s; a fall ends the run earlier")->capture_default_str();
  app.add_option(
         "--rule", o.rule,
         "contact-point rule: witness, manifold, face_centroid, pressure_centroid, patch, stiff_patch, foundation")
      ->capture_default_str();
  app.add_option("--slab", s.rule.slab, "of face_centroid, a fraction of the overlap")->capture_default_str();
  app.add_option("--sharpness", s.rule.sharpness, "of stiff_patch: half its rocking stiffness over a foundation's")
      ->capture_default_str();
  app.add_option("--law", o.law, "contact law: linear, linear_local, tensor")->capture_default_str();
  app.add_option("--dt", s.step, "time step, s; 0: --fraction of the stability bound")->capture_default_str();
  app.add_option("--fraction", s.fraction, "of the stability bound")->capture_default_str();
  app.add_option("--kn", s.contact.stiffness, "normal stiffness, N/m")->capture_default_str();
  app.add_option("--restitution", s.contact.restitution, "normal")->capture_default_str();
  app.add_option("--restitution-t", s.contact.restitutionT, "tangential")->capture_default_str();
  app.add_option("--friction", s.contact.friction, "Coulomb's coefficient")->capture_default_str();
  app.add_option("--side", s.side, "of a cube, m")->capture_default_str();
  app.add_option("--height", s.height, "of a cuboid, m; 0: as the side")->capture_default_str();
  app.add_option("--sizes", s.sizes, "factors on side and height, repeated up the tower")->delimiter(',');
  app.add_option("--density", s.density, "kg/m^3")->capture_default_str();
  app.add_option("--gravity", s.gravity, "m/s^2")->capture_default_str();
  app.add_option("--perturb", s.perturbation,
                 "places off by up to this times the side, orientations by up to this in rad")
      ->capture_default_str();
  app.add_option("--sway", s.sway, "start with the top off by this times the side, along the lowest sway mode")
      ->capture_default_str();
  app.add_option("--seed", s.seed, "of the perturbation")->capture_default_str();
  app.add_flag_callback(
      "--drop", [&s] { s.start = granular::StackSettings::Start::drop; },
      "start with gaps instead of in static equilibrium");
  app.add_option("--gap", s.gap, "of --drop, over the side")->capture_default_str();
  app.add_flag("--skip", s.skip, "use the library's shortcuts; nothing is skipped otherwise");
  app.add_option("--engine", o.engine, "granular, or Bullet's own contacts, solver and integrator")
      ->check(CLI::IsMember({"granular", "bullet"}))
      ->capture_default_str();
  app.add_option("--iterations", s.solverIterations, "of Bullet's solver")->capture_default_str();
  app.add_option("--sample", s.sampleEvery, "time between samples, s")->capture_default_str();
  app.add_option("--json", o.json, "write the figures here");
  app.add_option("--out", o.out, "folder for result.json, samples.csv, velocity.png and tower.png");
  app.add_option("--checkpoints", o.checkpoints.folder, "folder for checkpoints; default: that of --out, if given");
  app.add_option("--checkpoint-every", o.checkpoints.every, "wall time between checkpoints, s")->capture_default_str();
  app.add_option("--resume", o.resume,
                 "go on from this folder's newest checkpoint, or from a checkpoint file; the folder keeps those to "
                 "come; the tower is "
                 "that of the checkpoint, only --time, --json, --out and --checkpoint-every may be given");
}

/// A resumed tower takes nothing that would make it another.
void checkResume(const CLI::App& app, const Options& o) {
  if (o.resume.empty()) return;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    const bool allowed =
        name == "--resume" || name == "--time" || name == "--json" || name == "--out" || name == "--checkpoint-every";
    granular::require(option->count() == 0 || allowed, name + ": can't be given with --resume");
  }
}

void writeText(const fs::path& path, const std::string& text) {
  granular::OutputFile file(path);
  file.write(text);
  file.finish();
}

void draw(const fs::path& out) {
  std::fflush(stdout);
  const std::string script = std::string(GRANULAR_PLOTS_DIR) + "/plot_stack.py";
  if (!runProgram({"/usr/bin/python3", script, out.string()})) {
    std::printf("plots      not drawn: they need Debian's python3-matplotlib, and %s\n", script.c_str());
  }
}

granular::StackResult runTower(Options& o, std::optional<double> timeGiven) {
  granular::Progress line;
  const auto watch = [&](const granular::StackSample& s) {
    line.report(s.time / o.stack.time, [&s] { return granular::describeSample(s); });
    return stopAsked == 0;
  };
  if (o.engine == "bullet") return runBulletStack(o.stack, watch);
  granular::StackRun tower =
      o.resume.empty() ? granular::StackRun(o.stack) : granular::StackRun::resumed(o.resume, timeGiven);
  o.stack = tower.settings();
  return tower.run(watch, o.checkpoints);
}

int run(Options& o, std::optional<double> timeGiven) {
  o.stack.rule.rule = granular::pointRuleFromName(o.rule);
  o.stack.law = granular::lawFromName(o.law);
  // A tower is too small to share out.
  omp_set_num_threads(1);

  if (!o.out.empty()) granular::prepareOutputFolder(o.out);
  fs::path& kept = o.checkpoints.folder;
  if (!o.resume.empty()) kept = granular::checkpointFolder(o.resume);
  if (kept.empty() && o.engine != "bullet") kept = o.out;
  granular::require(kept.empty() || o.engine != "bullet", "--checkpoints: Bullet's own engine has none");
  if (!kept.empty()) {
    if (o.resume.empty()) granular::prepareOutputFolder(kept);
    listenForStop();
  }
  const granular::StackResult result = runTower(o, timeGiven);
  if (result.stopped) {
    std::printf("interrupted at t = %.6g s; go on with: stack --resume %s\n", result.simulated, kept.c_str());
    return exitInterrupted;
  }

  std::fputs(granular::describeStack(o.stack, o.engine, result).c_str(), stdout);
  const std::string json = granular::stackToJson(o.stack, o.engine, result);
  if (!o.json.empty()) writeText(o.json, json);
  if (o.out.empty()) return exitDone;
  writeText(o.out / "result.json", json);
  writeText(o.out / "samples.csv", granular::samplesToCsv(result));
  writeText(o.out / "poses.csv", granular::posesToCsv(o.stack, result));
  draw(o.out);
  std::printf("results    %s (result.json, samples.csv, poses.csv, velocity.png, tower.png)\n", o.out.c_str());
  return exitDone;
}

int parseAndRun(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Builds a tower of cuboids, from static equilibrium or from a drop, and watches whether it stands.\n"
      "Exit codes: 0 the run is done, standing or fallen; 1 settings that can't be used; 2 a problem of the program; 5 "
      "interrupted (go on with --resume).");
  addOptions(app, options);
  CLI11_PARSE(app, argc, argv);
  checkResume(app, options);
  granular::require(options.checkpoints.every > 0,
                    "--checkpoint-every = " + std::to_string(options.checkpoints.every) + " s: must be > 0");
  const bool timed = app.count("--time") > 0;
  return run(options, timed ? std::optional(options.stack.time) : std::nullopt);
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("stack", [&] { return parseAndRun(argc, argv); });
}
