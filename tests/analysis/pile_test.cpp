// Slopes of made heaps whose angle is known.
#include "granular/analysis/pile.h"

#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/shape/shape_table.h"

namespace granular {
namespace {

std::vector<SurfacePoint> makeSurface(double angle, double height, double spacing) {
  // Straight but for a rounded top and a tail.
  std::vector<SurfacePoint> surface;
  const double slope = std::tan(angle * pi / 180);
  for (double x = spacing / 2; x < 2 * height / slope; x += spacing) {
    const double straight = height - slope * x;
    surface.push_back({x, straight > .9 * height ? .9 * height : straight < .1 * height ? .05 * height : straight});
  }
  return surface;
}

TEST(Pile, AngleIsThatOfTheMiddleOfTheSlope) {
  for (const double angle : {10.0, 22.7, 35.0}) {
    const auto line = fitSlope(makeSurface(angle, .1, 1e-4), {}, 5e-3);
    ASSERT_TRUE(line);
    EXPECT_NEAR(line->angle, angle, 1e-9);
    EXPECT_NEAR(line->top, .1, 1e-12);
    EXPECT_NEAR(line->height, .09, 1e-12);
    EXPECT_NEAR(line->deviation, 0, 1e-12);
    // From .8 to .2 of the height.
    EXPECT_NEAR(line->from, (.1 - .8 * .09) / std::tan(angle * pi / 180), 1e-3);
    EXPECT_NEAR(line->to, (.1 - .2 * .09) / std::tan(angle * pi / 180), 1e-3);
  }
}

TEST(Pile, AngleByTheBaseCountsTheLayerAtTheFoot) {
  // A heap of 45 degrees, and from a fifth of its height on a layer three times as wide as the heap that thins out.
  std::vector<SurfacePoint> surface;
  const double spacing = 1e-3;
  const auto heightAt = [](double x) { return x < .8 ? 1 - x : .2 * (1 - (x - .8) / 2.4); };
  for (double x = spacing / 2; x < 3.2; x += spacing) surface.push_back({x, heightAt(x)});
  surface.push_back({3.2, 0});  // a gap, and a grain that went astray
  surface.push_back({3.3, .1});
  PileOptions ofBase;
  ofBase.ofBase = true;
  const auto byHeight = fitSlope(surface, {}, .01), byBase = fitSlope(surface, ofBase, .01);
  ASSERT_TRUE(byHeight && byBase);
  EXPECT_NEAR(byHeight->angle, 45, 1e-3);  // one place of 600 is of the layer
  EXPECT_NEAR(byBase->from, .2 * 3.2, spacing);
  EXPECT_NEAR(byBase->to, .8 * 3.2, spacing);
  EXPECT_LT(byBase->angle, 20);
  EXPECT_GT(byBase->angle, std::atan(.2 / 2.4) * 180 / pi);

  // A straight slope has one angle.
  const auto straight = makeSurface(30, .1, 1e-4);
  PileOptions inside = ofBase;
  inside.low = .6;
  inside.high = .9;
  EXPECT_NEAR(fitSlope(straight, inside, 5e-3)->angle, 30, 1e-9);
}

TEST(Pile, StandardErrorOfTheAngleIsThatOfTheScatter) {
  // Noise that is the same over a grain's length: as many draws as grains. 400 heaps: 4 % of the error itself.
  const double angle = 25, height = .1, spacing = 1e-4, grain = 4e-3;
  Random random(2);
  double sum = 0, squares = 0, claimed = 0;
  const int heaps = 400;
  for (int h = 0; h < heaps; ++h) {
    auto surface = makeSurface(angle, height, spacing);
    double noise = 0;
    for (std::size_t k = 0; k < surface.size(); ++k) {
      if (k % static_cast<std::size_t>(grain / spacing) == 0) noise = 5e-4 * random.normal();
      surface[k].height += noise;
    }
    const auto line = fitSlope(surface, {}, grain);
    ASSERT_TRUE(line);
    sum += line->angle / heaps;
    squares += line->angle * line->angle / heaps;
    claimed += line->standardError / heaps;
  }
  EXPECT_NEAR(sum, angle, .1);
  EXPECT_NEAR(claimed / std::sqrt(squares - sum * sum), 1, .2);
}

TEST(Pile, WithoutAMiddleHasNoAngle) {
  EXPECT_FALSE(fitSlope({}, {}, 1e-3));
  EXPECT_FALSE(fitSlope({{.1, 1}, {.2, .9}, {.3, .05}}, {}, 1e-3));
}

TEST(Pile, SurfaceIsTheTopOfTheHighestParticle) {
  // Two balls side by side and one on top of the first.
  const auto ball = makeShape("sphere", std::vector{1.0});
  Bed bed;
  for (const Vec3& x : {Vec3(1, 0, 1), Vec3(3, 0, 1), Vec3(1, 0, 3)}) {
    bed.shapes.push_back(ball.get());
    bed.frames.emplace_back(Pose{x, Quat::Identity()});
  }
  const auto surface = sampleSide(bed, .01);
  ASSERT_EQ(surface.size(), 400u);
  for (const SurfacePoint& p : surface) {
    const double centre = p.distance < 2 ? 1 : 3, base = p.distance < 2 ? 3 : 1;
    EXPECT_NEAR(p.height, base + std::sqrt(1 - std::pow(p.distance - centre, 2)), 1e-12);
  }
  // Area under it: the half discs, what is under their centres, and no more.
  const PlanePorosity porosity = measurePorosity(bed, surface);
  EXPECT_NEAR(porosity.pileArea, pi / 2 + 6 + pi / 2 + 2, 1e-3);
  EXPECT_NEAR(porosity.sectionArea, 3 * pi, 1e-4);
  EXPECT_NEAR(porosity.porosity, 1 - 3 * pi / (pi + 8), 1e-4);
}

TEST(Pile, ConeOfBallsHasItsAngle) {
  // Small balls fill a cone of 30 degrees: the mean surface is parallel to it.
  const auto ball = makeShape("sphere", std::vector{.02});
  Bed bed;
  const double slope = std::tan(pi / 6);
  for (double x = -1; x <= 1; x += .03)
    for (double y = -1; y <= 1; y += .03) {
      const double z = .5 - slope * std::hypot(x, y);
      if (z < .02) continue;
      bed.shapes.push_back(ball.get());
      bed.frames.emplace_back(Pose{Vec3(x, y, z), Quat::Identity()});
    }
  const auto line = fitSlope(sampleCone(bed, .004, 72), {}, .04);
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->angle, 30, .3);
}

}  // namespace
}  // namespace granular
