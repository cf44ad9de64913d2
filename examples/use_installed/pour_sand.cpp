// A first program with the library: twenty grains of made-up sand fall into a cylinder; how deep is the bed?
#include <algorithm>
#include <cstdio>

#include "granular/insert/inserter.h"
#include "granular/insert/made_particle.h"
#include "granular/world/time_step.h"
#include "granular/world/world.h"

using namespace granular;

int main() {
  const double density = 2500;  // kg/m^3
  const double radius = 6e-3;   // of the vessel, m

  // One material for all, soft so that steps are long; a vessel with a floor.
  MaterialTable materials;
  ContactParameters soft;
  soft.stiffness = 1e3;  // N/m
  const int sand = materials.add("sand", soft);
  World world(WorldOptions{}, materials);
  world.walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  world.walls.push_back(makeCylinderWall(Vec2::Zero(), radius));

  // Twenty grains at once, at random and without overlap.
  PourGroup grains;
  grains.name = "sand";
  grains.count = 20;
  grains.make = [](double, Random& random) { return std::shared_ptr<const Shape>(makeSand(SandOptions{}, random)); };
  grains.longestExtent = [](double) { return longestSand(SandOptions{}); };
  PourOptions options;
  options.minBatch = options.maxBatch = grains.count;
  options.reach = 6;  // longest extents above the floor: room for all at once
  Region region;
  region.kind = Region::Kind::cylinder;
  region.radius = radius;
  Inserter inserter(options, {grains}, region, {}, 1);
  std::vector<BodyKind> kinds;
  for (NewParticle& particle : inserter.insert(0, true, {})) {
    NewBody body;
    body.id = particle.number;
    body.material = sand;
    body.density = density;
    body.pose = particle.pose;
    body.shapeIndex = world.addShape(particle.shape);
    world.addBody(body);
    kinds.push_back({particle.shape.get(), sand, density});
  }

  // Four tenths of a second, enough to come to rest, at half of the largest stable step.
  const TimeStepBound bound = boundBeforeRun(kinds, world.materials, world.options);
  const double dt = bound.bound / 2;
  std::printf("%s\n%zu grains, steps of %.3g s\n", bound.explanation.c_str(), world.bodies.size(), dt);
  startHalfSteps(world, dt, 0, false);
  while (world.time < 0.4) step(world, dt);

  // Where they lie now.
  double top = 0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    top = std::max(top, world.bodies.shape[i]->bounds(world.bodies.frame[i]).hi.z());
  std::printf("after %.2f s: top at %.2f mm, %zu contacts, kinetic energy %.2g J\n", world.time, top * 1e3,
              world.contactCount(), kineticEnergy(world.bodies));
  return top < 4 * radius && world.contactCount() >= world.bodies.size() ? 0 : 1;
}
