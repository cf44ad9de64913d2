// Walls that move, against the same walls at rest seen from axes that move the other way, and against closed forms.
#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"
#include "granular/wall/wall.h"

namespace granular {
namespace {

WallPath tumble() {
  WallPath path;
  path.velocity = Vec3(0.1, -0.2, 0.3);
  path.amplitude = Vec3(0, 0, 1e-3);
  path.frequency = 50;
  path.phase = 0.4;
  path.axisPoint = Vec3(0.02, 0.01, 0);
  path.spin = Vec3(1, 2, -3);
  path.start = 0.01;
  return path;
}

TEST(MovingWall, WithoutMotionIsTheWallItself) {
  std::unique_ptr<Wall> plane = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  const Wall* address = plane.get();
  EXPECT_EQ(makeMovingWall(std::move(plane), WallPath{}, WallServo{}).get(), address);
}

TEST(MovingWall, TouchesLikeThePlaneThatLiesWhereItWent) {
  const WallPath path = tumble();
  const Cuboid cube(Vec3::Constant(2e-3));
  Random random(3);
  int touching = 0;
  for (int k = 0; k < 500; ++k) {
    const double time = random.uniform(0, 0.2);
    const auto wall = makeMovingWall(makePlaneWall(Vec3(0, 0, -0.01), Vec3(0, 0.6, 0.8)), path, {});
    wall->place(time);
    const Frame axes = path.placeAt(time);
    const auto there = makePlaneWall(axes.toWorld(Vec3(0, 0, -0.01)), axes.rotate(Vec3(0, 0.6, 0.8)));

    const Quat q = random.rotation();
    const Vec3 onPlane = axes.toWorld(Vec3(0, 0, -0.01)) + 2e-3 * random.direction();
    const Frame frame(q.toRotationMatrix(), onPlane);
    std::vector<WallTouch> got, expected;
    wall->touch({}, cube, frame, got);
    there->touch({}, cube, frame, expected);
    ASSERT_EQ(got.size(), expected.size());
    EXPECT_NEAR(wall->clearance(frame.x, 1e-3), there->clearance(frame.x, 1e-3), 1e-15);
    if (got.empty()) continue;
    ++touching;
    EXPECT_NEAR(got[0].overlap, expected[0].overlap, 1e-15);
    EXPECT_LT((got[0].normal - expected[0].normal).norm(), 1e-14);
    EXPECT_LT((got[0].patch.point - expected[0].patch.point).norm(), 1e-12);
    EXPECT_NEAR(got[0].patch.uu + got[0].patch.vv, expected[0].patch.uu + expected[0].patch.vv, 1e-15);
  }
  EXPECT_GT(touching, 200);
}

TEST(MovingWall, VelocityOfItsSurfaceIsTheDerivativeOfItsPlace) {
  const WallPath path = tumble();
  const double h = 1e-6;
  for (const double time : {0.02, 0.05, 0.11}) {
    const Vec3 body(0.03, -0.02, 0.01);  // a point that goes along
    const Vec3 there = path.placeAt(time).toWorld(body);
    const Vec3 derivative = (path.placeAt(time + h).toWorld(body) - path.placeAt(time - h).toWorld(body)) / (2 * h);
    // Central difference: h^2/6 of the third derivative, some (2 pi 50)^3 mm/s^3.
    EXPECT_LT((path.motionAt(time).velocityAt(there) - derivative).norm(), 1e-7);
  }
}

TEST(MovingWall, RestsBeforeItsStartAndAfterItsStop) {
  WallPath path = tumble();
  path.stop = 0.03;
  EXPECT_EQ(path.motionAt(0.005).velocity, Vec3::Zero());
  EXPECT_EQ(path.motionAt(0.03).spin, Vec3::Zero());
  const Frame end = path.placeAt(0.03), later = path.placeAt(7);
  EXPECT_EQ(end.x, later.x);
  EXPECT_EQ(end.R, later.R);
}

TEST(WallServo, MovesAtItsLimitWithoutContactsAndStopsAtItsForce) {
  const WallServo servo{Vec3::UnitX(), 2, 0.1, 1e-3};
  EXPECT_EQ(servo.speedFor(0, 0), 0.1);
  EXPECT_EQ(servo.speedFor(2, 1e4), 0);
  EXPECT_DOUBLE_EQ(servo.speedFor(1.5, 1e4), 0.5 / (1e-3 * 1e4));
  EXPECT_EQ(servo.speedFor(1e6, 1e4), -0.1);
}

}  // namespace
}  // namespace granular
