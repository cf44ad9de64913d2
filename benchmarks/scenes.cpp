// Whole steps of dense scenes: particle-steps per second, time per contact, the share of each stage, and the contact
// certificate beside them. Measures; asserts nothing.
#include <omp.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "demos/exit_code.h"
#include "granular/core/errors.h"
#include "granular/shape/polyhedron.h"
#include "granular/world/time_step.h"
#include "granular/world/world.h"

namespace {

using namespace granular;

struct Settings {
  std::string scene = "cubes";
  std::string poses;  ///< file of packed cubes
  std::string rule = "patch";
  std::string skip = "all";
  std::string json;
  int threads = 1;
  int relax = 2000;  ///< steps before the clock starts
  int steps = 2000;  ///< steps timed
  double dt = 2e-6;  ///< s
  bool energy = false;
};

/// Packed cubes in an open box, as the pose file has them: "# n base side", then x y z qw qx qy qz.
std::unique_ptr<World> loadCubes(const Settings& settings) {
  std::ifstream file(settings.poses);
  require(file.good(), "can't read " + settings.poses);
  std::string line;
  std::getline(file, line);
  std::getline(file, line);
  double count = 0, base = 0, side = 0;
  std::istringstream(line) >> count >> base >> side;

  WorldOptions options;
  options.rule.rule = pointRuleFromName(settings.rule);
  const bool all = settings.skip == "all";
  options.skips = {all, all, all};
  options.energy = settings.energy;
  MaterialTable materials;
  materials.add("cube", ContactParameters{});
  auto world = std::make_unique<World>(options, std::move(materials));
  const double half = base / 2;
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  for (const double sign : {-1.0, 1.0}) {
    world->walls.push_back(makePlaneWall({sign * half, 0, 0}, {-sign, 0, 0}));
    world->walls.push_back(makePlaneWall({0, sign * half, 0}, {0, -sign, 0}));
  }
  const std::int32_t cube = world->addShape(std::make_shared<Cuboid>(Vec3::Constant(side / 2)));
  while (std::getline(file, line)) {
    NewBody body;
    body.shapeIndex = cube;
    Quat& q = body.pose.q;
    Vec3& x = body.pose.x;
    std::istringstream(line) >> x.x() >> x.y() >> x.z() >> q.w() >> q.x() >> q.y() >> q.z();
    world->addBody(body);
  }
  return world;
}

void report(const Settings& settings, const World& world, double seconds) {
  const Report& r = world.report;
  const double bodySteps = static_cast<double>(r.bodySteps);
  const double contactSteps = static_cast<double>(r.contactSteps);
  nlohmann::json json;
  json["scene"] = settings.scene;
  json["particles"] = world.bodies.size();
  json["threads"] = settings.threads;
  json["rule"] = settings.rule;
  json["skip"] = settings.skip;
  json["particle_steps_per_s"] = bodySteps / seconds;
  json["us_per_contact"] = 1e6 * seconds / contactSteps;
  json["contacts"] = world.contactCount();
  json["pairs"] = world.pairs.pairs.size();
  for (int k = 0; k < stageCount; ++k) {
    json["stages"][std::string(stageName(static_cast<Stage>(k)))] = r.seconds[static_cast<std::size_t>(k)] / seconds;
  }
  json["certificate"] = {{"cold", r.narrow.cold},           {"searches", r.narrow.searches},
                         {"warm", r.narrow.warm},           {"uncertified", r.narrow.uncertified},
                         {"fallbacks", r.narrow.fallbacks}, {"normal_flips", r.narrow.normalFlips},
                         {"coarse", r.narrow.coarse}};
  json["max_overlap_over_size"] = r.deepestOverlap;
  json["kinetic_energy_j"] = kineticEnergy(world.bodies);
  std::printf("%s\n", json.dump(2).c_str());
  if (!settings.json.empty()) std::ofstream(settings.json) << json.dump(2) << "\n";
}

int parseAndRun(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Times whole steps of dense scenes."};
  app.add_option("--scene", settings.scene, "cubes")->check(CLI::IsMember({"cubes"}));
  app.add_option("--poses", settings.poses, "packed cubes: a comment line, '# n base side', then poses")->required();
  app.add_option("--rule", settings.rule, "contact-point rule");
  app.add_option("--skip", settings.skip, "all or none")->check(CLI::IsMember({"all", "none"}));
  app.add_option("--threads", settings.threads, "OpenMP threads");
  app.add_option("--relax", settings.relax, "steps before the clock starts");
  app.add_option("--steps", settings.steps, "steps timed");
  app.add_option("--dt", settings.dt, "time step, s");
  app.add_flag("--energy", settings.energy, "keep the energy ledger");
  app.add_option("--json", settings.json, "write the figures here too");
  CLI11_PARSE(app, argc, argv);
  omp_set_num_threads(settings.threads);
  const std::unique_ptr<World> world = loadCubes(settings);
  startHalfSteps(*world, settings.dt, 0, true);
  for (int k = 0; k < settings.relax; ++k) step(*world, settings.dt);
  world->report = Report{};
  const auto began = std::chrono::steady_clock::now();
  for (int k = 0; k < settings.steps; ++k) step(*world, settings.dt);
  report(settings, *world, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("scenes", [&] { return parseAndRun(argc, argv); });
}
