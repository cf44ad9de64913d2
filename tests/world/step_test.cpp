#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/shape_table.h"
#include "granular/shape/sphere.h"
#include "granular/world/contact_radius.h"
#include "granular/world/time_step.h"
#include "world/heap.h"

namespace granular {
namespace {

using testing::makeEmptyWorld;
using testing::run;
using testing::stateOf;

/// A loose heap of cubes and spheres above a floor, between four walls.
std::unique_ptr<World> makeHeap(const WorldOptions& options, int perSide) {
  auto world = makeEmptyWorld(options);
  const double pitch = 3.9e-3;
  testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  const std::int32_t cube = world->addShape(std::make_shared<Cuboid>(Vec3::Constant(1.2e-3)));
  const std::int32_t ball = world->addShape(std::make_shared<Sphere>(1.5e-3));
  testing::addLattice({ball, cube}, perSide, pitch, 0, *world);
  return world;
}

TEST(Step, FreeFallFollowsTheParabola) {
  auto world = makeEmptyWorld();
  const std::int32_t ball = world->addShape(std::make_shared<Sphere>(1e-3));
  NewBody body;
  body.shapeIndex = ball;
  body.pose.x = Vec3(0, 0, 1);
  body.velocity = Vec3(0.3, 0, 1);
  world->addBody(body);
  run(*world, 1e-3, 500);
  const double t = 0.5;
  // Leapfrog is exact for a constant acceleration: round-off of 500 additions of order 1.
  EXPECT_NEAR(world->bodies.x(0).x(), 0.3 * t, 500 * 1e-16);
  EXPECT_NEAR(world->bodies.x(0).z(), 1 + t - 0.5 * 9.81 * t * t, 500 * 2e-16);
  EXPECT_NEAR(world->bodies.v(0).z(), 1 - 9.81 * t, 500 * 1e-15);
}

TEST(Step, SameBitsForOneTwoAndFourThreads) {
  std::vector<std::vector<double>> states;
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    // Enough bodies and pairs for every stage to use its threads.
    auto world = makeHeap({}, 16);
    run(*world, 5e-6, 150);
    EXPECT_GT(world->report.contactSteps, 1000u);
    EXPECT_GE(world->bodies.movingSlots().size(), bodiesForThreads);
    EXPECT_GE(world->chunks.size(), chunksForThreads);
    states.push_back(stateOf(*world));
  }
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_EQ(std::memcmp(states[0].data(), states[1].data(), 8 * states[0].size()), 0);
  EXPECT_EQ(std::memcmp(states[0].data(), states[2].data(), 8 * states[0].size()), 0);
}

/// Every pair of bodies, looked at from nothing, against what the step found: the same pairs touch, equally deep.
/// Returns how many contacts were compared.
std::size_t compareWithFreshSearch(const World& world) {
  std::map<std::pair<std::int32_t, std::int32_t>, double> found;
  world.visitContacts([&](const Contact& contact) {
    if (contact.b >= 0) found[std::minmax(contact.a, contact.b)] = contact.touch.overlap;
  });
  const Bodies& bodies = world.bodies;
  const auto n = static_cast<std::int32_t>(bodies.size());
  std::size_t compared = 0;
  for (std::int32_t a = 0; a < n; ++a) {
    for (std::int32_t b = a + 1; b < n; ++b) {
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      const bool near = (bodies.x(i) - bodies.x(j)).norm() < bodies.boundingRadius(i) + bodies.boundingRadius(j);
      const auto known = found.find({a, b});
      WarmCache cache;
      NarrowCounts counts;
      Touch touch{Vec3::Zero(), 0, Vec3::Zero(), Vec3::Zero()};
      if (near)
        findTouch(*bodies.shape[i], bodies.frameOf(i), *bodies.shape[j], bodies.frameOf(j), true, cache, counts, touch);
      const double size = std::min(bodies.shape[i]->size(), bodies.shape[j]->size());
      // A pair within round-off of touching may be called either way: its force is nothing.
      const double overlap = known == found.end() ? 0 : known->second;
      EXPECT_NEAR(touch.overlap, overlap, 1e-9 * size) << a << " " << b;
      compared += known != found.end();
    }
  }
  return compared;
}

TEST(Step, SkippingFindsTheSameContactsAsSearchingEveryPairFromNothing) {
  auto world = makeHeap({}, 4);
  startHalfSteps(*world, 5e-6, 0, true);
  std::size_t compared = 0;
  for (int n = 0; n < 6000; ++n) {
    step(*world, 5e-6);
    if (n % 100 == 0) compared += compareWithFreshSearch(*world);
  }
  EXPECT_GT(compared, 100u);
  EXPECT_LT(world->search.refreshes, 600u);
  EXPECT_GT(world->report.narrow.warm, 10 * world->report.narrow.searches);
}

TEST(Step, TheBoxTreeAndBruteForceGiveTheSameBits) {
  WorldOptions plain;
  plain.bruteForce = true;
  auto reference = makeHeap(plain, 3);
  auto world = makeHeap({}, 3);
  run(*reference, 5e-6, 3000);
  run(*world, 5e-6, 3000);
  EXPECT_GT(world->report.contactSteps, 2000u);
  const auto a = stateOf(*reference), b = stateOf(*world);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), 8 * a.size()), 0);
}

TEST(Step, ContactsConserveMomentum) {
  WorldOptions options;
  options.gravity = Vec3::Zero();
  auto world = makeHeap(options, 4);
  world->walls.clear();
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < world->bodies.size(); ++i) sum += world->bodies.mass[i] * world->bodies.vHalf(i);
    return sum;
  };
  startHalfSteps(*world, 5e-6, 0, true);
  const Vec3 before = momentum();
  std::uint64_t contacts = 0;
  double flow = 0;
  for (std::size_t i = 0; i < world->bodies.size(); ++i) flow += world->bodies.mass[i] * world->bodies.vHalf(i).norm();
  for (int n = 0; n < 4000; ++n) {
    step(*world, 5e-6);
    contacts += world->contactCount();
  }
  EXPECT_GT(contacts, 1000u);
  EXPECT_LT((momentum() - before).norm(), 1e-12 * flow);
}

TEST(Step, ABedInAPeriodicBoxDoesNotKnowWhereTheBoxBegins) {
  const double width = 0.0126;
  std::vector<std::unique_ptr<World>> worlds;
  for (const double offset : {0.0, 0.4 * width}) {
    WorldOptions options;
    options.periods.length = Vec3(width, width, 0);
    options.periods.origin = Vec3(offset, -offset, 0);
    auto world = makeHeap(options, 3);
    world->walls.resize(1);  // the floor alone
    run(*world, 5e-6, 2500);
    EXPECT_GT(world->report.contactSteps, 500u);
    worlds.push_back(std::move(world));
  }
  const auto a = stateOf(*worlds[0]), b = stateOf(*worlds[1]);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), 8 * a.size()), 0);
}

TEST(TimeStep, DampedOscillatorIsStableBelowTheRangeAndNotAbove) {
  // Mirrors the scheme: leapfrog with the velocity predicted from the half step.
  const auto grows = [](double dtOmega, double zeta) {
    double x = 1, v = 0, a = -x * dtOmega * dtOmega;
    v += 0.5 * a;
    for (int n = 0; n < 20000; ++n) {
      x += v;
      a = -dtOmega * dtOmega * x - 2 * zeta * dtOmega * (v + 0.5 * a);
      v += a;
      if (std::abs(x) > 1e6) return true;
    }
    return false;
  };
  for (const double zeta : {0.0, 0.1, 0.6, 1.2}) {
    const double range = stableRange(zeta);
    EXPECT_FALSE(grows(0.99 * range, zeta)) << zeta;
    EXPECT_TRUE(grows(1.01 * range, zeta)) << zeta;
  }
  EXPECT_NEAR(stableRange(0), 2, 1e-15);
  EXPECT_NEAR(stableRange(0.6), 0.724, 1e-3);
}

TEST(TimeStep, BoundBeforeTheRunIsBelowThatOfTheContactsThatCome) {
  auto world = makeHeap({}, 4);
  std::vector<BodyKind> kinds;
  for (const auto& shape : world->shapes) kinds.push_back({shape.get(), 0, 2500});
  const TimeStepBound before = boundBeforeRun(kinds, world->materials, world->options);
  startHalfSteps(*world, 5e-6, 0, true);
  double smallest = infinity;
  for (int n = 0; n < 6000; ++n) {
    step(*world, 5e-6);
    if (n % 20 == 0) smallest = std::min(smallest, boundOfContacts(*world).bound);
  }
  EXPECT_LT(before.bound, smallest);
  EXPECT_GT(before.bound, 0.2 * smallest);
}

TEST(TimeStep, BoundOfTheContactsCountsThoseWhoMove) {
  auto world = makeHeap({}, 4);
  startHalfSteps(*world, 5e-6, 0, true);
  testing::run(*world, 5e-6, 6000);
  const double ofAll = boundOfContacts(*world).bound;
  std::size_t touching = 0;
  world->visitContacts([&](const Contact& contact) { touching = static_cast<std::size_t>(contact.a); });
  for (std::size_t i = 0; i < world->bodies.size(); ++i) world->bodies.hold(i, BodyState::asleep);
  EXPECT_EQ(boundOfContacts(*world).bound, infinity);
  world->bodies.release(touching);
  const double ofOne = boundOfContacts(*world).bound;
  EXPECT_LT(ofOne, infinity);
  EXPECT_GE(ofOne, ofAll);
}

/// A heap of balls and ellipsoids of Hertz's law, soft enough for long steps.
std::unique_ptr<World> makeElasticHeap(double young) {
  WorldOptions options;
  options.law = LawKind::hertzMindlin;
  options.rule.rule = PointRule::patch;
  MaterialTable materials;
  ContactParameters contact;
  contact.restitution = 0.5;
  contact.friction = 0.3;
  setElasticity({young, .2}, {young, .2}, contact);
  materials.add("rice", contact);
  auto world = std::make_unique<World>(options, std::move(materials));
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  world->walls.push_back(makeCylinderWall(Vec2::Zero(), 10e-3));
  const std::int32_t shapes[] = {world->addShape(makeShape("sphere", std::vector{1.2e-3})),
                                 world->addShape(makeShape("ellipsoid", std::vector{2.2e-3, 1e-3, 1e-3}))};
  Random random(4);
  for (int k = 0; k < 48; ++k) {
    NewBody body;
    body.shapeIndex = shapes[k % 2];
    const int column = k % 4 / 2, layer = k / 4;
    body.pose.x = 5e-3 * Vec3(column - .5, k % 2 - .5, 0) + Vec3(0, 0, 3e-3 + 5e-3 * layer);
    body.pose.q = random.rotation();
    body.density = 1300;
    world->addBody(body);
  }
  return world;
}

TEST(TimeStep, HertzsBoundAtTheDeepestOverlapIsBelowThatOfTheContactsThatCome) {
  auto world = makeElasticHeap(5e6);
  std::vector<BodyKind> kinds;
  for (const auto& shape : world->shapes) kinds.push_back({shape.get(), 0, 1300});
  const double dt = 5e-6;
  startHalfSteps(*world, dt, 0, true);
  double smallest = infinity;
  for (int n = 0; n < 20000; ++n) {
    step(*world, dt);
    if (n % 20 == 0) smallest = std::min(smallest, boundOfContacts(*world).bound);
  }
  world->options.expectedOverlap = world->report.deepestOverlap;
  const TimeStepBound before = boundBeforeRun(kinds, world->materials, world->options);
  // Eight contacts at once, all as deep as the deepest, never come.
  EXPECT_LT(before.bound, smallest);
  EXPECT_GT(before.bound, 0.1 * smallest);
  EXPECT_NE(before.explanation.find("overlap"), std::string::npos);
  // dF/d delta = 2 E* sqrt(R delta): four times the overlap, twice the stiffness, half the square of the step.
  world->options.expectedOverlap *= 4;
  EXPECT_NEAR(boundBeforeRun(kinds, world->materials, world->options).bound / before.bound, std::sqrt(.5), .1);
}

TEST(Law, RadiusOfAContactIsThatOfTheSumOfBothCurvatures) {
  // In a heap, against the invariants of the sum of the 3 x 3 matrices h P D^-2 P.
  auto world = makeElasticHeap(5e6);
  startHalfSteps(*world, 5e-6, 0, true);
  const auto curvature = [&](std::int32_t body, const Vec3& n) -> Mat3 {
    const Shape& shape = *world->bodies.shape[static_cast<std::size_t>(body)];
    const Mat3 plane = Mat3::Identity() - n * n.transpose();
    if (shape.kind() == ShapeKind::sphere) return plane / shape.size();
    const Frame& frame = world->bodies.frameOf(static_cast<std::size_t>(body));
    const Vec3 semi(2.2e-3, 1e-3, 1e-3), local = frame.unrotate(n);
    const Vec3 inverse = semi.cwiseProduct(semi).cwiseInverse();
    return semi.cwiseProduct(local).norm() * (plane * frame.R * inverse.asDiagonal() * frame.R.transpose() * plane);
  };
  int mixed = 0;
  const auto check = [&](const Contact& contact) {
    const Vec3& n = contact.touch.normal;
    Mat3 sum = curvature(contact.a, n);
    if (contact.b >= 0) {
      sum += curvature(contact.b, -n);
      ++mixed;
    } else if (contact.b == -2) {
      // The vessel is hollow across its axis.
      const Vec3 around = Vec3::UnitZ().cross(n).normalized();
      sum -= around * around.transpose() / 10e-3;
    }
    const double expected = 1 / std::sqrt(0.5 * (sum.trace() * sum.trace() - sum.squaredNorm()));
    EXPECT_NEAR(contactRadius(*world, contact), expected, 1e-9 * expected);
  };
  for (int n = 0; n < 12000; ++n) {
    step(*world, 5e-6);
    if (n % 50 == 0) world->visitContacts(check);
  }
  EXPECT_GT(mixed, 40);
}

TEST(Law, OfHertzNeedsElasticMaterialsAndARuleOfItsDepth) {
  WorldOptions options;
  options.law = LawKind::hertz;
  options.rule.rule = PointRule::patch;
  MaterialTable materials;
  materials.add("stone", ContactParameters{});
  EXPECT_THROW(World(options, materials), InputError);
  ContactParameters contact;
  setElasticity({1e9, .3}, {1e9, .3}, contact);
  MaterialTable elastic;
  elastic.add("stone", contact);
  EXPECT_NO_THROW(World(options, elastic));
  options.rule.rule = PointRule::foundation;
  EXPECT_THROW(World(options, elastic), InputError);
}

}  // namespace
}  // namespace granular
