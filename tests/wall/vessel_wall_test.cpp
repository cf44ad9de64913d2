#include <gtest/gtest.h>

#include <map>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/wall/wall.h"

namespace granular {
namespace {

constexpr double radius = 0.025;
const Vec2 axis(0.002, -0.001);

std::vector<WallTouch> touchVessel(const Shape& shape, const Frame& frame, double vesselRadius = radius) {
  std::vector<WallTouch> touches;
  makeCylinderWall(axis, vesselRadius)->touch(RuleOptions{}, shape, frame, touches);
  return touches;
}

double distanceFromAxis(const Vec3& p) { return (p.head<2>() - axis).norm(); }

/// The frame of a body turned by q and moved outwards along `azimuth` until its surface stands out by `overlap`.
Frame pushOut(const Shape& shape, const Quat& q, double azimuth, double overlap) {
  const Vec3 out(std::cos(azimuth), std::sin(azimuth), 0);
  const TriangleMesh mesh = shape.surface(200);
  double lo = 0, hi = 2 * radius;
  Frame frame(q.toRotationMatrix(), Vec3::Zero());
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (lo + hi);
    frame.x = Vec3(axis.x(), axis.y(), 0.01) + middle * out;
    double furthest = 0;
    for (const Vec3& p : mesh.vertices) furthest = std::max(furthest, distanceFromAxis(frame.toWorld(p)));
    (furthest < radius + overlap ? lo : hi) = middle;
  }
  return frame;
}

Vec3 totalForce(const std::vector<WallTouch>& touches) {
  Vec3 force = Vec3::Zero();
  for (const WallTouch& touch : touches) force -= touch.share * touch.overlap * touch.normal;
  return force;
}

/// Everything a touch must be, whatever the shape.
void expectSound(const std::vector<WallTouch>& touches) {
  std::int32_t last = -1;
  for (const WallTouch& touch : touches) {
    EXPECT_GT(touch.overlap, 0);
    EXPECT_GT(touch.spot, last) << "spots must be distinct and in order";
    last = touch.spot;
    EXPECT_NEAR(touch.normal.norm(), 1, 1e-14);
    EXPECT_EQ(touch.normal.z(), 0);
    EXPECT_GE(touch.share, 0);
    EXPECT_LE(touch.share, 1 + 1e-14);
    // The contact point lies in the middle of the overlap, straight outwards from the axis.
    const Vec2 r = touch.patch.point.head<2>() - axis;
    EXPECT_NEAR(r.norm(), radius + touch.overlap / 2, 1e-15);
    EXPECT_NEAR(r.normalized().dot(touch.normal.head<2>()), 1, 1e-14);
    EXPECT_EQ(touch.patch.area, 0);
  }
}

TEST(VesselWall, SphereTouchesOnceOnTheLineFromTheAxis) {
  const Sphere sphere(0.0015);
  const Frame frame(Mat3::Identity(), Vec3(axis.x() + 0.6 * 0.0236, axis.y() - 0.8 * 0.0236, 0.03));
  const auto touches = touchVessel(sphere, frame);
  ASSERT_EQ(touches.size(), 1u);
  expectSound(touches);
  EXPECT_EQ(touches[0].spot, 0);
  EXPECT_NEAR(touches[0].overlap, 1e-4, 1e-16);
  EXPECT_LT((touches[0].normal - Vec3(0.6, -0.8, 0)).norm(), 1e-13);
  EXPECT_EQ(touches[0].share, 1);
}

TEST(VesselWall, FlatFaceTouchesAtItsFourCornersAndStaysAsStiffAsOneContact) {
  const Cuboid cube(Vec3(0.0015, 0.0015, 0.0015));
  const Frame frame = pushOut(cube, Quat::Identity(), 0, 1e-6);
  const auto touches = touchVessel(cube, frame);
  ASSERT_EQ(touches.size(), 4u);
  expectSound(touches);
  // Corners with the x bit set.
  const std::int32_t spots[] = {1, 3, 5, 7};
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(touches[k].spot, spots[k]);
    EXPECT_NEAR(touches[k].overlap, 1e-6, 1e-15);
    sum += touches[k].share;
  }
  // Upper and lower corners are parallel; left and right ones diverge by 2 asin(.0015 / R): they share a little less.
  const double cosine = std::cos(2 * std::asin(0.0015 / (radius + 1e-6)));
  EXPECT_NEAR(sum, 4 / (2 + 2 * cosine), 1e-9);
  EXPECT_NEAR(sum, 1, 0.004);
}

TEST(VesselWall, VerticalEdgeSharesBetweenItsTwoEnds) {
  const Cuboid cube(Vec3(0.0015, 0.0015, 0.0015));
  const auto touches = touchVessel(cube, pushOut(cube, Quat(Eigen::AngleAxisd(pi / 4, Vec3::UnitZ())), 0, 1e-6));
  ASSERT_EQ(touches.size(), 2u);
  expectSound(touches);
  EXPECT_NEAR(touches[0].share, 0.5, 1e-9);
  EXPECT_NEAR(touches[1].share, 0.5, 1e-9);
}

TEST(VesselWall, SpotsOnOppositeSidesDoNotShare) {
  const Cuboid rod(Vec3(radius + 1e-6, 1e-5, 1e-5));
  const auto touches = touchVessel(rod, Frame(Mat3::Identity(), Vec3(axis.x(), axis.y(), 0)));
  ASSERT_EQ(touches.size(), 8u);
  double sum = 0;
  for (const WallTouch& touch : touches) sum += touch.share;
  EXPECT_NEAR(sum, 2, 1e-5);
}

TEST(VesselWall, EveryVertexBeyondTheRadiusIsASpotOfItsOwn) {
  Random random(5);
  std::vector<Vec3> points;
  for (int k = 0; k < 30; ++k) points.push_back(0.003 * random.direction());
  const Polyhedron stone(points);
  for (int trial = 0; trial < 300; ++trial) {
    const Frame frame = pushOut(stone, random.rotation(), random.uniform(0, 2 * pi), 3e-4 * random.uniform());
    std::map<std::int32_t, double> expected;
    for (int v = 0; v < stone.tables().vertexCount(); ++v) {
      const double d = distanceFromAxis(frame.toWorld(stone.tables().vertices[std::size_t(v)])) - radius;
      if (d > 0) expected[v] = d;
    }
    const auto touches = touchVessel(stone, frame);
    expectSound(touches);
    ASSERT_EQ(touches.size(), expected.size());
    for (const WallTouch& touch : touches) EXPECT_NEAR(touch.overlap, expected.at(touch.spot), 1e-16);
  }
}

TEST(VesselWall, TotalForceIsContinuousWhileSpotsAppearAndGo) {
  // A cube turns about two axes while pressed against the wall: in small steps the force moves by small steps only.
  const Cuboid cube(Vec3(0.0015, 0.001, 0.0015));
  const Frame start = pushOut(cube, Quat::Identity(), 0.3, 1e-4);
  const int steps = 20000;
  Vec3 last = Vec3::Zero();
  std::size_t fewest = 9, most = 0;
  for (int k = 0; k <= steps; ++k) {
    const double angle = 0.5 * k / steps;
    const Quat q = Eigen::AngleAxisd(angle, Vec3(0.3, -0.8, 0.5).normalized()) * Quat::Identity();
    const auto touches = touchVessel(cube, Frame(q.toRotationMatrix(), start.x));
    fewest = std::min(fewest, touches.size());
    most = std::max(most, touches.size());
    const Vec3 force = totalForce(touches);
    // A corner moves by at most its radius times the angle; shares add a factor of a few.
    if (k > 0) {
      EXPECT_LT((force - last).norm(), 4 * 0.0024 * 0.5 / steps) << "step " << k;
    }
    last = force;
  }
  EXPECT_LT(fewest, most);
}

TEST(VesselWall, SpotsKeepTheirNamesUnderSmallRotations) {
  Random random(9);
  const Cuboid cube(Vec3(0.0015, 0.001, 0.002));
  for (int trial = 0; trial < 200; ++trial) {
    const Quat q = random.rotation();
    const Frame frame = pushOut(cube, q, random.uniform(0, 2 * pi), 1e-5);
    const auto before = touchVessel(cube, frame);
    const auto after =
        touchVessel(cube, Frame((rotationFromVector(1e-9 * random.direction()) * q).toRotationMatrix(), frame.x));
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t k = 0; k < before.size(); ++k) {
      EXPECT_EQ(before[k].spot, after[k].spot);
      EXPECT_LT((before[k].patch.point - after[k].patch.point).norm(), 1e-11);
    }
  }
}

TEST(VesselWall, ClearanceNeverExceedsTheDistance) {
  Random random(3);
  const auto wall = makeCylinderWall(axis, radius);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 centre = 0.03 * random.uniform() * random.direction();
    const double r = 0.01 * random.uniform();
    const Sphere ball(std::max(r, 1e-6));
    const double clearance = wall->clearance(centre, ball.radius());
    EXPECT_LE(clearance, radius - distanceFromAxis(centre) - ball.radius() + 1e-17);
    EXPECT_EQ(clearance < 0, !touchVessel(ball, Frame(Mat3::Identity(), centre)).empty());
    EXPECT_EQ(wall->admits(centre), distanceFromAxis(centre) < radius);
  }
}

TEST(VesselWall, RefusesARadiusThatIsNotPositive) {
  EXPECT_THROW(makeCylinderWall(axis, 0), InputError);
  EXPECT_THROW(makeCylinderWall(axis, -1), InputError);
  EXPECT_THROW(makeCylinderWall(axis, std::nan("")), InputError);
}

}  // namespace
}  // namespace granular
