// (f) Columns, silos and heaps.
#include <algorithm>
#include <array>

#include "granular/analysis/pile.h"
#include "granular/core/random.h"
#include "granular/run/bed_of_world.h"
#include "verification/record.h"
#include "verification/scenes.h"

namespace granular {
namespace {

constexpr double earth = 9.81;  // m/s^2

/// Spheres as sand has them: friction and damping, under gravity; soft enough for steps of some 1e-5 s.
WorldOptions grainOptions(double gravity = earth) {
  WorldOptions options = plainOptions();
  options.gravity = Vec3(0, 0, -gravity);
  options.lawOptions.frictionOfPush = false;
  options.lawOptions.tension = true;
  return options;
}

/// A twentieth of the contact time of two equal bodies of this mass, s.
double stepFor(double mass, double stiffness) { return pi * std::sqrt(mass / (2 * stiffness)) / 20; }

/// Spheres of nine sizes, from 1 - spread to 1 + spread times the radius: no bed of them crystallises.
std::vector<std::shared_ptr<const Shape>> mixedSpheres(double radius, double spread) {
  std::vector<std::shared_ptr<const Shape>> sizes;
  for (int k = -4; k <= 4; ++k) sizes.push_back(sphereOf(radius * (1 + .25 * k * spread)));
  return sizes;
}

TEST(Flow, WallFrictionAndFloorCarryTheWeightOfAColumn) {
  // 90 spheres settle in a tube of four diameters, then rest: all forces on the walls together are the weight.
  const double radius = 1.5e-3, tube = 4 * radius;
  auto world = makeWorld(grainOptions(), {5e3, .3, .3, .5});
  addFloor(*world);
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
  for (const double mass : world->bodies.mass) weight += mass * earth;
  const int steps = static_cast<int>(.02 / dt);
  for (int n = 0; n < steps; ++n) {
    step(*world, dt);
    floor -= world->wallForces[0].z() / steps;
    wall -= world->wallForces[1].z() / steps;
  }
  verify('f', "column of 90 spheres in a tube: (floor + wall)/weight", 1, (floor + wall) / weight, 1e-4,
         "equilibrium (Janssen's premise); decayed motion");
}

TEST(Flow, WallThatSlidesUpCarriesWhatJanssenSays) {
  // Statics leaves open what a wall carries; one that slides along the column carries mu times its push everywhere
  // (of less friction than the spheres have among themselves: they would roll along it). Then the column's balance has
  // one unknown, the ratio K of the stress on the wall to that along the axis. It is read from the contacts in the
  // middle of the column, and the floor's share follows without any fit.
  const double radius = 1.5e-3, tube = 8 * radius, friction = .15, stiffness = 1e3;
  MaterialTable materials;
  materials.add("spheres", {stiffness, .3, .3, .5});
  const int smooth = materials.add("tube", {stiffness, .3, .3, .5});
  materials.setPair("spheres", "tube", {stiffness, .3, .3, friction});
  World world(grainOptions(), std::move(materials));
  addFloor(world);
  const double settled = .4, slid = .1, measured = .2;  // s
  WallPath lift;
  lift.velocity = Vec3(0, 0, .03);
  lift.start = settled;
  world.walls.push_back(makeMovingWall(makeCylinderWall(Vec2::Zero(), tube), lift, {}));
  world.walls.back()->material = smooth;
  Random random(5);
  const auto sizes = mixedSpheres(radius, .12);
  const double pitch = 2.3 * radius;
  const int across = static_cast<int>(tube / pitch);
  for (int layer = 0; layer < 28; ++layer) {
    for (int i = -across; i <= across; ++i) {
      for (int j = -across; j <= across; ++j) {
        const Vec3 off(random.uniform(-.05, .05) * radius, random.uniform(-.05, .05) * radius, 0);
        const Vec3 x = Vec3(i * pitch, j * pitch, (1.2 + 2.3 * layer) * radius) + off;
        if (x.head<2>().norm() < tube - 1.12 * radius) place(world, sizes[random.below(sizes.size())], x);
      }
    }
  }
  const double dt = stepFor(world.bodies.mass[0], stiffness);
  runFor(world, dt, settled + slid);

  double top = 0, weight = 0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    top = std::max(top, world.bodies.x(i).z());
    weight += world.bodies.mass[i] * earth;
  }
  // Push and friction of the wall, and weight, by height.
  constexpr int bins = 20;
  std::array<double, bins> push{}, rub{}, load{};
  const auto binOf = [&](double z) { return std::clamp(static_cast<int>(z / top * bins), 0, bins - 1); };
  double floor = 0;
  const int steps = static_cast<int>(measured / dt);
  for (int n = 0; n < steps; ++n) {
    step(world, dt);
    floor -= world.wallForces[0].z() / steps;
    world.visitContacts([&](const Contact& contact) {
      if (contact.b != -2) return;
      const int bin = binOf(contact.patch.point.z());
      push[bin] += contact.force.normalForce / steps;
      rub[bin] += contact.force.force.z() / steps;
    });
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    load[binOf(world.bodies.x(i).z())] += world.bodies.mass[i] * earth;

  double pushes = 0, rubs = 0, carried = 0, pushesBetween = 0, carriedBetween = 0;
  for (int bin = bins - 1; bin >= 0; --bin) {
    pushes += push[bin];
    rubs += rub[bin];
    const double middle = carried + .5 * (load[bin] - rub[bin]);
    carried += load[bin] - rub[bin];
    if (bin < bins / 5 || bin >= bins - bins / 5) continue;
    pushesBetween += push[bin];
    carriedBetween += middle;
  }
  // Stress on the wall over stress along the axis, in the middle three fifths.
  const double ratio = pushesBetween / (2 * pi * tube * top / bins) / (carriedBetween / (pi * tube * tube));
  const double length = tube / (2 * friction * ratio);
  const double janssen = length / top * (1 - std::exp(-top / length));
  verify('f', "wall that slides along a column of spheres: friction/push", friction, rubs / pushes, .03 * friction,
         "Coulomb");
  verify('f', "wall that slides along a column of spheres: floor/weight", janssen, floor / weight, .05,
         "Janssen, K as measured; K varies by a tenth along the column");
}

/// A floor with a round hole at the height 0: a ring from outside inwards, and the inside of its hole.
std::unique_ptr<Wall> makeFloorWithHole(double outside, double hole, double thickness) {
  TriangleMesh ring;
  constexpr int around = 48;
  for (const Vec2& p : {Vec2(outside, 0), Vec2(hole, 0), Vec2(hole, -thickness)}) {
    for (int k = 0; k < around; ++k) {
      const double azimuth = 2 * pi * k / around;
      ring.vertices.emplace_back(p.x() * std::cos(azimuth), p.x() * std::sin(azimuth), p.y());
    }
  }
  for (int level = 0; level < 2; ++level) {
    for (int k = 0; k < around; ++k) {
      const int a = level * around + k, b = level * around + (k + 1) % around;
      ring.triangles.push_back({a, b, a + around});
      ring.triangles.push_back({b, b + around, a + around});
    }
  }
  return makeMeshWall(ring, "the floor");
}

struct Discharge {
  double rate, error;  ///< spheres per sqrt(d/g), and its standard error
};

/// Spheres of diameter d = 2 mm run out of a flat-bottomed silo; those that have left come back on top.
Discharge measureDischarge(double orifice, double gravity) {
  const double radius = 1e-3, silo = 12 * radius, stiffness = 100;
  auto world = makeWorld(grainOptions(gravity), {stiffness, .5, .5, .4});
  world->walls.push_back(makeCylinderWall(Vec2::Zero(), silo));
  world->walls.push_back(makeFloorWithHole(1.2 * silo, orifice / 2, 2 * radius));
  Random random(7);
  const auto sizes = mixedSpheres(radius, .12);
  const double pitch = 2.3 * radius;
  const int across = static_cast<int>(silo / pitch);
  const auto placeAny = [&](const Vec3& x) { place(*world, sizes[random.below(sizes.size())], x); };
  const auto inside = [&](const Vec3& x) { return x.head<2>().norm() < silo - 1.12 * radius; };
  for (int layer = 0; layer < 16; ++layer) {
    for (int i = -across; i <= across; ++i) {
      for (int j = -across; j <= across; ++j) {
        const Vec3 x =
            Vec3(i, j, layer) * pitch + Vec3(random.uniform(-.05, .05), random.uniform(-.05, .05), 1.2) * radius;
        if (inside(x)) placeAny(x);
      }
    }
  }
  // A free place above the bed.
  const auto comeBack = [&] {
    while (true) {
      const Vec3 x(random.uniform(-silo, silo), random.uniform(-silo, silo), random.uniform(34, 60) * radius);
      const auto meets = [&](const BoundingSphere& other) { return (other.x - x).norm() < 2.3 * radius; };
      if (inside(x) && std::none_of(world->bodies.bounds.begin(), world->bodies.bounds.end(), meets))
        return placeAny(x);
    }
  };
  const double dt = stepFor(world->bodies.mass[0], stiffness), unit = std::sqrt(2 * radius / gravity);
  startHalfSteps(*world, dt, 0, true);
  // Some units of time to begin with, then ten parts.
  constexpr double begin = 20, part = 4;
  std::array<double, 10> parts{};
  const auto steps = static_cast<int>((begin + part * parts.size()) * unit / dt);
  for (int n = 0; n < steps; ++n) {
    step(*world, dt);
    if (n % 50 != 0) continue;
    std::vector<bool> gone(world->bodies.size());
    for (std::size_t i = 0; i < gone.size(); ++i) gone[i] = world->bodies.x(i).z() < -4 * radius;
    const auto left = std::count(gone.begin(), gone.end(), true);
    if (left == 0) continue;
    const double at = (n * dt / unit - begin) / part;
    if (at >= 0) parts[std::min(static_cast<std::size_t>(at), parts.size() - 1)] += static_cast<double>(left) / part;
    world->removeBodies(gone);
    const std::size_t first = world->bodies.size();
    for (std::ptrdiff_t k = 0; k < left; ++k) comeBack();
    startHalfSteps(*world, dt, first, false);
  }
  double mean = 0, squares = 0;
  for (const double one : parts) mean += one / parts.size();
  for (const double one : parts) squares += (one - mean) * (one - mean) / (parts.size() - 1);
  return {mean, std::sqrt(squares / parts.size())};
}

TEST(Flow, DischargeGrowsWithOrificeAndGravityAsBeverlooSays) {
  const double size = 2e-3;
  Vec2 sum = Vec2::Zero(), squares = Vec2::Zero();
  double products = 0;
  Discharge middle{};
  for (const double orifice : {4, 5, 6, 7}) {
    const Discharge discharge = measureDischarge(orifice * size, earth);
    if (orifice == 5) middle = discharge;
    const Vec2 point(orifice, std::pow(discharge.rate, .4));
    sum += point / 4;
    squares += point.cwiseAbs2() / 4;
    products += point.prod() / 4;
  }
  const Vec2 variance = squares - sum.cwiseAbs2();
  const double covariance = products - sum.prod();
  verify('f', "discharge W from orifices of 4 to 7 diameters: R^2 of W^.4 over the orifice", 1,
         covariance * covariance / variance.prod(), .01, "Beverloo et al. 1961");
  // In units of sqrt(d/g) the rate is the same.
  const Discharge heavy = measureDischarge(5 * size, 4 * earth);
  verify('f', "discharge under four times the gravity: W/W", 2, 2 * heavy.rate / middle.rate,
         2 * 3 * std::hypot(heavy.error / heavy.rate, middle.error / middle.rate), "W ~ sqrt(g); 3 standard errors");
}

/// A block of discs beside a wall falls apart on a rough floor: the angle of what stays, degrees.
double measureRepose(double friction, double partOfStep, int seed) {
  const double radius = 1e-3, stiffness = 100;
  auto world = makeWorld(grainOptions(), {stiffness, .3, .3, friction});
  addFloor(*world);
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitX()));
  const auto sizes = mixedSpheres(radius, .2);
  Random random(100 + seed);
  const auto put = [&](double x, double z) {
    NewBody body;
    body.shapeIndex = world->addShape(sizes[random.below(sizes.size())]);
    body.pose = {Vec3(x, 0, z), Quat::Identity()};
    body.locks = lockTranslation(1) | lockRotation(0) | lockRotation(2);
    return world->addBody(body);
  };
  for (int k = 0; k < 60; ++k) world->bodies.hold(put((1.3 + 2.45 * k) * radius, 1.3 * radius), BodyState::frozen);
  for (int layer = 0; layer < 18; ++layer) {
    for (int k = 0; k < 12; ++k)
      put((1.3 + 2.45 * k + random.uniform(-.02, .02)) * radius, (3.8 + 2.45 * layer) * radius);
  }
  const double dt = partOfStep * stepFor(world->bodies.mass[0], stiffness);
  runFor(*world, dt, .6);
  const Bed bed = makeBed(*world, {});
  const auto slope = fitSlope(sampleSide(bed, radius / 20), {}, 2 * radius);
  EXPECT_TRUE(slope);
  return slope ? slope->angle : 0;
}

struct MeanAngle {
  double mean = 0, error = 0;
};
MeanAngle meanRepose(double friction, double partOfStep) {
  constexpr int seeds = 10;
  double sum = 0, squares = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const double angle = measureRepose(friction, partOfStep, seed);
    sum += angle / seeds;
    squares += angle * angle / seeds;
  }
  return {sum, std::sqrt((squares - sum * sum) / (seeds - 1))};
}

TEST(Flow, AngleOfReposeGrowsWithFrictionAndNotWithTheStep) {
  const MeanAngle low = meanRepose(.05, 1), middle = meanRepose(.15, 1), high = meanRepose(.5, 1);
  const MeanAngle fine = meanRepose(.15, .5);
  verifyThat('f', "angle of repose, discs, 10 seeds: friction .15 above .05",
             middle.mean - low.mean > std::hypot(low.error, middle.error), "monotonic; by more than a standard error");
  verifyThat('f', "angle of repose, discs, 10 seeds: friction .5 above .15",
             high.mean - middle.mean > std::hypot(high.error, middle.error),
             "monotonic; by more than a standard error");
  verify('f', "angle of repose, discs, friction .15, 10 seeds: at half the step, degrees", middle.mean, fine.mean,
         3 * std::hypot(middle.error, fine.error), "the same; 3 standard errors");
}

}  // namespace
}  // namespace granular
