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

}  // namespace
}  // namespace granular
