// Order parameters of directors with known answers (S appendix B).
#include <gtest/gtest.h>

#include "analysis/lattice.h"
#include "granular/analysis/bed_analysis.h"
#include "granular/core/random.h"

namespace granular::test {
namespace {

/// Square rods spread through a cylinder, turned so that their long axis points along director(position).
template <class Turn>
OwnedBed makeRods(int count, const Turn& turn) {
  OwnedBed owned{std::make_shared<Cuboid>(Vec3(0.1, 0.1, 0.3)), {}};
  owned.bed.vessel.kind = Vessel::Kind::cylinder;
  owned.bed.vessel.radius = 5;
  Random random(11);
  for (int k = 0; k < count; ++k) {
    const double r = 4.9 * std::sqrt(random.uniform()), azimuth = random.uniform(0, 2 * pi);
    const Vec3 x(r * std::cos(azimuth), r * std::sin(azimuth), random.uniform(0.5, 20));
    const Vec3 radial(std::cos(azimuth), std::sin(azimuth), 0);
    owned.add(x, Quat::FromTwoVectors(owned.shape->director(), turn(radial, random)).toRotationMatrix());
  }
  return owned;
}

std::vector<Director> collect(const OwnedBed& owned) {
  return collectDirectors(owned.bed, CrossSection(owned.bed.vessel, {}), 0);
}
Order measureRadial(const std::vector<Director>& directors) {
  return measureOrder(
      directors, [](const Director& d) { return d.radial; }, [](const Director&) { return true; });
}

TEST(Order, RadialDirectorsAreFullyOrdered) {
  const auto directors = collect(makeRods(200, [](const Vec3& radial, Random&) { return radial; }));
  const Order order = measureRadial(directors);
  EXPECT_EQ(order.count, 200u);
  EXPECT_NEAR(order.s2, 1, 1e-12);
  EXPECT_NEAR(order.s4, 1, 1e-12);
}

TEST(Order, VerticalDirectorsArePerpendicularToTheRadius) {
  const auto directors = collect(makeRods(200, [](const Vec3&, Random&) { return Vec3(0, 0, 1); }));
  const Order order = measureRadial(directors);
  EXPECT_NEAR(order.s2, -0.5, 1e-12);
  EXPECT_NEAR(order.s4, 0.375, 1e-12);
  EXPECT_NEAR(measureNematicOrder(directors), 1, 1e-12);
}

TEST(Order, IsotropicDirectorsHaveNone) {
  // <P2^2> = 1/5 and <P4^2> = 1/9 on the sphere.
  constexpr int n = 20000;
  const auto directors = collect(makeRods(n, [](const Vec3&, Random& random) { return random.direction(); }));
  const Order order = measureRadial(directors);
  EXPECT_LT(std::abs(order.s2), 5 * std::sqrt(0.2 / n));
  EXPECT_LT(std::abs(order.s4), 5 * std::sqrt(1.0 / 9 / n));
  EXPECT_NEAR(order.s2Error, std::sqrt(0.2 / n), 0.1 * std::sqrt(0.2 / n));
  EXPECT_NEAR(order.s4Error, std::sqrt(1.0 / 9 / n), 0.1 * std::sqrt(1.0 / 9 / n));
}

TEST(Order, SignOfADirectorHasNoMeaning) {
  int sign = 1;
  const auto directors =
      collect(makeRods(50, [&](const Vec3& radial, Random&) -> Vec3 { return (sign = -sign) * radial; }));
  EXPECT_NEAR(measureRadial(directors).s2, 1, 1e-12);
}

TEST(Order, InThePlaneOfTheWallTheAngleIsFound) {
  // Directors at 45 degrees between azimuthal and vertical: S2 = P2(cos(alpha - 45)).
  const auto directors = collect(makeRods(300, [](const Vec3& radial, Random&) -> Vec3 {
    return (Vec3::UnitZ().cross(radial) + Vec3::UnitZ()).normalized();
  }));
  Regions regions;
  regions.unit = regions.length = regions.nearWall = 1;
  regions.to = 100;
  regions.core = 2;
  regions.hasCore = true;
  const Table table = tabulatePlaneOrder(directors, regions, 5);
  ASSERT_EQ(table.rows.size(), 19u);
  for (const std::vector<double>& row : table.rows) {
    const double c = std::pow(std::cos((row[0] - 45) * pi / 180), 2);
    for (const std::size_t column : {1u, 3u, 5u}) {
      EXPECT_NEAR(row[column], 0.5 * (3 * c - 1), 1e-12);
      EXPECT_NEAR(row[column + 1], 0.125 * (35 * c * c - 30 * c + 3), 1e-12);
    }
  }
}

TEST(Order, BinsHoldEveryParticleOnceAndTheLastCumulativeRowAll) {
  const OwnedBed owned = makeRods(500, [](const Vec3&, Random& random) { return random.direction(); });
  const auto directors = collect(owned);
  Regions regions;
  regions.unit = 1;
  const Table bins = tabulateRadialOrder(directors, regions, 5, 0.7),
              sums = tabulateCumulativeOrder(directors, regions, 5, 0.7);
  double count = 0, weighted = 0;
  for (std::size_t k = 0; k < bins.rows.size(); ++k) {
    count += bins.rows[k][2];
    if (bins.rows[k][2] > 0) weighted += bins.rows[k][2] * bins.rows[k][3];
    EXPECT_EQ(sums.rows[k][2], count);
    EXPECT_NEAR(sums.rows[k][3], weighted / count, 1e-12);
  }
  EXPECT_EQ(count, 500);
  EXPECT_NEAR(sums.rows.back()[3], measureRadial(directors).s2, 1e-12);
}

TEST(Order, InABoxTheRadiusPointsToTheNearestSideWall) {
  OwnedBed owned{std::make_shared<Cuboid>(Vec3(0.1, 0.1, 0.3)), {}};
  owned.bed.vessel = makeBox(Vec3(10, 10, 10));
  const Mat3 alongX = Quat::FromTwoVectors(owned.shape->director(), Vec3::UnitX()).toRotationMatrix();
  owned.add({1, 5, 1}, alongX);
  owned.add({9, 5, 1}, alongX);
  owned.add({5, 1, 1}, alongX);
  const auto directors = collect(owned);
  EXPECT_EQ(directors[0].radial, Vec3(-1, 0, 0));
  EXPECT_EQ(directors[1].radial, Vec3(1, 0, 0));
  EXPECT_EQ(directors[2].radial, Vec3(0, -1, 0));
  EXPECT_NEAR(measureRadial(directors).s2, (1 + 1 - 0.5) / 3, 1e-12);
}

TEST(Order, SpheresHaveNone) {
  OwnedBed owned = makeCubicSpheres({4, 4, 9});
  const BedAnalysis spheres = analyseBed(owned.bed);
  EXPECT_EQ(findTable(spheres, "order_radial"), nullptr);
  EXPECT_FALSE(findQuantity(spheres, "order_s2_r").has_value());
  EXPECT_FALSE(findQuantity(spheres, "order_nematic").has_value());

  // Beside other particles they are left out of every mean.
  const Cuboid rod(Vec3(0.1, 0.1, 0.3));
  owned.bed.shapes[5] = &rod;
  owned.bed.frames[5].R = Quat::FromTwoVectors(rod.director(), Vec3::UnitZ()).toRotationMatrix();
  EXPECT_NEAR(*findQuantity(analyseBed(owned.bed), "order_s2_z"), 1, 1e-12);
}

TEST(Order, WithoutAWallThereIsNoRadialOrder) {
  OwnedBed owned = makeCubes({4, 4, 9});
  makePeriodic(owned.bed);
  const BedAnalysis a = analyseBed(owned.bed);
  EXPECT_EQ(findTable(a, "order_radial"), nullptr);
  EXPECT_FALSE(findQuantity(a, "order_s2_r").has_value());
  EXPECT_TRUE(findQuantity(a, "order_s2_z").has_value());
}

}  // namespace
}  // namespace granular::test
