// Warm answers against full searches, along trajectories on which bodies slide, roll and spin over each other's
// features.
#include <gtest/gtest.h>

#include "granular/core/tolerances.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/sphere.h"
#include "narrow/scenes.h"

namespace granular {
namespace {

using testing::makeRock;

struct Tally {
  NarrowCounts warm, full;
  long steps = 0, touching = 0, differing = 0;
  double worst = 0;  // depth too large by, relative to the size
};

/// Lets B wander over A: small random turns and slides, its depth steered to targets spread over several decades. Each
/// step is asked twice, with a cache that skips and with one that always searches.
void wander(const Shape& a, const Shape& b, Random& random, int steps, double deepest, double tolerance, Tally& tally) {
  const double size = std::min(a.size(), b.size());
  const double reach = a.boundingRadius() + b.boundingRadius();
  Pose poseA{reach * random.direction(), random.rotation()},
      poseB{poseA.x + reach * random.direction(), random.rotation()};
  WarmCache warm, full;
  Touch touch, reference;
  Vec3 spin = random.direction(), slide = random.direction();
  double target = 0;
  for (int step = 0; step < steps; ++step) {
    if (step % 50 == 0)
      target = (random.below(8) ? 1 : -1) * size * std::pow(10, random.uniform(-6, std::log10(deepest)));
    if (step % 200 == 0) {
      const double rate = std::pow(10.0, random.uniform(-4, -1.5));
      spin = rate * random.direction();
      slide = rate * size * random.direction();
    }
    poseB.q = (rotationFromVector(spin) * poseB.q).normalized();
    poseB.x += slide;

    const Frame frameA(poseA), frameB(poseB);
    const bool touches = findTouch(a, frameA, b, frameB, false, warm, tally.warm, touch);
    const bool expected = findTouch(a, frameA, b, frameB, true, full, tally.full, reference);
    ++tally.steps;
    tally.touching += expected;
    if (touches != expected) {
      // The two may part only within round-off of the first touch.
      const double depth = touches ? touch.overlap : reference.overlap;
      if (depth > 1e-13 * size) ++tally.differing;
    } else if (touches) {
      const double excess = (touch.overlap - reference.overlap) / size;
      tally.worst = std::max(tally.worst, std::abs(excess));
      if (std::abs(excess) > tolerance) ++tally.differing;
      EXPECT_NEAR(depthAlong(a, frameA, b, frameB, touch.normal), touch.overlap, 4e-15 * reach);
    }

    // Steer the depth towards its target, along the normal or, apart, along the line of centres.
    if (expected) {
      poseB.x += 0.5 * (reference.overlap - target) * reference.normal;
    } else {
      poseB.x -= std::min(full.budget + std::abs(target), 0.2 * size) * (poseB.x - poseA.x).normalized();
      if (target < 0 && full.budget < -target) poseB.x -= 2 * target * (poseB.x - poseA.x).normalized();
    }
  }
}

TEST(Trajectory, WarmAnswersOfPolyhedraAreThoseOfTheFullSearch) {
  Random random(11);
  std::vector<std::unique_ptr<Shape>> shapes;
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, 1, 1)));
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, 1, 3)));
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, 1, .25)));
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, .02, .02)));
  shapes.push_back(makeRock(random, 4, 1, Vec3::Ones()));
  shapes.push_back(makeRock(random, 12, 1, Vec3(1, 1, 3)));
  shapes.push_back(makeRock(random, 60, 1, Vec3::Ones()));
  Tally tally;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = 0; j < shapes.size(); ++j)
      wander(*shapes[i], *shapes[j], random, 3000, 0.05, 2 * tolerance::tie, tally);
  }
  EXPECT_EQ(tally.differing, 0);
  EXPECT_GT(tally.touching, tally.steps / 2);
  EXPECT_GT(tally.warm.warm, 4 * tally.warm.searches);
  EXPECT_EQ(tally.warm.uncertified, 0u);
}

TEST(Trajectory, WarmAnswersOfSmoothShapesAreThoseOfTheFullSearch) {
  Random random(12);
  std::vector<std::unique_ptr<Shape>> shapes;
  shapes.push_back(std::make_unique<Sphere>(1));
  shapes.push_back(std::make_unique<Ellipsoid>(Vec3(1, 1, 3)));
  shapes.push_back(std::make_unique<Ellipsoid>(Vec3(1, .6, .25)));
  shapes.push_back(std::make_unique<Cylinder>(1, 2));
  shapes.push_back(std::make_unique<Cylinder>(1, .4));
  shapes.push_back(std::make_unique<Cone>(1, 2));
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, .5, .8)));
  shapes.push_back(makeRock(random, 30, 1, Vec3::Ones()));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = i; j < shapes.size(); ++j) {
      if (i > 5) continue;
      Tally tally;
      wander(*shapes[i], *shapes[j], random, 2000, 0.03, tolerance::certificate, tally);
      SCOPED_TRACE(shapes[i]->describe() + " and " + shapes[j]->describe());
      EXPECT_EQ(tally.differing, 0);
      EXPECT_GT(tally.touching, tally.steps / 6);
      EXPECT_EQ(tally.warm.uncertified + tally.full.uncertified, 0u);
    }
  }
}

TEST(Trajectory, WarmAnswersOfPlatesRodsAndNeedlesAreThoseOfTheFullSearch) {
  Random random(13);
  for (const double aspect : {.02, .25, .5, 3., 50.}) {
    std::vector<std::unique_ptr<Shape>> shapes;
    shapes.push_back(std::make_unique<Cylinder>(1, 2 * aspect));
    shapes.push_back(std::make_unique<Cone>(1, 2 * aspect));
    shapes.push_back(std::make_unique<Ellipsoid>(Vec3(1, 1, std::min(aspect, 3.))));
    shapes.push_back(std::make_unique<Cuboid>(Vec3(1, 1, aspect)));
    shapes.push_back(makeRock(random, 40, 1, Vec3(1, 1, aspect)));
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i; j < shapes.size(); ++j) {
        Tally tally;
        wander(*shapes[i], *shapes[j], random, 1000, 0.03, tolerance::certificate, tally);
        SCOPED_TRACE(shapes[i]->describe() + " and " + shapes[j]->describe());
        EXPECT_EQ(tally.differing, 0);
        EXPECT_EQ(tally.warm.uncertified + tally.full.uncertified, 0u);
      }
    }
  }
}

/// Rocks B about a pose in which faces or sides lie on each other, by turns and slides of all sizes down to none, and
/// compares every warm answer with the full search's.
void rockAbout(const Shape& a, const Shape& b, const Pose& start, Random& random, Tally& tally) {
  const double size = std::min(a.size(), b.size());
  WarmCache warm, full;
  Touch touch, reference;
  for (int step = 0; step < 1500; ++step) {
    const double scale = random.below(4) ? std::pow(10.0, random.uniform(-16, -3)) : 0.0;
    Pose pose = start;
    pose.q = (rotationFromVector(scale * random.direction()) * start.q).normalized();
    pose.x += scale * size * random.direction();
    const Frame frameA(Pose{}), frameB(pose);
    const bool touches = findTouch(a, frameA, b, frameB, false, warm, tally.warm, touch);
    const bool expected = findTouch(a, frameA, b, frameB, true, full, tally.full, reference);
    ++tally.steps;
    tally.touching += expected;
    if (touches != expected) {
      tally.differing += (touches ? touch.overlap : reference.overlap) > 1e-13 * size;
    } else if (touches) {
      const double off = std::abs(touch.overlap - reference.overlap) / size;
      tally.worst = std::max(tally.worst, off);
      if (off > tolerance::certificate) ++tally.differing;
      EXPECT_NEAR(depthAlong(a, frameA, b, frameB, touch.normal), touch.overlap, 1e-14 * size);
    }
  }
}

TEST(Trajectory, WarmAnswersAboutTiesAreThoseOfTheFullSearch) {
  Random random(14);
  const Cylinder cylinder(1, 2), rod(.5, 6);
  const Cone cone(1, 2);
  const Cuboid cube(Vec3::Ones());
  const Ellipsoid egg(Vec3(1, 1, 2));
  const Quat upright = Quat::Identity(), lying(Eigen::AngleAxisd(pi / 2, Vec3::UnitX())),
             sideways(Eigen::AngleAxisd(pi / 2, Vec3::UnitY()));
  const double deep = 1e-3;
  const struct {
    const Shape &a, &b;
    Pose start;
  } cases[] = {
      {cylinder, cylinder, {Vec3(0, 0, 2 - deep), upright}},    // cap on cap
      {cylinder, cylinder, {Vec3(.7, .4, 2 - deep), upright}},  // caps half off
      {cylinder, cylinder, {Vec3(2 - deep, 0, 0), upright}},    // sides along each other
      {cylinder, cylinder, {Vec3(2 - deep, 0, .7), upright}},   // shifted
      {cylinder, cylinder, {Vec3(2 - deep, 0, 0), lying}},      // sides crossed
      {cylinder, cylinder, {Vec3(0, 0, 2 - deep), lying}},      // side on cap
      {rod, cylinder, {Vec3(1.5 - deep, 0, 3), upright}},       // beyond the end
      {rod, rod, {Vec3(1 - deep, 0, 0), upright}},              // long sides
      {cylinder, cube, {Vec3(0, 0, 2 - deep), upright}},        // cap on face
      {cylinder, cube, {Vec3(2 - deep, 0, 0), upright}},        // side on face
      {rod, cube, {Vec3(1.5 - deep, 0, 3), upright}},           // side over the face's edge
      {cylinder, cone, {Vec3(0, 0, 1.5 - deep), upright}},      // cap under base
      {cone, cone, {Vec3(0, 0, -1 - deep), Quat(0, 1, 0, 0)}},  // base on base
      {cone, cube, {Vec3(0, 0, -1.5 + deep), upright}},         // base on face
      {egg, cylinder, {Vec3(0, 0, 3 - deep), upright}},         // tip on cap
      {egg, cylinder, {Vec3(2 - deep, 0, 0), sideways}},        // waist on cap
      {egg, cube, {Vec3(2 - deep, 0, 0), upright}},
  };
  for (const auto& pair : cases) {
    Tally tally;
    rockAbout(pair.a, pair.b, pair.start, random, tally);
    SCOPED_TRACE(pair.a.describe() + " and " + pair.b.describe());
    EXPECT_EQ(tally.differing, 0) << tally.worst;
    EXPECT_GT(tally.touching, 0);
    EXPECT_EQ(tally.warm.uncertified + tally.full.uncertified, 0u);
  }
}

TEST(Trajectory, AProofOutlastsASmallMotionAndNoMore) {
  const Cylinder a(1, 2), b(1, 2);
  const Quat turned = rotationFromVector(Vec3(.4, .7, .2));
  const Frame frameA(Pose{});
  Pose pose{Vec3(1.8, 1, 2.8), turned};
  WarmCache cache;
  NarrowCounts counts;
  Touch touch;
  while (!findTouch(a, frameA, b, Frame(pose), false, cache, counts, touch)) pose.x *= .999;
  ASSERT_TRUE(findTouch(a, frameA, b, Frame(pose), false, cache, counts, touch));
  const KeptProof proof = cache.proof;
  ASSERT_GT(proof.floor, touch.overlap);

  // Within half the slack the proof stays as it is; beyond it, another is made.
  const double slack = proof.floor - touch.overlap;
  const Vec3 across = perpendicular(touch.normal);
  pose.x += .5 * slack * across;
  ASSERT_TRUE(findTouch(a, frameA, b, Frame(pose), false, cache, counts, touch));
  EXPECT_EQ(cache.proof.floor, proof.floor);
  pose.x += slack * across;
  ASSERT_TRUE(findTouch(a, frameA, b, Frame(pose), false, cache, counts, touch));
  EXPECT_NE(cache.proof.place, proof.place);
}

TEST(Trajectory, NoDirectionOutsideAKeptConeIsShallowerThanItsFloor) {
  Random random(15);
  std::vector<std::unique_ptr<Shape>> shapes;
  shapes.push_back(std::make_unique<Cylinder>(1, 2));
  shapes.push_back(std::make_unique<Cylinder>(1, .3));
  shapes.push_back(std::make_unique<Cone>(1, 2));
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, .5, .8)));
  shapes.push_back(makeRock(random, 30, 1, Vec3::Ones()));
  int proofs = 0;
  for (int trial = 0; trial < 400; ++trial) {
    // A's kind comes first, as the cache has it.
    const std::size_t i = random.below(3), j = i + random.below(shapes.size() - i);
    const Shape &a = *shapes[i], &b = *shapes[j];
    const Frame frameA(Pose{Vec3::Zero(), random.rotation()});
    Frame frameB(Pose{3 * random.direction(), random.rotation()});
    WarmCache cache;
    NarrowCounts counts;
    Touch touch;
    const double step = std::pow(10.0, random.uniform(-5, -1.5));
    for (int k = 0; k < 5000 && !findTouch(a, frameA, b, frameB, false, cache, counts, touch); ++k)
      frameB.x *= 1 - std::max(step, .2 * cache.budget);
    findTouch(a, frameA, b, frameB, false, cache, counts, touch);
    if (!(cache.proof.floor > 0)) continue;
    ++proofs;

    // Everywhere, and close around the cone.
    const Eigen::Map<const Eigen::Vector3f> single(cache.proof.axis.data());
    const Vec3 axis = frameA.rotate(single.cast<double>()).normalized();
    for (int k = 0; k < 4000; ++k) {
      Vec3 n = random.direction();
      if (k % 2) {
        const Vec3 across = (n - n.dot(axis) * axis).normalized();
        const double angle = 8.0001 * pi / 180 * std::pow(10.0, random.uniform(0, 1));
        n = std::cos(angle) * axis + std::sin(angle) * across;
      }
      if (n.dot(axis) > std::cos(8 * pi / 180)) continue;
      EXPECT_GT(depthAlong(a, frameA, b, frameB, n), cache.proof.floor - 1e-6);
    }
  }
  EXPECT_GT(proofs, 100);
}

}  // namespace
}  // namespace granular
