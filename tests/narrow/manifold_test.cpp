// Bullet's persistent manifold as plain data.
#include <gtest/gtest.h>

#include <numeric>

#include "granular/narrow/bullet_manifold.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

/// A cube on a cube, tilted a little about an axis that goes round: each step another corner is the deepest.
struct Rocking {
  explicit Rocking(double scale) : half(1.5e-3 * scale), cube(Vec3::Constant(half)) {}

  int step(int k) {
    const double azimuth = 0.25 * pi + 0.5 * pi * k;
    const double tilt = 1e-4;
    const Vec3 axis(std::cos(azimuth), std::sin(azimuth), 0);
    const Frame below;
    const Frame above(Pose{Vec3(0, 0, 2 * half - 2 * tilt * half), rotationFromVector(tilt * axis)});
    Touch touch;
    EXPECT_TRUE(findTouch(cube, below, cube, above, false, cache, counts, touch));
    return refreshManifold(cube, below, cube, above, touch, manifold, contacts);
  }

  double half;
  Cuboid cube;
  WarmCache cache;
  NarrowCounts counts;
  Manifold manifold;
  std::array<ManifoldContact, 4> contacts;
};

TEST(Manifold, ARockingCubeGathersItsFourCornersWithEqualShares) {
  Rocking rocking(1);
  int count = 0;
  for (int k = 0; k < 12; ++k) count = rocking.step(k);
  EXPECT_EQ(rocking.manifold.count, 4);
  ASSERT_GE(count, 1);
  double shares = 0;
  for (int k = 0; k < count; ++k) {
    shares += rocking.contacts[static_cast<std::size_t>(k)].share;
    const Touch& touch = rocking.contacts[static_cast<std::size_t>(k)].touch;
    EXPECT_GT(touch.overlap, 0);
    EXPECT_NEAR((touch.onA - touch.onB - touch.overlap * touch.normal).norm(), 0, 1e-15);
    EXPECT_NEAR(std::abs(touch.onA.x()), rocking.half, 1e-2 * rocking.half);
    EXPECT_NEAR(std::abs(touch.onA.y()), rocking.half, 1e-2 * rocking.half);
  }
  EXPECT_NEAR(shares, 1, 1e-15);
}

TEST(Manifold, PointsKeepTheirSpotsWhileTheyLive) {
  Rocking rocking(1);
  for (int k = 0; k < 4; ++k) rocking.step(k);
  const Manifold before = rocking.manifold;
  for (int k = 4; k < 8; ++k) rocking.step(k);
  ASSERT_EQ(before.count, 4);
  for (int i = 0; i < 4; ++i) {
    const ManifoldPoint& old = before.points[static_cast<std::size_t>(i)];
    bool found = false;
    for (const ManifoldPoint& now : rocking.manifold.points) {
      found = found || (now.spot == old.spot && (now.onB - old.onB).norm() < 1e-2 * rocking.half);
    }
    EXPECT_TRUE(found) << old.spot;
  }
  EXPECT_EQ(rocking.manifold.nextSpot, 4);
}

TEST(Manifold, TheUnitOfLengthChangesNothing) {
  Rocking millimetres(1), kilometres(1e6);
  for (int k = 0; k < 9; ++k) {
    const int count = millimetres.step(k);
    ASSERT_EQ(kilometres.step(k), count);
    for (int i = 0; i < count; ++i) {
      const ManifoldContact &p = millimetres.contacts[static_cast<std::size_t>(i)],
                            &q = kilometres.contacts[static_cast<std::size_t>(i)];
      EXPECT_EQ(p.spot, q.spot);
      EXPECT_NEAR(q.touch.overlap * 1e-6, p.touch.overlap, 1e-9 * millimetres.half);
    }
  }
}

}  // namespace
}  // namespace granular
