// Bodies are removed, or come, while others sleep: what stays asleep keeps its contacts and forces.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <map>

#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

constexpr double side = 3e-3, dt = 5e-6;
constexpr int columns = 3, layers = 3;

/// Columns of cubes side by side on a floor, with gaps between them; ids go up each column.
std::unique_ptr<World> makeColumns(bool sleeping) {
  MaterialTable materials;
  materials.add("rock", ContactParameters{});
  WorldOptions options;
  options.sleep.on = sleeping;
  options.sleep.time = 2e-3;
  options.sleep.energy = 1e-9;
  options.sleep.balance = 1e-3;
  options.sleep.wake = 3e-3;
  auto world = std::make_unique<World>(options, std::move(materials));
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  world->addShape(std::make_shared<Cuboid>(Vec3::Constant(side / 2)));
  world->addShape(std::make_shared<Sphere>(0.3 * side));
  for (int column = 0; column < columns; ++column) {
    for (int layer = 0; layer < layers; ++layer) {
      NewBody body;
      body.pose.x = Vec3(1.02 * side * column, 0, (layer + 0.5) * side);
      world->addBody(body);
    }
  }
  omp_set_num_threads(1);  // so few bodies gain nothing from more
  startHalfSteps(*world, dt, 0, true);
  return world;
}

void run(World& world, double time) {
  for (int n = 0; n < static_cast<int>(time / dt); ++n) step(world, dt);
}

std::size_t countAsleep(const World& world) {
  return static_cast<std::size_t>(std::count(world.bodies.state.begin(), world.bodies.state.end(), BodyState::asleep));
}

/// Marks the bodies of these ids.
std::vector<bool> mark(const World& world, const std::vector<std::int64_t>& ids) {
  std::vector<bool> gone;
  for (const std::int64_t id : world.bodies.id) gone.push_back(std::find(ids.begin(), ids.end(), id) != ids.end());
  return gone;
}

/// Normal force of each contact by the ids of both bodies (-1: the floor). Every contact must name its pair.
std::map<std::pair<std::int64_t, std::int64_t>, double> forcesOf(const World& world) {
  std::map<std::pair<std::int64_t, std::int64_t>, double> forces;
  world.visitContacts([&](const Contact& contact) {
    const auto pair = static_cast<std::size_t>(contact.pair);
    if (contact.b < 0) {
      ASSERT_LT(pair, world.pairs.wallPairs.size());
      EXPECT_EQ(world.pairs.wallPairs[pair].body, contact.a);
    } else {
      ASSERT_LT(pair, world.pairs.pairs.size());
      EXPECT_EQ(world.pairs.pairs[pair].a, contact.a);
      EXPECT_EQ(world.pairs.pairs[pair].b, contact.b);
    }
    const std::int64_t b = contact.b < 0 ? -1 : world.bodies.id[static_cast<std::size_t>(contact.b)];
    forces[{world.bodies.id[static_cast<std::size_t>(contact.a)], b}] += contact.force.normalForce;
  });
  return forces;
}

TEST(Removal, LeavesForcesAndContactsAsInAWorldThatNeverSlept) {
  auto asleep = makeColumns(true), awake = makeColumns(false);
  // All of the first column, the top of the second; the third has nothing to do with it.
  for (World* world : {asleep.get(), awake.get()}) {
    run(*world, 0.1);
    world->removeBodies(mark(*world, {0, 1, 2, 5}));
  }
  const std::uint64_t wokenBefore = asleep->sleep.woken;
  EXPECT_GE(wokenBefore, 1u) << "what touched a removed body wakes";
  EXPECT_GE(countAsleep(*asleep), 3u) << "the third column sleeps on";
  for (World* world : {asleep.get(), awake.get()}) run(*world, 0.1);
  EXPECT_EQ(countAsleep(*asleep), 5u);
  EXPECT_EQ(asleep->sleep.calm.size(), 5u);
  EXPECT_EQ(asleep->sleep.force.size(), 5u);
  EXPECT_EQ(asleep->sleep.load.size(), 5u);

  const auto slept = forcesOf(*asleep), never = forcesOf(*awake);
  ASSERT_EQ(slept.size(), 5u);
  ASSERT_EQ(never.size(), 5u);
  const std::vector<double>& load = asleep->sleep.load;
  const double most = *std::max_element(load.begin(), load.end());
  for (const auto& [pair, force] : never) {
    ASSERT_TRUE(slept.contains(pair)) << pair.first << " " << pair.second;
    // Each body above may sleep with a net force just too small to wake it.
    EXPECT_NEAR(slept.at(pair), force, layers * asleep->options.sleep.wake * most);
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_LT(asleep->sleep.force[i].norm(), asleep->options.sleep.balance * load[i] * (1 + 1e-12));
    // A neighbour that settles later changes it by less than what wakes.
    EXPECT_LT((asleep->bodies.force[i] - asleep->sleep.force[i]).norm(), asleep->options.sleep.wake * load[i]);
  }
}

TEST(Removal, OfASupportWakesWhatItHeldUp) {
  auto world = makeColumns(true);
  run(*world, 0.1);
  ASSERT_EQ(countAsleep(*world), 9u);
  world->removeBodies(mark(*world, {3}));
  run(*world, 0.4);
  const Bodies& bodies = world->bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const bool above = bodies.id[i] == 4 || bodies.id[i] == 5;
    const int layer = static_cast<int>(bodies.id[i] % layers) - above;
    EXPECT_NEAR(bodies.x(i).z(), (layer + 0.5) * side, 1e-3 * side) << bodies.id[i];
  }
}

TEST(Removal, ContactsAtRestNameTheirPairsAfterOthersCome) {
  auto world = makeColumns(true);
  run(*world, 0.1);
  ASSERT_EQ(countAsleep(*world), 9u);
  const auto before = forcesOf(*world);
  // A ball in front of the first columns: its pairs come between theirs.
  NewBody ball;
  ball.shapeIndex = 1;
  ball.pose.x = Vec3(0.5 * side, -0.85 * side, side);
  startHalfSteps(*world, dt, world->addBody(ball), false);
  run(*world, 10 * dt);
  const auto after = forcesOf(*world);
  EXPECT_EQ(countAsleep(*world), 9u);
  EXPECT_EQ(before, after);
}

TEST(Removal, AndEveryChangeOfStateListsTheMovingAnew) {
  auto world = makeColumns(true);
  Bodies& bodies = world->bodies;
  const auto expected = [&] {
    std::vector<std::int32_t> slots;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (bodies.moves(i)) slots.push_back(static_cast<std::int32_t>(i));
    return slots;
  };
  EXPECT_EQ(bodies.movingSlots().size(), 9u);
  bodies.hold(3, BodyState::frozen);
  bodies.hold(5, BodyState::asleep);
  EXPECT_EQ(bodies.movingSlots(), expected());
  bodies.release(5);
  EXPECT_EQ(bodies.movingSlots(), expected());
  world->addBody({});
  EXPECT_EQ(bodies.movingSlots(), expected());
  world->removeBodies(mark(*world, {0, 3}));
  EXPECT_EQ(bodies.movingSlots(), expected());
  EXPECT_EQ(bodies.movingSlots().size(), 8u);
}

}  // namespace
}  // namespace granular
