// Bodies that meet nobody for a while, moved at once, against the same bodies moved step by step.
#include <gtest/gtest.h>
#include <omp.h>

#include "granular/io/state_hash.h"
#include "granular/shape/shape_table.h"
#include "world/heap.h"

namespace granular {
namespace {

constexpr double dt = 1e-5;

std::int32_t addShape(const char* name, const std::vector<double>& numbers, World& world) {
  return world.addShape(makeShape(name, numbers));
}

/// Every family of shapes, or spheres alone, at a wide pitch: many fly, and many meet.
std::unique_ptr<World> makeGas(const WorldOptions& options, int perSide, double pitch, bool spheresAlone = false) {
  auto world = testing::makeEmptyWorld(options, {2e3, .7, .7, .4});
  const double r = 1e-3;
  testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  std::vector<std::int32_t> shapes;
  const auto add = [&](const char* name, const std::vector<double>& numbers) {
    shapes.push_back(addShape(name, numbers, *world));
  };
  add("sphere", {r});
  if (!spheresAlone) {
    add("ellipsoid", {r, 1.2 * r, 0.8 * r});
    add("cylinder", {0.8 * r, 2 * r});
    add("cuboid", {r, 0.8 * r, 0.7 * r});
    add("polyhedron", {r, r, r, r, -r, -r, -r, r, -r, -r, -r, r});
    add("clump", {0, 0, 0, 0.8 * r, r, 0, 0, 0.6 * r});
  }
  testing::addLattice(shapes, perSide, pitch, 40, *world);
  return world;
}

/// The options of a run in which bodies fly, or in which each is moved in each step.
WorldOptions with(bool flight, WorldOptions options = {}) {
  options.skips.flight = flight;
  return options;
}

TEST(Flight, HasTheSameBitsAsStepByStepForEveryFamilySchemeAndOrderOfWork) {
  for (const SchemeKind scheme : {SchemeKind::seelen, SchemeKind::spiral}) {
    for (const bool orientation : {false, true}) {
      for (const bool oneByOne : {false, true}) {
        WorldOptions options;
        options.integrator = scheme;
        options.skips.orientation = !orientation;
        options.noBatches = oneByOne;
        const auto stepped = makeGas(with(false, options), 5, 8e-3), flying = makeGas(with(true, options), 5, 8e-3);
        testing::run(*stepped, dt, 2000);
        testing::run(*flying, dt, 2000);
        land(*flying);
        EXPECT_EQ(stepped->aloft.bodySteps, 0u);
        EXPECT_GT(flying->aloft.bodySteps, 50000u);  // of 250 000
        EXPECT_GT(flying->report.contactSteps, 1000u);
        EXPECT_EQ(flying->report.contactSteps, stepped->report.contactSteps);
        EXPECT_EQ(flying->report.bodySteps, stepped->report.bodySteps);
        EXPECT_EQ(flying->search.refreshes, stepped->search.refreshes);
        EXPECT_EQ(hashState(flying->bodies), hashState(stepped->bodies));
      }
    }
  }
}

TEST(Flight, LandsWheneverSomebodyAsksWithoutAnotherMotion) {
  const auto stepped = makeGas(with(false), 4, 9e-3), flying = makeGas(with(true), 4, 9e-3);
  startHalfSteps(*stepped, dt, 0, true);
  startHalfSteps(*flying, dt, 0, true);
  std::size_t aloft = 0;
  for (int n = 1; n <= 3000; ++n) {
    step(*stepped, dt);
    step(*flying, dt);
    if (n % 7 != 0 && n % 100 != 0) continue;
    aloft += flying->bodies.flying().all.size();
    land(*flying);
    ASSERT_EQ(hashState(flying->bodies), hashState(stepped->bodies)) << n;
  }
  EXPECT_GT(aloft, 1000u);
}

TEST(Flight, EndsBeforeTheMarginOfAnyBodyIsUsedUp) {
  // Tops whose spin is nearly about the axis of middle inertia: their speed of turning changes most.
  auto world = testing::makeEmptyWorld(with(true));
  addShape("cuboid", {2e-3, 1e-3, .3e-3}, *world);
  Random random(4);
  for (int k = 0; k < 64; ++k) {
    NewBody body;
    const int row = k / 4 % 4, layer = k / 16;
    body.pose.x = Vec3(k % 4, row, layer) * 0.05;
    body.pose.q = random.rotation();
    body.velocity = 0.2 * random.direction();
    body.spin = body.pose.q * Vec3(5, 600, 5);
    world->addBody(body);
  }
  startHalfSteps(*world, dt, 0, true);
  int landings = 0;
  for (int n = 0; n < 20000; ++n) {
    if (world->steps >= world->aloft.until) {
      land(*world);
      ++landings;
      EXPECT_FALSE(world->search.isDue(world->bodies, 0)) << "step " << n;
    }
    step(*world, dt);
  }
  EXPECT_GT(landings, 20);
  land(*world);
  EXPECT_GT(world->aloft.bodySteps, 64u * 10000);
}

TEST(Flight, OfPeriodicDomainsAndWithSeveralThreadsHasTheSameBits) {
  WorldOptions options;
  options.periods.length = Vec3(0.1, 0.1, 0);
  options.periods.origin = Vec3(-0.05, -0.05, 0);
  std::vector<std::string> hashes;
  for (const int threads : {0, 1, 2}) {
    if (threads > 0) omp_set_num_threads(threads);
    auto world = testing::makeEmptyWorld(with(threads > 0, options), {2e3, .7, .7, .4});
    world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
    testing::addLattice({addShape("sphere", {1e-3}, *world), addShape("cuboid", {1e-3, .8e-3, .7e-3}, *world)}, 12,
                        8e-3, 40, *world);
    for (MotionRow& row : world->bodies.motion) row.v.x() += 2;
    testing::run(*world, dt, 1500);
    land(*world);
    EXPECT_GT(world->report.contactSteps, 1000u);
    EXPECT_EQ(world->aloft.bodySteps > 100000, threads > 0);
    hashes.push_back(hashState(world->bodies));
  }
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(Flight, OfBodiesThatComeAndGoHasTheSameBits) {
  std::vector<std::string> hashes;
  for (const bool flight : {false, true}) {
    const auto world = makeGas(with(flight), 4, 9e-3);
    startHalfSteps(*world, dt, 0, true);
    Random random(9);
    for (int n = 0; n < 3000; ++n) {
      if (n % 300 == 150) {
        NewBody body;
        body.shapeIndex = n / 300 % 6;
        body.pose.x = Vec3(0.01 * random.normal(), 0.01 * random.normal(), 0.05);
        body.velocity = Vec3(0, 0, -0.5);
        const std::size_t slot = world->addBody(body);
        startHalfSteps(*world, dt, slot, false);
      }
      if (n % 500 == 333) {
        std::vector<bool> gone(world->bodies.size(), false);
        gone[static_cast<std::size_t>(n / 500)] = true;
        world->removeBodies(gone);
      }
      step(*world, dt);
    }
    land(*world);
    EXPECT_EQ(world->aloft.bodySteps > 10000, flight);
    hashes.push_back(hashState(world->bodies));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Flight, IsNotTakenWhereWallsMoveOrEveryStepIsCounted) {
  const auto flown = [](const WorldOptions& options, bool wallMoves, Locks locks) {
    auto world = testing::makeEmptyWorld(options);
    addShape("sphere", {1e-3}, *world);
    WallPath path;
    if (wallMoves) path.velocity = Vec3(0, 0, 0.1);
    world->walls.push_back(makeMovingWall(makePlaneWall(Vec3(0, 0, -1), Vec3::UnitZ()), path, {}));
    NewBody body;
    body.locks = locks;
    world->addBody(body);
    testing::run(*world, dt, 300);
    land(*world);
    return world->aloft.bodySteps > 0;
  };
  EXPECT_TRUE(flown(with(true), false, 0));
  EXPECT_FALSE(flown(with(false), false, 0));
  EXPECT_FALSE(flown(with(true), false, lockTranslation(0)));
  EXPECT_FALSE(flown(with(true), true, 0));
  WorldOptions keepsLedger = with(true), sleeps = with(true), searches = with(true);
  keepsLedger.energy = true;
  sleeps.sleep.on = true;
  searches.skips.search = false;
  EXPECT_FALSE(flown(keepsLedger, false, 0));
  EXPECT_FALSE(flown(sleeps, false, 0));
  EXPECT_FALSE(flown(searches, false, 0));
}

TEST(Flight, EndsWhereABodyWouldBecomeTooFastForTheReport) {
  WorldOptions options = with(true);
  options.maxSpeed = 0.5;
  auto world = testing::makeEmptyWorld(options);
  addShape("sphere", {1e-3}, *world);
  world->addBody({});
  testing::run(*world, 1e-4, 600);  // g t = .59 m/s
  ASSERT_FALSE(world->report.troubles.empty());
  EXPECT_NEAR(world->report.troubles[0].time, 0.5 / 9.81, 2e-4);
  EXPECT_GT(world->aloft.bodySteps, 200u);
}

}  // namespace
}  // namespace granular
