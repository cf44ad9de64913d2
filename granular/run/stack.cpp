#include "granular/run/stack.h"

#include <chrono>
#include <cmath>

#include "granular/core/errors.h"
#include "granular/run/stack_watch.h"
#include "granular/shape/polyhedron.h"
#include "granular/world/time_step.h"
#include "granular/world/world.h"

namespace granular {
namespace {

std::unique_ptr<World> buildTower(const StackSettings& settings, const std::vector<Pose>& poses) {
  WorldOptions options;
  options.gravity = Vec3(0, 0, -settings.gravity);
  options.rule = settings.rule;
  options.law = settings.law;
  options.lawOptions = settings.lawOptions;
  options.skips = {settings.skip, settings.skip, settings.skip};
  MaterialTable materials;
  materials.add("cuboid", settings.contact);
  auto world = std::make_unique<World>(options, std::move(materials));
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));

  // One shape for each factor of the sequence.
  const int kinds = std::max<int>(1, static_cast<int>(settings.sizes.size()));
  for (int k = 0; k < kinds; ++k) world->addShape(std::make_shared<Cuboid>(halfLengths(settings, k)));
  for (int k = 0; k < settings.count; ++k) {
    NewBody body;
    body.id = k;
    body.shapeIndex = k % kinds;
    body.density = settings.density;
    body.pose = poses[static_cast<std::size_t>(k)];
    world->addBody(body);
  }
  return world;
}

double chooseStep(const StackSettings& settings, const World& world) {
  std::vector<BodyKind> kinds;
  for (const auto& shape : world.shapes) kinds.push_back({shape.get(), 0, settings.density});
  // A face on either side.
  const TimeStepBound bound = boundBeforeRun(kinds, world.materials, world.options, 2);
  if (settings.step == 0) return settings.fraction * bound.bound;
  require(settings.step <= bound.bound, "dt = " + std::to_string(settings.step) + " s is above " + bound.explanation);
  return settings.step;
}

double meanSpeed(const Bodies& bodies) {
  double sum = 0;
  for (const MotionRow& row : bodies.motion) sum += row.v.norm();
  return sum / static_cast<double>(bodies.size());
}

/// The upward force on each cuboid from what is below it.
std::vector<double> layerForces(const World& world) {
  std::vector<double> force(world.bodies.size(), 0.0);
  world.visitContacts([&](const Contact& contact) {
    const std::int64_t a = world.bodies.id[static_cast<std::size_t>(contact.a)];
    const std::int64_t b = contact.b < 0 ? -1 : world.bodies.id[static_cast<std::size_t>(contact.b)];
    const double onA = contact.force.force.z();
    if (a > b) {
      force[static_cast<std::size_t>(a)] += onA;
    } else {
      force[static_cast<std::size_t>(b)] -= onA;
    }
  });
  return force;
}

/// Poses by id: slots need not be ids.
std::vector<Pose> posesOf(const Bodies& bodies) {
  std::vector<Pose> poses(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    poses[static_cast<std::size_t>(bodies.id[i])] = bodies.poseOf(i);
  }
  return poses;
}

}  // namespace

StackRun::StackRun(const StackSettings& settings) : chosen(settings) {
  checkStack(chosen);
  const std::vector<Pose> placed = placeStack(chosen);
  world = buildTower(chosen, placed);
  dt = chooseStep(chosen, *world);
  tower = std::make_unique<StackWatch>(chosen, placed);
  startHalfSteps(*world, dt, 0, true);
}

StackRun::~StackRun() = default;
StackRun::StackRun(StackRun&&) noexcept = default;

double StackRun::time() const { return world->time; }

StackResult StackRun::run(const StackObserver& watch, const StackCheckpoints& checkpoints) {
  const auto steps = static_cast<std::int64_t>(std::ceil(chosen.time / dt));
  const std::int64_t perSample = std::max<std::int64_t>(1, std::llround(chosen.sampleEvery / dt));
  // Energies are noted some ten times in a sample: waves in the tower take longer.
  const std::int64_t perNote = std::max<std::int64_t>(1, perSample / 10);

  const auto began = std::chrono::steady_clock::now();
  const double before = wall;
  double savedAt = wall;
  bool stopped = false;
  while (world->steps < steps && !tower->fallen() && !stopped) {
    step(*world, dt);
    const std::int64_t k = world->steps;
    if (k % perNote == 0) tower->note(kineticEnergy(world->bodies), meanSpeed(world->bodies));
    if (k % perSample != 0 && k != steps) continue;
    const StackSample& sample = tower->sample(world->time, posesOf(world->bodies), layerForces(*world));
    stopped = watch && !watch(sample) && k != steps && !tower->fallen();
    wall = before + std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    // The last sample may end an interval early, which a longer run would not: nothing is kept there.
    if (checkpoints.folder.empty() || k == steps || tower->fallen()) continue;
    if (stopped || wall - savedAt > checkpoints.every) {
      save(checkpoints.folder);
      savedAt = wall;
    }
  }

  StackResult result = tower->finish(world->time);
  result.stopped = stopped;
  result.wallTime = wall;
  result.step = dt;
  result.steps = world->steps;
  const Report& report = world->report;
  result.nsPerContact = report.contactSteps > 0 ? 1e9 * result.wallTime / static_cast<double>(report.contactSteps) : 0;
  result.deepestOverlap = report.deepestOverlap;
  result.uncertified = report.narrow.uncertified;
  result.poses = posesOf(world->bodies);
  return result;
}

StackResult runStack(const StackSettings& settings, const StackObserver& watch) {
  return StackRun(settings).run(watch);
}

}  // namespace granular
