// Clumps in whole steps: a clump of one sphere is that sphere, a dumbbell's impact is the rigid body's, contacts are
// those of all children against all, and the bits don't depend on threads or on what is skipped.
#include "granular/shape/clump.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "granular/core/random.h"
#include "granular/narrow/clump_pair.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/world/time_step.h"
#include "world/heap.h"

namespace granular {
namespace {

using testing::isSameBits;
using testing::makeEmptyWorld;
using testing::run;
using testing::stateOf;

std::shared_ptr<const Clump> makeDumbbell(double radius, double distance) {
  return std::make_shared<Clump>(
      std::vector<ChildSphere>{{Vec3(-distance / 2, 0, 0), radius}, {Vec3(distance / 2, 0, 0), radius}});
}

/// A plate with a hole and a step: spheres on a crooked line, so that pairs lock into each other.
std::shared_ptr<const Clump> makeHook(double scale) {
  std::vector<ChildSphere> spheres;
  for (int k = 0; k < 7; ++k)
    spheres.push_back({scale * Vec3(0.5 * k, 0.15 * k * k * 0.5, 0.1 * (k % 3)), scale * (0.5 - 0.03 * k)});
  return std::make_shared<Clump>(spheres);
}

/// A triangulated table with a dent, wider than the heap.
TriangleMesh makeTable(double half) {
  TriangleMesh mesh;
  mesh.vertices = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}, {0, 0, -0.1 * half}};
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  return mesh;
}

/// Bodies of the given shapes in turn, falling together into a tube with a dented floor, or between planes.
std::unique_ptr<World> makeHeap(const WorldOptions& options, int perSide,
                                const std::vector<std::shared_ptr<const Shape>>& shapes, bool tube = false,
                                double pitch = 5.2e-3) {
  WorldOptions heavy = options;
  heavy.gravity = Vec3(0, 0, -100);  // so that they are together soon
  auto world = makeEmptyWorld(heavy);
  const double half = 0.5 * pitch * perSide;
  if (tube) {
    world->walls.push_back(makeCylinderWall(Vec2::Zero(), std::sqrt(2.0) * half));
    world->walls.push_back(makeMeshWall(makeTable(3 * half), "table"));
  } else {
    testing::addBoxOfPlanes(half, *world);
  }
  std::vector<std::int32_t> kinds;
  for (const auto& shape : shapes) kinds.push_back(world->addShape(shape));
  testing::addLattice(kinds, perSide, pitch, 50, *world);
  return world;
}

TEST(Clumps, OneSphereMovesAsTheSphereDoesToTheBit) {
  const auto sphere = std::make_shared<Sphere>(1.5e-3);
  const auto clump = std::make_shared<Clump>(std::vector<ChildSphere>{{Vec3(0.1, 0.2, 0.3), 1.5e-3}});
  for (const bool tube : {false, true}) {
    for (const PointRule rule : {PointRule::patch, PointRule::faceCentroid, PointRule::stiffPatch}) {
      WorldOptions options;
      options.rule.rule = rule;
      auto spheres = makeHeap(options, 4, {sphere}, tube);
      auto clumps = makeHeap(options, 4, {clump}, tube);
      auto mixed = makeHeap(options, 4, {clump, sphere, sphere}, tube);
      run(*spheres, 1e-5, 4000);
      run(*clumps, 1e-5, 4000);
      run(*mixed, 1e-5, 4000);
      EXPECT_GT(spheres->report.contactSteps, 10000u);
      EXPECT_TRUE(isSameBits(stateOf(*spheres), stateOf(*clumps)));
      EXPECT_TRUE(isSameBits(stateOf(*spheres), stateOf(*mixed)));
    }
  }
}

TEST(Clumps, OneSphereAllowsTheSpheresTimeStep) {
  auto world = makeEmptyWorld();
  const Sphere sphere(1.5e-3);
  const Clump clump(std::vector<ChildSphere>{{Vec3::Zero(), 1.5e-3}});
  EXPECT_EQ(boundBeforeRun({{&sphere, 0, 2500}}, world->materials, world->options).bound,
            boundBeforeRun({{&clump, 0, 2500}}, world->materials, world->options).bound);
  // Children that touch a flat neighbour together are as many contacts.
  const Clump row(std::vector<ChildSphere>{{Vec3(-1e-3, 0, 0), 1e-3}, {Vec3::Zero(), 1e-3}, {Vec3(1e-3, 0, 0), 1e-3}});
  const double bound = boundBeforeRun({{&row, 0, 2500}}, world->materials, world->options).bound;
  const double massRatio = row.massProperties().volume / sphere.massProperties().volume;
  EXPECT_LT(bound, std::sqrt(massRatio) * boundBeforeRun({{&sphere, 0, 2500}}, world->materials, world->options).bound);
}

/// A dumbbell that hits the floor with its lower sphere, elastic and without friction: velocity and spin afterwards
/// against the impulse of rigid bodies, J = 2 u/(1/m + (r x n)^2/I), u the speed of the point that hits.
double impactError(double stiffness) {
  ContactParameters contact;
  contact.stiffness = stiffness;
  contact.restitution = contact.restitutionT = 1;
  contact.friction = 0;
  WorldOptions options;
  options.gravity = Vec3::Zero();
  auto world = makeEmptyWorld(options, contact);
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  const double radius = 1e-3, distance = 1.4e-3, tilt = 0.6, speed = 0.2, spin = 30;
  const auto clump = makeDumbbell(radius, distance);
  NewBody body;
  body.shapeIndex = world->addShape(clump);
  body.pose.q = Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()));  // the sphere at +x is the lower one
  body.pose.x = Vec3(0, 0, radius + 0.5 * distance * std::sin(tilt) + 1e-9);
  body.velocity = Vec3(0, 0, -speed);
  body.spin = Vec3(0, spin, 0);
  world->addBody(body);

  const double m = world->bodies.mass[0], inertia = world->bodies.inertiaOf(0).y();
  const double arm = 0.5 * distance * std::cos(tilt);  // of the contact, along x
  const double hit = speed + spin * arm;               // downwards: (w x r)_z = -spin * arm
  const double impulse = 2 * hit / (1 / m + arm * arm / inertia);
  const double speedAfter = -speed + impulse / m, spinAfter = spin - arm * impulse / inertia;

  const double dt = 2e-3 * std::sqrt(m / stiffness);
  startHalfSteps(*world, dt, 0, true);
  bool touched = false;
  for (int n = 0; n < 20000; ++n) {
    step(*world, dt);
    const bool touches = world->contactCount() > 0;
    if (touched && !touches) break;
    touched = touched || touches;
  }
  EXPECT_TRUE(touched);
  const double v = world->bodies.v(0).z(), w = world->bodies.w(0).y();
  return std::abs(v - speedAfter) / speed + std::abs(w - spinAfter) / spin;
}

TEST(Clumps, ADumbbellsImpactTendsToTheRigidBodysAsItsContactStiffens) {
  // The contact's duration, and with it what the arm turns meanwhile, goes as 1/sqrt(k).
  const double soft = impactError(1e4), stiff = impactError(1e6), hard = impactError(1e8);
  EXPECT_LT(soft, 0.5);
  EXPECT_LT(stiff, 0.15 * soft);
  EXPECT_LT(hard, 0.15 * stiff);
  EXPECT_LT(hard, 5e-3);
}

/// All children of one against all of the other.
std::vector<ChildTouch> touchAllChildren(const ClumpPairView& pair) {
  const auto count = [](const Shape& s) { return asClump(s) ? static_cast<int>(asClump(s)->children().size()) : 0; };
  std::vector<ChildTouch> all;
  const int countA = count(pair.a), countB = count(pair.b);
  for (int i = countA ? 0 : -1; i < countA; ++i) {
    for (int j = countB ? 0 : -1; j < countB; ++j) {
      const PlacedChild a = placeChild(pair.a, pair.frameA, i), b = placeChild(pair.b, pair.frameB, j);
      WarmCache cache;
      NarrowCounts counts;
      Touch touch;
      if (findTouch(*a.shape, a.frame, *b.shape, b.frame, true, cache, counts, touch)) all.push_back({{i, j}, touch});
    }
    if (i == -1) break;
  }
  return all;
}

std::vector<std::shared_ptr<const Shape>> partners(Random& random) {
  std::vector<ChildSphere> rubble;
  for (int k = 0; k < 60; ++k) rubble.push_back({1e-3 * random.direction(), random.uniform(0.2e-3, 0.6e-3)});
  std::vector<Vec3> points;
  for (int k = 0; k < 20; ++k) points.push_back(1.5e-3 * random.direction());
  return {makeDumbbell(1e-3, 1.5e-3),
          makeHook(1e-3),
          std::make_shared<Clump>(rubble),
          std::make_shared<Sphere>(1e-3),
          std::make_shared<Cuboid>(Vec3(0.5e-3, 1e-3, 2e-3)),
          std::make_shared<Ellipsoid>(Vec3(2e-3, 1e-3, 0.7e-3)),
          std::make_shared<Polyhedron>(points)};
}

TEST(Clumps, ContactsAreThoseOfAllChildrenAgainstAll) {
  Random random(31);
  const auto shapes = partners(random);
  std::size_t contacts = 0, pairsOfSeveral = 0;
  for (std::size_t s = 0; s < 3; ++s) {
    for (std::size_t t = 0; t < shapes.size(); ++t) {
      for (int trial = 0; trial < 60; ++trial) {
        const double reach = shapes[s]->boundingRadius() + shapes[t]->boundingRadius();
        const Frame first(random.rotation().toRotationMatrix(), random.direction());
        const Frame second(random.rotation().toRotationMatrix(),
                           first.x + random.uniform(0.3, 1) * reach * random.direction());
        const ClumpPairView pair{*shapes[s], first, *shapes[t], second};
        const std::vector<ChildTouch> expected = touchAllChildren(pair);
        std::vector<ChildTouch> found;
        findTouches(pair, found);
        ASSERT_EQ(found.size(), expected.size());
        double deepest = 0;
        for (std::size_t k = 0; k < found.size(); ++k) {
          EXPECT_EQ(found[k].children.childA, expected[k].children.childA);
          EXPECT_EQ(found[k].children.childB, expected[k].children.childB);
          EXPECT_EQ(found[k].touch.overlap, expected[k].touch.overlap);
          deepest = std::max(deepest, found[k].touch.overlap);
        }
        double overlap = 0;
        EXPECT_EQ(overlaps(*shapes[s], first, *shapes[t], second, &overlap), !expected.empty());
        EXPECT_NEAR(overlap, deepest, 1e-9 * reach);
        contacts += found.size();
        pairsOfSeveral += found.size() > 1;
      }
    }
  }
  EXPECT_GT(contacts, 1000u);
  EXPECT_GT(pairsOfSeveral, 100u);
}

/// What the step found against all children of every pair, and against all walls, looked at from nothing.
std::size_t compareWithFreshLook(const World& world) {
  using Name = std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t>;
  std::map<Name, double> found, fresh;
  world.visitContacts([&](const Contact& c) {
    found[{c.a, c.b, c.spot.childA, c.spot.childB, c.b < 0 ? c.spot.number : 0}] = c.touch.overlap;
  });
  const Bodies& bodies = world.bodies;
  const auto n = static_cast<std::int32_t>(bodies.size());
  double size = infinity;
  std::vector<WallTouch> touches;
  for (std::int32_t a = 0; a < n; ++a) {
    const auto i = static_cast<std::size_t>(a);
    size = std::min(size, bodies.shape[i]->size());
    for (std::int32_t b = a + 1; b < n; ++b) {
      const auto j = static_cast<std::size_t>(b);
      if ((bodies.x(i) - bodies.x(j)).norm() > bodies.boundingRadius(i) + bodies.boundingRadius(j)) continue;
      for (const auto& [c, touch] :
           touchAllChildren({*bodies.shape[i], bodies.frame[i], *bodies.shape[j], bodies.frame[j]}))
        fresh[{a, b, c.childA, c.childB, 0}] = touch.overlap;
    }
    for (std::size_t w = 0; w < world.walls.size(); ++w) {
      touches.clear();
      touchWall(*world.walls[w], world.options.rule, *bodies.shape[i], bodies.frame[i], touches);
      for (const WallTouch& t : touches) fresh[{a, -1 - static_cast<std::int32_t>(w), t.child, -1, t.spot}] = t.overlap;
    }
  }
  // A contact within round-off of touching may be called either way.
  for (const auto& [name, overlap] : found) EXPECT_NEAR(overlap, fresh.contains(name) ? fresh[name] : 0, 1e-9 * size);
  for (const auto& [name, overlap] : fresh) EXPECT_NEAR(overlap, found.contains(name) ? found[name] : 0, 1e-9 * size);
  return found.size();
}

TEST(Clumps, SkippingFindsTheSameContactsAsLookingAtAllChildrenFromNothing) {
  Random random(37);
  const auto shapes = partners(random);
  for (const bool tube : {false, true}) {
    auto world = makeHeap({}, 3, shapes, tube);
    startHalfSteps(*world, 5e-6, 0, true);
    std::size_t compared = 0;
    for (int n = 0; n < 8000; ++n) {
      step(*world, 5e-6);
      if (n % 40 == 0) compared += compareWithFreshLook(*world);
    }
    EXPECT_GT(compared, 150u);
  }
}

TEST(Clumps, TheSeparationSkipAndTheBroadPhaseChangeNoBit) {
  const std::vector<std::shared_ptr<const Shape>> shapes{makeDumbbell(1e-3, 1.5e-3), makeHook(0.8e-3),
                                                         std::make_shared<Sphere>(1.5e-3)};
  auto plain = makeHeap({}, 3, shapes);
  WorldOptions every;
  every.skips.separation = false;
  auto looking = makeHeap(every, 3, shapes);
  WorldOptions brute;
  brute.bruteForce = true;
  auto searching = makeHeap(brute, 3, shapes);
  for (World* world : {plain.get(), looking.get(), searching.get()}) run(*world, 5e-6, 6000);
  EXPECT_TRUE(isSameBits(stateOf(*plain), stateOf(*looking)));
  EXPECT_TRUE(isSameBits(stateOf(*plain), stateOf(*searching)));
  EXPECT_LT(plain->report.narrow.warm, looking->report.narrow.warm / 2);
}

TEST(Clumps, SameBitsForOneTwoAndFourThreads) {
  std::vector<std::vector<double>> states;
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    auto world = makeHeap({}, 16, {makeDumbbell(1.2e-3, 1.6e-3), makeHook(0.7e-3)}, false, 3.7e-3);
    run(*world, 2e-6, 400);
    EXPECT_GT(world->report.contactSteps, 10000u);
    EXPECT_GE(world->chunks.size(), chunksForThreads);
    states.push_back(stateOf(*world));
  }
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_TRUE(isSameBits(states[0], states[1]));
  EXPECT_TRUE(isSameBits(states[0], states[2]));
}

/// Two hooks that collide in free space: how far linear and angular momentum are from those before, relative to those
/// of one body's flight.
double momentumError(double dt) {
  WorldOptions options;
  options.gravity = Vec3::Zero();
  auto world = makeEmptyWorld(options);
  NewBody body;
  body.shapeIndex = world->addShape(makeHook(1e-3));
  body.velocity = Vec3(0.2, 0, 0);
  body.spin = Vec3(10, -20, 30);
  world->addBody(body);
  body.pose.x = Vec3(5e-3, 0.3e-3, 0.2e-3);
  body.pose.q = Quat(0.5, 0.5, -0.5, 0.5);
  body.velocity = -body.velocity;
  world->addBody(body);
  const Bodies& bodies = world->bodies;
  const double m = bodies.mass[0];
  const auto spinOf = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < 2; ++i)
      sum += m * bodies.x(i).cross(bodies.v(i)) +
             bodies.frame[i].rotate(bodies.inertiaOf(i).cwiseProduct(bodies.frame[i].unrotate(bodies.w(i))));
    return sum;
  };
  const Vec3 before = spinOf();
  run(*world, dt, static_cast<int>(0.02 / dt));
  EXPECT_GT(world->report.contactSteps, 30u);
  EXPECT_LT((bodies.vHalf(0) + bodies.vHalf(1)).norm(), 1e-13);
  return (spinOf() - before).norm() / (m * 0.2 * 1e-3);
}

TEST(Clumps, KeepLinearMomentumExactlyAndAngularMomentumToSecondOrder) {
  const double coarse = momentumError(2e-6), fine = momentumError(1e-6);
  EXPECT_LT(coarse, 2e-5);
  EXPECT_LT(fine, 0.35 * coarse);
}

TEST(Clumps, FallAsleepHoldingAllTheirContactsAndWake) {
  WorldOptions options;
  options.sleep.on = true;
  options.sleep.time = 2e-3;
  options.sleep.balance = 0.3;
  auto world = makeHeap(options, 2, {makeDumbbell(1.2e-3, 1.6e-3)});
  run(*world, 1e-5, 40000);
  EXPECT_EQ(world->bodies.movingSlots().size(), 0u);
  const std::size_t held = world->contactCount();
  EXPECT_GT(held, 8u);
  wakeAll(*world);
  step(*world, 1e-5);
  EXPECT_EQ(world->contactCount(), held);
}

TEST(Locks, KeepABodyInItsPlaneAndTurnItAboutTheFreeAxisAlone) {
  WorldOptions options;
  auto world = makeEmptyWorld(options);
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3(0.2, 0.1, 1).normalized()));
  const auto hook = makeHook(1e-3);
  NewBody body;
  body.shapeIndex = world->addShape(hook);
  body.locks = lockTranslation(1) | lockRotation(0) | lockRotation(2);
  body.pose.x = Vec3(0, 7e-3, 5e-3);
  body.pose.q = Quat(0.3, 0.5, -0.4, 0.7).normalized();
  body.velocity = Vec3(0.1, 3, 0);
  body.spin = Vec3(5, 20, -5);
  world->addBody(body);
  const Mat3 before = world->bodies.frame[0].R;
  run(*world, 5e-6, 60000);
  EXPECT_GT(world->report.contactSteps, 100u);
  const Bodies& bodies = world->bodies;
  EXPECT_EQ(bodies.x(0).y(), 7e-3);
  EXPECT_LT(std::abs(bodies.w(0).x()) + std::abs(bodies.w(0).z()), 1e-10);
  // Turned about y: what lay along y still does.
  EXPECT_LT((bodies.frame[0].R.transpose() * Vec3::UnitY() - before.transpose() * Vec3::UnitY()).norm(), 1e-9);
}

TEST(Locks, APhysicalPendulumAboutALockedAxisHasItsAngularAcceleration) {
  // Locked but for rotation about y; a force off the centre turns it with T_y / I_yy about the world's y axis.
  auto world = makeEmptyWorld();
  NewBody body;
  body.shapeIndex = world->addShape(std::make_shared<Cuboid>(Vec3(1e-3, 2e-3, 3e-3)));
  body.locks = lockRotation(0) | lockRotation(2);
  body.pose.q = Quat(0.3, 0.5, -0.4, 0.7).normalized();
  world->addBody(body);
  Bodies& bodies = world->bodies;
  const Vec3 torque(1e-6, 2e-6, 3e-6);
  bodies.torque[0] = torque;
  applyLocks(0, bodies);
  const Mat3 inertia = bodies.frame[0].R * bodies.inertiaOf(0).asDiagonal() * bodies.frame[0].R.transpose();
  const Vec3 alpha = inertia.inverse() * bodies.torque[0];
  EXPECT_NEAR(alpha.y(), torque.y() / inertia(1, 1), 1e-12 * std::abs(alpha.y()));
  EXPECT_LT(std::hypot(alpha.x(), alpha.z()), 1e-12 * std::abs(alpha.y()));
}

TEST(Locks, KeepTheTorqueInFreeDirectionsAndSpinUpNoOthers) {
  Random random(9);
  for (int n = 0; n < 200; ++n) {
    auto world = makeEmptyWorld();
    NewBody body;
    body.shapeIndex = world->addShape(std::make_shared<Cuboid>(Vec3(1e-3, 2e-3, 3e-3)));
    body.locks = static_cast<Locks>(8 * (1 + n % 7));  // every set of rotations
    body.pose.q = random.rotation();
    body.spin = 30 * random.direction();
    world->addBody(body);
    Bodies& bodies = world->bodies;
    const Vec3 torque = 1e-6 * random.direction();
    bodies.torque[0] = torque;
    applyLocks(0, bodies);
    const Mat3 inertia = bodies.frame[0].R * bodies.inertiaOf(0).asDiagonal() * bodies.frame[0].R.transpose();
    const Vec3 gyroscopic = bodies.w(0).cross(inertia * bodies.w(0));
    const Vec3 alpha = inertia.inverse() * (bodies.torque[0] - gyroscopic);
    const double large = (inertia.inverse() * (torque + gyroscopic)).norm();
    for (int axis = 0; axis < 3; ++axis) {
      if (body.locks & lockRotation(axis))
        EXPECT_LT(std::abs(alpha[axis]), 1e-12 * large);
      else
        EXPECT_NEAR(bodies.torque[0][axis], torque[axis], 1e-13 * (torque + gyroscopic).norm());
    }
  }
}

}  // namespace
}  // namespace granular
