// Bodies in another order in memory: a world moves on as it was, and large scattered beds are laid in an order of
// space.
#include "granular/world/order.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <numeric>

#include "granular/shape/clump.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "world/heap.h"

namespace granular {
namespace {

/// The largest difference of positions (m) and spins (rad/s times m) of bodies of the same id.
double largestDifference(const World& a, const World& b, double size) {
  const std::vector<std::int32_t> slotsA = a.bodies.slotsById(), slotsB = b.bodies.slotsById();
  EXPECT_EQ(slotsA.size(), slotsB.size());
  double largest = 0;
  for (std::size_t k = 0; k < slotsA.size(); ++k) {
    const auto i = static_cast<std::size_t>(slotsA[k]), j = static_cast<std::size_t>(slotsB[k]);
    EXPECT_EQ(a.bodies.id[i], b.bodies.id[j]);
    largest = std::max(
        {largest, (a.bodies.x(i) - b.bodies.x(j)).norm(), 1e-3 * size * (a.bodies.w(i) - b.bodies.w(j)).norm()});
  }
  return largest;
}

/// All kinds of bodies and their pairs: spheres, cuboids, cylinders, ellipsoids, rocks and clumps.
std::vector<std::shared_ptr<const Shape>> makeShapes() {
  std::vector<Vec3> tetrahedron;
  for (const Vec3& v : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)})
    tetrahedron.push_back(.8e-3 * v);
  return {std::make_shared<Sphere>(1.2e-3),
          std::make_shared<Cuboid>(Vec3(1e-3, .8e-3, 1.2e-3)),
          std::make_shared<Cylinder>(1e-3, 2e-3),
          std::make_shared<Ellipsoid>(Vec3(1e-3, 1.2e-3, .8e-3)),
          std::make_shared<Polyhedron>(tetrahedron),
          std::make_shared<Clump>(std::vector<ChildSphere>{{Vec3(-.5e-3, 0, 0), .9e-3}, {Vec3(.5e-3, 0, 0), .7e-3}})};
}

std::unique_ptr<World> makeHeap(const WorldOptions& options, int perSide, const std::vector<int>& kinds) {
  auto world = testing::makeEmptyWorld(options);
  const double pitch = 2.7e-3;
  if (options.periods.any())
    world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  else
    testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  const auto all = makeShapes();
  std::vector<std::int32_t> shapes;
  for (const int kind : kinds) shapes.push_back(world->addShape(all[static_cast<std::size_t>(kind)]));
  testing::addLattice(shapes, perSide, pitch, 60, *world);
  return world;
}

std::vector<std::int32_t> shuffledOrder(std::size_t count, std::uint64_t seed) {
  std::vector<std::int32_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  Random random(seed);
  for (std::size_t k = count; k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
  return order;
}

constexpr double dt = 5e-6;

TEST(Order, OfSlotsChangesTheMotionByRoundOffAlone) {
  WorldOptions periodic, sleeping;
  periodic.periods.length = Vec3(5 * 2.7e-3, 5 * 2.7e-3, 0);
  periodic.periods.origin = Vec3(-2.5 * 2.7e-3, -2.5 * 2.7e-3, 0);
  sleeping.sleep.on = true;
  sleeping.sleep.time = 1e-3;
  sleeping.sleep.energy = 1;
  sleeping.sleep.balance = 1e3;
  std::size_t contacts = 0;
  std::uint64_t asleep = 0;
  for (WorldOptions options : {WorldOptions{}, periodic, sleeping}) {
    options.gravity = Vec3(0, 0, -100);  // so that they are together soon
    // The polygon that stands for a cylinder's end begins at the azimuth of its tilt: of round-off, where it lies flat.
    options.rule.rule = PointRule::witness;
    for (const std::vector<int>& kinds : {std::vector<int>{0, 1, 2, 3, 4, 5}, {0}, {1}, {2}, {3}, {4}, {5}}) {
      std::array<std::unique_ptr<World>, 2> worlds;
      for (auto& world : worlds) {
        world = makeHeap(options, 5, kinds);
        startHalfSteps(*world, dt, 0, true);
        for (int n = 0; n < 3000; ++n) step(*world, dt);
      }
      contacts += worlds[0]->contactCount();
      ASSERT_EQ(largestDifference(*worlds[0], *worlds[1], 1e-3), 0);
      // Nothing but the order: the same contacts and springs, so that only sums are taken in another order.
      worlds[1]->rearrange(shuffledOrder(worlds[1]->bodies.size(), 3));
      for (int n = 0; n < 20; ++n) {
        for (auto& world : worlds) step(*world, dt);
        ASSERT_EQ(worlds[0]->contactCount(), worlds[1]->contactCount()) << "step " << n;
      }
      EXPECT_LE(largestDifference(*worlds[0], *worlds[1], 1e-3), 1e-13) << kinds.front();
      EXPECT_EQ(worlds[0]->sleep.fallen, worlds[1]->sleep.fallen);
      asleep += worlds[0]->sleep.fallen;
    }
  }
  EXPECT_GT(contacts, 500u);
  EXPECT_GT(asleep, 100u);
}

/// Spheres side by side on a lattice, in an order at random.
std::unique_ptr<World> makeScattered(bool keepSlots) {
  WorldOptions options;
  options.keepSlots = keepSlots;
  auto world = makeHeap(options, 17, {0});
  const std::vector<std::int32_t> order = shuffledOrder(world->bodies.size(), 4);
  world->rearrange(order);
  startHalfSteps(*world, dt, 0, true);
  return world;
}

TEST(Order, LaysScatteredBedsSideBySide) {
  const auto kept = makeScattered(true), laid = makeScattered(false);
  ASSERT_GE(kept->bodies.size(), bodiesBeyondCaches);
  for (int n = 0; n < 100; ++n) {
    for (World* world : {kept.get(), laid.get()}) step(*world, dt);
  }
  EXPECT_TRUE(isScattered(*kept));
  EXPECT_FALSE(isScattered(*laid));
  EXPECT_GT(kept->contactCount(), 100u);
  EXPECT_EQ(kept->contactCount(), laid->contactCount());
  EXPECT_LE(largestDifference(*kept, *laid, 1e-3), 1e-13);
  // It is done once.
  const std::vector<std::int64_t> ids = laid->bodies.id;
  for (int n = 0; n < 300; ++n) step(*laid, dt);
  EXPECT_GT(laid->search.refreshes, 3u);
  EXPECT_EQ(laid->bodies.id, ids);
}

TEST(Order, OfSpaceLeavesNeighboursAboutAsNearAsLayersDo) {
  const auto world = makeScattered(true);
  world->rearrange(orderInSpace(*world));
  refreshPairs(dt, *world);
  double sum = 0;
  for (const Pair& pair : world->pairs.pairs) sum += std::abs(pair.a - pair.b);
  const double layer = std::pow(static_cast<double>(world->bodies.size()), 2.0 / 3);
  EXPECT_LT(sum, 2 * layer * static_cast<double>(world->pairs.pairs.size()));
}

}  // namespace
}  // namespace granular
