// The linear law's parts: coefficients, history, sliding, patches.
#include "granular/law/linear.h"

#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/point/moments.h"
#include "point/random_polygon.h"

namespace granular {
namespace {

const LawConstants& makeLaw() {
  static const LawConstants law = prepareLaw({1e4, .8, .6, .3});
  return law;
}

ContactBody makeBody(double mass = 2e-3) {
  ContactBody body;
  body.inverseMass = 1 / mass;
  body.radiusRatio = 2.5 / mass;
  return body;
}

/// A motion of a point contact along z.
ContactMotion makeMotion(double overlap = 1e-5) {
  ContactMotion m;
  m.normal = Vec3::UnitZ();
  m.overlap = overlap;
  m.velocity = m.slip = m.spin = m.meanSpin = m.centreArm = Vec3::Zero();
  m.u = Vec3::UnitX();
  m.dt = 1e-6;
  return m;
}

TEST(Coefficients, AreThoseOfThePaper) {
  const ContactBody a = makeBody(2e-3), b = makeBody(5e-3);
  const ContactStiffness k = stiffnessOf(LawKind::linear, makeLaw(), {}, a, b, Vec3::UnitZ());
  const double mu = 1 / (1 / 2e-3 + 1 / 5e-3), mt = 1 / (1 / mu + 2.5 / 2e-3 + 2.5 / 5e-3);
  const double phase = pi * pi + std::log(.8) * std::log(.8), time = std::sqrt(mu * phase / 1e4);
  EXPECT_NEAR(k.contactTime / time, 1, 1e-14);
  EXPECT_NEAR(k.tangential / (1e4 * mt / mu * (pi * pi + std::log(.6) * std::log(.6)) / phase), 1, 1e-14);
  EXPECT_NEAR(mt / mu, 2.0 / 7, 1e-14);
  EXPECT_NEAR(k.dampingNormal / (-2 * mu * std::log(.8) / time), 1, 1e-14);
  EXPECT_NEAR(k.dampingTangential / (-2 * mt * std::log(.6) / time), 1, 1e-14);
}

TEST(Coefficients, WithLocalMassDampTheMassTheContactFeels) {
  Random random(1);
  ContactBody a = makeBody(2e-3);
  a.arm = Vec3(1e-3, 2e-3, -1e-3);
  const Mat3 r = random.rotation().toRotationMatrix();
  a.inverseInertia = r * Vec3(1e8, 2e8, 3e8).asDiagonal() * r.transpose();
  const Vec3 n = random.direction();
  // 1/m_n = n.A n with A = 1/m 1 - [r]x I^-1 [r]x.
  Mat3 x;
  x << 0, -a.arm.z(), a.arm.y(), a.arm.z(), 0, -a.arm.x(), -a.arm.y(), a.arm.x(), 0;
  const double inverse = n.dot((Mat3(Mat3::Identity() / 2e-3) - x * a.inverseInertia * x) * n);
  EXPECT_NEAR(localInverseMass(a, n) / inverse, 1, 1e-13);

  LawOptions local;
  local.localMass = true;
  const ContactStiffness k = stiffnessOf(LawKind::linear, makeLaw(), local, a, {}, n),
                         usual = stiffnessOf(LawKind::linear, makeLaw(), {}, a, {}, n);
  EXPECT_NEAR(k.dampingNormal / usual.dampingNormal, std::sqrt(1 / (inverse * 2e-3)), 1e-13);
  EXPECT_EQ(k.tangential, usual.tangential);
}

TEST(Coefficients, OfRestitutionOneDampNothing) {
  const LawConstants law = prepareLaw({1e4, 1, 1, .3});
  for (const bool tension : {true, false}) {
    LawOptions options;
    options.tension = tension;
    const ContactStiffness k = stiffnessOf(LawKind::linear, law, options, makeBody(), {}, Vec3::UnitZ());
    EXPECT_EQ(k.dampingNormal, 0);
    EXPECT_EQ(k.dampingTangential, 0);
    EXPECT_NEAR(k.contactTime, pi * std::sqrt(2e-3 / 1e4), 1e-15);
  }
}

TEST(Spring, IsCarriedByTheSmallestRotationAndTheSpin) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 old = random.direction();
    const Vec3 normal = (old + std::pow(10, random.uniform(-6, 0)) * random.direction()).normalized();
    const double angle = random.uniform(-.01, .01);
    const Vec3 spring = old.cross(random.direction());
    const Vec3 expected = Eigen::AngleAxisd(angle, normal) * (Quat::FromTwoVectors(old, normal) * spring);
    const Vec3 carried = carrySpring(spring, old, normal, angle);
    EXPECT_NEAR((carried - expected).norm(), 0, 1e-7 * spring.norm());
    EXPECT_NEAR(carried.norm(), spring.norm(), 1e-15);
    EXPECT_NEAR(carried.dot(normal), 0, 1e-15);
  }
}

TEST(Spring, TurnsWithAPairThatTurnsRigidly) {
  // Both bodies turn with W: after n steps the spring is the start's, turned by W n dt.
  const Vec3 spin(3, -2, 5), start(1e-6, 2e-6, 0);
  const double dt = 1e-4;
  const int steps = 4000;
  ContactHistory history;
  history.spring = start;
  history.normal = Vec3::UnitZ();
  ContactForce out;
  for (int k = 1; k <= steps; ++k) {
    ContactMotion m = makeMotion(1e-3);
    m.normal = rotationFromVector(spin * (k * dt)) * Vec3::UnitZ();
    m.meanSpin = spin;
    m.dt = dt;
    applyLinearLaw(makeLaw(), {}, makeBody(), makeBody(), m, history, out);
  }
  const Vec3 expected = rotationFromVector(spin * (steps * dt)) * start;
  EXPECT_LT((history.spring - expected).norm(), 1e-6 * start.norm());
}

TEST(Spring, GrowsByTheTangentialSlipAlone) {
  ContactMotion m = makeMotion();
  m.slip = Vec3(1e-8, 2e-8, 5e-8);
  ContactHistory history;
  ContactForce out;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, out);
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, out);
  EXPECT_NEAR((history.spring - Vec3(2e-8, 4e-8, 0)).norm(), 0, 1e-22);
  EXPECT_FALSE(out.sliding);
  const double kt = stiffnessOf(LawKind::linear, makeLaw(), {}, makeBody(), {}, m.normal).tangential;
  EXPECT_NEAR((out.force - Vec3(-kt * 2e-8, -kt * 4e-8, -.1)).norm(), 0, 1e-14);
}

TEST(Sliding, LeavesSpringAndDashpotAtCoulombsForce) {
  const ContactStiffness k = stiffnessOf(LawKind::linear, makeLaw(), {}, makeBody(), {}, Vec3::UnitZ());
  ContactMotion m = makeMotion();
  m.velocity = Vec3(1e-3, 2e-3, 0);
  m.slip = Vec3(3e-5, -1e-5, 0);
  ContactHistory history;
  ContactForce out;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, out);
  const Vec3 friction(out.force.x(), out.force.y(), 0);
  EXPECT_TRUE(out.sliding);
  EXPECT_NEAR(friction.norm(), .3 * .1, 1e-15);
  EXPECT_NEAR((k.tangential * history.spring + k.dampingTangential * m.velocity + friction).norm(), 0, 1e-15);
}

TEST(Sliding, FasterThanTheDashpotAllowsLeavesNoSpring) {
  ContactMotion m = makeMotion();
  m.velocity = Vec3(100, 0, 0);
  ContactHistory history;
  history.spring = Vec3(0, 1e-7, 0);
  history.normal = m.normal;
  ContactForce out;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, out);
  EXPECT_EQ(history.spring, Vec3(0, 0, 0));
  EXPECT_NEAR(out.force.head<2>().norm(), .3 * .1, 1e-15);
}

TEST(Sliding, AlongTheVelocityAloneFlipsTheForceOfAnUnloadedContactAtRest) {
  // A loaded spring whose normal force drops while round-off moves the contact backwards.
  for (const bool literal : {false, true}) {
    LawOptions options;
    options.slideAlongVelocity = literal;
    ContactMotion m = makeMotion();
    ContactHistory history;
    history.spring = Vec3(1e-4, 0, 0);
    history.normal = m.normal;
    m.velocity = Vec3(-1e-15, 0, 0);
    ContactForce out;
    applyLinearLaw(makeLaw(), options, makeBody(), {}, m, history, out);
    EXPECT_NEAR(out.force.x(), literal ? .03 : -.03, 1e-12);
  }
}

TEST(Friction, OfZeroKeepsNoHistory) {
  const LawConstants law = prepareLaw({1e4, .8, .6, 0});
  ContactMotion m = makeMotion();
  m.slip = m.velocity = Vec3(1e-3, 0, 0);
  ContactHistory history;
  history.twist = 3;
  ContactForce out;
  applyLinearLaw(law, {}, makeBody(), {}, m, history, out);
  EXPECT_EQ(history.spring, Vec3(0, 0, 0));
  EXPECT_EQ(history.normal, Vec3(0, 0, 0));
  EXPECT_EQ(history.twist, 0);
  EXPECT_EQ(out.force.head<2>().norm(), 0);
}

TEST(Shares, OfTheSpotsOfOneFaceAddUpToTheFace) {
  ContactMotion m = makeMotion();
  m.velocity = Vec3(1e-4, 0, 1e-3);
  m.slip = Vec3(1e-8, 0, 0);
  ContactHistory history, shared;
  ContactForce whole, quarter;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, whole);
  m.share = .25;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, shared, quarter);
  EXPECT_NEAR((4 * quarter.force - whole.force).norm(), 0, 1e-15);
}

/// A patch with its polygon in a random plane.
struct RandomPatch {
  Polygon polygon;
  AreaMoments moments;
  Linear depth;
  ContactMotion motion;
  Vec3 v;

  explicit RandomPatch(Random& random) {
    // A depth that vanishes somewhere at the border or not at all.
    polygon = test::makeRandomPolygon(random, 3 + static_cast<int>(random.below(8)));
    depth = {0, Vec2(random.uniform(-1, 1), random.uniform(-1, 1))};
    double least = infinity;
    for (int k = 0; k < polygon.count; ++k) least = std::min(least, depth.at(polygon[k]));
    depth.offset = -least + (random.below(2) ? 0 : random.uniform());
    moments = integrate(polygon, depth);

    motion.normal = random.direction();
    motion.u = perpendicular(motion.normal);
    v = motion.normal.cross(motion.u);
    const Vec2 c = moments.centroid(), p = moments.centroidOfVolume();
    motion.centreArm = toWorld(c) - toWorld(p);
    motion.area = moments.area;
    motion.uu = moments.xx / moments.area - c.x() * c.x();
    motion.vv = moments.yy / moments.area - c.y() * c.y();
    motion.uv = moments.xy / moments.area - c.x() * c.y();
    motion.velocity = random.direction() * random.uniform(0, 2);
    motion.spin = random.direction() * random.uniform(0, 3);
    motion.meanSpin = motion.slip = Vec3::Zero();
  }
  Vec3 toWorld(const Vec2& x) const { return x.x() * motion.u + x.y() * v; }
  Vec2 point() const { return moments.centroidOfVolume(); }
};

TEST(PatchDashpot, IsTheIntegralOverItsPolygon) {
  // Fast enough to matter, slow enough for no pressure to be cut.
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    RandomPatch patch(random);
    const double damping = .1, elastic = 1;
    patch.motion.velocity *= .1;
    patch.motion.spin *= .1;
    Vec3 couple;
    const double push = pressPatch(patch.motion, elastic, damping, true, couple);
    // Triangles of a fan, each by the midpoints of its sides: exact for the quadratic integrand of the torque.
    double normal = 0;
    Vec3 torque = Vec3::Zero();
    const Polygon& p = patch.polygon;
    for (int k = 2; k < p.count; ++k) {
      const double weight = cross(p[k - 1] - p[0], p[k] - p[0]) / 6;
      for (const Vec2& x : {Vec2(p[0] + p[k - 1]), Vec2(p[k - 1] + p[k]), Vec2(p[k] + p[0])}) {
        const Vec3 arm = patch.toWorld(0.5 * x - patch.point());
        const double speed = patch.motion.normal.dot(patch.motion.velocity + patch.motion.spin.cross(arm));
        const double force = damping / patch.moments.area * speed * weight;
        normal += force;
        torque -= arm.cross(force * patch.motion.normal);
      }
    }
    EXPECT_NEAR(push, elastic + normal, 1e-13);
    EXPECT_NEAR((couple - torque).norm(), 0, 1e-13);
  }
}

TEST(PatchDashpot, TakesEnergyFromEveryMotion) {
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const RandomPatch patch(random);
    const double elastic = random.uniform(0, 2), damping = random.uniform(0, 3);
    for (const bool tension : {true, false}) {
      Vec3 couple;
      const double push = pressPatch(patch.motion, elastic, damping, tension, couple);
      // The dashpot's part of the power on A relative to B: all but the elastic force at the contact point.
      const double power =
          -(push - elastic) * patch.motion.normal.dot(patch.motion.velocity) + couple.dot(patch.motion.spin);
      EXPECT_LE(power, 1e-13);
    }
  }
}

TEST(PatchDashpot, NeverPullsNorLeavesThePolygonWithoutTension) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const RandomPatch patch(random);
    Vec3 couple;
    const double push = pressPatch(patch.motion, random.uniform(0, 2), random.uniform(0, 3), false, couple);
    ASSERT_GE(push, 0);
    if (push < 1e-9) {
      EXPECT_LT(couple.norm(), 1e-8);
      continue;
    }
    // couple = -S x n = n x S, so that S = couple x n.
    const Vec3 s = couple.cross(patch.motion.normal) / push;
    const Vec2 at = patch.point() + Vec2(s.dot(patch.motion.u), s.dot(patch.v));
    Polygon grown = patch.polygon;
    for (int k = 0; k < grown.count; ++k) grown[k] += 1e-6 * (grown[k] - patch.moments.centroid());
    EXPECT_TRUE(test::isInside(grown, at)) << i;
  }
}

TEST(PatchDashpot, IsContinuousInTheMotion) {
  // Along lines through the space of motions, with and without tension: no step larger than its slope allows.
  Random random(6);
  for (int i = 0; i < 50; ++i) {
    RandomPatch patch(random);
    const Vec3 v0 = patch.motion.velocity, w0 = patch.motion.spin, v1 = 3 * random.direction(),
               w1 = 3 * random.direction();
    for (const bool tension : {true, false}) {
      double lastPush = 0;
      Vec3 lastCouple, couple;
      const int steps = 4000;
      for (int k = 0; k <= steps; ++k) {
        const double t = double(k) / steps;
        patch.motion.velocity = (1 - t) * v0 + t * v1;
        patch.motion.spin = (1 - t) * w0 + t * w1;
        const double push = pressPatch(patch.motion, .5, 1, tension, couple);
        if (k > 0) {
          // Projections don't stretch in their metric, and the polygons are at most 2 across.
          ASSERT_LT(std::abs(push - lastPush), 40.0 / steps) << i;
          ASSERT_LT((couple - lastCouple).norm(), 80.0 / steps) << i << " " << k;
        }
        lastPush = push;
        lastCouple = couple;
      }
    }
  }
}

TEST(PatchDashpot, OfATranslationWithTensionIsThePaper) {
  Random random(7);
  for (int i = 0; i < 100; ++i) {
    RandomPatch patch(random);
    patch.motion.spin.setZero();
    Vec3 couple;
    const double push = pressPatch(patch.motion, .5, 1, true, couple);
    EXPECT_NEAR(push, .5 + patch.motion.normal.dot(patch.motion.velocity), 1e-14);
  }
}

TEST(PatchDashpot, OfADegenerateSliverStaysFinite) {
  ContactMotion m = makeMotion(1e-3);
  m.area = 1e-300;
  m.uu = 1;
  m.spin = Vec3(1, 1, 1);
  for (const bool tension : {true, false}) {
    LawOptions options;
    options.tension = tension;
    ContactHistory history;
    ContactForce out;
    applyLinearLaw(makeLaw(), options, makeBody(), {}, m, history, out);
    EXPECT_TRUE(out.force.allFinite() && out.couple.allFinite() && std::isfinite(history.twist));
    m.uu = 0;
    applyLinearLaw(makeLaw(), options, makeBody(), {}, m, history, out);
    EXPECT_TRUE(out.force.allFinite() && out.couple.allFinite() && std::isfinite(history.twist));
  }
}

TEST(Twist, IsSprungAndThenHeldByFriction) {
  // A square patch of side 2e-3 under 1 N, turned slowly: spring, then mu N (2/3) sqrt(area/pi).
  ContactMotion m = makeMotion(1e-4);
  m.area = 4e-6;
  m.uu = m.vv = 4e-6 / 12;
  m.turn = Vec3(0, 0, 1e-5);
  ContactHistory history;
  ContactForce out;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, out);
  const double stiffness =
      stiffnessOf(LawKind::linear, makeLaw(), {}, makeBody(), {}, m.normal).tangential * (m.uu + m.vv);
  EXPECT_NEAR(out.couple.z() / (-stiffness * 1e-5), 1, 1e-12);
  EXPECT_NEAR(out.couple.head<2>().norm(), 0, 1e-18);

  m.turn.z() = 1;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, out);
  const double limit = .3 * 1 * 2 / 3 * std::sqrt(4e-6 / pi);
  EXPECT_NEAR(out.couple.z() / -limit, 1, 1e-12);
  EXPECT_NEAR(history.twist * stiffness / limit, 1, 1e-12);

  // Turned back, it unloads along the spring at once.
  m.turn.z() = -1e-5;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, out);
  EXPECT_NEAR(out.couple.z(), -limit + stiffness * 1e-5, 1e-12 * limit);

  // Faster than the dashpot allows: no spring.
  m.spin.z() = 1e9;
  applyLinearLaw(makeLaw(), {}, makeBody(), {}, m, history, out);
  EXPECT_EQ(history.twist, 0);
  EXPECT_NEAR(out.couple.z() / -limit, 1, 1e-9);
}

}  // namespace
}  // namespace granular
