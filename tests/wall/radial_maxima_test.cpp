#include "granular/wall/radial_maxima.h"

#include <gtest/gtest.h>

#include "granular/core/random.h"

namespace granular {
namespace {

Vec2 pointOf(double c1, double c2, double s1, double s2, const Vec2& angle) {
  return {c1 + s1 * angle.x(), c2 + s2 * angle.y()};
}

/// Local maxima of |y| on a ring of samples: their number and the largest.
struct Sampled {
  int count = 0;
  double largest = 0;
};
Sampled sampleMaxima(double c1, double c2, double s1, double s2, int samples) {
  const auto distance = [&](int k) {
    const double t = 2 * pi * (k + 0.5) / samples;
    return pointOf(c1, c2, s1, s2, {std::cos(t), std::sin(t)}).norm();
  };
  Sampled result;
  for (int k = 0; k < samples; ++k) {
    const double here = distance(k);
    if (here > distance(k - 1) && here >= distance(k + 1)) ++result.count;
    result.largest = std::max(result.largest, here);
  }
  return result;
}

TEST(RadialMaxima, AgreeWithDenseSampling) {
  Random random(11);
  int two = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const double s1 = random.uniform(0.1, 2), s2 = s1 * random.uniform(0.02, 0.98);
    const double c1 = random.uniform(-1, 1) * s1, c2 = random.uniform(-2, 2) * s1;
    // Within a hair of the evolute a sampling can't tell one maximum from two.
    const auto power = [](double x) { return std::pow(std::abs(x), 2.0 / 3); };
    const double inside = power(c1 * s1) + power(c2 * s2) - power(s1 * s1 - s2 * s2);
    if (std::abs(inside) < 1e-2 * power(s1 * s1)) continue;
    const RadialMaxima maxima = findRadialMaxima(c1, c2, s1, s2);
    const Sampled sampled = sampleMaxima(c1, c2, s1, s2, 10000);
    ASSERT_EQ(maxima.count, sampled.count) << c1 << ' ' << c2 << ' ' << s1 << ' ' << s2;
    EXPECT_GE(maxima.distance[0], sampled.largest - 1e-12);
    EXPECT_LE(maxima.distance[0], sampled.largest + 1e-6);
    two += maxima.count == 2;
  }
  EXPECT_GT(two, 50);
}

TEST(RadialMaxima, TheirNormalsPointAwayFromTheOrigin) {
  Random random(12);
  for (int trial = 0; trial < 1000; ++trial) {
    const double s1 = random.uniform(0.1, 2), s2 = s1 * random.uniform();
    const double c1 = random.uniform(-2, 2), c2 = random.uniform(-2, 2);
    const RadialMaxima maxima = findRadialMaxima(c1, c2, s1, s2);
    for (int k = 0; k < maxima.count; ++k) {
      const Vec2 y = pointOf(c1, c2, s1, s2, maxima.angle[k]);
      const Vec2 tangent(-s1 * maxima.angle[k].y(), s2 * maxima.angle[k].x());
      EXPECT_NEAR(y.dot(tangent), 0, 1e-13);
      EXPECT_NEAR(y.norm(), maxima.distance[k], 1e-14);
      EXPECT_LE(maxima.distance[k], maxima.distance[0]);
    }
    if (maxima.count == 2) {
      EXPECT_LE(maxima.between, maxima.distance[1]);
    }
  }
}

TEST(RadialMaxima, LyingEllipseTouchesTwiceWhenItsSideIsFlatterThanTheWall) {
  // Centred above the minor axis: the two touching points have sin t = c2 s2 / (s1^2 - s2^2).
  const double s1 = 3, s2 = 1, c2 = 5;
  const RadialMaxima maxima = findRadialMaxima(0, c2, s1, s2);
  ASSERT_EQ(maxima.count, 2);
  const double sine = c2 * s2 / (s1 * s1 - s2 * s2);
  EXPECT_NEAR(maxima.angle[0].y(), sine, 1e-14);
  EXPECT_NEAR(maxima.angle[1].y(), sine, 1e-14);
  EXPECT_NEAR(maxima.angle[0].x(), -maxima.angle[1].x(), 1e-14);
  EXPECT_NEAR(maxima.between, c2 + s2, 1e-14);
  // Further out its side rests on one point.
  EXPECT_EQ(findRadialMaxima(0, 8.1, s1, s2).count, 1);
}

TEST(RadialMaxima, SegmentsAndCirclesAreLimits) {
  const RadialMaxima segment = findRadialMaxima(0.5, 2, 1, 0);
  ASSERT_EQ(segment.count, 2);
  EXPECT_DOUBLE_EQ(segment.distance[0], std::hypot(1.5, 2));
  EXPECT_DOUBLE_EQ(segment.distance[1], std::hypot(0.5, 2));
  EXPECT_DOUBLE_EQ(segment.between, 2);
  const RadialMaxima circle = findRadialMaxima(3, -4, 1, 1);
  ASSERT_EQ(circle.count, 1);
  EXPECT_NEAR(circle.distance[0], 6, 1e-14);
  EXPECT_NEAR(circle.angle[0].x(), 0.6, 1e-14);
  EXPECT_NEAR(circle.angle[0].y(), -0.8, 1e-14);
}

}  // namespace
}  // namespace granular
