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
    const Vec3 n = random.direction(), u = perpendicular(n), v = n.cross(u);
    const Vec3 t = (random.uniform(-1, 1) * u + random.uniform(-1, 1) * v).normalized();
    const double h = 1e-4;
    const Vec3 ahead = (n + h * t).normalized(), behind = (n - h * t).normalized();
    const Vec3 step = ellipsoid.support(ahead) - ellipsoid.support(behind), turn = ahead - behind;
    const Curvature S = curvatureOf(ellipsoid, n, u);
    const double error = std::hypot(S.uu * u.dot(step) + S.uv * v.dot(step) - u.dot(turn),
                                    S.uv * u.dot(step) + S.vv * v.dot(step) - v.dot(turn));
    EXPECT_LT(error, 3e-6 * turn.norm());
  }
}

TEST(Curvature, OfABallIsItsRadiusInEveryDirection) {
  const Ellipsoid ball(Vec3::Constant(3e-3));
  const auto sphere = makeShape("sphere", std::vector{3e-3});
  const Vec3 n = Vec3(1, 2, -2) / 3, u = perpendicular(n);
  for (const Curvature& S : {curvatureOf(ball, n, u), curvatureOf(*sphere, n, u)}) {
    EXPECT_NEAR(S.uu * 3e-3, 1, 1e-13);
    EXPECT_NEAR(S.vv * 3e-3, 1, 1e-13);
    EXPECT_NEAR(S.uv * 3e-3, 0, 1e-13);
  }
}

TEST(Curvature, EffectiveRadiusOfTwoBallsIsTheirHarmonicHalf) {
  EXPECT_NEAR(effectiveRadius(ballCurvature(2) + ballCurvature(3), infinity), 6.0 / 5, 1e-14);
  EXPECT_NEAR(effectiveRadius(ballCurvature(2), infinity), 2, 1e-14);
}

TEST(Curvature, EffectiveRadiusOfProlateEllipsoidsIsThatOfTheirPrincipalRadii) {
  // a = 2.7, b = 1.15: at the waist radii a^2/b along the axis and b across, at a tip b^2/a in both directions.
  const double a = 2.7, b = 1.15;
  const Ellipsoid grain({a, b, b});
  const Curvature waist = curvatureOf(grain, Vec3::UnitZ(), Vec3::UnitX());
  const Curvature turned = curvatureOf(grain, Vec3::UnitZ(), Vec3::UnitY());
  const Curvature tip = curvatureOf(grain, -Vec3::UnitX(), Vec3::UnitY());
  EXPECT_NEAR(effectiveRadius(waist, infinity), a, 1e-13);  // sqrt(a^2/b b)
  EXPECT_NEAR(effectiveRadius(tip, infinity), b * b / a, 1e-13);
  EXPECT_NEAR(largestRadius(grain), a, 1e-13);

  // Waist on waist: parallel half of each radius, crossed the same mean curvature in both directions.
  EXPECT_NEAR(effectiveRadius(waist + waist, infinity), a / 2, 1e-13);
  EXPECT_NEAR(effectiveRadius(waist + turned, infinity), 1 / (b / (a * a) + 1 / b), 1e-13);
}

TEST(Curvature, SurfacesThatFollowEachOtherCountNoFlatterThanTheLimit) {
  // A ball in a cylinder of its own radius has a line of contact; in a narrower one it would have none.
  EXPECT_NEAR(effectiveRadius(ballCurvature(1) + Curvature{0, -1, 0}, 100), 10, 1e-12);  // sqrt(1 100)
  EXPECT_NEAR(effectiveRadius(ballCurvature(1) + Curvature{0, -2, 0}, 100), 10, 1e-12);
  EXPECT_NEAR(effectiveRadius({}, 100), 100, 1e-12);
}

TEST(Curvature, BodiesWithFacesCountAsTheSphereOfEqualVolume) {
  const auto cube = makeShape("cuboid", std::vector{1e-3, 1e-3, 1e-3});
  EXPECT_NEAR(effectiveRadius(curvatureOf(*cube, Vec3::UnitX(), Vec3::UnitY()), infinity), std::cbrt(6 / pi) * 1e-3,
              1e-15);
  EXPECT_EQ(largestRadius(*cube), cube->size());
}

TEST(Curvature, LargestRadiusOfAClumpIsThatOfItsLargestChild) {
  const std::vector<ChildSphere> children = {{Vec3::Zero(), 1e-3}, {Vec3(1e-3, 0, 0), 2e-3}};
  EXPECT_NEAR(largestRadius(Clump(children)), 2e-3, 1e-18);
}

}  // namespace
}  // namespace granular
