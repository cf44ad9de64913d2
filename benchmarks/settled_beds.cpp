// The same cubes fall into the same box with this library's contacts and with plain Bullet: run time beside what the
// bed that comes of it is worth, judged by one yardstick, the certified contacts of the poses at the end. Measures;
// asserts nothing.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "demos/exit_code.h"
#include "granular/analysis/solid_fraction.h"
#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/run/bullet_world.h"
#include "granular/shape/bullet_vectors.h"
#include "granular/shape/polyhedron.h"
#include "granular/world/stages.h"

namespace {

using namespace granular;

struct Settings {
  std::string engine = "granular";
  int count = 200;
  double side = 3e-3, box = 18e-3;  ///< of a cube, of the square box, m
  std::uint64_t seed = 1;
  double time = 0.6;  ///< simulated, s
  double dt = 2e-6;   ///< s
  double friction = 0.3, restitution = 0.5;
  double stiffness = 1e4;  ///< k_n, N/m
  std::string rule = "patch";
  int iterations = 10;  ///< of Bullet's solver
  double units = 1;     ///< Bullet: how many units a metre is
  std::string json;
};

constexpr double gravity = 9.81, density = 2500;

/// Cubes at random turns on a lattice in which they don't touch, layer by layer.
std::vector<Pose> layOutCubes(const Settings& settings) {
  const double pitch = 1.8 * settings.side;
  const int perSide = static_cast<int>(settings.box / pitch);
  require(perSide >= 1, "--box must be at least 1.8 times --side");
  Random random(settings.seed);
  std::vector<Pose> poses;
  for (int k = 0; k < settings.count; ++k) {
    const auto along = [&](int n) { return (n + 0.5) * settings.box / perSide - 0.5 * settings.box; };
    const int layer = k / (perSide * perSide);
    const Vec3 x(along(k % perSide), along(k / perSide % perSide), (layer + 1) * pitch);
    poses.push_back({x, random.rotation()});
  }
  return poses;
}

std::unique_ptr<World> makeWorld(const Settings& settings, const std::vector<Pose>& poses) {
  WorldOptions options;
  options.rule.rule = pointRuleFromName(settings.rule);
  MaterialTable materials;
  ContactParameters contact;
  contact.stiffness = settings.stiffness;
  contact.restitution = contact.restitutionT = settings.restitution;
  contact.friction = settings.friction;
  materials.add("cube", contact);
  auto world = std::make_unique<World>(options, std::move(materials));
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  for (const double sign : {-1.0, 1.0}) {
    world->walls.push_back(makePlaneWall({sign * settings.box / 2, 0, 0}, {-sign, 0, 0}));
    world->walls.push_back(makePlaneWall({0, sign * settings.box / 2, 0}, {0, -sign, 0}));
  }
  world->addShape(std::make_shared<Cuboid>(Vec3::Constant(settings.side / 2)));
  for (const Pose& pose : poses) {
    NewBody body;
    body.density = density;
    body.pose = pose;
    world->addBody(body);
  }
  return world;
}

double processorTime() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Poses at the end, their kinetic energy (J) and the processor's time (s).
struct Settled {
  std::vector<Pose> poses;
  double kinetic = 0, seconds = 0;
};

Settled settleHere(const Settings& settings) {
  auto world = makeWorld(settings, layOutCubes(settings));
  const auto steps = static_cast<std::int64_t>(std::ceil(settings.time / settings.dt));
  const double began = processorTime();
  startHalfSteps(*world, settings.dt, 0, false);
  for (std::int64_t n = 0; n < steps; ++n) step(*world, settings.dt);
  Settled settled{{}, kineticEnergy(world->bodies), processorTime() - began};
  for (std::size_t i = 0; i < world->bodies.size(); ++i) settled.poses.push_back(world->bodies.poseOf(i));
  return settled;
}

Settled settleInBullet(const Settings& settings) {
  const double scale = settings.units;
  BulletWorld world(scale, gravity, settings.iterations);
  const auto addWall = [&](const Vec3& normal, double offset) {
    BulletBody wall;
    wall.pose = {Vec3::Zero(), Quat::Identity()};
    wall.friction = settings.friction;
    wall.restitution = settings.restitution;
    world.addBody(wall, {0, 0, 0}, std::make_unique<btStaticPlaneShape>(toBullet(normal), scale * offset));
  };
  addWall(Vec3::UnitZ(), 0);
  for (const double sign : {-1.0, 1.0}) {
    addWall({-sign, 0, 0}, -settings.box / 2);
    addWall({0, -sign, 0}, -settings.box / 2);
  }
  const std::size_t walls = world.size();
  const double mass = density * std::pow(settings.side, 3);
  for (const Pose& pose : layOutCubes(settings)) {
    BulletBody cube;
    cube.mass = mass;
    cube.pose = pose;
    cube.friction = settings.friction;
    cube.restitution = settings.restitution;
    auto box = std::make_unique<btBoxShape>(toBullet(Vec3::Constant(scale * settings.side / 2)));
    btVector3 inertia;
    box->calculateLocalInertia(mass, inertia);
    world.addBody(cube, inertia, std::move(box));
  }
  const auto steps = static_cast<std::int64_t>(std::ceil(settings.time / settings.dt));
  const double began = processorTime();
  for (std::int64_t n = 0; n < steps; ++n) world.step(settings.dt);
  Settled settled{{}, 0, processorTime() - began};
  for (std::size_t k = walls; k < world.size(); ++k) {
    settled.poses.push_back(world.pose(k));
    settled.kinetic += world.kineticEnergy(k);
  }
  return settled;
}

nlohmann::ordered_json judge(const Settings& settings, const Settled& settled) {
  // One world for all: its contacts are certified, whoever made the poses.
  Settings yardstick = settings;
  yardstick.rule = "witness";
  auto world = makeWorld(yardstick, settled.poses);
  startHalfSteps(*world, 1e-6, 0, true);
  double deepest = 0, sum = 0;
  std::size_t contacts = 0;
  world->visitContacts([&](const Contact& contact) {
    deepest = std::max(deepest, contact.touch.overlap);
    sum += contact.touch.overlap;
    ++contacts;
  });
  Bed bed;
  for (std::size_t i = 0; i < world->bodies.size(); ++i) {
    bed.shapes.push_back(world->bodies.shape[i]);
    bed.frames.push_back(world->bodies.frameOf(i));
  }
  // Up to two thirds of the height of a bed with a fraction of .6.
  const double volume = settings.count * std::pow(settings.side, 3), area = settings.box * settings.box;
  const double height = volume / area / 0.6 * 2 / 3;
  const double weight = density * std::pow(settings.side, 3) * gravity;
  nlohmann::ordered_json json;
  json["engine"] = settings.engine;
  json["dt_s"] = settings.dt;
  json["seed"] = settings.seed;
  json["processor_s"] = settled.seconds;
  json["solid_fraction"] = measureVolumeBelow(bed, height) / (area * height);
  double mean = 0;
  for (const Pose& pose : settled.poses) mean += pose.x.z() / settings.count;
  json["mean_height_m"] = mean;
  json["contacts"] = contacts;
  json["largest_overlap_over_side"] = deepest / settings.side;
  json["mean_overlap_over_side"] = contacts > 0 ? sum / static_cast<double>(contacts) / settings.side : 0;
  json["kinetic_over_mgd"] = settled.kinetic / (settings.count * weight * settings.side);
  return json;
}

int parseAndRun(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Cubes that fall into a box, with this library or with plain Bullet."};
  app.add_option("--engine", settings.engine, "granular or bullet")->check(CLI::IsMember({"granular", "bullet"}));
  app.add_option("--count", settings.count, "cubes")->check(CLI::PositiveNumber);
  app.add_option("--side", settings.side, "of a cube, m")->check(CLI::PositiveNumber);
  app.add_option("--box", settings.box, "width of the box, m")->check(CLI::PositiveNumber);
  app.add_option("--seed", settings.seed, "of the turns");
  app.add_option("--time", settings.time, "simulated, s")->check(CLI::PositiveNumber);
  app.add_option("--dt", settings.dt, "time step, s")->check(CLI::PositiveNumber);
  app.add_option("--friction", settings.friction, "coefficient")->check(CLI::NonNegativeNumber);
  app.add_option("--restitution", settings.restitution, "coefficient")->check(CLI::Range(0.01, 1.0));
  app.add_option("--stiffness", settings.stiffness, "k_n of granular, N/m")->check(CLI::PositiveNumber);
  app.add_option("--rule", settings.rule, "contact-point rule of granular");
  app.add_option("--iterations", settings.iterations, "of Bullet's solver")->check(CLI::PositiveNumber);
  app.add_option("--units", settings.units, "Bullet's units in a metre")->check(CLI::PositiveNumber);
  app.add_option("--json", settings.json, "write the figures here too");
  CLI11_PARSE(app, argc, argv);
  const auto json = judge(settings, settings.engine == "bullet" ? settleInBullet(settings) : settleHere(settings));
  std::printf("%s\n", json.dump(2).c_str());
  if (!settings.json.empty()) std::ofstream(settings.json) << json.dump(2) << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("settled_beds", [&] { return parseAndRun(argc, argv); });
}
