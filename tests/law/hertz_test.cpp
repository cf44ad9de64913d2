// Hertz's laws: coefficients, impacts of one body on a wall against closed forms, the tangential spring.
#include "granular/law/hertz.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/law/materials.h"

namespace granular {
namespace {

const Elasticity rice{183e6, .2};

ContactParameters makeParameters(double e = .8, double friction = 1e9, const Elasticity& solid = rice) {
  ContactParameters p;
  p.restitution = e;
  p.friction = friction;
  setElasticity(solid, solid, p);
  return p;
}

ContactBody makeBall(double mass = 2e-5) {
  ContactBody body;
  body.inverseMass = 1 / mass;
  return body;
}

ContactMotion makeMotion(double overlap, double radius) {
  ContactMotion m;
  m.normal = -Vec3::UnitZ();
  m.overlap = overlap;
  m.squaredDepth = overlap * overlap;
  m.radius = radius;
  m.velocity = m.slip = m.spin = m.meanSpin = m.centreArm = m.u = Vec3::Zero();
  m.dt = 1e-6;
  return m;
}

TEST(Hertz, ForcesOfEqualSolidsAreThoseOfMarkauskas) {
  // M 23 and 24 with their own numbers: E = 183 MPa, nu = .2, G = 76.5 MPa (E/(2 (1 + nu)) is 76.25), eta = 100 1/s.
  const double E = 183e6, nu = .2, G = E / (2 * (1 + nu)), R = 1.1e-3, h = 2e-5, mass = 2e-5;
  ContactParameters p = makeParameters();
  p.dampingRateN = p.dampingRateT = 100;
  const LawConstants c = prepareLaw(p);
  ContactMotion m = makeMotion(h, R);
  m.velocity = Vec3(.02, 0, -.3);
  m.slip = Vec3(1e-8, 0, -3e-7);
  ContactHistory history;
  ContactForce out;
  lawFunction(LawKind::hertz)(c, {}, makeBall(mass), makeBall(mass), m, history, out);
  EXPECT_NEAR(out.normalForce, 2.0 / 3 * E / (1 - nu * nu) * std::sqrt(R * h * h * h) + 100 * mass / 2 * .3, 1e-12);
  EXPECT_NEAR(out.force.z(), out.normalForce, 1e-15);
  EXPECT_NEAR(-out.force.x(), 8.0 / 3 * G * std::sqrt(R * h) / (2 - nu) * 1e-8 + 100 * mass / 2 * .02, 1e-14);
}

TEST(Hertz, ModuliOfTwoSolidsAddTheirCompliances) {
  ContactParameters p;
  setElasticity({70e9, .3}, {infinity, .25}, p);
  EXPECT_NEAR(p.modulus, 70e9 / (1 - .09), 1e-3);
  EXPECT_NEAR(p.shearModulus, 70e9 / 2.6 / 1.7, 1e-3);
  setElasticity({70e9, .3}, {2.5e9, .4}, p);
  EXPECT_NEAR(1 / p.modulus, .91 / 70e9 + .84 / 2.5e9, 1e-22);

  // Mixing in the table gives the same.
  MaterialTable table;
  ContactParameters aluminium, nylon;
  setElasticity({70e9, .3}, {70e9, .3}, aluminium);
  setElasticity({2.5e9, .4}, {2.5e9, .4}, nylon);
  table.add("aluminium", aluminium);
  table.add("nylon", nylon);
  EXPECT_NEAR(table.constants(0, 1).parameters.modulus, p.modulus, 1e-6);
  EXPECT_NEAR(table.constants(0, 1).parameters.shearModulus, p.shearModulus, 1e-6);
}

TEST(Hertz, BadElasticityIsRefusedByNameAndLimit) {
  const auto refusal = [](const Elasticity& a, const Elasticity& b) {
    ContactParameters p;
    try {
      setElasticity(a, b, p);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal(rice, {infinity, .3}), "");
  for (const double E : {0.0, -1.0, std::nan("")})
    EXPECT_NE(refusal({E, .3}, rice).find("young_modulus"), std::string::npos) << E;
  for (const double nu : {-1.0, .51, std::nan("")})
    EXPECT_NE(refusal(rice, {1e9, nu}).find("poisson_ratio"), std::string::npos) << nu;
  EXPECT_NE(refusal({infinity, .3}, {infinity, .3}).find("rigid"), std::string::npos);
}

/// One body that meets a wall head on; leapfrog with the velocity at t_n for the dashpot.
struct Bounce {
  double restitution = 0, deepest = 0, duration = 0, force = 0;

  static Bounce run(LawKind kind, const LawConstants& c, const LawOptions& options, double mass, double radius,
                    double speed, double dt) {
    const ContactBody body = makeBall(mass);
    ContactHistory history;
    ContactForce out;
    Bounce bounce;
    double overlap = 0, vHalf = speed, acceleration = 0;
    while (true) {
      // Until it parts: then nothing changes the half-step velocity any more.
      overlap += dt * vHalf;
      if (overlap <= 0) break;
      ContactMotion m = makeMotion(overlap, radius);
      m.velocity.z() = -(vHalf + 0.5 * dt * acceleration);
      m.slip.z() = -dt * vHalf;
      lawFunction(kind)(c, options, body, {}, m, history, out);
      acceleration = -out.force.z() / mass;
      vHalf += dt * acceleration;
      bounce.deepest = std::max(bounce.deepest, overlap);
      bounce.force = std::max(bounce.force, out.normalForce);
      bounce.duration += dt;
    }
    bounce.duration += dt + overlap / -vHalf;  // back to where the overlap ended
    bounce.restitution = -vHalf / speed;
    return bounce;
  }
};

TEST(Hertz, ElasticImpactHasHertzsDepthForceAndDuration) {
  // d = (5 m v^2/(4 k))^{2/5}, F = k d^{3/2}, t = 2.943 d/v = 2.87 (m^2/(R E*^2 v))^{1/5}; k = 4/3 E* sqrt(R).
  // At N steps per contact the leapfrog is off by some (pi/N)^2/24 of the phase, and the largest overlap is read within
  // half a step of its place: (pi/N)^2/8 of it. N = 2000: 3e-7.
  const double mass = 2e-5, radius = 1.15e-3, speed = .7;
  ContactParameters p = makeParameters(1);
  const LawConstants c = prepareLaw(p);
  const double k = 4.0 / 3 * p.modulus * std::sqrt(radius);
  const double depth = std::pow(5 * mass * speed * speed / (4 * k), .4), time = 2.9432751 * depth / speed;
  EXPECT_NEAR(time, 2.8683 * std::pow(mass * mass / (radius * p.modulus * p.modulus * speed), .2), 1e-4 * time);
  for (const LawKind kind : {LawKind::hertz, LawKind::hertzMindlin}) {
    const Bounce got = Bounce::run(kind, c, {}, mass, radius, speed, time / 2000);
    EXPECT_NEAR(got.deepest, depth, 1e-6 * depth);
    EXPECT_NEAR(got.force, k * std::pow(depth, 1.5), 2e-6 * got.force);
    EXPECT_NEAR(got.duration, time, 1e-5 * time);  // 1/N of a step at both ends, where the force starts as t^{3/2}
    EXPECT_NEAR(got.restitution, 1, 1e-6);
    EXPECT_NEAR(stiffnessOf(kind, c, {}, makeBall(mass), {}, Vec3::UnitZ(), depth, radius).contactTime, time,
                1e-6 * time);
  }
}

TEST(Hertz, RestitutionIsTheOneAskedForAtEverySpeed) {
  // Second order while in contact; where it ends the dashpot of a cut contact stops at a finite speed, which the step
  // rounds to one of its own: .35/N for the linear law at e = .5, less here where the dashpot fades as delta^{1/4}.
  const double mass = 2e-5, radius = 1.15e-3, steps = 4000;
  for (const bool tension : {true, false}) {
    LawOptions options;
    options.tension = tension;
    for (const double e : {1.0, .9, .7, .5, .3, .1}) {
      const LawConstants c = prepareLaw(makeParameters(e));
      for (const double speed : {.01, 1.0, 10.0}) {
        const double time =
            2.9432751 * std::pow(5 * mass / (4 * c.hertz * std::sqrt(radius)), .4) / std::pow(speed, .2);
        const Bounce got = Bounce::run(LawKind::hertzMindlin, c, options, mass, radius, speed, time / steps);
        EXPECT_NEAR(got.restitution, e, 0.35 / steps) << "e " << e << " speed " << speed << " tension " << tension;
      }
    }
  }
}

TEST(Hertz, StiffnessIsTheSlopeOfTheForce) {
  const LawConstants c = prepareLaw(makeParameters(1));
  const double overlap = 1e-5, radius = 1e-3, h = 1e-9;
  for (const LawKind kind : {LawKind::hertz, LawKind::hertzMindlin}) {
    const auto force = [&](double x) {
      ContactHistory history;
      ContactForce out;
      lawFunction(kind)(c, {}, makeBall(), {}, makeMotion(x, radius), history, out);
      return out.normalForce;
    };
    const double slope = (force(overlap + h) - force(overlap - h)) / (2 * h);
    const double k = stiffnessOf(kind, c, {}, makeBall(), {}, Vec3::UnitZ(), overlap, radius).normal;
    EXPECT_NEAR(k, slope, 1e-7 * slope);
    EXPECT_NEAR(k, 2 * c.parameters.modulus * std::sqrt(radius * overlap), 1e-12 * k);
  }
}

/// A contact moved by hand.
class Hand {
 public:
  explicit Hand(LawKind law, double e = 1, double friction = 1e9)
      : kind(law), constants(prepareLaw(makeParameters(e, friction))) {}

  /// Moves to an overlap and sideways by `slide`, in n small steps; returns the work done on the contact, J.
  double move(double overlap, double slide, int n) {
    double work = 0;
    const double sink = (overlap - depth) / n;
    for (int k = 0; k < n; ++k) {
      const Vec3 before = force;
      depth += sink;
      ContactMotion m = makeMotion(depth, radius);
      m.slip = Vec3(slide / n, 0, -sink);
      ContactForce out;
      if (depth > 0) lawFunction(kind)(constants, {}, makeBall(), {}, m, history, out);
      force = out.force;
      work -= 0.5 * (before + force).dot(m.slip);
    }
    return work;
  }

  double radius = 1e-3, depth = 0;
  Vec3 force = Vec3::Zero();
  LawKind kind;
  LawConstants constants;
  ContactHistory history;
};

TEST(HertzMindlin, TangentialStiffnessWithoutSlipIsMindlins) {
  // 8 G* a, G* = G/(2 (2 - nu)); against the normal one 2 E* a: 2 (1 - nu)/(2 - nu).
  Hand hand(LawKind::hertzMindlin);
  hand.move(1e-5, 0, 1);
  hand.move(1e-5, 3e-7, 100);
  const double a = std::sqrt(1e-3 * 1e-5), G = rice.young / (2 * (1 + rice.poisson));
  EXPECT_NEAR(-hand.force.x() / 3e-7, 4 * G / (2 - rice.poisson) * a, 1e-10 * 4 * G * a);
  const ContactStiffness k =
      stiffnessOf(LawKind::hertzMindlin, hand.constants, {}, makeBall(), {}, Vec3::UnitZ(), 1e-5, 1e-3);
  EXPECT_NEAR(k.tangential / k.normal, 2 * (1 - rice.poisson) / (2 - rice.poisson), 1e-12);
}

TEST(HertzMindlin, GrowingContactKeepsItsTangentialForceAndAShrinkingOneLetsItGo) {
  Hand hand(LawKind::hertzMindlin);
  hand.move(1e-5, 0, 1);
  hand.move(1e-5, 1e-7, 1);
  const double force = hand.force.x();
  hand.move(4e-5, 0, 1000);
  EXPECT_NEAR(hand.force.x(), force, 1e-12 * std::abs(force));
  hand.move(1e-5, 0, 1000);
  EXPECT_NEAR(hand.force.x(), 0.5 * force, 1e-12 * std::abs(force));  // a fell to half

  // M's secant spring stretches with the stiffness, and comes back.
  Hand secant(LawKind::hertz);
  secant.move(1e-5, 0, 1);
  secant.move(1e-5, 1e-7, 1);
  const double first = secant.force.x();
  secant.move(4e-5, 0, 1000);
  EXPECT_NEAR(secant.force.x(), 2 * first, 1e-12 * std::abs(first));
}

TEST(HertzMindlin, NoClosedPathOfAStickingContactWinsEnergy) {
  // Press, shear, press or lift, shear back, part: the work put in is never negative.
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    Hand hand(LawKind::hertzMindlin);
    double work = 0, place = 0;
    for (int leg = 0; leg < 6; ++leg) {
      const double depth = random.uniform(1e-6, 4e-5), slide = random.uniform(-1e-6, 1e-6);
      work += hand.move(depth, 0, 400);
      work += hand.move(depth, slide, 400);
      place += slide;
    }
    work += hand.move(hand.depth, -place, 400);
    work += hand.move(0, 0, 400);
    // The trapezoids of 400 steps leave some 1e-5 of the largest normal energy, 2/5 k d^{5/2}.
    const double scale = 0.4 * hand.constants.hertz * std::sqrt(1e-3) * std::pow(4e-5, 2.5);
    EXPECT_GT(work, -2e-5 * scale);
  }
}

TEST(Hertz, FrictionIsCoulombsOfTheNormalForce) {
  for (const LawKind kind : {LawKind::hertz, LawKind::hertzMindlin}) {
    Hand hand(kind, 1, .3);
    hand.move(1e-5, 0, 1);
    hand.move(1e-5, 1e-4, 100);
    EXPECT_NEAR(-hand.force.x(), .3 * hand.force.z(), 1e-12);
  }
}

TEST(Hertz, AccountsOfAContactAreItsForceAndItsEnergy) {
  Random random(5);
  for (const LawKind kind : {LawKind::hertz, LawKind::hertzMindlin}) {
    ContactParameters p = makeParameters(.7, .4);
    p.dampingRateN = p.dampingRateT = 100;
    const LawConstants c = prepareLaw(p);
    for (int k = 0; k < 100; ++k) {
      ContactMotion m = makeMotion(random.uniform(1e-6, 1e-5), 1e-3);
      m.velocity = .1 * random.direction();
      m.slip = 1e-7 * random.direction();
      ContactHistory before;
      before.normal = m.normal;
      before.spring = 1e-6 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0);
      ContactHistory after = before;
      ContactForce out;
      lawFunction(kind)(c, {}, makeBall(), {}, m, after, out);
      const ContactAccount account = accountContact(kind, c, {}, makeBall(), {}, m, before, after, out);
      const Vec3 sum = account.elasticForce + account.dampingForce + account.viscousForce;
      EXPECT_LT((sum - out.force).norm(), 1e-13 * out.force.norm());
      EXPECT_NEAR(account.normalSpring, 0.4 * c.hertz * std::sqrt(1e-3) * std::pow(m.overlap, 2.5),
                  1e-13 * account.normalSpring);
      EXPECT_EQ(account.slides, out.sliding);
      if (!out.sliding) {
        EXPECT_NEAR(account.slipHeat, 0, 1e-14 * account.tangentialSpring);
      }
    }
  }
}

}  // namespace
}  // namespace granular
