// The law of examples/extend/cohesive_law.h against the closed forms of an oscillator with a constant pull.
#include "examples/extend/cohesive_law.h"

#include <gtest/gtest.h>

#include "extend/scene_of_own.h"
#include "granular/core/errors.h"
#include "granular/shape/sphere.h"
#include "granular/world/world.h"

namespace granular {
namespace {

const LawKind cohesive = extend::addCohesiveLaw();

constexpr double radius = 1e-3, density = 2500, stiffness = 1e3;
const double mass = density * 4.0 / 3 * pi * radius * radius * radius;

/// A ball under a ceiling at z = 0, which it touches with an overlap (m).
std::unique_ptr<World> hangBall(double pull, double restitution, const Vec3& gravity, double overlap, double speed) {
  ContactParameters contact;
  contact.stiffness = stiffness;
  contact.restitution = restitution;
  contact.own[0] = pull;
  MaterialTable materials;
  materials.add("clay", contact);
  WorldOptions options;
  options.law = cohesive;
  options.gravity = gravity;
  options.energy = true;
  auto world = std::make_unique<World>(options, std::move(materials));
  world->walls.push_back(makePlaneWall(Vec3::Zero(), -Vec3::UnitZ()));
  NewBody body;
  body.shapeIndex = world->addShape(std::make_shared<Sphere>(radius));
  body.density = density;
  body.pose.x = Vec3(0, 0, overlap - radius);
  body.velocity = Vec3(0, 0, speed);
  world->addBody(body);
  return world;
}

void run(World& world, double dt, double time) {
  startHalfSteps(world, dt, 0, true);
  for (auto n = std::lround(time / dt); n > 0; --n) step(world, dt);
}

/// m x'' = -k x - eta x' + F from x = 0 with speed u: overlap and its rate after a time.
struct PulledOscillator {
  double omega = std::sqrt(stiffness / mass), zeta, rest, speed;

  PulledOscillator(double restitution, double pull, double speed)
      : zeta(dampingRatioFor(restitution, true)), rest(pull / stiffness), speed(speed) {}
  std::pair<double, double> after(double t) const {
    const double rate = omega * std::sqrt(1 - zeta * zeta), decay = std::exp(-zeta * omega * t);
    const double a = -rest, b = (speed - zeta * omega * rest) / rate;
    const double c = std::cos(rate * t), s = std::sin(rate * t);
    return {rest + decay * (a * c + b * s),
            decay * ((b * rate - zeta * omega * a) * c - (a * rate + zeta * omega * b) * s)};
  }
  /// When it turns: the deepest overlap, and a period later; m/s go through 0 there.
  double turn(double from, double to) const {
    const bool rises = after(from).second < 0;
    for (int n = 0; n < 200; ++n) {
      const double middle = 0.5 * (from + to);
      ((after(middle).second < 0) == rises ? from : to) = middle;
    }
    return from;
  }
  /// The restitution: 0 if it never comes back to x = 0.
  double restitution() const {
    const double half = pi / (omega * std::sqrt(1 - zeta * zeta));
    const double deepest = turn(0, half + 1e-9 * half), back = turn(deepest + 1e-9 * half, deepest + 1.5 * half);
    if (after(back).first > 0) return 0;
    double from = deepest, to = back;
    for (int n = 0; n < 200; ++n) {
      const double middle = 0.5 * (from + to);
      (after(middle).first > 0 ? from : to) = middle;
    }
    return -after(from).second / speed;
  }
};

TEST(CohesiveLaw, HoldsABallUnderACeilingUntilItWeighsMoreThanThePull) {
  const Vec3 gravity(0, 0, -9.81);
  const double weight = mass * 9.81, dt = 2e-6;
  for (const double pull : {1.01 * weight, 3 * weight}) {
    const double rest = (pull - weight) / stiffness;
    auto world = hangBall(pull, 0.5, gravity, 0.9 * rest, 0);
    run(*world, dt, 0.1);
    EXPECT_NEAR(world->bodies.x(0).z() + radius, rest, 1e-6 * rest) << pull / weight;
  }
  auto world = hangBall(0.99 * weight, 0.5, gravity, 1e-12, 0);
  run(*world, dt, 0.1);
  EXPECT_LT(world->bodies.x(0).z(), -10 * radius);
}

TEST(CohesiveLaw, HasTheRestitutionOfADampedOscillatorWithAConstantPull) {
  const double pull = 0.002, dt = 2e-7;
  for (const double restitution : {1.0, 0.8, 0.5}) {
    for (const double speed : {0.1, 0.5}) {
      const double expected = PulledOscillator(restitution, pull, speed).restitution();
      ASSERT_GT(expected, 0.05);
      auto world = hangBall(pull, restitution, Vec3::Zero(), -0.5 * speed * dt, speed);
      run(*world, dt, 4e-3);
      EXPECT_EQ(world->contactCount(), 0u);
      EXPECT_NEAR(-world->bodies.v(0).z() / speed, expected, 2e-3) << restitution << ' ' << speed;
    }
  }
  EXPECT_NEAR(PulledOscillator(0.8, 0, 0.3).restitution(), 0.8, 1e-9);
}

TEST(CohesiveLaw, CatchesWhatComesTooSlowly) {
  // Between these two speeds the closed form changes from sticking to leaving.
  const double pull = 0.002, restitution = 0.5, dt = 2e-7;
  double slow = 1e-3, fast = 0.5;
  for (int n = 0; n < 60; ++n) {
    const double middle = 0.5 * (slow + fast);
    (PulledOscillator(restitution, pull, middle).restitution() == 0 ? slow : fast) = middle;
  }
  ASSERT_LT(slow, 0.4);
  for (const double speed : {0.97 * slow, 1.03 * slow}) {
    auto world = hangBall(pull, restitution, Vec3::Zero(), -0.5 * speed * dt, speed);
    run(*world, dt, 2e-2);
    EXPECT_EQ(world->contactCount(), speed < slow ? 1u : 0u) << speed / slow;
    if (speed > slow) continue;
    EXPECT_NEAR(world->bodies.x(0).z() + radius, pull / stiffness, 1e-3 * pull / stiffness);
  }
}

TEST(CohesiveLaw, ClosesTheEnergyLedger) {
  const double dt = 2e-7;
  auto world = hangBall(0.002, 0.8, Vec3::Zero(), -0.5 * 0.1 * dt, 0.1);
  const double before = 0.5 * mass * 0.01;
  run(*world, dt, 4e-3);
  const double lost = before - kineticEnergy(world->bodies);
  double dashpots = 0;
  for (const auto& [name, value] : world->ledger.entries())
    if (name == "normal_dashpots_j") dashpots = value;
  EXPECT_GT(lost, 0.3 * before);
  EXPECT_NEAR(dashpots, lost, 2e-3 * before);
}

TEST(CohesiveLaw, CanBeChosenInAScene) {
  const PackingRun run = runWithModel("law = \"cohesive\"");
  EXPECT_EQ(run.world().options.law, cohesive);
  EXPECT_GT(run.bound().bound, 0);
}

std::string refusalOf(const LawRow& row) {
  try {
    addLaw(row);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LawsTable, RefusesARowThatCannotServe) {
  const LawRow good{"another", extend::applyCohesiveLaw, extend::findCohesiveStiffness};
  LawRow row = good;
  row.name = "linear";
  EXPECT_EQ(refusalOf(row), "contact law \"linear\" exists: choose another name");
  row.name = "cohesive";
  EXPECT_EQ(refusalOf(row), "contact law \"cohesive\" exists: choose another name");
  row.name = "";
  EXPECT_EQ(refusalOf(row), "contact law of your own: its row needs a name");
  row = good;
  row.stiffness = nullptr;
  EXPECT_EQ(refusalOf(row), "contact law \"another\": its row needs the functions apply and stiffness");
}

TEST(LawsTable, RefusesALedgerForALawWithoutAnAccount) {
  static const LawKind unaccounted = addLaw({"unaccounted", extend::applyCohesiveLaw, extend::findCohesiveStiffness});
  WorldOptions options;
  options.law = unaccounted;
  EXPECT_NO_THROW(World(options, MaterialTable{}));
  options.energy = true;
  EXPECT_THROW(World(options, MaterialTable{}), InputError);
}

}  // namespace
}  // namespace granular
