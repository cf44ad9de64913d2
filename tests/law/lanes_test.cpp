// Laws of contacts side by side against the same law one by one, to the bit.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "granular/core/random.h"
#include "granular/law/contact_lanes.h"
#include "granular/law/hertz.h"

namespace granular {
namespace {

/// A contact as a law is asked about it, and how its parties move.
struct Asked {
  struct Party {
    Vec3 v, w, vHalf, spinHalf;
  };
  ContactBody a, b;
  Party moveA, moveB;
  const LawConstants* constants = nullptr;
  ContactMotion motion;
  ContactHistory history;
};

constexpr double dt = 1e-6;

Asked::Party makeMotion(Random& random) {
  const double speed = std::pow(10, random.uniform(-4, 0)), spin = std::pow(10, random.uniform(-1, 3));
  Asked::Party party{speed * random.direction(), spin * random.direction(), {}, {}};
  party.vHalf = party.v + 0.1 * speed * random.direction();
  party.spinHalf = party.w + 0.1 * spin * random.direction();
  return party;
}

/// A patch: thin or wide, its centre near the contact point, at its rim or beyond. Now and then a sliver without
/// moments.
void addPatch(Random& random, ContactMotion& m) {
  const double size = std::pow(10, random.uniform(-5, -3)), angle = random.uniform(0, pi);
  const double flat = random.below(3) == 0 ? 1e-3 : 1, turn = random.uniform(0, pi);
  m.u = std::cos(turn) * perpendicular(m.normal) + std::sin(turn) * m.normal.cross(perpendicular(m.normal));
  m.area = size * size * flat;
  const double c = std::cos(angle), s = std::sin(angle), big = size * size / 12, small = big * flat * flat;
  m.uu = big * c * c + small * s * s;
  m.vv = big * s * s + small * c * c;
  m.uv = (big - small) * c * s;
  m.centreArm = size * random.uniform(0, 1) * m.normal.cross(random.direction());
  if (random.below(20) == 0) m.uu = m.vv = m.uv = 0;
}

Asked makeAsked(Random& random, const std::vector<LawConstants>& constants, double rocking, double patches) {
  Asked asked;
  asked.constants = &constants[random.below(constants.size())];
  ContactMotion& m = asked.motion;
  m.normal = random.direction();
  m.overlap = std::pow(10, random.uniform(-9, -4));
  m.squaredDepth = m.overlap * m.overlap * random.uniform(0.5, 1);
  m.radius = std::pow(10, random.uniform(-4, -2));
  m.share = random.below(2) ? 1 : random.uniform(0.1, 1);
  m.dt = dt;
  m.rocking = rocking;
  m.centreArm = m.u = Vec3::Zero();
  asked.moveA = makeMotion(random);
  asked.moveB = makeMotion(random);
  // B may be a wall, as the step describes it.
  const bool wall = random.below(4) == 0;
  for (ContactBody* body : {&asked.a, &asked.b}) {
    if (wall && body == &asked.b) continue;
    body->inverseMass = std::pow(10, random.uniform(3, 5));
    body->radiusRatio = random.uniform(1.5, 3) * body->inverseMass;
    body->arm = (body == &asked.a ? 1e-3 : -1e-3) * (m.normal + 0.3 * random.direction());
  }
  if (random.uniform() < patches) addPatch(random, m);

  // Born, or older, with a normal that has turned a little or all round.
  if (random.below(4) != 0) {
    ContactHistory& history = asked.history;
    history.normal = (m.normal + std::pow(10, random.uniform(-6, 0)) * random.direction()).normalized();
    if (random.below(30) == 0) history.normal = -m.normal;
    history.spring = std::pow(10, random.uniform(-10, -5)) * history.normal.cross(random.direction());
    history.twist = m.area > 0 ? std::pow(10, random.uniform(-7, -3)) * random.normal() : 0;
  }

  // As the step sees the contact.
  const Asked::Party &A = asked.moveA, &B = asked.moveB;
  const Vec3 &armA = asked.a.arm, &armB = asked.b.arm;
  m.velocity = A.v + A.w.cross(armA) - (B.v + B.w.cross(armB));
  m.slip = (A.vHalf + A.spinHalf.cross(armA) - (B.vHalf + B.spinHalf.cross(armB))) * dt;
  m.spin = A.w - B.w;
  m.meanSpin = 0.5 * (A.w + B.w);
  m.turn = (A.spinHalf - B.spinHalf) * dt;
  return asked;
}

void put(std::size_t k, const ContactBody& body, const Asked::Party& moves, ContactLanes::Party& party) {
  party.arm.put(k, body.arm);
  party.v.put(k, moves.v);
  party.w.put(k, moves.w);
  party.vHalf.put(k, moves.vHalf);
  party.spinHalf.put(k, moves.spinHalf);
  party.inverseMass[k] = body.inverseMass;
  party.radiusRatio[k] = body.radiusRatio;
}

void put(std::size_t k, const Asked& asked, bool tension, ContactLanes& lanes) {
  const ContactMotion& m = asked.motion;
  put(k, asked.a, asked.moveA, lanes.a);
  put(k, asked.b, asked.moveB, lanes.b);
  lanes.putConstants(k, *asked.constants, tension, true);
  lanes.normal.put(k, m.normal);
  lanes.overlap[k] = m.overlap;
  lanes.radius[k] = m.radius;
  lanes.squaredDepth[k] = m.squaredDepth;
  lanes.share[k] = m.share;
  lanes.area[k] = m.area;
  if (!(m.area > 0)) return;  // what is left in the other lanes must not matter
  lanes.centreArm.put(k, m.centreArm);
  lanes.u.put(k, m.u);
  lanes.uu[k] = m.uu;
  lanes.vv[k] = m.vv;
  lanes.uv[k] = m.uv;
}

/// One sign of zero, and the bits of everything else.
std::vector<double> bitsOf(const ContactForce& f, const ContactHistory& h, const Vec3& torqueA, const Vec3& torqueB) {
  std::vector<double> bits = {f.normalForce + 0, double(f.sliding), h.twist + 0};
  for (const Vec3& v : {f.force, f.couple, h.spring, h.normal, torqueA, torqueB}) {
    for (int k = 0; k < 3; ++k) bits.push_back(v[k] + 0);
  }
  return bits;
}

struct Tally {
  int contacts = 0, sliding = 0, viscous = 0, twistSlides = 0, pulls = 0, tilted = 0;
};

/// What this contact exercised.
void tally(const Asked& asked, Law alone, const LawOptions& options, const ContactHistory& after,
           const ContactForce& force, Tally& sum) {
  ++sum.contacts;
  sum.sliding += force.sliding;
  sum.viscous += force.sliding && after.spring.isZero();
  sum.pulls += force.normalForce < 0;
  if (!(asked.motion.area > 0)) return;
  const double turned = asked.history.twist + asked.motion.normal.dot(asked.motion.turn);
  sum.twistSlides += asked.constants->parameters.friction > 0 && after.twist != turned;
  // A patch whose force is not that of a point.
  ContactMotion free = asked.motion;
  free.area = 0;
  ContactHistory none;
  ContactForce plain;
  alone(*asked.constants, options, asked.a, asked.b, free, none, plain);
  sum.tilted += std::abs(plain.normalForce - force.normalForce) > 1e-12 * std::abs(force.normalForce);
}

class LawsInLanes : public ::testing::TestWithParam<LawKind> {};

TEST_P(LawsInLanes, HaveTheSameBitsAsOneByOne) {
  const Law alone = lawFunction(GetParam());
  std::vector<LawConstants> constants;
  for (ContactParameters p :
       {ContactParameters{1e4, .8, .6, .3}, ContactParameters{2e5, 1, 1, .5}, ContactParameters{1e4, .3, .9, 0},
        ContactParameters{1e3, .05, .05, .1}, ContactParameters{1e4, .8, .6, 1e3}}) {
    setElasticity({p.stiffness * 1e3, .3}, {p.stiffness * 1e3, .2}, p);
    p.dampingRateN = p.dampingRateT = -1e3 * std::log(p.restitution);
    constants.push_back(prepareLaw(p));
  }
  Random random(11);
  for (int choice = 0; choice < 8; ++choice) {
    LawOptions options;
    options.tension = choice & 1;
    options.frictionOfPush = choice & 2;
    options.slideAlongVelocity = choice & 4;
    const LawInLanes law = lawInLanes(GetParam(), options);
    ASSERT_TRUE(law);
    Tally sum;
    ContactLanes lanes{};
    for (int round = 0; round < 3000; ++round) {
      // None, some or all with patches; any number of lanes.
      const double patches = std::array{0.0, 0.2, 1.0}[static_cast<std::size_t>(round % 3)];
      lanes.count = 1 + random.below(ContactLanes::capacity);
      lanes.dt = dt;
      lanes.rocking = random.below(2) ? 1 : random.uniform(1, 8);
      std::vector<Asked> all;
      for (std::size_t k = 0; k < lanes.count; ++k) {
        all.push_back(makeAsked(random, constants, lanes.rocking, patches));
        put(k, all.back(), options.tension, lanes);
      }
      std::vector<Contact> found(lanes.count);
      std::vector<ContactHistory> kept(lanes.count);
      std::array<Contact*, ContactLanes::capacity> contactAt;
      std::array<ContactHistory*, ContactLanes::capacity> historyAt;
      for (std::size_t k = 0; k < ContactLanes::capacity; ++k) {
        const std::size_t last = std::min(k, lanes.count - 1);
        kept[last] = all[last].history;
        contactAt[k] = &found[last];
        historyAt[k] = &kept[last];
      }
      for (std::size_t k = 0; k < lanes.count; k += wideSize) lanes.putHistories(k, &historyAt[k]);
      law(options, lanes);
      for (std::size_t k = 0; k < lanes.count; k += wideSize) {
        const std::size_t some = std::min(wideSize, lanes.count - k);
        lanes.takeForces(k, some, &contactAt[k]);
        lanes.takeHistories(k, some, &historyAt[k]);
      }
      for (std::size_t k = 0; k < lanes.count; ++k) {
        const Asked& asked = all[k];
        ContactForce expected;
        ContactHistory history = asked.history;
        alone(*asked.constants, options, asked.a, asked.b, asked.motion, history, expected);
        const Vec3 torqueA = asked.a.arm.cross(expected.force) + expected.couple;
        const Vec3 torqueB = -asked.b.arm.cross(expected.force) - expected.couple;
        const auto wanted = bitsOf(expected, history, torqueA, torqueB);
        const auto given = bitsOf(found[k].force, kept[k], found[k].torqueA, found[k].torqueB);
        ASSERT_EQ(std::memcmp(wanted.data(), given.data(), 8 * wanted.size()), 0)
            << "options " << choice << ", round " << round << ", lane " << k << " of " << lanes.count << ", area "
            << asked.motion.area << ", friction " << asked.constants->parameters.friction << ", forces "
            << expected.force.transpose() << " and " << found[k].force.force.transpose();
        tally(asked, alone, options, history, expected, sum);
      }
    }
    // Nothing was left out.
    for (const int part : {sum.sliding, sum.contacts - sum.sliding, sum.viscous, sum.twistSlides, sum.tilted}) {
      EXPECT_GT(part, 500) << "options " << choice;
    }
    EXPECT_EQ(sum.pulls > 500, options.tension);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, LawsInLanes, ::testing::Values(LawKind::linear, LawKind::hertz, LawKind::hertzMindlin),
                         [](const auto& info) { return std::string(lawName(info.param)); });

TEST(Laws, WithoutLanesSaySo) {
  LawOptions options;
  for (const LawKind kind : {LawKind::linear, LawKind::hertz, LawKind::hertzMindlin}) {
    EXPECT_TRUE(lawInLanes(kind, options)) << lawName(kind);
  }
  for (const LawKind kind : {LawKind::linearLocal, LawKind::tensor}) {
    EXPECT_FALSE(lawInLanes(kind, options)) << lawName(kind);
  }
  options.localMass = true;
  for (const LawKind kind : {LawKind::linear, LawKind::hertz}) EXPECT_FALSE(lawInLanes(kind, options)) << lawName(kind);
}

}  // namespace
}  // namespace granular
