#include "granular/insert/placement.h"

#include <gtest/gtest.h>

#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

Region makeVessel(double radius) {
  Region region;
  region.kind = Region::Kind::cylinder;
  region.radius = radius;
  return region;
}

Region makeBox(double width, bool periodic = false) {
  Region region;
  region.kind = periodic ? Region::Kind::periodic : Region::Kind::box;
  region.lo = Vec2::Constant(-width / 2);
  region.hi = Vec2::Constant(width / 2);
  return region;
}

Frame at(double x, double y, double z, const Quat& q = Quat::Identity()) { return Frame(Pose{{x, y, z}, q}); }

TEST(Region, DrawnPointsAreUniformOverTheCircle) {
  const Region region = makeVessel(2);
  Random random(1);
  int inner = 0;
  const int count = 100000;
  for (int k = 0; k < count; ++k) {
    const Vec2 p = region.drawPoint(random);
    ASSERT_LE(p.norm(), 2);
    inner += p.norm() < 1;
  }
  EXPECT_NEAR(double(inner) / count, 0.25, 5 * std::sqrt(0.25 * 0.75 / count));
}

TEST(Region, HoldsACubeUntilItsEdgesMeetTheVessel) {
  const Cuboid cube(Vec3::Constant(1));
  const Region region = makeVessel(5);
  // The outer edges of a cube at (x, 0) are at distance hypot(x + 1, 1).
  const double x = std::sqrt(24.0) - 1;
  EXPECT_TRUE(region.holds(cube, at(x - 1e-9, 0, 1.5)));
  EXPECT_FALSE(region.holds(cube, at(x + 1e-9, 0, 1.5)));
  EXPECT_FALSE(region.holds(cube, at(0, 0, 0.99)));
}

TEST(Region, HoldsALyingDiscOnlyWhereItsRimFits) {
  // A disc of radius 2 standing on its rim, its face towards the wall: the far corner is at hypot(x + .25, 2).
  const Cylinder disc(2, 0.5);
  const Region region = makeVessel(5);
  const Quat upright(Eigen::AngleAxisd(pi / 2, Vec3::UnitY()));
  const double x = std::sqrt(21.0) - 0.25;
  EXPECT_TRUE(region.holds(disc, at(x - 1e-9, 0, 3, upright)));
  EXPECT_FALSE(region.holds(disc, at(x + 1e-9, 0, 3, upright)));
}

TEST(Region, HoldsAgreesWithSampledSurfacePoints) {
  const Ellipsoid rod(Vec3(0.4, 0.6, 1.5));
  const Region region = makeVessel(3);
  Random random(3);
  int held = 0, refused = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec2 xy = region.drawPoint(random);
    const Frame frame(Pose{{xy.x(), xy.y(), 2}, random.rotation()});
    // Semi-axis lengths seen from every horizontal direction: a fine scan.
    double reach = 0;
    for (int a = 0; a < 2000; ++a) {
      const Vec3 d(std::cos(a * pi / 1000), std::sin(a * pi / 1000), 0);
      reach = std::max(reach, d.dot(frame.toWorld(rod.support(frame.unrotate(d)))));
    }
    if (std::abs(reach - 3) < 1e-4) continue;
    EXPECT_EQ(region.holds(rod, frame), reach < 3);
    ++(reach < 3 ? held : refused);
  }
  EXPECT_GT(held, 100);
  EXPECT_GT(refused, 100);
}

TEST(Columns, SphereIsLetDownToTheFloorAndOntoASphere) {
  const Sphere sphere(1);
  Columns columns(makeBox(20), {}, 1);
  Frame frame = at(0, 0, 0);
  ASSERT_TRUE(columns.letDown(sphere, 0, frame));
  EXPECT_NEAR(frame.x.z(), 1, 1e-8);
  columns.add(sphere, frame);
  EXPECT_NEAR(columns.top(), 2, 1e-8);

  Frame above = at(1, 0, 0);
  ASSERT_TRUE(columns.letDown(sphere, 0, above));
  EXPECT_NEAR(above.x.z(), 1 + std::sqrt(3.0), 1e-8);
  Frame beside = at(2.5, 0, 0);
  ASSERT_TRUE(columns.letDown(sphere, 0, beside));
  EXPECT_NEAR(beside.x.z(), 1, 1e-8);
}

TEST(Columns, FlatPlateIsLetDownWithinAStepOfThePlateBelow) {
  const Cuboid plate(Vec3(3, 3, 0.5));
  Columns columns(makeBox(20), {}, plate.boundingRadius());
  columns.add(plate, at(0, 0, 0.5));
  Frame frame = at(1, 1, 0);
  ASSERT_TRUE(columns.letDown(plate, 0, frame));
  EXPECT_GE(frame.x.z(), 1.5);
  EXPECT_LE(frame.x.z(), 1.5 + 0.25 * plate.innerRadius());
}

TEST(Columns, StopAtTheLowestPlaneAskedFor) {
  const Sphere sphere(1);
  Columns columns(makeBox(20), {}, 1);
  Frame frame = at(0, 0, 0);
  ASSERT_TRUE(columns.letDown(sphere, 7, frame));
  EXPECT_NEAR(frame.x.z(), 8, 1e-8);
}

TEST(Columns, WhatSticksOutOfTheRegionFindsNoPlace) {
  const Sphere sphere(1);
  Columns columns(makeBox(20), {}, 1);
  Frame frame = at(9.5, 0, 0);
  EXPECT_FALSE(columns.letDown(sphere, 0, frame));
}

TEST(Columns, SlopingWallStopsWhatIsLetDown) {
  const Sphere sphere(1);
  const auto slope = makePlaneWall({0, 0, 0}, Vec3(1, 0, 1).normalized());
  Columns columns(makeBox(20), {slope.get()}, 1);
  for (const double lowest : {0.0, 10.0}) {
    Frame frame = at(-3, 0, 0);
    ASSERT_TRUE(columns.letDown(sphere, lowest, frame));
    // The sphere touches the plane z = -x at the height 3 + sqrt(2).
    const double touching = 3 + std::sqrt(2.0);
    EXPECT_GE(frame.x.z(), std::max(touching, lowest + 1));
    EXPECT_LE(frame.x.z(), std::max(touching + 0.25, lowest + 1 + 1e-8));
  }
}

TEST(Columns, PeriodicNeighboursAreSeenAcrossTheSides) {
  const Sphere sphere(1);
  Columns columns(makeBox(20, true), {}, 1);
  columns.add(sphere, at(9.5, 0, 1));
  columns.add(sphere, at(-9.8, -9.9, 1));
  EXPECT_FALSE(columns.isFree(sphere, at(-9.5, 0, 1)));
  EXPECT_FALSE(columns.isFree(sphere, at(9.9, 9.9, 1)));
  EXPECT_FALSE(columns.isFree(sphere, at(29.9, -30.1, 1)));
  EXPECT_TRUE(columns.isFree(sphere, at(-8.4, 0, 1)));
  EXPECT_TRUE(columns.isFree(sphere, at(-9.5, 0, 3.1)));
}

TEST(Columns, FreePosesAgreeWithEveryPairTested) {
  // Random sequential addition of two shapes, each pose judged by the columns and by brute force.
  const Cuboid cube(Vec3::Constant(0.8));
  const Ellipsoid rod(Vec3(0.4, 0.4, 1.6));
  for (const bool periodic : {false, true}) {
    const Region region = makeBox(8, periodic);
    Columns columns(region, {}, 1.6);
    std::vector<PlacedShape> placed;
    Random random(4);
    int refused = 0;
    for (int k = 0; k < 1500; ++k) {
      const Shape& shape = k % 2 ? static_cast<const Shape&>(cube) : rod;
      const Vec2 xy = region.drawPoint(random);
      const Frame frame(Pose{{xy.x(), xy.y(), random.uniform(1.6, 6)}, random.rotation()});
      bool free = region.holds(shape, frame);
      for (const PlacedShape& other : placed)
        for (int i = -1; i <= 1; ++i)
          for (int j = -1; j <= 1; ++j) {
            if (!periodic && (i != 0 || j != 0)) continue;
            const Frame image(other.frame.R, other.frame.x + Vec3(8 * i, 8 * j, 0));
            free = free && !overlaps(shape, frame, *other.shape, image);
          }
      ASSERT_EQ(columns.isFree(shape, frame), free) << k;
      if (free) {
        columns.add(shape, frame);
        placed.push_back({&shape, frame});
      } else {
        ++refused;
      }
    }
    EXPECT_GT(placed.size(), 30u);
    EXPECT_GT(refused, 300);
  }
}

}  // namespace
}  // namespace granular
