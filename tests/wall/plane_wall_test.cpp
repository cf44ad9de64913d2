#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "wall/wall_samples.h"

namespace granular {
namespace {

using namespace sample;

constexpr PointRule everyRule[] = {PointRule::witness, PointRule::faceCentroid, PointRule::pressureCentroid,
                                   PointRule::patch};

TEST(PlaneWall, OverlapIsTheDepthOfTheDeepestSampledPoint) {
  Random random(1);
  for (const auto& body : bodies()) {
    const TriangleMesh surface = body->surface(400);
    for (int trial = 0; trial < 50; ++trial) {
      const Vec3 normal = random.direction(), point = 0.01 * random.direction();
      const auto wall = makePlaneWall(point, 3 * normal);
      const double wanted = 1e-5 * random.uniform();
      const Frame frame =
          lowered(*body, Frame(random.rotation().toRotationMatrix(), Vec3::Zero()), point, normal, wanted);
      const auto touches = touchesOf(*wall, *body, frame);
      ASSERT_EQ(touches.size(), 1u);
      double deepest = -1;
      for (const Vec3& p : surface.vertices) deepest = std::max(deepest, normal.dot(point - frame.toWorld(p)));
      EXPECT_NEAR(touches[0].overlap, wanted, 1e-16);
      EXPECT_GE(touches[0].overlap, deepest - 1e-16);
      EXPECT_LE(touches[0].overlap, deepest + 2e-3 * body->boundingRadius() * 0.1);
      EXPECT_LT((touches[0].normal + normal).norm(), 1e-15);
      EXPECT_EQ(touches[0].spot, 0);
      EXPECT_EQ(touches[0].share, 1);
    }
  }
}

TEST(PlaneWall, SphereAndEllipsoidTouchAtTheirSupportPoint) {
  const auto wall = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  Random random(2);
  const Vec3 semi(0.001, 0.002, 0.003);
  const Ellipsoid ellipsoid(semi);
  for (PointRule rule : everyRule) {
    const Sphere sphere(0.002);
    const auto ball = touchesOf(*wall, sphere, Frame(Mat3::Identity(), Vec3(0.1, 0.2, 0.0019)), rule);
    ASSERT_EQ(ball.size(), 1u);
    EXPECT_LT((ball[0].patch.point - Vec3(0.1, 0.2, -0.5e-4)).norm(), 1e-16);
    EXPECT_EQ(ball[0].patch.area, 0);

    // Support of an ellipsoid: A^2 n / |A n|.
    const Mat3 R = random.rotation().toRotationMatrix();
    const Vec3 n = -R.row(2).transpose(), scaled = semi.cwiseProduct(n);
    const double height = scaled.norm();
    const auto egg = touchesOf(*wall, ellipsoid, Frame(R, Vec3(0, 0, height - 1e-5)), rule);
    ASSERT_EQ(egg.size(), 1u);
    EXPECT_NEAR(egg[0].overlap, 1e-5, 1e-17);
    const Vec3 lowest = R * Vec3(semi.cwiseProduct(scaled) / height) + Vec3(0, 0, height - 1e-5);
    EXPECT_LT((egg[0].patch.point - lowest - Vec3(0, 0, 0.5e-5)).norm(), 1e-16);
  }
}

TEST(PlaneWall, FlatFaceGivesItsWholeAreaAndMoments) {
  const Cuboid block(Vec3(0.001, 0.002, 0.003));
  const auto wall = makePlaneWall(Vec3(0, 0, 0.5), Vec3::UnitZ());
  for (PointRule rule : everyRule) {
    const auto touches = touchesOf(*wall, block, Frame(Mat3::Identity(), Vec3(0.1, 0.2, 0.502999)), rule);
    ASSERT_EQ(touches.size(), 1u);
    const ContactPatch& patch = touches[0].patch;
    EXPECT_NEAR(patch.point.z(), 0.5 - 0.5e-6, 1e-15);
    if (rule == PointRule::witness) continue;
    EXPECT_LT((patch.point - Vec3(0.1, 0.2, patch.point.z())).norm(), 1e-15);
    if (rule != PointRule::patch) continue;
    EXPECT_NEAR(patch.area, 8e-6, 1e-18);
    EXPECT_LT((patch.centre - patch.point).norm(), 1e-15);
    const Vec3 v = touches[0].normal.cross(patch.u);
    const double alongX =
        patch.uu * patch.u.x() * patch.u.x() + patch.vv * v.x() * v.x() + 2 * patch.uv * patch.u.x() * v.x();
    EXPECT_NEAR(alongX, 1e-6 / 3, 1e-18);
    EXPECT_NEAR(patch.uu + patch.vv, 5e-6 / 3, 1e-18);
  }
}

TEST(PlaneWall, PressureCentroidMovesToTheThirdPointAndBeyond) {
  // A block of half-width b tilted by t about y: depth falls from delta at one edge by 2 b sin t to the other.
  const double b = 0.001;
  const Cuboid block(Vec3(b, 0.002, 0.003));
  const auto wall = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  const double tilt = 0.01;
  const Mat3 R = Eigen::AngleAxisd(tilt, Vec3::UnitY()).toRotationMatrix();
  const auto pointAlongFace = [&](double overlap) {
    const Frame frame = lowered(block, Frame(R, Vec3::Zero()), Vec3::Zero(), Vec3::UnitZ(), overlap);
    const auto touches = touchesOf(*wall, block, frame, PointRule::pressureCentroid);
    return frame.toWorld(Vec3(b, 0, -0.003)).x() - touches.at(0).patch.point.x();
  };
  const double width = 2 * b * std::cos(tilt), drop = 2 * b * std::sin(tilt);
  // At lift-off of the far edge: a third of the width from the deep edge.
  EXPECT_NEAR(pointAlongFace(drop), width / 3, 1e-15);
  // Half lifted: a third of what is left below the plane (a foot of the steep side lies under the deep edge too).
  const double side = drop / 2 * std::tan(tilt);
  EXPECT_NEAR(pointAlongFace(drop / 2), width / 6, side);
  // Everything below: trapezoid of depths d and d - drop.
  const double d = 3 * drop, e = d - drop;
  EXPECT_NEAR(pointAlongFace(d), width / 3 * (d + 2 * e) / (d + e), d * std::tan(tilt));
}

TEST(PlaneWall, LyingCylinderTouchesAlongItsSide) {
  const Cylinder cylinder(0.0015, 0.004);
  const auto wall = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  const Mat3 R = Eigen::AngleAxisd(pi / 2, Vec3::UnitX()).toRotationMatrix();
  for (PointRule rule : {PointRule::faceCentroid, PointRule::pressureCentroid, PointRule::patch}) {
    const auto touches = touchesOf(*wall, cylinder, Frame(R, Vec3(0.01, 0.02, 0.001499)), rule);
    ASSERT_EQ(touches.size(), 1u);
    EXPECT_LT((touches[0].patch.point - Vec3(0.01, 0.02, -0.5e-6)).norm(), 1e-14);
  }
}

TEST(PlaneWall, SeparatedBodiesTouchNothingAndClearanceIsExact) {
  Random random(4);
  const auto wall = makePlaneWall(Vec3(0, 0, 1), Vec3(0, 0, 2));
  EXPECT_NEAR(wall->clearance(Vec3(5, 5, 1.25), 0.1), 0.15, 1e-15);
  EXPECT_TRUE(wall->admits(Vec3(0, 0, 1.1)));
  EXPECT_FALSE(wall->admits(Vec3(0, 0, 0.9)));
  for (const auto& body : bodies()) {
    const Frame frame =
        lowered(*body, Frame(random.rotation().toRotationMatrix(), Vec3::Zero()), Vec3(0, 0, 1), Vec3::UnitZ(), -1e-9);
    EXPECT_TRUE(touchesOf(*wall, *body, frame).empty());
  }
}

TEST(PlaneWall, RefusesANormalWithoutDirection) {
  EXPECT_THROW(makePlaneWall(Vec3::Zero(), Vec3::Zero()), InputError);
  EXPECT_THROW(makePlaneWall(Vec3(std::nan(""), 0, 0), Vec3::UnitZ()), InputError);
}

}  // namespace
}  // namespace granular
