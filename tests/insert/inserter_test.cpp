#include "granular/insert/inserter.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "granular/core/errors.h"
#include "granular/insert/made_particle.h"
#include "granular/insert/pose_check.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

Region makeVessel(double radius) {
  Region region;
  region.kind = Region::Kind::cylinder;
  region.radius = radius;
  return region;
}

PourGroup makeSpheres(std::int64_t count, double radius) {
  PourGroup group;
  group.name = "balls";
  group.count = count;
  group.make = [radius](double size, Random&) { return std::make_shared<Sphere>(radius * size); };
  group.longestExtent = [radius](double size) { return 2 * radius * size; };
  return group;
}

PourGroup makeGrains(std::int64_t count) {
  PourGroup group;
  group.name = "sand";
  group.count = count;
  SizeOptions size;
  size.kind = SizeKind::uniform;
  size.min = 0.8;
  size.max = 1.2;
  group.size = SizeDistribution(size);
  const auto scaled = [](double s) {
    SandOptions options;
    options.radius *= s;
    return options;
  };
  group.make = [scaled](double s, Random& random) { return std::shared_ptr<const Shape>(makeSand(scaled(s), random)); };
  group.longestExtent = [scaled](double s) { return longestSand(scaled(s)); };
  return group;
}

/// Inserts batch after batch on top of each other, as if each came to rest where it was put.
std::vector<NewParticle> pourAll(Inserter& inserter, int callsAtMost = 1000) {
  std::vector<NewParticle> all;
  double time = 0;
  for (int call = 0; call < callsAtMost && !inserter.isDone(); ++call, time += 0.01) {
    std::vector<PlacedShape> present;
    for (const NewParticle& p : all) present.push_back({p.shape.get(), Frame(p.pose)});
    for (NewParticle& p : inserter.insert(time, true, present)) all.push_back(std::move(p));
  }
  return all;
}

TEST(Inserter, EveryParticleIsPlacedInsideAndWithoutOverlap) {
  const Region region = makeVessel(10e-3);
  Inserter inserter(PourOptions{}, {makeGrains(150), makeSpheres(50, 1e-3)}, region, {}, 1);
  const std::vector<NewParticle> all = pourAll(inserter);
  ASSERT_EQ(all.size(), 200u);

  std::vector<PlacedShape> placed;
  std::vector<std::int64_t> ids;
  int balls = 0;
  for (const NewParticle& p : all) {
    EXPECT_EQ(p.number, std::int64_t(ids.size()));
    balls += p.group == 1;
    placed.push_back({p.shape.get(), Frame(p.pose)});
    ids.push_back(p.number);
    EXPECT_TRUE(region.holds(*p.shape, Frame(p.pose)));
  }
  EXPECT_EQ(balls, 50);
  EXPECT_TRUE(findOverlaps(placed, ids, Periods{}, 0).empty());
}

TEST(Inserter, BatchesHaveTheirSizesAndWaitForRest) {
  PourOptions options;
  options.minBatch = 5;
  options.maxBatch = 9;
  Inserter inserter(options, {makeSpheres(100, 1e-3)}, makeVessel(25e-3), {}, 2);
  std::vector<std::size_t> sizes;
  std::vector<NewParticle> all;
  std::vector<PlacedShape> present;
  while (!inserter.isDone()) {
    EXPECT_FALSE(inserter.isDue(0, false));
    EXPECT_TRUE(inserter.isDue(0, true));
    const auto batch = inserter.insert(0, true, present);
    sizes.push_back(batch.size());
    for (const NewParticle& p : batch) {
      all.push_back(p);
      present.push_back({p.shape.get(), Frame(p.pose)});
    }
    EXPECT_EQ(inserter.state().batchLeft, 0);
  }
  EXPECT_EQ(inserter.state().batches, std::int64_t(sizes.size()));
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k) {
    EXPECT_GE(sizes[k], 5u);
    EXPECT_LE(sizes[k], 9u);
  }
  EXPECT_NE(*std::min_element(sizes.begin(), sizes.end() - 1), *std::max_element(sizes.begin(), sizes.end()));
}

TEST(Inserter, RainFallsAtItsRate) {
  PourOptions options;
  options.kind = PourOptions::Kind::rain;
  options.rate = 100;
  options.height = 50e-3;
  options.speed = 0.5;
  Inserter inserter(options, {makeSpheres(10, 1e-3)}, makeVessel(25e-3), {}, 3);
  std::size_t placed = 0;
  for (int step = 0; step < 50; ++step) {
    const double time = 0.002 * step;
    // One at once, then one every hundredth of a second.
    const auto fresh = inserter.insert(time, false, {});
    placed += fresh.size();
    EXPECT_EQ(placed, std::min<std::size_t>(10, static_cast<std::size_t>(step / 5) + 1)) << time;
    for (const NewParticle& p : fresh) {
      EXPECT_EQ(p.velocity, Vec3(0, 0, -0.5));
      EXPECT_NEAR(p.pose.x.z(), 51e-3, 1e-9);
    }
  }
  EXPECT_TRUE(inserter.isDone());
}

TEST(Inserter, ParticlesStartJustAboveTheBed) {
  // A single layer on an empty floor: nothing starts higher than its own extent.
  PourOptions options;
  options.minBatch = options.maxBatch = 20;
  Inserter inserter(options, {makeGrains(20)}, makeVessel(25e-3), {}, 4);
  int low = 0;
  for (const NewParticle& p : inserter.insert(0, true, {})) low += p.pose.x.z() < p.shape->longestExtent();
  EXPECT_GE(low, 15);
}

TEST(Inserter, WhatFindsNoPlaceIsCountedAndTriedLater) {
  // 200 balls in a tube one and a half balls wide: a column of three layers' reach takes only a few at a time.
  PourOptions options;
  options.minBatch = options.maxBatch = 200;
  Inserter inserter(options, {makeSpheres(200, 1e-3)}, makeVessel(1.5e-3), {}, 5);
  const auto first = inserter.insert(0, true, {});
  EXPECT_GE(first.size(), 2u);
  EXPECT_LT(first.size(), 10u);
  EXPECT_EQ(inserter.state().postponed, 1);
  EXPECT_EQ(inserter.state().batchLeft, 200 - std::int64_t(first.size()));

  // Not before the retry time; then, with the first out of the way, the next few.
  EXPECT_FALSE(inserter.isDue(0.5 * options.retry, true));
  EXPECT_TRUE(inserter.isDue(options.retry, false));
  EXPECT_GE(inserter.insert(options.retry, false, {}).size(), 2u);
}

TEST(Inserter, IsDoneWhenABedAtRestLeavesNoRoomBelowTheCeiling) {
  for (const auto kind : {PourOptions::Kind::batches, PourOptions::Kind::rain}) {
    PourOptions options;
    options.kind = kind;
    options.rate = 1e9;
    Region region = makeVessel(5e-3);
    region.ceiling = 12e-3;
    Inserter inserter(options, {makeGrains(500)}, region, {}, 7);
    std::vector<NewParticle> all;
    std::vector<PlacedShape> present;
    double time = 0;
    const auto call = [&](bool consolidated) {
      time += options.retry;
      const auto fresh = inserter.insert(time, consolidated, present);
      for (const NewParticle& p : fresh) {
        EXPECT_LE(p.shape->bounds(Frame(p.pose)).hi.z(), region.ceiling);
        all.push_back(p);
        present.push_back({p.shape.get(), Frame(p.pose)});
      }
      return fresh.size();
    };
    while (call(true) > 0) {
    }
    // As long as anything moves, room may come.
    for (int k = 0; k < 20; ++k) call(false);
    EXPECT_FALSE(inserter.isDone());
    for (int k = 0; k < 100 && !inserter.isDone(); ++k) call(true);
    EXPECT_TRUE(inserter.isFull());
    EXPECT_TRUE(inserter.isDone());
    EXPECT_GT(all.size(), 10u);
    EXPECT_LT(all.size(), 500u);
    EXPECT_EQ(inserter.state().placed, std::int64_t(all.size()));
  }
}

TEST(Inserter, RestoredStateContinuesWithTheSameParticles) {
  const auto make = [] { return Inserter(PourOptions{}, {makeGrains(120)}, makeVessel(15e-3), {}, 6); };
  Inserter whole = make();
  const std::vector<NewParticle> expected = pourAll(whole);

  // Stop after the first batch; a new inserter takes over from the counters alone.
  Inserter before = make();
  std::vector<NewParticle> all = before.insert(0, true, {});
  Inserter after = make();
  after.setState(before.state());
  for (double time = 0.01; !after.isDone(); time += 0.01) {
    std::vector<PlacedShape> present;
    for (const NewParticle& p : all) present.push_back({p.shape.get(), Frame(p.pose)});
    for (NewParticle& p : after.insert(time, true, present)) all.push_back(std::move(p));
  }
  ASSERT_EQ(all.size(), expected.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(all[k].pose.x, expected[k].pose.x);
    EXPECT_EQ(all[k].pose.q.coeffs(), expected[k].pose.q.coeffs());
    EXPECT_EQ(all[k].shape->massProperties().volume, expected[k].shape->massProperties().volume);
    EXPECT_EQ(after.makeShape(all[k].number)->massProperties().volume, all[k].shape->massProperties().volume);
  }
}

TEST(Inserter, AnotherSeedPoursOtherParticles) {
  Inserter a(PourOptions{}, {makeGrains(20)}, makeVessel(15e-3), {}, 1);
  Inserter b(PourOptions{}, {makeGrains(20)}, makeVessel(15e-3), {}, 2);
  EXPECT_NE(a.sizeOf(0), b.sizeOf(0));
  EXPECT_NE(a.insert(0, true, {})[0].pose.x, b.insert(0, true, {})[0].pose.x);
}

TEST(Inserter, UprightParticlesStandOnTheirAxis) {
  PourGroup rods;
  rods.name = "rods";
  rods.count = 20;
  rods.make = [](double, Random&) { return std::make_shared<Cylinder>(1e-3, 8e-3); };
  rods.longestExtent = [](double) { return std::hypot(2e-3, 8e-3); };
  PourOptions options;
  options.upright = true;
  Inserter inserter(options, {rods}, makeVessel(25e-3), {}, 7);
  for (const NewParticle& p : pourAll(inserter)) EXPECT_NEAR((p.pose.q * Vec3::UnitZ()).z(), 1, 1e-15);
}

TEST(Inserter, ParticleLargerThanTheVesselIsRefusedByName) {
  try {
    const Inserter inserter(PourOptions{}, {makeSpheres(3, 1e-3), makeSpheres(1, 30e-3)}, makeVessel(25e-3), {}, 1);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("balls"), std::string::npos) << message;
    EXPECT_NE(message.find("0.06 m"), std::string::npos) << message;
    EXPECT_NE(message.find("0.05 m"), std::string::npos) << message;
  }
}

TEST(Inserter, ParticleThatCouldMeetItsOwnImageIsRefused) {
  Region region;
  region.kind = Region::Kind::periodic;
  region.lo = {0, 0};
  region.hi = {0.01, 1};
  EXPECT_THROW(Inserter(PourOptions{}, {makeSpheres(1, 3e-3)}, region, {}, 1), InputError);
  EXPECT_NO_THROW(Inserter(PourOptions{}, {makeSpheres(1, 2e-3)}, region, {}, 1));
}

TEST(Inserter, ImpossibleOptionsAreRefused) {
  const auto refused = [](const PourOptions& options) {
    EXPECT_THROW(Inserter(options, {makeSpheres(1, 1e-3)}, makeVessel(25e-3), {}, 1), InputError);
  };
  PourOptions options;
  options.minBatch = 0;
  refused(options);
  options = {};
  options.maxBatch = 3;
  refused(options);
  options = {};
  options.kind = PourOptions::Kind::rain;
  refused(options);
  options = {};
  options.speed = -1;
  refused(options);
}

TEST(Inserter, DroppedParticlesComeOneByOneFromTheirBoxTurnedAboutTheirAxis) {
  PourOptions options;
  options.kind = PourOptions::Kind::drop;
  options.rate = 25;
  options.from = {2e-3, 0, .15};
  options.to = {2.5e-3, 0, .16};
  options.turn = PourOptions::Turn::y;
  options.speed = .3;
  Region open;
  open.lo.setConstant(-infinity);
  open.hi.setConstant(infinity);
  Inserter inserter(options, {makeSpheres(50, 1e-3)}, open, {}, 3);
  std::vector<NewParticle> all;
  double turned = 0;
  for (double time = 0; !inserter.isDone(); time += .04) {
    ASSERT_LT(time, 3);
    for (const NewParticle& p : inserter.insert(time + 1e-9, false, {})) {
      EXPECT_GE(p.pose.x.x(), 2e-3);
      EXPECT_LT(p.pose.x.x(), 2.5e-3);
      EXPECT_EQ(p.pose.x.y(), 0);
      EXPECT_GE(p.pose.x.z(), .15);
      EXPECT_EQ(p.pose.q.x(), 0);
      EXPECT_EQ(p.pose.q.z(), 0);
      EXPECT_EQ(p.velocity, Vec3(0, 0, -.3));
      turned = std::max(turned, std::abs(p.pose.q.y()));
      all.push_back(p);
    }
    EXPECT_EQ(all.size(), static_cast<std::size_t>(std::lround(time / .04)) + 1);
  }
  EXPECT_GT(turned, .9);
}

TEST(Inserter, DroppedParticleWaitsWhileItsPlaceIsTaken) {
  PourOptions options;
  options.kind = PourOptions::Kind::drop;
  options.rate = 100;
  options.from = options.to = {0, 0, .1};
  options.turn = PourOptions::Turn::none;
  Region open;
  open.lo.setConstant(-infinity);
  open.hi.setConstant(infinity);
  Inserter inserter(options, {makeSpheres(2, 1e-3)}, open, {}, 3);
  const std::vector<NewParticle> first = inserter.insert(0, false, {});
  ASSERT_EQ(first.size(), 1u);
  const std::vector<PlacedShape> there = {{first[0].shape.get(), Frame(first[0].pose)}};
  EXPECT_TRUE(inserter.insert(.02, false, there).empty());
  EXPECT_EQ(inserter.state().postponed, 1);
  EXPECT_EQ(inserter.insert(.04, false, {}).size(), 1u);
}

TEST(Inserter, DroppingEndsWhereABedAtRestFillsThePlace) {
  PourOptions options;
  options.kind = PourOptions::Kind::drop;
  options.rate = 100;
  options.from = options.to = {0, 0, .1};
  Region open;
  open.lo.setConstant(-infinity);
  open.hi.setConstant(infinity);
  Inserter inserter(options, {makeSpheres(9, 1e-3)}, open, {}, 3);
  const std::vector<NewParticle> first = inserter.insert(0, false, {});
  const std::vector<PlacedShape> there = {{first[0].shape.get(), Frame(first[0].pose)}};
  for (double time = .01; time < .2; time += .01) inserter.insert(time, false, there);
  EXPECT_FALSE(inserter.isDone()) << "the bed still moves";
  for (double time = .2; time < .4; time += .01) inserter.insert(time, true, there);
  EXPECT_TRUE(inserter.isDone());
  EXPECT_TRUE(inserter.isFull());
}

}  // namespace
}  // namespace granular
