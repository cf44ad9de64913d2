// The tensor law: its matrices, Coulomb's limit, and collisions of two bodies that touch at a fixed point.
#include "granular/law/tensor.h"

#include <gtest/gtest.h>

#include "granular/core/random.h"

namespace granular {
namespace {

ContactBody makeBody(Random& random, double mass = 2e-3, double size = 3e-3) {
  ContactBody body;
  body.inverseMass = 1 / mass;
  body.arm = size * random.uniform(.5, 1.7) * random.direction();
  const Mat3 r = random.rotation().toRotationMatrix();
  const Vec3 inertia =
      mass * size * size * Vec3(random.uniform(.3, .6), random.uniform(.3, .6), random.uniform(.3, .6));
  body.inverseInertia = r * inertia.cwiseInverse().asDiagonal() * r.transpose();
  body.radiusRatio = body.inverseInertia.trace() / 3 * size * size;
  return body;
}

Mat3 crossMatrix(const Vec3& r) {
  Mat3 x;
  x << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return x;
}

Mat3 inverseMassOf(const ContactBody& body) {
  return body.inverseMass * Mat3::Identity() - crossMatrix(body.arm) * body.inverseInertia * crossMatrix(body.arm);
}

/// Two bodies that touch at a point fixed in both, in the limit of small motion: arms, normal and A keep still, and the
/// overlap is the way along the normal. Leapfrog, with the velocity at t_n for the dashpot.
struct Collision {
  LawKind kind = LawKind::tensor;
  LawConstants law;
  LawOptions options;
  ContactBody a, b;
  Vec3 normal = Vec3::UnitZ();

  struct Outcome {
    Vec3 before, after;  ///< relative velocity of the contact point
    double kineticBefore = 0, kineticAfter = 0;
    Vec3 spring;
  };

  double contactTime() const { return stiffnessOf(kind, law, options, a, b, normal).contactTime; }

  Outcome run(const Vec3& u, double stepsPerContact) const {
    const Mat3 inverse = inverseMassOf(a) + inverseMassOf(b), mass = inverse.inverse();
    const double dt = contactTime() / stepsPerContact;
    Outcome outcome;
    outcome.before = u;
    outcome.kineticBefore = .5 * u.dot(mass * u);
    Vec3 half = u, rate = Vec3::Zero();
    ContactHistory history;
    ContactForce force;
    ContactMotion m;
    m.normal = normal;
    m.spin = m.meanSpin = m.centreArm = m.u = Vec3::Zero();
    m.dt = dt;
    double overlap = -.5 * dt * u.dot(normal);
    while (true) {
      overlap += dt * half.dot(normal);
      if (overlap <= 0) break;
      m.overlap = overlap;
      m.slip = dt * half;
      m.velocity = half + .5 * dt * rate;
      lawFunction(kind)(law, options, a, b, m, history, force);
      rate = inverse * force.force;
      half += dt * rate;
    }
    outcome.after = half;
    outcome.kineticAfter = .5 * half.dot(mass * half);
    outcome.spring = history.spring;
    return outcome;
  }
};

Collision makeCollision(Random& random, const ContactParameters& parameters, LawKind kind = LawKind::tensor) {
  Collision collision;
  collision.kind = kind;
  collision.law = prepareLaw(parameters);
  collision.a = makeBody(random);
  collision.b = makeBody(random);
  collision.normal = random.direction();
  return collision;
}

Vec3 drawApproach(Random& random, const Vec3& n) {
  const Vec3 u = random.direction();
  return u.dot(n) < 0 ? Vec3(-u) : u;
}

constexpr double noLimit = 1e12;

TEST(Tensor, MakesNormalAndTangentialMotionIsochronous) {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Collision c = makeCollision(random, {1e4, .7, .7, noLimit});
    const TensorStiffness t = findTensorStiffness(c.law, {}, c.a, c.b, c.normal);
    const Mat3 inverse = t.axes.transpose() * (inverseMassOf(c.a) + inverseMassOf(c.b)) * t.axes;
    const double square = 1e4 * c.normal.dot((inverseMassOf(c.a) + inverseMassOf(c.b)) * c.normal);
    EXPECT_LT((inverse * t.spring - square * Mat3::Identity()).norm(), 1e-11 * square);
    const double damping = 2 * dampingRatioFor(.7, true) * std::sqrt(square);
    EXPECT_LT((inverse * t.damping - damping * Mat3::Identity()).norm(), 1e-11 * damping);
    EXPECT_EQ((t.spring - t.spring.transpose()).norm(), 0);
  }
}

TEST(Tensor, HasTheStiffnessAndDashpotOfTheLinearLawWhereNothingHoldsTheContactSideways) {
  // Schur complements of K and C: the normal force when the tangential one is zero.
  Random random(2);
  for (int k = 0; k < 100; ++k) {
    const Collision c = makeCollision(random, {1e4, .8, .4, noLimit});
    const TensorStiffness t = findTensorStiffness(c.law, {}, c.a, c.b, c.normal);
    const auto schur = [](const Mat3& m) {
      const Mat2 block = m.block<2, 2>(1, 1);
      const Vec2 column = m.block<2, 1>(1, 0);
      return m(0, 0) - column.dot(block.inverse() * column);
    };
    EXPECT_NEAR(schur(t.spring) / 1e4, 1, 1e-11);
    const ContactStiffness local = stiffnessOf(LawKind::linearLocal, c.law, {}, c.a, c.b, c.normal);
    EXPECT_NEAR(schur(t.damping) / local.dampingNormal, 1, 1e-11);
  }
}

TEST(Tensor, IsTheLinearLawForSpheres) {
  Random random(3);
  ContactBody a, b;
  a.inverseMass = 500;
  a.inverseInertia = Mat3::Identity() * 500 / (.4 * 9e-6);
  a.radiusRatio = 2.5 * 500;
  b = a;
  const LawConstants law = prepareLaw({1e4, .8, .5, .3});
  ContactHistory histories[3];
  for (int k = 0; k < 2000; ++k) {
    ContactMotion m;
    m.normal = Vec3::UnitZ();
    a.arm = 3e-3 * m.normal;
    b.arm = -3e-3 * m.normal;
    m.overlap = 1e-5;
    m.velocity = 1e-2 * random.direction();
    m.slip = 1e-6 * random.direction();
    m.spin = m.meanSpin = 10 * random.direction();
    m.centreArm = m.u = Vec3::Zero();
    m.dt = 1e-6;
    ContactForce out[3];
    histories[1] = histories[2] = histories[0];
    int n = 0;
    for (const LawKind kind : {LawKind::linear, LawKind::linearLocal, LawKind::tensor}) {
      lawFunction(kind)(law, {}, a, b, m, histories[n], out[n]);
      ++n;
    }
    EXPECT_LT((out[1].force - out[0].force).norm(), 1e-12 * out[0].force.norm());
    EXPECT_EQ(out[2].sliding, out[0].sliding);
    EXPECT_NEAR(out[2].normalForce, out[0].normalForce, 1e-12 * out[0].normalForce);
    // A slider in series gives way by the dashpot too, so a sliding spring differs; the force has the same magnitude.
    EXPECT_NEAR((out[2].force - out[0].force).norm(), 0, 1e-11 * out[0].force.norm()) << out[0].sliding;
  }
}

TEST(Tensor, LeavesNothingInTheTangentialSpringOfRandomCollisions) {
  Random random(4);
  double worst[3] = {}, worstLoss[3] = {};
  int n = 0;
  for (const LawKind kind : {LawKind::linear, LawKind::linearLocal, LawKind::tensor}) {
    Random draws(5);
    for (int k = 0; k < 100; ++k) {
      const Collision c = makeCollision(draws, {1e4, 1, 1, noLimit}, kind);
      const Collision::Outcome outcome = c.run(drawApproach(draws, c.normal), 100);
      const double loss = 1 - outcome.kineticAfter / outcome.kineticBefore;
      worst[n] = std::max(worst[n], loss);
      worstLoss[n] += std::abs(loss) / 100;
    }
    ++n;
  }
  RecordProperty("worst_linear", std::to_string(worst[0]));
  RecordProperty("worst_local", std::to_string(worst[1]));
  RecordProperty("worst_tensor", std::to_string(worst[2]));
  RecordProperty("mean_linear", std::to_string(worstLoss[0]));
  RecordProperty("mean_local", std::to_string(worstLoss[1]));
  // The phase of the last step leaves the spring stretched by up to |u_t| dt: (pi/100)^2 of the energy.
  EXPECT_LT(worst[2], 1e-3);
  EXPECT_LT(worstLoss[2], 5e-4);
  EXPECT_GT(worstLoss[0], .03);
  EXPECT_GT(worstLoss[1], .01);
}

TEST(Tensor, ReversesTheRelativeVelocityOfEveryEccentricImpactByTheRestitution) {
  Random random(6);
  for (const double e : {1.0, .9, .6}) {
    for (int k = 0; k < 50; ++k) {
      const Collision c = makeCollision(random, {1e4, e, e, noLimit});
      const Collision::Outcome outcome = c.run(drawApproach(random, c.normal), 2000);
      EXPECT_LT((outcome.after + e * outcome.before).norm(), 4e-3) << e;
    }
  }
}

TEST(Tensor, NeverAddsEnergyWhateverTheRestitutionsAndTheFriction) {
  Random random(7);
  for (int k = 0; k < 400; ++k) {
    Collision c = makeCollision(
        random, {1e4, random.uniform(.1, 1), random.uniform(.1, 1), std::pow(10, random.uniform(-3, 1.5))});
    c.options.tension = random.uniform(0, 1) < .5;
    c.options.frictionOfPush = random.uniform(0, 1) < .5;
    const Collision::Outcome outcome = c.run(drawApproach(random, c.normal), 400);
    EXPECT_LT(outcome.kineticAfter, outcome.kineticBefore * (1 + 1e-4)) << k;
  }
}

TEST(Tensor, KeepsTheNormalRestitutionOnAverageWhereTheTwoDiffer) {
  Random random(8);
  double worst = 0, mean = 0;
  int count = 0;
  for (int k = 0; k < 400; ++k) {
    const Collision c = makeCollision(random, {1e4, .8, .6, noLimit});
    const Vec3 u = drawApproach(random, c.normal);
    if (u.dot(c.normal) < .3) continue;
    const Collision::Outcome outcome = c.run(u, 1000);
    const double error = -outcome.after.dot(c.normal) / u.dot(c.normal) - .8;
    worst = std::max(worst, std::abs(error));
    mean += error;
    ++count;
  }
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("mean", std::to_string(mean));
  // A tangential approach is damped across into the normal one, with either sign: sqrt(zeta_n zeta_t) A^-1's coupling.
  EXPECT_LT(std::abs(mean / count), .02);
}

TEST(Tensor, HoldsCoulombsLimitExactlyAndTendsToNoFriction) {
  Random random(9);
  int sliding = 0;
  for (int k = 0; k < 5000; ++k) {
    const double friction = std::pow(10, random.uniform(-8, 1));
    const Collision c = makeCollision(random, {1e4, random.uniform(.2, 1), random.uniform(.2, 1), friction});
    ContactMotion m;
    m.normal = c.normal;
    m.overlap = std::pow(10, random.uniform(-9, -4));
    m.velocity = std::pow(10, random.uniform(-6, 1)) * random.direction();
    m.slip = 1e-6 * m.velocity;
    m.spin = m.meanSpin = m.centreArm = m.u = Vec3::Zero();
    m.dt = random.uniform(0, 1) < .1 ? 0 : 1e-6;
    ContactHistory history;
    history.normal = m.normal;
    history.spring = 1e-6 * m.normal.cross(random.direction());
    const Vec3 old = history.spring;
    ContactForce out;
    applyTensorLaw(c.law, {}, c.a, c.b, m, history, out);
    const Vec3 tangential = out.force + out.normalForce * m.normal;
    EXPECT_LE(tangential.norm(), friction * std::abs(out.normalForce) * (1 + 1e-14) + 1e-15 * out.force.norm());
    ASSERT_TRUE(history.spring.allFinite());
    if (!out.sliding) continue;
    ++sliding;
    // The slip opposes the friction on A, so friction heats.
    const Vec3 slip = old + (m.slip - m.normal.dot(m.slip) * m.normal) - history.spring;
    EXPECT_LE(slip.dot(tangential), 1e-20);
  }
  EXPECT_GT(sliding, 1000);

  // e_n = e_t: with little friction, the force of the law without any.
  for (int k = 0; k < 100; ++k) {
    Collision c = makeCollision(random, {1e4, .7, .7, 1e-9});
    const Vec3 u = drawApproach(random, c.normal);
    const Collision::Outcome little = c.run(u, 200);
    c.law = prepareLaw({1e4, .7, .7, 0});
    const Collision::Outcome none = c.run(u, 200);
    EXPECT_LT((little.after - none.after).norm(), 1e-6);
  }
}

TEST(Tensor, DoesNotDependOnWhichBodyComesFirst) {
  Random random(10);
  for (int k = 0; k < 50; ++k) {
    Collision c = makeCollision(random, {1e4, .8, .6, .4});
    const Vec3 u = drawApproach(random, c.normal);
    const Collision::Outcome forward = c.run(u, 200);
    std::swap(c.a, c.b);
    const Vec3 normal = c.normal;
    c.normal = -normal;
    const Collision::Outcome backward = c.run(-u, 200);
    EXPECT_LT((forward.after + backward.after).norm(), 1e-10);
  }
}

}  // namespace
}  // namespace granular
