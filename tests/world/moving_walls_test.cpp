// Bodies that moving walls carry, shake, press and wake, against closed forms.
#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"
#include "granular/world/world.h"

namespace granular {
namespace {

constexpr double half = 1.5e-3, density = 2500, gravity = 9.81, friction = 0.3, stiffness = 1e4, dt = 5e-6;
constexpr double mass = density * 8 * half * half * half;

std::unique_ptr<World> makeWorldOfCubes(double weight = gravity) {
  WorldOptions options;
  options.gravity = Vec3(0, 0, -weight);
  MaterialTable materials;
  ContactParameters parameters;
  parameters.stiffness = stiffness;
  parameters.restitution = 0.5;
  parameters.restitutionT = 0.6;
  parameters.friction = friction;
  materials.add("rock", parameters);
  auto world = std::make_unique<World>(options, std::move(materials));
  world->addShape(std::make_shared<Cuboid>(Vec3::Constant(half)));
  return world;
}

void addCube(World& world, const Vec3& x, const Vec3& velocity = Vec3::Zero(), const Quat& q = Quat::Identity()) {
  NewBody body;
  body.density = density;
  body.pose.x = x;
  body.pose.q = q;
  body.velocity = velocity;
  world.addBody(body);
}

void addFloor(World& world, const WallPath& path, const WallServo& servo = {}, const Vec3& point = Vec3::Zero(),
              const Vec3& normal = Vec3::UnitZ()) {
  world.walls.push_back(makeMovingWall(makePlaneWall(point, normal), path, servo));
}

void runTo(World& world, double time) {
  if (world.steps == 0) startHalfSteps(world, dt, 0, true);
  while (world.time < time) step(world, dt);
}

/// A cube that rests on the floor: its overlap carries its weight.
const Vec3 resting(0, 0, half - mass * gravity / stiffness);

TEST(MovingWalls, ThatDriftWithTheBodiesChangeNothing) {
  const Vec3 drift(0.2, -0.1, 0.05);
  WallPath path;
  path.velocity = drift;
  auto still = makeWorldOfCubes(), moving = makeWorldOfCubes();
  addFloor(*still, {});
  addFloor(*moving, path);
  Random random(8);
  for (int k = 0; k < 4; ++k) {
    const Vec3 x((k - 1.5) * 3 * half, 0, 1.2 * half * std::sqrt(3.0));
    const Quat q = random.rotation();
    addCube(*still, x, Vec3(0.1, 0, -0.2), q);
    addCube(*moving, x, Vec3(0.1, 0, -0.2) + drift, q);
  }
  runTo(*still, 0.02);
  runTo(*moving, 0.02);
  EXPECT_GT(moving->report.contactSteps, 500u);
  for (std::size_t i = 0; i < 4; ++i) {
    // Round-off alone: 1e-17 m a step, which a tumbling cube multiplies at each impact.
    EXPECT_LT((moving->bodies.x(i) - drift * moving->time - still->bodies.x(i)).norm(), 1e-11);
    EXPECT_LT(moving->bodies.orientation(i).angularDistance(still->bodies.orientation(i)), 1e-8);
  }
}

TEST(MovingWalls, DragAPlateWithCoulombsForceUntilItGoesAlong) {
  WallPath path;
  path.velocity = Vec3(0.1, 0, 0);
  auto world = makeWorldOfCubes();
  addFloor(*world, path);
  // Flat, so that friction below its centre does not make it hop.
  NewBody plate;
  plate.shapeIndex = world->addShape(std::make_shared<Cuboid>(Vec3(half, half, 0.05 * half)));
  plate.density = density;
  plate.pose.x = Vec3(0, 0, 0.05 * (half - mass * gravity / stiffness));
  world->addBody(plate);
  runTo(*world, 0.02);
  // Full friction but for the time in which the spring winds up: its stretch mu m g/k_t over the speed, below 0.1 ms.
  EXPECT_NEAR(world->bodies.v(0).x(), friction * gravity * world->time, friction * gravity * 1e-4);
  runTo(*world, 0.1);
  EXPECT_NEAR(world->bodies.v(0).x(), 0.1, 1e-6);
}

TEST(MovingWalls, ShakeACubeThatStaysOnTheFloor) {
  WallPath path;
  path.amplitude = Vec3(0, 0, 2e-4);
  path.frequency = 20;
  auto world = makeWorldOfCubes();
  addFloor(*world, path);
  // It starts with the floor's velocity.
  addCube(*world, resting, path.motionAt(0).velocity);
  startHalfSteps(*world, dt, 0, true);
  const double omega = 2 * pi * path.frequency, peak = omega * omega * 2e-4;
  ASSERT_LT(peak, gravity);
  while (world->time < 0.1) {
    step(*world, dt);
    const double floor = path.placeAt(world->time).x.z();
    // The overlap carries m (g + a), and rings no more than the floor's jerk makes it in a contact time.
    const double overlap = half - (world->bodies.x(0).z() - floor);
    EXPECT_NEAR(overlap, mass * (gravity - omega * omega * floor) / stiffness, 0.02 * mass * gravity / stiffness);
  }
}

TEST(MovingWalls, AServoPressesACubeWithItsForce) {
  auto world = makeWorldOfCubes(0);
  addFloor(*world, {});
  addFloor(*world, {}, {-Vec3::UnitZ(), 0.05, 0.2, 1e-3}, Vec3(0, 0, 2.1 * half), -Vec3::UnitZ());
  addCube(*world, Vec3(0, 0, half));
  runTo(*world, 0.05);
  EXPECT_NEAR(-world->wallForces[0].z(), 0.05, 1e-6);
  EXPECT_NEAR(world->wallForces[1].z(), 0.05, 1e-6);
  EXPECT_NEAR(world->walls[1]->servoWay, 0.1 * half + 2 * 0.05 / stiffness, 1e-8);
}

TEST(MovingWalls, WakeWhomTheyMeet) {
  auto world = makeWorldOfCubes();
  world->options.sleep.on = true;
  WallPath path;
  path.velocity = Vec3(0.05, 0, 0);
  path.start = 0.05;
  addFloor(*world, {});
  addFloor(*world, path, {}, Vec3(-1.5 * half, 0, 0), Vec3::UnitX());
  addCube(*world, resting);
  runTo(*world, 0.049);
  ASSERT_EQ(world->bodies.state[0], BodyState::asleep);
  runTo(*world, 0.15);
  EXPECT_EQ(world->bodies.state[0], BodyState::moving);
  // The wall's way less the gap, and the overlap with which it pushes against friction.
  const double push = friction * mass * gravity / stiffness;
  EXPECT_NEAR(world->bodies.x(0).x(), 0.05 * 0.1 - 0.5 * half - push, 2e-6);
}

TEST(MovingWalls, TurnACubeOnATurntable) {
  WallPath path;
  path.spin = Vec3(0, 0, 5);
  auto world = makeWorldOfCubes();
  addFloor(*world, path);
  const double radius = 5e-3;  // 5^2 * 5 mm is below mu g
  addCube(*world, resting + radius * Vec3::UnitX(), Vec3(0, 5 * radius, 0));
  world->bodies.w(0) = Vec3(0, 0, 5);
  runTo(*world, 0.3);
  const Vec3 there = path.placeAt(world->time).toWorld(radius * Vec3::UnitX());
  // It creeps by the stretch of its friction spring as that force turns round.
  EXPECT_LT((world->bodies.x(0).head<2>() - there.head<2>()).norm(), 1e-6);
  EXPECT_NEAR(world->bodies.w(0).z(), 5, 1e-3);
}

}  // namespace
}  // namespace granular
