// (f) Columns: what the walls of a filled tube carry.
#include <fmt/format.h>

#include "granular/core/random.h"
#include "verification/record.h"
#include "verification/scenes.h"

namespace granular {
namespace {

TEST(Flow, WallFrictionAndFloorCarryTheWeightOfAColumn) {
  // 90 spheres settle in a tube of four diameters, then rest: all forces on the walls together are the weight.
  const double radius = 1.5e-3, tube = 4 * radius;
  WorldOptions options = plainOptions();
  options.gravity = Vec3(0, 0, -9.81);
  options.lawOptions.frictionOfPush = false;
  options.lawOptions.tension = true;
  auto world = makeWorld(options, {5e3, .3, .3, .5});
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  world->walls.push_back(makeCylinderWall(Vec2::Zero(), tube));
  const auto shape = sphereOf(radius);
  Random random(3);
  for (int k = 0; k < 90; ++k) {
    const double angle = 2 * pi * (k % 6) / 6 + .2 * random.uniform(), away = k % 6 == 5 ? 0 : 2.6 * radius;
    const int layer = k / 6;
    place(*world, shape, {away * std::cos(angle), away * std::sin(angle), radius * (1.2 + 2.2 * layer)});
  }
  const double dt = .04 * pi * std::sqrt(world->bodies.mass[0] / 5e3);
  runFor(*world, dt, .5);

  // The mean over .02 s, of what still swings. How much of it the wall carries, statics leaves open: rounding alone
  // makes it some percent of the weight or a few thousandths.
  double weight = 0, floor = 0, wall = 0;
  for (const double mass : world->bodies.mass) weight += mass * 9.81;
  const int steps = static_cast<int>(.02 / dt);
  for (int n = 0; n < steps; ++n) {
    step(*world, dt);
    floor -= world->wallForces[0].z() / steps;
    wall -= world->wallForces[1].z() / steps;
  }
  verify('f', "column of 90 spheres in a tube: (floor + wall)/weight", 1, (floor + wall) / weight, 1e-4,
         "equilibrium (Janssen's premise); decayed motion");
}

}  // namespace
}  // namespace granular
