#include "dense_beds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <numeric>
#include <sstream>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/shape/clump.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/ellipsoid_chain.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace granular::benchmarks {
namespace {

using ShapeSet = std::vector<std::shared_ptr<const Shape>>;

constexpr double diameter = 3e-3;  // of spheres; other shapes are about as large, m

/// Hulls of points at random on an ellipsoid, all different.
ShapeSet makeRocks(int points, std::uint64_t seed) {
  constexpr int kinds = 32;
  Random random(seed);
  ShapeSet rocks;
  for (int k = 0; k < kinds; ++k) {
    std::vector<Vec3> cloud;
    for (int p = 0; p < points; ++p) {
      cloud.emplace_back(0.5 * diameter * random.direction().cwiseProduct(Vec3(1.2, 1, 0.85)));
    }
    rocks.push_back(std::make_shared<Polyhedron>(cloud));
  }
  return rocks;
}

/// A chain of spheres in place of an ellipsoid of revolution, with the ellipsoid's mass.
ShapeSet makeChain(int spheres) {
  constexpr double a = 2.7e-3, b = 1.15e-3;
  return {std::make_shared<Clump>(makeEllipsoidChain(a, b, spheres), Ellipsoid(Vec3(a, b, b)).massProperties())};
}

/// A cube as a hull of eight points: Bullet's GJK/EPA searches it, and the way of all polyhedra looks at it.
ShapeSet makeHullOfCube() {
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k) corners.push_back(0.5 * diameter * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  return {std::make_shared<Polyhedron>(corners)};
}

struct Family {
  std::string scene;
  std::function<ShapeSet(std::uint64_t seed)> shapes;
  double solidFraction;  ///< of the lattice that it starts from
};

const std::vector<Family>& families() {
  const auto spheres = [](std::uint64_t) { return ShapeSet{std::make_shared<Sphere>(diameter / 2)}; };
  const auto cubes = [](std::uint64_t) { return ShapeSet{std::make_shared<Cuboid>(Vec3::Constant(diameter / 2))}; };
  static const std::vector<Family> all = {
      {"cubes", cubes, 0.58},
      {"cube_hulls", [](std::uint64_t) { return makeHullOfCube(); }, 0.58},
      {"spheres", spheres, 0.6},
      {"ellipsoids", [](std::uint64_t) { return ShapeSet{std::make_shared<Ellipsoid>(Vec3(1.5e-3, 1.5e-3, 3e-3))}; },
       0.62},
      {"cylinders", [](std::uint64_t) { return ShapeSet{std::make_shared<Cylinder>(diameter / 2, diameter)}; }, 0.6},
      {"rocks20", [](std::uint64_t seed) { return makeRocks(20, seed); }, 0.58},
      {"rocks60", [](std::uint64_t seed) { return makeRocks(60, seed); }, 0.58},
      {"rocks500", [](std::uint64_t seed) { return makeRocks(500, seed); }, 0.58},
      {"clumps5", [](std::uint64_t) { return makeChain(5); }, 0.58},
      {"clumps9", [](std::uint64_t) { return makeChain(9); }, 0.58},
      {"clumps17", [](std::uint64_t) { return makeChain(17); }, 0.58},
      {"resting", spheres, 0.6},
      {"stirred", spheres, 0.6},
      {"stirred_alone", spheres, 0.6},
      {"free_fall", spheres, 0.05},
      {"free_fall_cubes", cubes, 0.05},
      {"hopper", spheres, 0.5},
  };
  return all;
}

std::unique_ptr<World> makeWorld(const WorldOptions& options, const ShapeSet& shapes) {
  MaterialTable materials;
  materials.add("grain", ContactParameters{});
  auto world = std::make_unique<World>(options, std::move(materials));
  for (const auto& shape : shapes) world->addShape(shape);
  return world;
}

/// Spacing of a lattice with this solid fraction, m.
double spacingOf(const Family& family, const ShapeSet& shapes) {
  double volume = 0;
  for (const auto& shape : shapes) volume += shape->massProperties().volume;
  return std::cbrt(volume / static_cast<double>(shapes.size()) / family.solidFraction);
}

/// A lattice of perSide columns each way about the z axis, from the height bottom on, displaced a little and turned at
/// random.
void addLattice(int count, int perSide, double pitch, double bottom, Random& random, World& world) {
  const double half = 0.5 * pitch * perSide;
  world.bodies.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const int column = k % perSide, row = k / perSide % perSide, layer = k / (perSide * perSide);
    NewBody body;
    body.shapeIndex = static_cast<std::int32_t>(static_cast<std::size_t>(k) % world.shapes.size());
    body.pose.x = Vec3((column + 0.5) * pitch - half, (row + 0.5) * pitch - half, bottom + (layer + 0.5) * pitch) +
                  0.1 * pitch * random.direction();
    body.pose.q = random.rotation();
    world.addBody(body);
  }
}

/// Steps whose velocities keep only this share, and never move a surface far at once.
void settle(World& world, double dt, int steps, double keep) {
  constexpr double furthest = 0.01;  // per step, over the size
  Bodies& bodies = world.bodies;
  for (int n = 0; n < steps; ++n) {
    step(world, dt);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const double limit = furthest * bodies.shape[i]->size() / dt;
      const double speed = bodies.vHalf(i).norm();
      const double turning = bodies.wHalfOf(i).norm() * bodies.boundingRadius(i);
      bodies.vHalf(i) *= keep * std::min(1.0, limit / std::max(speed, limit));
      bodies.wHalfOf(i) *= keep * std::min(1.0, limit / std::max(turning, limit));
    }
  }
}

/// Presses the bed by a hundredfold weight, and lets go bit by bit, so that nothing rebounds.
void letGo(const Vec3& gravity, double dt, World& world) {
  for (const auto& [weights, steps] :
       {std::pair{100, 1500}, std::pair{20, 1000}, std::pair{4, 1000}, std::pair{1, 1500}}) {
    world.options.gravity = weights * gravity;
    settle(world, dt, steps, 0.995);
  }
}

/// A periodic bed at rest on the floor. Returns the world it was made in.
std::unique_ptr<World> makePatch(const Family& family, int count, const BedSettings& settings) {
  constexpr double dt = 5e-6;
  const ShapeSet shapes = family.shapes(settings.seed);
  const double pitch = spacingOf(family, shapes);
  const int perSide = std::max(5, static_cast<int>(std::lround(std::cbrt(count))));
  WorldOptions options;
  options.rule.rule = PointRule::witness;
  options.periods.length = {perSide * pitch, perSide * pitch, 0};
  options.periods.origin = {-0.5 * perSide * pitch, -0.5 * perSide * pitch, 0};

  // Drive the overlaps out.
  options.gravity.setZero();
  Random random(settings.seed);
  std::unique_ptr<World> world = makeWorld(options, shapes);
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  addLattice(count, perSide, pitch, 0, random, *world);
  startHalfSteps(*world, dt, 0, false);
  for (int round = 0; round < 60; ++round) {
    world->report = Report{};
    settle(*world, dt, 25, 0.9);
    if (world->report.deepestOverlap < 0.03) break;
  }

  letGo(settings.options.gravity, dt, *world);
  return world;
}

/// The patch repeated across the plane; shuffle: in an order at random, if given.
std::unique_ptr<World> repeatPatch(const World& patch, int repeats, Random* shuffle, WorldOptions options) {
  const Vec3 period = patch.options.periods.length;
  options.periods.length = repeats * period;
  options.periods.origin = patch.options.periods.origin;
  std::unique_ptr<World> world = makeWorld(options, patch.shapes);
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  const std::size_t inPatch = patch.bodies.size(), count = static_cast<std::size_t>(repeats * repeats) * inPatch;
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  if (shuffle) {
    for (std::size_t k = count; k > 1; --k) std::swap(order[k - 1], order[shuffle->below(k)]);
  }
  world->bodies.reserve(count);
  for (const std::size_t k : order) {
    const std::size_t i = k % inPatch;
    const int tile = static_cast<int>(k / inPatch), column = tile % repeats, row = tile / repeats;
    NewBody body;
    body.shapeIndex = patch.bodies.shapeIndex[i];
    body.pose = {patch.bodies.x(i) + Vec3(column * period.x(), row * period.y(), 0), patch.bodies.orientation(i)};
    world->addBody(body);
  }
  return world;
}

std::unique_ptr<World> makeFreeFall(const Family& family, const BedSettings& settings) {
  const ShapeSet shapes = family.shapes(settings.seed);
  const double pitch = spacingOf(family, shapes);
  const int perSide = static_cast<int>(std::ceil(std::cbrt(settings.count)));
  Random random(settings.seed);
  std::unique_ptr<World> world = makeWorld(settings.options, shapes);
  addLattice(settings.count, perSide, pitch, 0, random, *world);
  for (std::size_t i = 0; i < world->bodies.size(); ++i) {
    world->bodies.v(i) = 0.1 * random.direction();
    world->bodies.w(i) = 10 * random.direction();
  }
  return world;
}

/// A square funnel with a square hole: four trapezia that lean inwards.
TriangleMesh makeFunnel(double hole, double rim, double height) {
  TriangleMesh mesh;
  for (const auto& [half, z] : {std::pair{hole, 0.0}, std::pair{rim, height}}) {
    for (const auto& [x, y] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}}) {
      mesh.vertices.emplace_back(x * half, y * half, z);
    }
  }
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    mesh.triangles.push_back({next, k, 4 + k});
    mesh.triangles.push_back({next, 4 + k, 4 + next});
  }
  return mesh;
}

/// A box of spheres over a funnel at 45 degrees whose hole is eight diameters wide.
std::unique_ptr<World> makeHopper(const Family& family, const BedSettings& settings) {
  const ShapeSet shapes = family.shapes(settings.seed);
  const double pitch = spacingOf(family, shapes);
  const int perSide = std::max(16, static_cast<int>(std::lround(std::cbrt(settings.count))));
  const double rim = 0.5 * perSide * pitch + 0.5 * diameter, hole = 4 * diameter;
  std::unique_ptr<World> world = makeWorld(settings.options, shapes);
  for (const double sign : {-1.0, 1.0}) {
    world->walls.push_back(makePlaneWall({sign * rim, 0, 0}, {-sign, 0, 0}));
    world->walls.push_back(makePlaneWall({0, sign * rim, 0}, {0, -sign, 0}));
  }
  world->walls.push_back(makeMeshWall(makeFunnel(hole, rim, rim - hole), "funnel"));
  Random random(settings.seed);
  addLattice(settings.count, perSide, pitch, rim - hole + 0.5 * diameter, random, *world);
  constexpr double dt = 5e-6;
  startHalfSteps(*world, dt, 0, false);
  settle(*world, dt, 1500, 0.9);
  letGo(settings.options.gravity, dt, *world);
  for (MotionRow& row : world->bodies.motion) row.v = row.w = Vec3::Zero();
  return world;
}

/// The patch repeated as often as a bed of settings.count bodies needs.
std::unique_ptr<World> makeDenseBed(const Family& family, const BedSettings& settings, bool sleeps) {
  constexpr double mostInPatch = 2000;
  const int repeats = static_cast<int>(std::ceil(std::sqrt(settings.count / mostInPatch)));
  const int inPatch = static_cast<int>(std::lround(static_cast<double>(settings.count) / (repeats * repeats)));
  WorldOptions options = settings.options;
  options.sleep.on = sleeps;
  Random random(settings.seed);
  return repeatPatch(*makePatch(family, inPatch, settings), repeats, settings.shuffled ? &random : nullptr, options);
}

/// A hundred spheres in layers that knock against each other for some milliseconds, above a bed that sleeps; alone:
/// without the bed.
std::unique_ptr<World> makeStirred(const Family& family, const BedSettings& settings, bool alone) {
  constexpr double dt = 2e-6;
  BedSettings calm = settings;
  calm.options.sleep.energy = 1e-3;  // loose spheres rock for long
  std::unique_ptr<World> world = makeDenseBed(family, calm, true);
  startHalfSteps(*world, dt, 0, true);
  for (int n = 0; n < 30000 && !world->bodies.movingSlots().empty(); ++n) step(*world, dt);
  double top = 0;
  for (const BoundingSphere& sphere : world->bodies.bounds) top = std::max(top, sphere.x.z());
  if (alone) world->removeBodies(std::vector<bool>(world->bodies.size(), true));
  Random random(settings.seed);
  const std::size_t first = world->bodies.size();
  for (int k = 0; k < 100; ++k) {
    NewBody body;
    const int column = k % 7, row = k / 7 % 7, layer = k / 49;
    body.pose.x = diameter * Vec3(1.02 * column, 1.02 * row, top / diameter + 1.1 + 1.02 * layer);
    body.velocity = 0.05 * random.direction();
    body.spin = 10 * random.direction();
    world->addBody(body);
  }
  startHalfSteps(*world, dt, first, false);
  return world;
}

}  // namespace

std::vector<std::string> bedScenes() {
  std::vector<std::string> names;
  for (const Family& family : families()) names.push_back(family.scene);
  return names;
}

std::unique_ptr<World> makeBed(const BedSettings& settings) {
  const auto isAsked = [&](const Family& each) { return each.scene == settings.scene; };
  const auto family = std::find_if(families().begin(), families().end(), isAsked);
  require(family != families().end(), "unknown scene \"" + settings.scene + "\"");
  require(settings.count >= 1, "count = " + std::to_string(settings.count) + ": must be >= 1");
  if (family->scene.starts_with("free_fall")) return makeFreeFall(*family, settings);
  if (family->scene == "hopper") return makeHopper(*family, settings);
  if (family->scene.starts_with("stirred")) {
    return makeStirred(*family, settings, family->scene == "stirred_alone");
  }
  return makeDenseBed(*family, settings, family->scene == "resting");
}

std::unique_ptr<World> loadCubes(const std::string& path, const WorldOptions& options) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::getline(file, line);
  double count = 0, base = 0, side = 0;
  std::string hash;
  std::istringstream second(line);
  if (line.starts_with("#")) second >> hash;
  second >> count >> base >> side;
  require(file.good() && base > 0 && side > 0, path + ": can't be read, or no second line 'count base side'");

  std::unique_ptr<World> world = makeWorld(options, {std::make_shared<Cuboid>(Vec3::Constant(side / 2))});
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  for (const double sign : {-1.0, 1.0}) {
    world->walls.push_back(makePlaneWall({sign * base / 2, 0, 0}, {-sign, 0, 0}));
    world->walls.push_back(makePlaneWall({0, sign * base / 2, 0}, {0, -sign, 0}));
  }
  while (std::getline(file, line)) {
    NewBody body;
    Quat& q = body.pose.q;
    Vec3& x = body.pose.x;
    std::istringstream(line) >> x.x() >> x.y() >> x.z() >> q.w() >> q.x() >> q.y() >> q.z();
    world->addBody(body);
  }
  return world;
}

}  // namespace granular::benchmarks
