// (b) A frictionless rigid body on a wall: with the contact point frozen, J = m (1 + e) v/(1 + m r_x^2/I) with r_x the
// offset of the contact point from the centroid along the wall, v_z' = -v + J/m and w' = J r_x/I.
#include <fmt/format.h>

#include "verification/impact_scenes.h"
#include "verification/record.h"

namespace granular {
namespace {

Rebound drop(const std::shared_ptr<const Shape>& shape, const Quat& q, const ContactParameters& contact,
             bool localMass) {
  const Rebound got = dropOnFloor(shape, q, contact, localMass, {PointRule::witness, LawKind::linear, 4000});
  EXPECT_TRUE(got.parted);
  return got;
}

TEST(Walls, TiltedCylinderReboundsAsTheFrozenContactSays) {
  struct Case {
    double degrees, e, spin, velocity;
  };
  for (const Case& c : {Case{30, .85, 362.5, .0746}, Case{45, .85, 243.5, .6175}, Case{45, 1, 263.3, .7487}}) {
    const double tilt = c.degrees * pi / 180;
    const Rebound got = drop(TiltedCylinder::make(), tiltedBy(tilt), {1e9, c.e, 1, 0}, true);
    const double scale = got.turn + 2e-3;  // the dashpot's restitution at N = 4000 steps: 1e-5; half the last digit
    verify('b', fmt::format("cylinder, {} deg, e = {}, local mass: w', rad/s", c.degrees, c.e), c.spin, got.spin,
           scale * c.spin * 0.1 + .05, "exact, four digits; the turn during the contact");
    verify('b', fmt::format("cylinder, {} deg, e = {}, local mass: v_z'", c.degrees, c.e), c.velocity, got.velocity,
           scale * 0.2 + 5e-5, "exact, four digits; the turn during the contact");
    const FrozenContact exact = solveFrozenContact(c.e, TiltedCylinder::offset(tilt), TiltedCylinder::moment);
    EXPECT_NEAR(exact.spin, c.spin, .05);
    EXPECT_NEAR(exact.velocity, c.velocity, 5e-5);
  }
}

TEST(Walls, NominalDashpotOfTheReducedMassDampsEccentricContactsMore) {
  // S 15 with mu: the contact feels m_n = m/(1 + m r_x^2/I) < m, so that the restitution is that of a larger damping
  // ratio zeta sqrt(m/m_n).
  const double rows[][3] = {{30, .050, 354.2}, {45, .6092, 242.3}};
  for (const auto& [degrees, velocity, spin] : rows) {
    const Rebound got = drop(TiltedCylinder::make(), tiltedBy(degrees * pi / 180), {1e9, .85, 1, 0}, false);
    verify('b', fmt::format("cylinder, {} deg, e = .85, reduced mass: v_z'", degrees), velocity, got.velocity,
           got.turn * 0.2 + (degrees == 30 ? 5e-4 : 1e-4), "independent computation, digits as given; the turn");
    verify('b', fmt::format("cylinder, {} deg, e = .85, reduced mass: w', rad/s", degrees), spin, got.spin,
           got.turn * 0.1 * spin + .05, "independent computation, four digits; the turn");
  }
}

TEST(Walls, CylinderOverItsRimDoesNotTurn) {
  const double tilt = std::atan(2 * 4e-3 / 5.3e-3);
  const Rebound got = drop(TiltedCylinder::make(), tiltedBy(tilt), {1e9, 1, 1, 0}, true);
  verify('b', "cylinder, tan t = 2R/L: v_z'", 1, got.velocity, 1e-5, "exact: r_x = 0");
  verifyBelow('b', "cylinder, tan t = 2R/L: w' R/v", 1e-4, got.spin * 4e-3, "exact: 0");
}

TEST(Walls, EllipsoidReboundsAsTheFrozenContactSays) {
  // a:b = 2:1; long axis at angle t from the wall.
  const double rows[][3] = {{15, .36205, .93216}, {30, .01818, .99983}};
  const double b = 2e-3;
  const auto shape = makeShape("ellipsoid", std::vector{2 * b, b, b});
  for (const auto& [degrees, velocity, spin] : rows) {
    const Rebound got = drop(shape, tiltedBy(degrees * pi / 180), {1e9, 1, 1, 0}, false);
    verify('b', fmt::format("ellipsoid 2:1, {} deg: v_z'/v", degrees), velocity, got.velocity, got.turn + 5e-6,
           "exact, five digits; the turn during the contact");
    verify('b', fmt::format("ellipsoid 2:1, {} deg: w' b/v", degrees), spin, got.spin * b, got.turn + 5e-6,
           "exact, five digits; the turn during the contact");
  }
}

TEST(Walls, ErrorFallsAsTheContactGetsShorter) {
  // The error is the turn w' t_c ~ k^-1/2: a hundred times the stiffness leaves a tenth.
  const FrozenContact exact = solveFrozenContact(1, TiltedCylinder::offset(pi / 4), TiltedCylinder::moment);
  double errors[3];
  int k = 0;
  for (const double stiffness : {1e5, 1e7, 1e9}) {
    const Rebound got = drop(TiltedCylinder::make(), tiltedBy(pi / 4), {stiffness, 1, 1, 0}, false);
    errors[k++] = std::abs(got.velocity - exact.velocity);
    if (got.turn < .01)
      verifyBelow('b', fmt::format("cylinder, 45 deg, k_n = {:g}: error of v_z' (w' t_c < .01)", stiffness), .01,
                  errors[k - 1], "below 1 % once w' t_c < .01");
  }
  verify('b', "cylinder, 45 deg: error at k_n = 1e7 over that at 1e5", .1, errors[1] / errors[0], .05,
         "w' t_c ~ 1/sqrt(k_n), higher orders at 1e5");
  verify('b', "cylinder, 45 deg: error at k_n = 1e9 over that at 1e7", .1, errors[2] / errors[1], .02,
         "w' t_c ~ 1/sqrt(k_n)");
}

}  // namespace
}  // namespace granular
