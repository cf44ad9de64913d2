// Curvatures against the turn of the normal along the surface, and effective radii against principal ones.
#include "granular/shape/curvature.h"

#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/shape/clump.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/shape_table.h"

namespace granular {
namespace {

TEST(Curvature, IsTheTurnOfTheNormalAlongTheSurface) {
  // The support point p(n) moves by dp where the normal turns by dn: S dp = dn. Central differences: error h^2 of the
  // third derivative, here of order one for aspect ratios up to 4; h = 1e-4 leaves 1e-7.
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const Vec3 semi(random.uniform(.5, 2), random.uniform(.5, 2), random.uniform(.5, 2));
    const Ellipsoid ellipsoid(semi);
    const Vec3 n = random.direction(), t = n.cross(random.direction()).normalized();
    const double h = 1e-4;
    const Vec3 ahead = (n + h * t).normalized(), behind = (n - h * t).normalized();
    const Vec3 step = ellipsoid.support(ahead) - ellipsoid.support(behind);
    const Mat3 S = curvatureOf(ellipsoid, n);
    EXPECT_LT((S * step - (ahead - behind)).norm(), 3e-6 * (ahead - behind).norm());
    EXPECT_LT((S * n).norm(), 1e-13 * S.norm());
    EXPECT_LT((S - S.transpose()).norm(), 1e-14 * S.norm());
  }
}

TEST(Curvature, OfABallIsItsRadiusInEveryDirection) {
  const Ellipsoid ball(Vec3::Constant(3e-3));
  const auto sphere = makeShape("sphere", std::vector{3e-3});
  const Vec3 n = Vec3(1, 2, -2) / 3;
  const Mat3 expected = (Mat3::Identity() - n * n.transpose()) / 3e-3;
  EXPECT_LT((curvatureOf(ball, n) - expected).norm(), 1e-13 * expected.norm());
  EXPECT_LT((curvatureOf(*sphere, n) - expected).norm(), 1e-13 * expected.norm());
}

TEST(Curvature, EffectiveRadiusOfTwoBallsIsTheirHarmonicHalf) {
  const Vec3 n = Vec3(2, -1, 2) / 3;
  const Mat3 plane = Mat3::Identity() - n * n.transpose();
  EXPECT_NEAR(effectiveRadius(plane / 2 + plane / 3, infinity), 6.0 / 5, 1e-14);
  EXPECT_NEAR(effectiveRadius(plane / 2, infinity), 2, 1e-14);
}

TEST(Curvature, EffectiveRadiusOfProlateEllipsoidsIsThatOfTheirPrincipalRadii) {
  // a = 2.7, b = 1.15: at the waist radii a^2/b along the axis and b across, at a tip b^2/a in both directions.
  const double a = 2.7, b = 1.15;
  const Ellipsoid grain({a, b, b});
  const Mat3 waist = curvatureOf(grain, Vec3::UnitZ()), tip = curvatureOf(grain, -Vec3::UnitX());
  EXPECT_NEAR(effectiveRadius(waist, infinity), a, 1e-13);  // sqrt(a^2/b b)
  EXPECT_NEAR(effectiveRadius(tip, infinity), b * b / a, 1e-13);
  EXPECT_NEAR(largestRadius(grain), a, 1e-13);

  // Waist on waist: parallel half of each radius, crossed the same mean curvature in both directions.
  EXPECT_NEAR(effectiveRadius(2 * waist, infinity), a / 2, 1e-13);
  const Mat3 turn = Eigen::AngleAxisd(pi / 2, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_NEAR(effectiveRadius(waist + turn * waist * turn.transpose(), infinity), 1 / (b / (a * a) + 1 / b), 1e-13);
}

TEST(Curvature, SurfacesThatFollowEachOtherCountNoFlatterThanTheLimit) {
  // A ball in a cylinder of its own radius has a line of contact; in a narrower one it would have none.
  const Mat3 across = Vec3::UnitY() * Vec3::UnitY().transpose();
  const Mat3 ball = Mat3::Identity() - Vec3::UnitX() * Vec3::UnitX().transpose();
  EXPECT_NEAR(effectiveRadius(ball - across, 100), 10, 1e-12);  // sqrt(1 100)
  EXPECT_NEAR(effectiveRadius(ball - 2 * across, 100), 10, 1e-12);
  EXPECT_NEAR(effectiveRadius(Mat3::Zero(), 100), 100, 1e-12);
}

TEST(Curvature, BodiesWithFacesCountAsTheSphereOfEqualVolume) {
  const auto cube = makeShape("cuboid", std::vector{1e-3, 1e-3, 1e-3});
  const Vec3 n = Vec3::UnitX();
  EXPECT_NEAR(effectiveRadius(curvatureOf(*cube, n), infinity), std::cbrt(6 / pi) * 1e-3, 1e-15);
  EXPECT_EQ(largestRadius(*cube), cube->size());
}

TEST(Curvature, LargestRadiusOfAClumpIsThatOfItsLargestChild) {
  const std::vector<ChildSphere> children = {{Vec3::Zero(), 1e-3}, {Vec3(1e-3, 0, 0), 2e-3}};
  EXPECT_NEAR(largestRadius(Clump(children)), 2e-3, 1e-18);
}

}  // namespace
}  // namespace granular
