// The energy ledger: closed forms, the order of its residual, and that keeping it changes nothing.
#include "granular/energy/ledger.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>
#include <functional>

#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/world/stages.h"
#include "granular/world/world.h"

namespace granular {
namespace {

constexpr double radius = 3e-3, density = 2500;

struct Scenario {
  ContactParameters contact{1e4, .8, .6, .3};
  WorldOptions options;
  bool floor = false;
};

std::unique_ptr<World> makeWorld(Scenario scenario) {
  scenario.options.energy = true;
  MaterialTable materials;
  materials.add("rock", scenario.contact);
  auto world = std::make_unique<World>(scenario.options, std::move(materials));
  if (scenario.floor) world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  return world;
}

void addBall(World& world, const Vec3& x, const Vec3& v, const Vec3& spin = Vec3::Zero()) {
  NewBody body;
  body.shapeIndex = world.addShape(std::make_shared<Sphere>(radius));
  body.density = density;
  body.pose.x = x;
  body.velocity = v;
  body.spin = spin;
  world.addBody(body);
}

void addCuboid(World& world, const Vec3& half, const Pose& pose, const Vec3& v, const Vec3& spin = Vec3::Zero()) {
  NewBody body;
  body.shapeIndex = world.addShape(std::make_shared<Cuboid>(half));
  body.density = density;
  body.pose = pose;
  body.velocity = v;
  body.spin = spin;
  world.addBody(body);
}

void run(World& world, double dt, double time) {
  startHalfSteps(world, dt, 0, true);
  const auto steps = static_cast<int>(std::lround(time / dt));
  for (int n = 0; n < steps; ++n) step(world, dt);
}

/// Root mean square of the relative residual over some phases of the first contact.
double meanResidual(double dt, const std::function<std::unique_ptr<World>(double phase)>& make, double time) {
  double sum = 0;
  const int phases = 16;
  for (int k = 0; k < phases; ++k) {
    auto world = make((k + .5) / phases);
    run(*world, dt, time);
    const double residual = world->ledger.relativeResidual();
    sum += residual * residual / phases;
  }
  return std::sqrt(sum);
}

TEST(Ledger, OfAFreeFallTurnsPotentialIntoKineticEnergyToRoundOff) {
  auto world = makeWorld({});
  addBall(*world, Vec3(0, 0, 1), Vec3(.1, 0, .2), Vec3(3, 4, 5));
  const double mass = world->bodies.mass[0], dt = 1e-5;
  const double start = .5 * mass * .05 + .5 * world->bodies.inertiaOf(0).x() * 50 + mass * 9.81;
  run(*world, dt, .1);
  const EnergyLedger& ledger = world->ledger;
  // t_{n+1/2}: half a step on.
  const double time = world->time + .5 * dt, fallen = .2 * time - .5 * 9.81 * time * time;
  EXPECT_NEAR(ledger.potential, mass * 9.81 * (1 + fallen), 1e-9 * start);
  EXPECT_NEAR(ledger.kinetic + ledger.potential, start, 1e-9 * start);
  EXPECT_NEAR(ledger.relativeResidual(), 0, 1e-11);
  EXPECT_EQ(ledger.dissipated(), 0);
}

std::unique_ptr<World> makeHeadOn(double e, double dt, double phase) {
  Scenario scenario;
  scenario.contact = {1e4, e, e, .3};
  scenario.options.gravity.setZero();
  auto world = makeWorld(scenario);
  const double gap = .3 * 2 * dt * phase;
  addBall(*world, Vec3(-radius - .5 * gap, 0, 0), Vec3(.3, 0, 0));
  addBall(*world, Vec3(radius + .5 * gap, 0, 0), Vec3(-.3, 0, 0));
  return world;
}

TEST(Ledger, OfAHeadOnCollisionHoldsTheClosedForms) {
  const double dt = 2e-6;
  for (const double e : {1.0, .8, .5}) {
    auto world = makeHeadOn(e, dt, .4);
    const double before = world->bodies.mass[0] * .09;
    run(*world, dt, 1.5e-3);
    const EnergyLedger& ledger = world->ledger;
    EXPECT_EQ(ledger.normalSprings, 0);
    EXPECT_NEAR(ledger.normalDashpots / before, 1 - e * e, 2e-3) << e;
    EXPECT_NEAR(ledger.kinetic / before, e * e, 2e-3);
    EXPECT_NEAR(ledger.friction + ledger.tangentialDashpots + ledger.parted, 0, 1e-12 * before);
    EXPECT_NEAR(ledger.rule / before, 0, 1e-9);
    // Beginning and end of the contact leave at most (w dt)^2/4 each.
    const double omega = std::sqrt(2 * 1e4 / world->bodies.mass[0]);
    EXPECT_NEAR(ledger.relativeResidual(), 0, .5 * omega * omega * dt * dt);
    // The identity: kinetic energy changes by the work of the contact force.
    EXPECT_NEAR((ledger.kinetic - before - ledger.contactWork) / before, 0, 1e-13);
  }
}

TEST(Ledger, OfACompressedContactIsExact) {
  // No contact begins or ends: the springs' part is the invariant of the leapfrog oscillator.
  Scenario scenario;
  scenario.contact = {1e4, 1, 1, .3};
  scenario.options.gravity.setZero();
  auto world = makeWorld(scenario);
  addBall(*world, Vec3(-radius + 4e-5, 0, 0), Vec3::Zero());
  addBall(*world, Vec3(radius - 4e-5, 0, 0), Vec3::Zero());
  startHalfSteps(*world, 1e-5, 0, true);
  double worst = 0;
  for (int n = 0; n < 8; ++n) {
    step(*world, 1e-5);
    worst = std::max(worst, std::abs(world->ledger.relativeResidual()));
  }
  EXPECT_GT(world->ledger.normalSprings, 0);
  EXPECT_LT(worst, 1e-12);
  EXPECT_NEAR(world->ledger.rule, 0, 1e-12 * world->ledger.peak);
}

/// Asserts that the residual falls at least as dt^1.7 over two halvings.
void expectSecondOrder(const std::function<std::unique_ptr<World>(double dt, double phase)>& make, double dt,
                       double time) {
  double residual[3];
  for (int k = 0; k < 3; ++k) {
    const double step = dt / (1 << k);
    residual[k] = meanResidual(
        step, [&](double phase) { return make(step, phase); }, time);
  }
  testing::Test::RecordProperty("residuals", std::to_string(residual[0] * 1e6) + " " +
                                                 std::to_string(residual[1] * 1e6) + " " +
                                                 std::to_string(residual[2] * 1e6) + " ppm");
  EXPECT_LT(residual[2], residual[0] / std::pow(4, 1.7)) << residual[0] << " " << residual[1] << " " << residual[2];
  EXPECT_LT(residual[0], 1e-2);
}

TEST(Ledger, OfAHeadOnCollisionHasAResidualOfSecondOrder) {
  for (const double e : {1.0, .5}) {
    expectSecondOrder([&](double dt, double phase) { return makeHeadOn(e, dt, phase); }, 2e-5, 2e-3);
  }
}

TEST(Ledger, OfAnObliqueImpactHasAResidualOfSecondOrder) {
  for (const LawKind law : {LawKind::linear, LawKind::tensor, LawKind::hertz, LawKind::hertzMindlin}) {
    for (const double speed : {.2, 1.0}) {
      expectSecondOrder(
          [&](double dt, double phase) {
            Scenario scenario;
            scenario.contact.dampingRateN = scenario.contact.dampingRateT = 200;
            setElasticity({1e7, .2}, {1e7, .2}, scenario.contact);
            scenario.floor = true;
            scenario.options.law = law;
            scenario.options.rule.rule = PointRule::witness;
            auto world = makeWorld(scenario);
            addBall(*world, Vec3(0, 0, radius + .3 * dt * phase), Vec3(speed, .1, -.3), Vec3(20, -10, 30));
            return world;
          },
          2e-5, 2e-3);
    }
  }
}

TEST(Ledger, OfASlidingBlockTurnsItsKineticEnergyIntoFrictionHeat) {
  Scenario scenario;
  scenario.floor = true;
  scenario.contact = {1e5, .5, .5, .3};
  auto world = makeWorld(scenario);
  const Vec3 half(8e-3, 8e-3, 1e-3);
  const double mass = 8 * half.prod() * density, dt = 5e-6;
  Pose pose;
  pose.x.z() = half.z() - mass * 9.81 / 1e5;
  addCuboid(*world, half, pose, Vec3(.1, 0, 0));
  const double before = .5 * mass * .01, stop = .1 / (.3 * 9.81);
  run(*world, dt, .9 * stop);
  const EnergyLedger& ledger = world->ledger;
  EXPECT_NEAR(ledger.friction / (.3 * mass * 9.81 * world->bodies.x(0).x()), 1, 1e-3);
  EXPECT_NEAR(ledger.relativeResidual(), 0, 1e-4);
  run(*world, dt, .3 * stop);
  EXPECT_NEAR((ledger.friction + ledger.tangentialDashpots + ledger.tangentialSprings) / before, 1, 2e-3);
  EXPECT_LT(ledger.kinetic / before, 1e-6);
  EXPECT_NEAR(ledger.relativeResidual(), 0, 1e-4);
}

TEST(Ledger, OfABeltCountsTheWorkOfTheWall) {
  // A block put on a moving belt: half of the belt's work becomes kinetic energy, half heat.
  Scenario scenario;
  scenario.floor = true;
  scenario.contact = {1e5, .5, .5, .3};
  auto world = makeWorld(scenario);
  world->walls[0]->motion.velocity = Vec3(.05, 0, 0);
  const Vec3 half(8e-3, 8e-3, 1e-3);
  const double mass = 8 * half.prod() * density;
  Pose pose;
  pose.x.z() = half.z() - mass * 9.81 / 1e5;
  addCuboid(*world, half, pose, Vec3::Zero());
  run(*world, 5e-6, 2 * .05 / (.3 * 9.81));
  const EnergyLedger& ledger = world->ledger;
  const double kinetic = .5 * mass * .0025;
  EXPECT_NEAR(ledger.wall / (2 * kinetic), 1, 1e-2);
  EXPECT_NEAR(ledger.kinetic / kinetic, 1, 1e-2);
  EXPECT_NEAR(ledger.relativeResidual(), 0, 1e-3);
}

std::unique_ptr<World> makeTumbling(double phase, LawKind law = LawKind::linear, PointRule rule = PointRule::patch) {
  Scenario scenario;
  scenario.floor = true;
  scenario.options.law = law;
  scenario.options.rule.rule = rule;
  auto world = makeWorld(scenario);
  Random random(3);
  Pose pose;
  pose.q = random.rotation();
  pose.x.z() = 6e-3 + 1e-5 * phase;
  addCuboid(*world, Vec3::Constant(1.5e-3), pose, Vec3(.2, .1, -.3), Vec3(30, -20, 10));
  pose.x += Vec3(1.5e-3, 0, 5e-3);
  pose.q = random.rotation();
  addCuboid(*world, Vec3(1e-3, 2e-3, 3e-3), pose, Vec3(0, .1, -.5), Vec3(-30, 20, 10));
  return world;
}

TEST(Ledger, OfTumblingCuboidsHasAResidualOfSecondOrder) {
  for (const PointRule rule : {PointRule::patch, PointRule::witness}) {
    expectSecondOrder([&](double, double phase) { return makeTumbling(phase, LawKind::linear, rule); }, 1e-5, .02);
  }
}

TEST(Ledger, FindsNoRuleWorkWhereTheForceHasAPotential) {
  // A cube that rocks on the floor, without loss: largest rule work over kinetic energy.
  const auto workOf = [](PointRule rule) {
    Scenario scenario;
    scenario.floor = true;
    scenario.contact = {1e4, 1, 1, 0};
    scenario.options.rule.rule = rule;
    auto world = makeWorld(scenario);
    Pose pose;
    pose.q = rotationFromVector(Vec3(.002, .001, 0));
    pose.x.z() = 1.5e-3;
    addCuboid(*world, Vec3::Constant(1.5e-3), pose, Vec3(0, 0, -.05));
    startHalfSteps(*world, 1e-6, 0, true);
    double worst = 0;
    for (int n = 0; n < 2000; ++n) {
      step(*world, 1e-6);
      worst = std::max(worst, std::abs(world->ledger.rule) / world->ledger.peak);
    }
    EXPECT_LT(std::abs(world->ledger.relativeResidual()), 1e-3);
    return worst;
  };
  const double foundation = workOf(PointRule::foundation), patch = workOf(PointRule::patch);
  RecordProperty("foundation", std::to_string(foundation));
  RecordProperty("patch", std::to_string(patch));
  EXPECT_LT(foundation, 1e-4);
  EXPECT_GT(patch, 1e-2);
}

TEST(Ledger, BooksWhatStaysInTheSpringsOfPartingContacts) {
  // e = e_t = 1 and no limit: the kinetic energy lost is what is left in the springs and what the rule worked.
  for (const LawKind law : {LawKind::linear, LawKind::linearLocal, LawKind::tensor}) {
    Scenario scenario;
    scenario.contact = {1e5, 1, 1, 1e9};
    scenario.options.law = law;
    scenario.options.gravity.setZero();
    scenario.options.rule.rule = PointRule::witness;
    auto world = makeWorld(scenario);
    Pose pose;
    pose.q = rotationFromVector(Vec3(.5, .3, .2));
    addCuboid(*world, Vec3::Constant(1.5e-3), pose, Vec3(.3, 0, 0));
    pose.x = Vec3(4.5e-3, .6e-3, .3e-3);
    pose.q = rotationFromVector(Vec3(-.2, .7, .4));
    addCuboid(*world, Vec3::Constant(1.5e-3), pose, Vec3(-.3, 0, 0));
    const double before = world->bodies.mass[0] * .09;
    run(*world, 2e-7, 6e-3);
    const EnergyLedger& ledger = world->ledger;
    ASSERT_EQ(world->contactCount(), 0u);
    // As above; the contact feels a third of the reduced mass or more.
    const double square = 3 * 2 * 1e5 / world->bodies.mass[0];
    EXPECT_NEAR((ledger.kinetic + ledger.parted - ledger.rule) / before, 1, .5 * square * 4e-14);
    EXPECT_LT(std::abs(ledger.rule) / before, 2e-2);
    if (law == LawKind::tensor) {
      EXPECT_LT(ledger.parted / before, 1e-3);
    }
    if (law == LawKind::linear) {
      EXPECT_GT(ledger.parted / before, 1e-2);
    }
    RecordProperty(std::string(lawName(law)),
                   std::to_string(ledger.parted / before) + " rule " + std::to_string(ledger.rule / before));
  }
}

std::vector<double> stateOf(const World& world) {
  std::vector<double> state;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      state.push_back(world.bodies.x(i)[k]);
      state.push_back(world.bodies.wHalfOf(i)[k]);
    }
  }
  return state;
}

/// Balls and cuboids that fall apart and onto each other in a box.
std::unique_ptr<World> makeHeap(WorldOptions options, bool energy, int perSide, const ContactParameters& contact = {}) {
  MaterialTable materials;
  materials.add("rock", contact);
  options.energy = energy;
  auto world = std::make_unique<World>(options, std::move(materials));
  const double pitch = 6.9e-3, width = pitch * perSide;
  world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  for (const Vec3& inwards : {Vec3(1, 0, 0), Vec3(0, 1, 0)}) {
    world->walls.push_back(makePlaneWall(Vec3::Zero(), inwards));
    world->walls.push_back(makePlaneWall(width * inwards, -inwards));
  }
  Random random(5);
  for (int k = 0; k < perSide * perSide * perSide; ++k) {
    Pose pose;
    const int row = k / perSide % perSide, layer = k / (perSide * perSide);
    pose.x = pitch * Vec3(k % perSide + .5, row + .5, layer + .56);
    pose.q = random.rotation();
    const Vec3 v(.2 * random.normal(), .2 * random.normal(), .2 * random.normal() - .3);
    if (k % 2) {
      addCuboid(*world, Vec3::Constant(2.2e-3), pose, v);
    } else {
      addBall(*world, pose.x, v);
    }
  }
  return world;
}

TEST(Ledger, ChangesNoBitOfTheMotionAndIsTheSameForAnyNumberOfThreads) {
  std::vector<std::vector<double>> states;
  std::vector<EnergyLedger> ledgers;
  for (const int threads : {1, 2, 4, 0}) {
    omp_set_num_threads(std::max(threads, 1));
    auto world = makeHeap({}, threads > 0, 12);
    run(*world, 5e-6, 4e-3);
    EXPECT_GT(world->report.contactSteps, 1000u);
    EXPECT_GE(world->chunks.size(), chunksForThreads);
    states.push_back(stateOf(*world));
    if (threads > 0) ledgers.push_back(world->ledger);
  }
  omp_set_num_threads(1);
  for (std::size_t k = 1; k < states.size(); ++k) {
    EXPECT_EQ(std::memcmp(states[0].data(), states[k].data(), 8 * states[0].size()), 0);
  }
  for (std::size_t k = 1; k < ledgers.size(); ++k) {
    const auto first = ledgers[0].entries(), other = ledgers[k].entries();
    for (std::size_t e = 0; e < first.size(); ++e) EXPECT_EQ(first[e].second, other[e].second) << first[e].first;
  }
}

TEST(Ledger, FollowsBodiesThatComeGoFreezeAndSleep) {
  WorldOptions options;
  options.sleep.on = true;
  options.sleep.energy = .1;
  options.sleep.time = 1e-3;
  options.sleep.balance = 1;
  auto world = makeHeap(options, true, 4, {1e4, .3, .3, .5});
  const double dt = 5e-6;
  run(*world, dt, .2);
  EXPECT_GT(world->sleep.fallen, 0u);
  const double scale = world->ledger.peak + world->ledger.dissipated();
  const double before = world->ledger.residual();
  EXPECT_LT(std::abs(before), 2e-3 * scale);

  // Take some out, freeze some, put one in.
  std::vector<bool> gone(world->bodies.size(), false);
  for (std::size_t i = 40; i < 50; ++i) gone[i] = true;
  world->removeBodies(gone);
  for (std::size_t i = 0; i < 9; ++i) world->bodies.hold(i, BodyState::frozen);
  world->search.invalidate();
  step(*world, dt);
  const std::size_t first = world->bodies.size();
  Pose pose;
  pose.x = Vec3(1e-2, 1e-2, .2);
  addCuboid(*world, Vec3::Constant(1e-3), pose, Vec3(0, 0, -1));
  startHalfSteps(*world, dt, first, false);
  for (int n = 0; n < 100; ++n) step(*world, dt);
  EXPECT_LT(std::abs(world->ledger.residual() - before), 2e-5 * scale);
  for (int n = 0; n < 10000; ++n) step(*world, dt);
  EXPECT_LT(std::abs(world->ledger.relativeResidual()), 2e-3);
}

}  // namespace
}  // namespace granular
