#include "granular/insert/made_particle.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {
namespace {

double closestPair(const std::vector<Vec3>& points) {
  double least = infinity;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, (points[i] - points[j]).norm());
  return least;
}

TEST(MadeParticle, SandPointsLieOnTheTemplate) {
  for (const double aspect : {1.0, 3.0}) {
    for (const double spread : {0.0, 0.5, 1.0}) {
      SandOptions options;
      options.aspect = aspect;
      options.spread = spread;
      Random random(2);
      for (const Vec3& p : spreadPoints(options, 20, random)) {
        const Vec3 scaled(p.x() / 1.5e-3, p.y() / 1.5e-3, p.z() / (1.5e-3 * aspect));
        EXPECT_NEAR(scaled.norm(), 1, 1e-14);
      }
    }
  }
}

TEST(MadeParticle, UnspreadPointsAreUniformOverTheTemplatesArea) {
  // On a prolate spheroid with c = 3a the area beyond |z| = c/2 is a known fraction of the whole: the band between 0
  // and z has 2 pi a (z sqrt(1 - e^2 z^2/c^2) + c asin(e z/c)/e)/2 ... with e the eccentricity.
  SandOptions options;
  options.aspect = 3;
  options.spread = 0;
  Random random(3);
  const double e = std::sqrt(8.0) / 3;
  const auto band = [&](double f) { return f * std::sqrt(1 - e * e * f * f) + std::asin(e * f) / e; };
  const double expected = 1 - band(0.5) / band(1);
  int beyond = 0;
  const int rounds = 5000, count = 8;
  for (int k = 0; k < rounds; ++k)
    for (const Vec3& p : spreadPoints(options, count, random)) beyond += std::abs(p.z()) > 0.5 * 4.5e-3;
  const double n = rounds * count;
  EXPECT_NEAR(beyond / n, expected, 5 * std::sqrt(expected * (1 - expected) / n));
}

TEST(MadeParticle, FourPointsAtRestOnTheSphereAreATetrahedron) {
  SandOptions options;
  options.radius = 1;
  options.spread = 1;
  Random random(4);
  const std::vector<Vec3> points = spreadPoints(options, 4, random);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NEAR(points[i].dot(points[j]), -1.0 / 3, 1e-3);
}

TEST(MadeParticle, SixPointsAtRestOnTheSphereAreAnOctahedron) {
  SandOptions options;
  options.radius = 1;
  options.spread = 1;
  Random random(5);
  EXPECT_NEAR(closestPair(spreadPoints(options, 6, random)), std::sqrt(2.0), 1e-2);
}

TEST(MadeParticle, SpreadingPushesTheClosestPointsApart) {
  double before = 0, after = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SandOptions options;
    options.radius = 1;
    Random a(seed), b(seed);
    options.spread = 0;
    before += closestPair(spreadPoints(options, 12, a));
    options.spread = 0.5;
    after += closestPair(spreadPoints(options, 12, b));
  }
  EXPECT_GT(after, 1.5 * before);
}

TEST(MadeParticle, SandHasTheWantedNumberOfVerticesAndStaysInsideItsTemplate) {
  for (const double aspect : {1.0, 3.0}) {
    SandOptions options;
    options.aspect = aspect;
    Random random(6);
    std::vector<int> counts(21, 0);
    for (int k = 0; k < 300; ++k) {
      const auto sand = makeSand(options, random);
      const int vertices = sand->tables().vertexCount();
      ASSERT_GE(vertices, 5);
      ASSERT_LE(vertices, 20);
      ++counts[static_cast<std::size_t>(vertices)];
      EXPECT_LE(sand->longestExtent(), longestSand(options) * (1 + 1e-12));
      EXPECT_LT(sand->massProperties().volume, 4.0 / 3 * pi * std::pow(1.5e-3, 3) * aspect);
    }
    for (std::size_t n = 5; n <= 20; ++n) EXPECT_GT(counts[n], 0) << n;
  }
}

TEST(MadeParticle, SameSeedMakesTheSameSandAndAnotherSeedAnother) {
  const auto make = [](std::uint64_t seed) {
    Random random(seed);
    return makeSand(SandOptions{}, random);
  };
  EXPECT_EQ(make(7)->massProperties().volume, make(7)->massProperties().volume);
  EXPECT_NE(make(7)->massProperties().volume, make(8)->massProperties().volume);
}

TEST(MadeParticle, SandOfEquallyManyPointsDiffers) {
  SandOptions options;
  options.minPoints = options.maxPoints = 6;
  Random random(8);
  std::vector<double> volumes;
  for (int k = 0; k < 50; ++k) volumes.push_back(makeSand(options, random)->massProperties().volume);
  const auto [least, most] = std::minmax_element(volumes.begin(), volumes.end());
  EXPECT_GT(*most, 1.2 * *least);
}

TEST(MadeParticle, WoodchipsHaveTheirEndsOnTheTwoCircles) {
  Random random(9);
  const WoodchipOptions options;
  for (int k = 0; k < 300; ++k) {
    const auto chip = makeWoodchip(options, random);
    EXPECT_LE(chip->tables().vertexCount(), 8);
    EXPECT_GE(chip->longestExtent(), options.minLength);
    EXPECT_LE(chip->longestExtent(), longestWoodchip(options));
    // Between a wedge of two chords and the cone of both circles, the largest there is.
    const double most = pi / 3 * 7e-3 * (0.7e-3 * 0.7e-3 + 0.7e-3 * 1.3e-3 + 1.3e-3 * 1.3e-3);
    EXPECT_LT(chip->massProperties().volume, most);
  }
}

TEST(MadeParticle, FlatDrawsAreDrawnAgainAndCounted) {
  // Four random points on a circle often leave the particle thin or two corners together.
  Random random(10);
  std::uint64_t redrawn = 0;
  for (int k = 0; k < 1000; ++k) makeWoodchip(WoodchipOptions{}, random, &redrawn);
  EXPECT_GT(redrawn, 0u);
  EXPECT_LT(redrawn, 500u);
}

TEST(MadeParticle, ImpossibleOptionsAreRefused) {
  Random random(1);
  SandOptions sand;
  sand.radius = -1;
  EXPECT_THROW(makeSand(sand, random), InputError);
  sand = {};
  sand.minPoints = 3;
  EXPECT_THROW(makeSand(sand, random), InputError);
  sand = {};
  sand.spread = 1.5;
  EXPECT_THROW(makeSand(sand, random), InputError);
  WoodchipOptions chip;
  chip.maxThin = 0.1e-3;
  EXPECT_THROW(makeWoodchip(chip, random), InputError);
}

}  // namespace
}  // namespace granular
