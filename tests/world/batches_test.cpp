// Contacts of spheres made in batches, and ellipsoids looked at in batches, against one by one.
#include <gtest/gtest.h>
#include <omp.h>

#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "world/heap.h"

namespace granular {
namespace {

using testing::isSameBits;
using testing::stateOf;

/// A heap of spheres of three sizes and two materials, one of them frictionless, turning as they fall into a box.
std::unique_ptr<World> makeBalls(const WorldOptions& options, int perSide) {
  MaterialTable materials;
  ContactParameters rough;
  rough.friction = 0.4;
  materials.add("rough", rough);
  ContactParameters slick;
  slick.stiffness = 2e4;
  slick.friction = 0;
  materials.add("slick", slick);
  auto world = std::make_unique<World>(options, std::move(materials));
  const double pitch = 2.75e-3;
  testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  std::vector<std::int32_t> sizes;
  for (const double radius : {1.5e-3, 1.3e-3, 1.1e-3})
    sizes.push_back(world->addShape(std::make_shared<Sphere>(radius)));
  testing::addLattice(sizes, perSide, pitch, 100, *world);
  for (std::size_t i = 0; i < world->bodies.size(); i += 7) world->bodies.material[i] = 1;
  return world;
}

/// Everything a visitor can read of the contacts.
std::vector<double> contactsOf(const World& world) {
  std::vector<double> out;
  const auto add = [&](const Vec3& v) { out.insert(out.end(), {v.x(), v.y(), v.z()}); };
  world.visitContacts([&](const Contact& c) {
    out.insert(out.end(), {double(c.pair), double(c.a), double(c.b), double(c.spot.number), c.share, c.touch.overlap,
                           c.patch.area, c.patch.depth, c.patch.squaredDepth, c.patch.share, c.force.normalForce,
                           double(c.force.sliding), double(c.held)});
    for (const Vec3& v : {c.shift, c.touch.normal, c.touch.onA, c.touch.onB, c.patch.point, c.patch.centre,
                          c.force.force, c.force.couple, c.torqueA, c.torqueB}) {
      add(v + Vec3::Zero());  // one sign of zero
    }
  });
  return out;
}

struct Case {
  const char* name;
  WorldOptions options;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Balls : public ::testing::TestWithParam<Case> {};

TEST_P(Balls, InBatchesHaveTheSameBitsAsOneByOne) {
  std::unique_ptr<World> worlds[2];
  for (const bool oneByOne : {false, true}) {
    WorldOptions options = GetParam().options;
    options.noBatches = oneByOne;
    worlds[oneByOne] = makeBalls(options, 7);
    startHalfSteps(*worlds[oneByOne], 5e-6, 0, true);
  }
  std::size_t contacts = 0, sliding = 0, batched = 0;
  for (int n = 0; n < 400; ++n) {
    for (auto& world : worlds) step(*world, 5e-6);
    ASSERT_TRUE(isSameBits(stateOf(*worlds[0]), stateOf(*worlds[1]))) << "step " << n;
    if (n % 20 != 0) continue;
    ASSERT_TRUE(isSameBits(contactsOf(*worlds[0]), contactsOf(*worlds[1]))) << "step " << n;
    worlds[0]->visitContacts([&](const Contact& contact) {
      ++contacts;
      sliding += contact.force.sliding;
    });
    for (const World::Chunk& chunk : worlds[0]->chunks) batched += chunk.balls.size();
  }
  EXPECT_EQ(worlds[0]->sleep.fallen > 10, GetParam().options.sleep.on);
  EXPECT_GT(batched, 1000u);
  EXPECT_GT(sliding, 100u);
  EXPECT_LT(sliding, contacts);
  EXPECT_EQ(worlds[0]->report.contactSteps, worlds[1]->report.contactSteps);
  EXPECT_EQ(worlds[0]->report.narrow.warm, worlds[1]->report.narrow.warm);
  EXPECT_EQ(worlds[0]->report.deepestA, worlds[1]->report.deepestA);
  EXPECT_EQ(worlds[0]->report.deepestB, worlds[1]->report.deepestB);
}

std::vector<Case> cases() {
  std::vector<Case> all(6);
  all[0].name = "AsTheyAre";
  all[1].name = "WithoutTension";
  all[1].options.lawOptions.tension = false;
  all[1].options.lawOptions.frictionOfPush = true;
  all[2].name = "SlidingAlongTheVelocity";
  all[2].options.lawOptions.slideAlongVelocity = true;
  all[3].name = "Periodic";
  all[3].options.periods.length = {7 * 2.75e-3, 7 * 2.75e-3, 0};
  all[3].options.periods.origin = {-3.5 * 2.75e-3, -3.5 * 2.75e-3, 0};
  all[4].name = "AtTheDeepestPoint";
  all[4].options.rule.rule = PointRule::witness;
  all[5].name = "FallingAsleep";
  all[5].options.sleep.on = true;
  all[5].options.sleep.time = 1e-3;
  all[5].options.sleep.energy = 1;
  all[5].options.sleep.balance = 1e3;
  all[5].options.sleep.wake = 1;
  return all;
}

INSTANTIATE_TEST_SUITE_P(World, Balls, ::testing::ValuesIn(cases()), [](const auto& info) { return info.param.name; });

TEST(Ellipsoids, LookedAtInBatchesHaveTheSameBitsAsOneByOne) {
  for (const LawKind law : {LawKind::linear, LawKind::hertz}) {
    std::unique_ptr<World> worlds[2];
    for (const bool oneByOne : {false, true}) {
      WorldOptions options;
      options.noBatches = oneByOne;
      options.law = law;
      options.sleep.on = law == LawKind::linear;
      options.sleep.time = 1e-3;
      options.sleep.energy = 1;
      ContactParameters contact;
      setElasticity({1e7, .3}, {1e7, .3}, contact);
      contact.dampingRateN = contact.dampingRateT = 200;
      worlds[oneByOne] = testing::makeEmptyWorld(options, contact);
      World& world = *worlds[oneByOne];
      const double pitch = 2.6e-3;
      testing::addBoxOfPlanes(0.5 * pitch * 6, world);
      const std::vector<std::int32_t> shapes = {
          world.addShape(std::make_shared<Ellipsoid>(Vec3(1e-3, 1e-3, 1.28e-3))),
          world.addShape(std::make_shared<Ellipsoid>(Vec3(.6e-3, 1.28e-3, 1e-3)))};
      testing::addLattice(shapes, 6, pitch, 100, world);
      startHalfSteps(world, 5e-6, 0, true);
    }
    std::size_t contacts = 0;
    for (int n = 0; n < 2000; ++n) {
      for (auto& world : worlds) step(*world, 5e-6);
      ASSERT_TRUE(isSameBits(stateOf(*worlds[0]), stateOf(*worlds[1]))) << "step " << n;
      if (n % 20 != 0) continue;
      ASSERT_TRUE(isSameBits(contactsOf(*worlds[0]), contactsOf(*worlds[1]))) << "step " << n;
      contacts += worlds[0]->contactCount();
    }
    EXPECT_TRUE(worlds[0]->chunks.front().ofEllipsoids);
    EXPECT_FALSE(worlds[1]->chunks.front().ofEllipsoids);
    EXPECT_GT(contacts, 500u);
    EXPECT_EQ(worlds[0]->report.narrow.warm, worlds[1]->report.narrow.warm);
    EXPECT_EQ(worlds[0]->report.narrow.searches, worlds[1]->report.narrow.searches);
  }
}

/// With one thread forces are added contact by contact, with several body by body.
TEST(Balls, MoveByTheSameBitsWithOneTwoAndFourThreads) {
  std::vector<std::vector<double>> states;
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    auto world = makeBalls({}, 17);
    testing::run(*world, 5e-6, 30);
    EXPECT_GE(world->bodies.movingSlots().size(), bodiesForThreads);
    EXPECT_GE(world->chunks.size(), chunksForThreads);
    EXPECT_GT(world->report.contactSteps, 1000u);
    states.push_back(stateOf(*world));
  }
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_TRUE(isSameBits(states[0], states[1]));
  EXPECT_TRUE(isSameBits(states[0], states[2]));
}

}  // namespace
}  // namespace granular
