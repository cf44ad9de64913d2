// Who falls asleep and who wakes, by motions and forces given from outside; and a bed that sleeps under rain.
#include "granular/skip/sleep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "granular/shape/sphere.h"

namespace granular {
namespace {

constexpr double gravity = 10, dt = 1e-5, radius = 1e-3;

/// One ball that is moved and pushed as a test says.
class SleepOfOne : public ::testing::Test {
 protected:
  using Course = std::function<Vec3(double)>;

  SleepOfOne() {
    bodies.add(NewBody{}, ball);
    options.on = true;
  }
  double mass() const { return bodies.mass[0]; }
  double weight() const { return mass() * gravity; }
  /// Speed whose energy is the bound of slowness, m/s.
  double slowest() const { return std::sqrt(2 * options.energy * gravity * 2 * radius); }
  bool asleep() const { return bodies.state[0] == BodyState::asleep; }

  /// Steps through this time with these courses of velocity and net force; returns when the state changed first, or a
  /// negative number.
  double go(double duration, const Course& velocity, const Course& force) {
    const bool before = asleep();
    for (int n = 0; n * dt < duration; ++n, time += dt) {
      if (!asleep()) bodies.v(0) = velocity(time);
      bodies.force[0] = force(time);
      updateSleep(options, gravity, dt, true, {0}, {load}, bodies, state);
      if (asleep() != before) return time;
    }
    return -1;
  }
  static Course always(const Vec3& value) {
    return [value](double) { return value; };
  }
  const Course none = always(Vec3::Zero());
  void fallAsleep() {
    ASSERT_GE(go(0.1, none, none), 0);
    time = 0;
  }

  Sphere ball{radius};
  Bodies bodies;
  SleepOptions options;
  SleepState state;
  double load = 1e-3;  // N
  double time = 0;
};

TEST_F(SleepOfOne, ABodyThatDriftsSlowerThanTheBoundFallsAsleepAfterTheTime) {
  const double when = go(0.1, always(0.99 * slowest() * Vec3::UnitX()), none);
  EXPECT_NEAR(when, options.time, 2 * dt);
}

TEST_F(SleepOfOne, ABodyThatDriftsFasterThanTheBoundStaysAwake) {
  // Its mean begins at zero and passes the bound before the time is over: (1 - 1/e) 1.65 > 1.
  EXPECT_LT(go(0.2, always(1.65 * slowest() * Vec3::UnitX()), none), 0);
}

TEST_F(SleepOfOne, ABodyThatIsShakenAndGoesNowhereFallsAsleep) {
  // Five times the speed of the bound, at 2 kHz: the mean over the time is smaller by omega time = 126.
  const auto shaken = [&](double t) -> Vec3 {
    return 5 * slowest() * std::sin(2 * std::numbers::pi * 2e3 * t) * Vec3::UnitZ();
  };
  EXPECT_NEAR(go(0.1, shaken, none), options.time, 2 * dt);
}

TEST_F(SleepOfOne, ABodyOutOfBalanceStaysAwake) {
  EXPECT_LT(go(0.1, none, always(1.01 * options.balance * load * Vec3::UnitZ())), 0);
  EXPECT_GE(go(0.1, none, always(0.99 * options.balance * load * Vec3::UnitZ())), 0);
}

TEST_F(SleepOfOne, TheEnergyTakenAwayIsThatOfItsLastMotion) {
  const Vec3 velocity = 0.5 * slowest() * Vec3(0.6, 0, 0.8);
  ASSERT_GE(go(0.1, always(velocity), none), 0);
  EXPECT_DOUBLE_EQ(state.energyLetGo, 0.5 * mass() * velocity.squaredNorm());
}

TEST_F(SleepOfOne, AForceThatStaysWakesAboveTheBoundAlone) {
  fallAsleep();
  EXPECT_LT(go(0.1, none, always(0.99 * options.wake * load * Vec3::UnitX())), 0);
  EXPECT_GE(go(0.1, none, always(1.01 * options.wake * load * Vec3::UnitX())), 0);
}

TEST_F(SleepOfOne, ABlowWakesByItsImpulse) {
  // Shorter by far than the average: only its impulse counts, whatever its force.
  const double bound = options.wake * load * options.average;
  const auto blow = [&](double impulse) {
    return [impulse](double t) -> Vec3 { return (t < 4.5 * dt ? impulse / (5 * dt) : 0) * Vec3::UnitY(); };
  };
  fallAsleep();
  EXPECT_LT(go(0.05, none, blow(0.98 * bound)), 0);
  EXPECT_LT(state.forceChange[0].norm(), 1e-15) << "a blow is forgotten";
  time = 0;
  EXPECT_GE(go(0.05, none, blow(1.05 * bound)), 0);
}

TEST_F(SleepOfOne, AWaveThatTakesBackWhatItBringsWakesNobody) {
  // Twenty times the bound, there and back at 5 kHz: omega average = 31.
  fallAsleep();
  const auto wave = [&](double t) -> Vec3 {
    return 20 * options.wake * load * std::cos(2 * std::numbers::pi * 5e3 * t) * Vec3::UnitX();
  };
  EXPECT_LT(go(0.1, none, wave), 0);
}

TEST_F(SleepOfOne, ATorqueWakesLikeAForceAtTheRadius) {
  fallAsleep();
  bodies.torque[0] = 0.99 * options.wake * load * radius * Vec3::UnitX();
  EXPECT_LT(go(0.1, none, none), 0);
  bodies.torque[0] = 1.01 * options.wake * load * radius * Vec3::UnitX();
  EXPECT_GE(go(0.1, none, none), 0);
}

TEST_F(SleepOfOne, WithoutAverageTheForceOfTheMomentWakes) {
  options.average = 0;
  fallAsleep();
  EXPECT_EQ(go(dt, none, always(1.01 * options.wake * load * Vec3::UnitX())), 0);
}

TEST_F(SleepOfOne, WhoWasWokenMustBeSlowForTheWholeTimeAgain) {
  fallAsleep();
  ASSERT_GE(go(0.1, none, always(2 * options.wake * load * Vec3::UnitX())), 0);
  time = 0;
  EXPECT_NEAR(go(0.1, none, none), options.time, 2 * dt);
}

}  // namespace
}  // namespace granular
