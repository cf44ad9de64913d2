// (a) Single impacts of spheres: the sliding and sticking tests of Chung & Ooi (Granular Matter 13, 643, 2011) that any
// law must pass whose friction never exceeds mu max(F_n, 0). Their tests 1 and 2 are of Hertz's force itself.
#include <fmt/format.h>

#include "verification/impact_scenes.h"
#include "verification/record.h"

namespace granular {
namespace {

const char* const exact = "exact for sliding throughout; step and overlap";

/// Relative errors of the result: the restitution of a contact cut at zero is known to .35/N of a step at N steps per
/// contact (measured independently: 7e-3 at 50, 3.5e-3 at 100), and the arm is short by the overlap.
struct Impact : SphereImpact {
  static constexpr double steps = 2000;
  static constexpr double tolerance = 0.35 / steps + 2 * depth;
};

TEST(Impacts, RestitutionIsTheOneAskedFor) {
  // Test 3: R 2.5 mm, 3.9 m/s.
  for (const double e : {0.2, 0.4, 0.6, 0.8, 1.0}) {
    Impact impact{{2.5e-3, 3.9, 0, 0, 0, e}};
    ASSERT_TRUE(impact.run());
    verify('a', fmt::format("test 3, e = {}: v'/v", e), e, impact.velocity.z() / 3.9, Impact::tolerance,
           "Chung & Ooi test 3; .35/N of the step");
  }
}

TEST(Impacts, ObliqueImpactsSlideAboveTheLimitingAngle) {
  // Test 4: R 2.5 mm, 3.9 m/s, mu .092, e .98.
  const double rows[][3] = {{45, .8178, 502.3}, {60, .8948, 355.2}, {75, .9512, 183.9}};
  for (const auto& [degrees, ratio, spin] : rows) {
    const double angle = degrees * pi / 180;
    Impact impact{{2.5e-3, 3.9 * std::cos(angle), 3.9 * std::sin(angle), 0, .092, .98}};
    ASSERT_TRUE(impact.run());
    verify('a', fmt::format("test 4, {} deg: v_t'/v_t", degrees), ratio, impact.velocity.x() / impact.tangential,
           Impact::tolerance * (1 - ratio) + 5e-5, "Chung & Ooi test 4, four digits; step and overlap");
    verify('a', fmt::format("test 4, {} deg: spin, rad/s", degrees), spin, impact.turning.y(),
           Impact::tolerance * spin + .05, "Chung & Ooi test 4, four digits; step and overlap");
  }
  // The limit is tan = 3.5 mu (1 + e): a degree above it slides throughout, so the closed form holds; well below
  // it sticks and the spin stays below it.
  for (const double degrees : {15.0, 33.5}) {
    const double angle = degrees * pi / 180;
    Impact impact{{2.5e-3, 3.9 * std::cos(angle), 3.9 * std::sin(angle), 0, .092, .98}};
    ASSERT_TRUE(impact.run());
    const double sliding = 2.5 * .092 * 1.98 * impact.normal / impact.radius;
    if (degrees > 32.52) {
      verify('a', fmt::format("test 4, {} deg (above 32.52): spin over sliding throughout", degrees), 1,
             impact.turning.y() / sliding, Impact::tolerance, exact);
    } else {
      verifyThat('a', fmt::format("test 4, {} deg (below 32.52): spins less than sliding throughout", degrees),
                 impact.turning.y() < (1 - 2 * Impact::tolerance) * sliding, "Chung & Ooi test 4: sticks");
    }
  }
}

TEST(Impacts, MicrometreSphereRecoilsByItsSlipLessSeven) {
  // Test 5: R 10 um, v_n 5, mu .3, e 1; x = v_t/(mu v_n) >= 7: R w'/(mu v_n) = 5, recoil of the contact point x - 7.
  for (const double x : {8.0, 12.0, 20.0}) {
    const double scale = .3 * 5;
    Impact impact{{1e-5, 5, x * scale, 0, .3, 1}};
    ASSERT_TRUE(impact.run());
    const double turn = impact.radius * impact.turning.y();
    verify('a', fmt::format("test 5, v_t/(mu v_n) = {}: R w'/(mu v_n)", x), 5, turn / scale, 5 * Impact::tolerance,
           exact);
    verify('a', fmt::format("test 5, v_t/(mu v_n) = {}: recoil/(mu v_n)", x), x - 7,
           (impact.velocity.x() - turn) / scale, 7 * Impact::tolerance, exact);
  }
}

TEST(Impacts, SpinningSphereIsThrownAside) {
  // Test 6: R .1, v_n .2, mu .4, e .5; spin >= 4.2: v_t' = .12, w' = w - 3.
  for (const double spin : {4.5, 8.0, 15.0}) {
    Impact impact{{.1, .2, 0, spin, .4, .5}};
    ASSERT_TRUE(impact.run());
    verify('a', fmt::format("test 6, w = {} rad/s: v_t'", spin), .12, std::abs(impact.velocity.x()),
           .12 * Impact::tolerance, exact);
    verify('a', fmt::format("test 6, w = {} rad/s: w - w'", spin), 3, spin - impact.turning.y(), 3 * Impact::tolerance,
           exact);
  }
}

/// Two spheres at +-0.2 m/s with equal spins, or one against a still giant.
struct Meeting {
  Vec3 velocity, turning;
  static Meeting run(double radiusB, double densityB, const Vec3& velocityA, const Vec3& velocityB, double spinB) {
    const double radius = .1, mass = 2500 * 4.0 / 3 * pi * std::pow(radius, 3);
    const double stiffness = mass * std::pow(.2 / (Impact::depth * radius), 2);
    auto world = makeWorld(plainOptions(), {stiffness, .5, .5, .4});
    place(*world, sphereOf(radius), Vec3::Zero());
    place(*world, sphereOf(radiusB), {(radius + radiusB) * (1 + 1e-12), 0, 0}, Quat::Identity(), densityB);
    move(*world, 0, velocityA, {0, 0, 8});
    move(*world, 1, velocityB, {0, 0, spinB});
    const double duration = pi * std::sqrt(.5 * mass / stiffness);
    EXPECT_TRUE(runThroughContact(*world, duration / Impact::steps, 4 * 2000));
    return {velocityOf(*world, 0), spinOf(*world, 0)};
  }
};

TEST(Impacts, TwoSpheresWithSpinsOfOneSignAreThrownAside) {
  const Meeting after = Meeting::run(.1, 2500, {.2, 0, 0}, {-.2, 0, 0}, 8);
  verify('a', "test 7: v_t'", .12, std::abs(after.velocity.y()), .12 * Impact::tolerance, exact);
  verify('a', "test 7: w - w'", 3, 8 - after.turning.z(), 3 * Impact::tolerance, exact);
  verify('a', "test 7: v_n'", -.1, after.velocity.x(), .1 * 2 * Impact::tolerance, exact);
}

TEST(Impacts, GiantActsAsAWall) {
  // Test 8: R .5 and a thousand times the density: the giant gives way by m/M = 8e-6.
  const Meeting after = Meeting::run(.5, 2.5e6, {.2, 0, 0}, Vec3::Zero(), 0);
  const double tolerance = Impact::tolerance + 2 * 8e-6;
  verify('a', "test 8: v_t'", .12, std::abs(after.velocity.y()), .12 * tolerance, exact);
  verify('a', "test 8: w - w'", 3, 8 - after.turning.z(), 3 * tolerance, exact);
}

TEST(Impacts, StickingContactTurnsTheTangentialVelocityByTheRatioOfStiffnesses) {
  // e = 1, mu -> infinity: v_ct'/v_ct = cos(pi sqrt(3.5 k_t/k_n)). The law's k_t/k_n = m_t/mu is set by the radius
  // ratio. Error: the spring's first increment is early by up to a step, pi/N of phase, where the sine is not zero.
  const double rows[][2] = {{2.0 / 7, -1}, {.5, -.528}, {.8, .518}};
  for (const auto& [ratio, expected] : rows) {
    const double radius = 3e-3, mass = 2500 * 4.0 / 3 * pi * std::pow(radius, 3), depth = 1e-5, normal = .1;
    const double stiffness = mass * std::pow(normal / (depth * radius), 2), steps = 4000;
    auto world = makeWorld(plainOptions(), {stiffness, 1, 1, 1e9});
    addFloor(*world);
    place(*world, sphereOf(radius), {0, 0, radius * (1 + 1e-9)});
    world->bodies.motion[0].radiusRatio = (1 / ratio - 1) / mass;
    move(*world, 0, {.1, 0, -normal});
    ASSERT_TRUE(runThroughContact(*world, pi * std::sqrt(mass / stiffness) / steps, 8000));
    const double after = (velocityOf(*world, 0).x() - radius * spinOf(*world, 0).y()) / .1;
    verify('a', fmt::format("sticking, k_t/k_n = {:.3g}: v_ct'/v_ct", ratio), expected, after,
           5e-4 + pi / steps * std::sqrt(3.5 * ratio) + 4 * depth, "exact, three digits; a step of phase, overlap");
  }
}

}  // namespace
}  // namespace granular
