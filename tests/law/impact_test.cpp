// The linear law in motion: impacts, sliding, sticking and rolling of one sphere on a wall, against closed forms.
#include <gtest/gtest.h>

#include "granular/integrate/integrator.h"
#include "granular/law/linear.h"

namespace granular {
namespace {

/// A sphere above the wall z = 0 (or a block that cannot turn: inverseInertia 0). The arm keeps the radius, so that the
/// closed forms, which neglect the overlap, are exact.
struct Ball {
  double mass = 2e-3, radius = 3e-3, inverseInertia = 0;
  Vec3 x = Vec3::Zero(), v = Vec3::Zero(), w = Vec3::Zero();
  Vec3 gravity = Vec3::Zero();
  ContactHistory history;
  ContactForce contact;

  Ball() { inverseInertia = 1 / (0.4 * mass * radius * radius); }
};

/// Leapfrog with the velocity at t_n for the dashpot; stops when the contact ends, if told, or after the time.
class Drop {
 public:
  Drop(const LawConstants& constants, const LawOptions& options, double radiusRatio) : law(constants), choice(options) {
    body.radiusRatio = radiusRatio;
  }

  double contactTime(const Ball& ball) {
    body.inverseMass = 1 / ball.mass;
    return stiffnessOf(LawKind::linear, law, choice, body, {}, -Vec3::UnitZ()).contactTime;
  }

  void run(Ball& ball, double dt, double time, bool untilApart = true) {
    body.inverseMass = 1 / ball.mass;
    Vec3 acceleration = ball.gravity, turning = Vec3::Zero(), vHalf = ball.v + 0.5 * dt * acceleration, wHalf = ball.w;
    bool touched = false;
    const double steps = time / dt;
    for (double n = 0; n < steps; ++n) {
      predictTranslation(dt, vHalf, acceleration, ball.x, ball.v);
      ball.w = wHalf + 0.5 * dt * turning;
      const bool touching = ball.x.z() < ball.radius;
      if (touched && !touching && untilApart) {
        // Apart: nothing changes the velocities of the half step any more.
        ball.v = vHalf;
        ball.w = wHalf;
        return;
      }
      touched |= touching;
      touch(ball, vHalf, wHalf, dt, touching);
      acceleration = ball.gravity + ball.contact.force / ball.mass;
      turning = ball.inverseInertia * (arm(ball).cross(ball.contact.force) + ball.contact.couple);
      advanceTranslation(dt, acceleration, vHalf);
      wHalf += dt * turning;
    }
  }

 private:
  static Vec3 arm(const Ball& ball) { return -ball.radius * Vec3::UnitZ(); }

  void touch(Ball& ball, const Vec3& vHalf, const Vec3& wHalf, double dt, bool touching) {
    ball.contact = ContactForce{};
    if (!touching) {
      ball.history = ContactHistory{};
      return;
    }
    ContactMotion m;
    m.normal = -Vec3::UnitZ();
    m.overlap = ball.radius - ball.x.z();
    m.velocity = ball.v + ball.w.cross(arm(ball));
    m.slip = dt * (vHalf + wHalf.cross(arm(ball)));
    m.spin = ball.w;
    m.meanSpin = 0.5 * ball.w;
    m.dt = dt;
    m.centreArm = m.u = Vec3::Zero();
    lawFunction(LawKind::linear)(law, choice, body, {}, m, ball.history, ball.contact);
  }

  LawConstants law;
  LawOptions choice;
  ContactBody body;
};

LawOptions makeOptions(bool tension, bool frictionOfPush = false) {
  LawOptions options;
  options.tension = tension;
  options.frictionOfPush = frictionOfPush;
  return options;
}

/// Largest error of the restitution over the phase of first contact.
double findRestitutionError(double e, bool tension, double stepsPerContact) {
  double worst = 0;
  for (int phase = 0; phase < 20; ++phase) {
    Drop drop(prepareLaw({1e4, e, 1, 0}), makeOptions(tension), 0);
    Ball ball;
    const double dt = drop.contactTime(ball) / stepsPerContact;
    ball.v.z() = -0.3;
    ball.x.z() = ball.radius + 0.3 * dt * (phase + 0.5) / 20;
    drop.run(ball, dt, 3 * stepsPerContact * dt);
    worst = std::max(worst, std::abs(ball.v.z() / 0.3 - e));
  }
  return worst;
}

TEST(Impact, RestitutionErrorsAreThoseOfTheStep) {
  // Worst over the phase of first contact; the figures of an independent computation, with a tenth to spare.
  EXPECT_LT(findRestitutionError(1, true, 10), 1.1 * 1.9e-3);
  EXPECT_LT(findRestitutionError(1, true, 20), 1.1 * 2.4e-4);
  EXPECT_LT(findRestitutionError(1, true, 50), 1.1 * 1.6e-5);
  EXPECT_LT(findRestitutionError(1, true, 100), 1.1 * 2e-6);
  EXPECT_LT(findRestitutionError(.9, true, 50), 1.1 * 2.2e-4);
  EXPECT_LT(findRestitutionError(.5, false, 10), 1.1 * 4.5e-2);
  EXPECT_LT(findRestitutionError(.5, false, 50), 1.1 * 7e-3);
  EXPECT_LT(findRestitutionError(.5, false, 100), 1.1 * 3.5e-3);
}

TEST(Impact, RestitutionIsTheNominalOneWithAndWithoutTension) {
  for (const double e : {1.0, .9, .7, .5, .3, .1, .05}) {
    EXPECT_NEAR(findRestitutionError(e, true, 2000), 0, 1e-3) << e;
    EXPECT_NEAR(findRestitutionError(e, false, 2000), 0, 1e-3) << e;
  }
}

TEST(Impact, NothingPullsWithoutTension) {
  for (const bool tension : {true, false}) {
    Drop drop(prepareLaw({1e4, .3, 1, 0}), makeOptions(tension), 0);
    Ball ball;
    ball.x.z() = ball.radius;
    ball.v.z() = -0.3;
    const double dt = drop.contactTime(ball) / 500;
    double least = infinity;
    for (int k = 0; k < 700; ++k) {
      drop.run(ball, dt, 1.5 * dt, false);
      least = std::min(least, ball.contact.normalForce);
    }
    EXPECT_EQ(least < 0, tension);
  }
}

TEST(Impact, OfAStickingSphereTurnsTheContactVelocityByTheClosedForm) {
  // v_ct'/v_ct = cos(pi sqrt(3.5 k_t/k_n)): k_t/k_n = m_t/mu = 1/(1 + m R) is set by the radius ratio.
  for (const double ratio : {2.0 / 7, .5, .8}) {
    Ball ball;
    Drop drop(prepareLaw({1e4, 1, 1, 1e6}), {}, (1 / ratio - 1) / ball.mass);
    const double dt = drop.contactTime(ball) / 4000;
    ball.x.z() = ball.radius;
    ball.v = Vec3(.1, 0, -.3);
    drop.run(ball, dt, 1e5 * dt);
    const double after = ball.v.x() - ball.w.y() * ball.radius;
    EXPECT_NEAR(after / .1, std::cos(pi * std::sqrt(3.5 * ratio)), 2e-3) << ratio;
  }
}

TEST(Impact, OfASphereKeepsNormalAndTangentialRestitutionBoth) {
  // S 13-16 for spheres: both contact times are equal and v_ct' = -e_t v_ct.
  for (const double e : {.9, .6, .3}) {
    Ball ball;
    Drop drop(prepareLaw({1e4, .8, e, 1e6}), {}, 2.5 / ball.mass);
    const double dt = drop.contactTime(ball) / 4000;
    ball.x.z() = ball.radius;
    ball.v = Vec3(.1, 0, -.3);
    drop.run(ball, dt, 1e5 * dt);
    EXPECT_NEAR((ball.v.x() - ball.w.y() * ball.radius) / .1, -e, 3e-3);
    EXPECT_NEAR(ball.v.z() / .3, .8, 1e-3);
  }
}

TEST(Impact, OfASlidingSphereFollowsCoulomb) {
  // v_t' = v_t - mu (1 + e) v_n, w' = 5/2 mu (1 + e) v_n/R, exact where friction never exceeds mu max(F_n, 0).
  const double mu = .2, e = .5, vn = .3, vt = 3.5 * mu * (1 + e) * vn * 1.5;
  for (const bool tension : {true, false}) {
    Ball ball;
    Drop drop(prepareLaw({1e4, e, .6, mu}), makeOptions(tension, true), 2.5 / ball.mass);
    const double dt = drop.contactTime(ball) / 2000;
    ball.x.z() = ball.radius;
    ball.v = Vec3(vt, 0, -vn);
    drop.run(ball, dt, 1e5 * dt);
    // With tension and a cap at max(F_n, 0) the friction impulse is that of the pushing phase: 1 + e less the pull's.
    const double impulse = (vt - ball.v.x()) / (mu * vn);
    if (!tension) {
      EXPECT_NEAR(impulse, 1 + e, 2e-3 * (1 + e));
      EXPECT_NEAR(ball.w.y(), 2.5 * mu * (1 + e) * vn / ball.radius, 2e-3 * ball.w.y());
    } else {
      EXPECT_GT(impulse, 1 + e);
      EXPECT_LT(impulse, 1.07 * (1 + e));
    }
  }
}

TEST(Impact, WithTensionFrictionOfTheMagnitudeIsLargerByThePublishedShare) {
  // S as it stands, |F_n|: the friction impulse exceeds mu (1 + e) v_n by 6.7 % at e = .5 and 15 % at .3.
  const double shares[][2] = {{.5, .067}, {.3, .15}};
  for (const auto& [e, share] : shares) {
    Ball ball;
    const double mu = .05, vn = .3;
    Drop drop(prepareLaw({1e4, e, .6, mu}), makeOptions(true, false), 2.5 / ball.mass);
    const double dt = drop.contactTime(ball) / 4000;
    ball.x.z() = ball.radius;
    ball.v = Vec3(2, 0, -vn);
    drop.run(ball, dt, 1e5 * dt);
    EXPECT_NEAR((2 - ball.v.x()) / (mu * (1 + e) * vn) - 1, share, .005) << e;
  }
}

/// A block on an incline in axes of the incline.
Ball makeBlock(double angle) {
  Ball block;
  block.inverseInertia = 0;
  block.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
  block.x.z() = block.radius;
  return block;
}

TEST(Slope, BlockSticksBelowTheAngleOfFrictionWithTheSpringAtItsRest) {
  const double angle = std::atan(.39);
  Drop drop(prepareLaw({1e4, .3, .3, .4}), {}, 0);
  Ball block = makeBlock(angle);
  block.x.z() -= block.mass * 9.81 * std::cos(angle) / 1e4;
  drop.run(block, drop.contactTime(block) / 50, .5, false);
  ContactBody a;
  a.inverseMass = 1 / block.mass;
  const double kt = stiffnessOf(LawKind::linear, prepareLaw({1e4, .3, .3, .4}), {}, a, {}, Vec3::UnitZ()).tangential;
  EXPECT_NEAR(block.history.spring.x() * kt / (block.mass * 9.81 * std::sin(angle)), 1, 1e-9);
  EXPECT_NEAR(block.v.norm(), 0, 1e-12);
}

TEST(Slope, BlockSlidesAboveTheAngleOfFriction) {
  const double angle = std::atan(.41), mu = .4;
  Drop drop(prepareLaw({1e4, .3, .3, mu}), {}, 0);
  Ball block = makeBlock(angle);
  block.x.z() -= block.mass * 9.81 * std::cos(angle) / 1e4;
  // The second half of a second: the spring is stretched by then.
  drop.run(block, drop.contactTime(block) / 50, .5, false);
  const double before = block.v.x();
  drop.run(block, drop.contactTime(block) / 50, .5, false);
  EXPECT_NEAR((block.v.x() - before) / .5 / (9.81 * (std::sin(angle) - mu * std::cos(angle))), 1, 1e-3);
}

TEST(Slope, BallRollsWithFiveSeventhsOfTheAcceleration) {
  const double angle = .3;
  Ball ball;
  Drop drop(prepareLaw({1e4, .5, .5, .2}), {}, 2.5 / ball.mass);
  ball.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
  ball.x.z() = ball.radius - ball.mass * 9.81 * std::cos(angle) / 1e4;
  drop.run(ball, drop.contactTime(ball) / 50, 1, false);
  EXPECT_NEAR(ball.v.x() / (5.0 / 7 * 9.81 * std::sin(angle)), 1, 1e-3);
}

TEST(Slope, SlidingBallStartsToRollAtTheClosedForm) {
  // v = 5/7 v0 after t = 2 v0/(7 mu g) and x = 12 v0^2/(49 mu g).
  Ball ball;
  const double mu = .1, v0 = .5, time = 2 * v0 / (7 * mu * 9.81);
  Drop drop(prepareLaw({1e4, .5, .5, mu}), {}, 2.5 / ball.mass);
  ball.gravity = Vec3(0, 0, -9.81);
  ball.x.z() = ball.radius - ball.mass * 9.81 / 1e4;
  ball.v.x() = v0;
  drop.run(ball, drop.contactTime(ball) / 50, time, false);
  EXPECT_NEAR(ball.v.x() / (5.0 / 7 * v0), 1, 1e-3);
  EXPECT_NEAR(ball.x.x() / (12 * v0 * v0 / (49 * mu * 9.81)), 1, 1e-3);
  drop.run(ball, drop.contactTime(ball) / 50, time, false);
  EXPECT_NEAR(ball.v.x() / (5.0 / 7 * v0), 1, 1e-3);
  EXPECT_NEAR(ball.v.x() / (ball.w.y() * ball.radius), 1, 1e-3);
}

}  // namespace
}  // namespace granular
