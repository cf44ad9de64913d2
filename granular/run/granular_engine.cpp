// The granular layer as an engine of the comparison.
#include <algorithm>
#include <ctime>

#include "granular/run/comparison_engine.h"
#include "granular/world/time_step.h"
#include "granular/world/world.h"

namespace granular {
namespace {

/// Mean mass of the bodies that move, kg.
double meanMass(const SceneSetup& setup) {
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < setup.bodies.size(); ++k) {
    if (setup.bodies[k].fixed) continue;
    sum += setup.mass(k);
    ++count;
  }
  return sum / count;
}

std::unique_ptr<World> buildWorld(const SceneSetup& setup, const EngineSettings& settings) {
  WorldOptions options;
  options.gravity = Vec3(0, 0, -setup.gravity);
  options.rule = settings.rule;
  options.law = settings.law;
  ContactParameters contact;
  contact.stiffness = meanMass(setup) * setup.gravity / (settings.softness * setup.unit);
  contact.restitution = setup.restitution;
  contact.friction = setup.friction;
  MaterialTable materials;
  materials.add("stone", contact);
  auto world = std::make_unique<World>(options, std::move(materials));
  for (const ScenePlane& plane : setup.planes) world->walls.push_back(makePlaneWall(plane.point, plane.normal));

  std::vector<const Shape*> known;
  for (std::size_t k = 0; k < setup.bodies.size(); ++k) {
    const SceneBody& each = setup.bodies[k];
    auto index = static_cast<std::size_t>(std::find(known.begin(), known.end(), each.shape.get()) - known.begin());
    if (index == known.size()) {
      known.push_back(each.shape.get());
      world->addShape(each.shape);
    }
    NewBody body;
    body.id = static_cast<std::int64_t>(k);
    body.shapeIndex = static_cast<std::int32_t>(index);
    body.density = setup.density;
    body.pose = each.pose;
    body.velocity = each.velocity;
    body.spin = each.spin;
    const std::size_t slot = world->addBody(body);
    if (each.fixed) world->bodies.hold(slot, BodyState::frozen);
  }
  return world;
}

double chooseStep(const SceneSetup& setup, const EngineSettings& settings, const World& world) {
  std::vector<BodyKind> kinds;
  for (const auto& shape : world.shapes) kinds.push_back({shape.get(), 0, setup.density});
  return settings.fraction * boundBeforeRun(kinds, world.materials, world.options, setup.contactsPerBody).bound;
}

/// Adds a snapshot; false, and none added, if it is not finite.
bool record(const World& world, Recording& recording) {
  Snapshot now;
  now.time = world.time;
  const Bodies& bodies = world.bodies;
  now.bodies.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    // Slots need not be ids.
    now.bodies[static_cast<std::size_t>(bodies.id[i])] = {bodies.poseOf(i), bodies.v(i), bodies.w(i)};
    if (!bodies.x(i).allFinite() || !bodies.orientation(i).coeffs().allFinite() || !bodies.w(i).allFinite())
      return false;
  }
  recording.snapshots.push_back(std::move(now));
  return true;
}

}  // namespace

EngineRun runGranularScene(const SceneSetup& setup, const EngineSettings& settings) {
  const std::unique_ptr<World> world = buildWorld(setup, settings);
  EngineRun run;
  run.step = chooseStep(setup, settings, *world);
  const auto steps = static_cast<std::int64_t>(std::ceil(setup.duration / run.step));
  const std::int64_t perSample = std::max<std::int64_t>(1, std::llround(setup.sampleEvery / run.step));
  record(*world, run.recording);

  const std::clock_t began = std::clock();
  startHalfSteps(*world, run.step, 0, true);
  for (std::int64_t k = 1; k <= steps && run.recording.finite; ++k) {
    step(*world, run.step);
    if (k % perSample == 0 || k == steps) run.recording.finite = record(*world, run.recording);
  }
  run.processorTime = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;

  run.steps = world->steps;
  run.simulated = world->time;
  run.contacts = world->report.contactSteps;
  run.uncertified = world->report.narrow.uncertified;
  if (!world->report.troubles.empty()) run.trouble = describe(world->report.troubles.front());
  return run;
}

}  // namespace granular
