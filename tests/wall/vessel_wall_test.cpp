#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <gtest/gtest.h>

#include <map>

#include "granular/core/errors.h"
#include "granular/shape/bullet_convex.h"
#include "wall/wall_samples.h"

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

TEST(VesselWall, RoundBodiesTouchWhereTheyReachFurthest) {
  // The largest overlap against a dense sampling, and every spot a stationary point of the distance on the surface.
  Random random(15);
  for (const auto& body : sample::bodies()) {
    const TriangleMesh surface = body->surface(400);
    for (int trial = 0; trial < 60; ++trial) {
      const Frame frame = pushOut(*body, random.rotation(), random.uniform(0, 2 * pi), 1e-5);
      const auto touches = touchVessel(*body, frame);
      ASSERT_FALSE(touches.empty());
      expectSound(touches);
      double sampled = 0, largest = 0;
      for (const Vec3& p : surface.vertices) sampled = std::max(sampled, distanceFromAxis(frame.toWorld(p)) - radius);
      for (const WallTouch& touch : touches) {
        largest = std::max(largest, touch.overlap);
        // The body's support along the normal is the touching point, unless a longer vertex lies elsewhere.
        const Vec3 p = touch.patch.point + 0.5 * touch.overlap * touch.normal;
        EXPECT_TRUE(body->contains(frame.toBody(p - 1e-9 * (p - frame.x)))) << body->describe();
      }
      EXPECT_GE(largest, sampled - 1e-15) << body->describe();
      EXPECT_LT(largest, sampled + 1e-6) << body->describe();
    }
  }
}

TEST(VesselWall, LongEllipsoidLyingAlongTheWallTouchesAtBothEnds) {
  // a^2/b = 16 mm > R = 10 mm: two points, where sin t = c b / (a^2 - b^2).
  const double a = 0.004, b = 0.001, R = 0.01;
  const Ellipsoid egg(Vec3(a, b, b));
  const auto touchAt = [&](double c) {
    return touchVessel(egg, Frame(Mat3::Identity(), Vec3(axis.x(), axis.y() + c, 0)), R);
  };
  const double c = 0.00905, sine = c * b / (a * a - b * b);
  const auto touches = touchAt(c);
  ASSERT_EQ(touches.size(), 2u);
  const double x = a * std::sqrt(1 - sine * sine), y = c + b * sine;
  EXPECT_NEAR(touches[0].overlap, std::hypot(x, y) - R, 1e-16);
  EXPECT_NEAR(touches[1].overlap, touches[0].overlap, 1e-16);
  EXPECT_EQ(touches[0].spot, 1);
  EXPECT_EQ(touches[1].spot, 2);
  EXPECT_GT(touches[0].normal.x(), 0);
  EXPECT_NEAR(touches[0].share, 1 / (1 + touches[0].normal.dot(touches[1].normal)), 1e-12);
  // In a vessel wider than its flattest curvature it touches once.
  EXPECT_EQ(touchVessel(egg, Frame(Mat3::Identity(), Vec3(axis.x(), axis.y() + 0.016 + 1e-5, 0)), 0.017).size(), 1u);
}

TEST(VesselWall, ForceOfARollingEllipsoidIsContinuousFromOneSpotToTwo) {
  // Turned about the radius, a long ellipsoid passes from one touching point (upright) to two (lying).
  const Ellipsoid egg(Vec3(0.001, 0.001, 0.004));
  const double R = 0.01;
  std::vector<WallTouch> touches;
  const auto wall = makeCylinderWall(axis, R);
  Vec3 last = Vec3::Zero();
  std::size_t most = 0;
  const int steps = 30000;
  for (int k = 0; k <= steps; ++k) {
    const double angle = pi * k / steps;
    const Mat3 turn =
        (Eigen::AngleAxisd(angle, Vec3(1, 0.0005, 0.001).normalized()) * Quat::Identity()).toRotationMatrix();
    touches.clear();
    wall->touch(RuleOptions{}, egg, Frame(turn, Vec3(axis.x() + R - 0.001 + 2e-5, axis.y(), 0)), touches);
    most = std::max(most, touches.size());
    const Vec3 force = totalForce(touches);
    if (k > 0) {
      EXPECT_LT((force - last).norm(), 3 * 0.004 * pi / steps) << angle;
    }
    last = force;
  }
  EXPECT_EQ(most, 2u);
}

TEST(VesselWall, CylindersTouchWithTheirRims) {
  const Cylinder cylinder(0.0015, 0.004);
  const double c = radius + 1e-6;
  // Upright: one azimuth, top and bottom.
  auto touches = touchVessel(cylinder, Frame(Mat3::Identity(), Vec3(axis.x() + c - 0.0015, axis.y(), 0)));
  ASSERT_EQ(touches.size(), 2u);
  expectSound(touches);
  for (const WallTouch& touch : touches) {
    EXPECT_NEAR(touch.overlap, 1e-6, 1e-16);
    EXPECT_NEAR(touch.share, 0.5, 1e-12);
  }
  EXPECT_NEAR(touches[0].patch.point.z(), -0.002, 1e-15);
  EXPECT_NEAR(touches[1].patch.point.z(), 0.002, 1e-15);
  // Lying with a cap towards the wall: the two ends of the level diameter of that cap.
  const Mat3 radial = Eigen::AngleAxisd(pi / 2, Vec3::UnitY()).toRotationMatrix();
  touches =
      touchVessel(cylinder, Frame(radial, Vec3(axis.x() + std::sqrt(c * c - 0.0015 * 0.0015) - 0.002, axis.y(), 0)));
  ASSERT_EQ(touches.size(), 2u);
  for (const WallTouch& touch : touches) EXPECT_NEAR(touch.overlap, 1e-6, 1e-15);
  EXPECT_NEAR((touches[0].patch.point - touches[1].patch.point).norm(), 0.003, 1e-6);
  // Lying along the wall: each cap with the outer end of its level diameter.
  const Mat3 tangential = Eigen::AngleAxisd(pi / 2, Vec3::UnitX()).toRotationMatrix();
  const double reach = std::sqrt(c * c - 0.002 * 0.002);
  touches = touchVessel(cylinder, Frame(tangential, Vec3(axis.x() + reach - 0.0015, axis.y(), 0)));
  ASSERT_EQ(touches.size(), 2u);
  for (const WallTouch& touch : touches) EXPECT_NEAR(touch.overlap, 1e-6, 1e-15);
  EXPECT_NEAR((touches[0].patch.point - touches[1].patch.point).norm(), 0.004, 1e-6);
}

TEST(VesselWall, ConesTouchWithApexAndRim) {
  const Cone cone(0.0015, 0.003);
  const Mat3 outwards = Eigen::AngleAxisd(pi / 2, Vec3::UnitY()).toRotationMatrix();
  const auto touches = touchVessel(cone, Frame(outwards, Vec3(axis.x() + radius + 1e-6 - cone.apexZ(), axis.y(), 0)));
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_EQ(touches[0].spot, 0);
  EXPECT_NEAR(touches[0].overlap, 1e-6, 1e-16);
}

TEST(VesselWall, ShapesKnownByTheirSupportAloneTouchLikeTheirKernels) {
  // A box of Bullet's against the cuboid.
  const auto shape = std::make_shared<btBoxShape>(btVector3(1.5, 1, 2));
  shape->setMargin(0);
  Frame principal;
  const BulletConvex box(shape, 1e-3, &principal);
  const Cuboid cuboid(Vec3(0.0015, 0.001, 0.002));
  Random random(21);
  for (int trial = 0; trial < 100; ++trial) {
    const Quat q = random.rotation();
    const Frame frame = pushOut(cuboid, q, random.uniform(0, 2 * pi), 1e-5);
    const auto expected = touchVessel(cuboid, frame);
    const auto got = touchVessel(box, Frame(frame.R * principal.R, frame.toWorld(principal.x)));
    expectSound(got);
    // It sees the local maxima alone: every spot is one of the corners, the deepest among them.
    ASSERT_FALSE(got.empty());
    double deepest = 0, found = 0;
    for (const WallTouch& touch : expected) deepest = std::max(deepest, touch.overlap);
    for (const WallTouch& touch : got) {
      found = std::max(found, touch.overlap);
      const bool known = std::any_of(expected.begin(), expected.end(), [&](const WallTouch& t) {
        return (t.patch.point - touch.patch.point).norm() < 1e-9;
      });
      EXPECT_TRUE(known);
    }
    EXPECT_NEAR(found, deepest, 1e-12);
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
