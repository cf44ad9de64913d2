// Hertz's contact: the elastic impacts of Chung & Ooi (tests 1 and 2), rest on a plane, small swings about it, and the
// restitution of the damped contact.
#include <fmt/format.h>

#include "verification/record.h"
#include "verification/scenes.h"

namespace granular {
namespace {

struct Solid {
  const char* name;
  Elasticity elasticity;
  double density;
};

ContactParameters contactOf(const Elasticity& a, const Elasticity& b, double e, double friction) {
  ContactParameters p;
  p.restitution = e;
  p.friction = friction;
  setElasticity(a, b, p);
  return p;
}

WorldOptions hertzOptions() {
  WorldOptions options = plainOptions();
  options.law = LawKind::hertzMindlin;
  return options;
}

double massOf(const World& world, std::size_t i) { return world.bodies.mass[i]; }

/// What the contact of an impact went through.
struct Course {
  double force = 0, overlap = 0, time = 0;
};
Course follow(World& world, double dt) {
  startHalfSteps(world, dt, 0, true);
  Course course;
  bool touched = false;
  for (int n = 0; n < 100000; ++n) {
    step(world, dt);
    const bool touching = world.contactCount() > 0;
    if (touched && !touching) return course;
    touched |= touching;
    if (touching) course.time += dt;
    world.visitContacts([&](const Contact& c) {
      course.force = std::max(course.force, c.force.normalForce);
      course.overlap = std::max(course.overlap, c.touch.overlap);
    });
  }
  ADD_FAILURE() << "the contact does not end";
  return course;
}

void verifyCourse(const std::string& name, const Course& got, double force, double overlap, double time) {
  // Figures of four digits. A contact is counted in whole steps, 1/2000 of it each.
  const char* source = "Chung & Ooi, four digits";
  verify('a', name + ": largest force, kN", force, got.force / 1e3, 5e-4 * force, source);
  verify('a', name + ": largest overlap, um", overlap, got.overlap * 1e6, 5e-4 * overlap, source);
  verify('a', name + ": duration, us", time, got.time * 1e6, (1.0 / 2000 + 2e-4) * time, "Chung & Ooi; whole steps");
}

TEST(Hertz, TwoSpheresCollideElastically) {
  // Test 1: R .01 m, 10 m/s each.
  const struct {
    Solid solid;
    double force, overlap, time;
  } rows[] = {{{"glass", {48e9, .2}, 2800}, 10.70, 274.1, 40.34},
              {{"limestone", {20e9, .25}, 2500}, 7.108, 368.3, 54.20}};
  for (const auto& row : rows) {
    auto world = makeWorld(hertzOptions(), contactOf(row.solid.elasticity, row.solid.elasticity, 1, 0));
    const double R = .01;
    place(*world, sphereOf(R), {-R * (1 + 1e-12), 0, 0}, Quat::Identity(), row.solid.density);
    place(*world, sphereOf(R), {R * (1 + 1e-12), 0, 0}, Quat::Identity(), row.solid.density);
    move(*world, 0, {10, 0, 0});
    move(*world, 1, {-10, 0, 0});
    verifyCourse(fmt::format("test 1, {}", row.solid.name), follow(*world, row.time * 1e-6 / 2000), row.force,
                 row.overlap, row.time);
  }
}

TEST(Hertz, SphereMeetsARigidWallElastically) {
  // Test 2: R .1 m, .2 m/s.
  const struct {
    Solid solid;
    double force, overlap, time;
  } rows[] = {{{"aluminium", {70e9, .3}, 2699}, 11.37, 49.72, 731.6},
              {{"magnesium", {40e9, .35}, 1800}, 7.233, 52.12, 767.1}};
  for (const auto& row : rows) {
    auto world = makeWorld(hertzOptions(), contactOf(row.solid.elasticity, {infinity, .3}, 1, 0));
    addFloor(*world);
    place(*world, sphereOf(.1), {0, 0, .1 * (1 + 1e-12)}, Quat::Identity(), row.solid.density);
    move(*world, 0, {0, 0, -.2});
    verifyCourse(fmt::format("test 2, {}", row.solid.name), follow(*world, row.time * 1e-6 / 2000), row.force,
                 row.overlap, row.time);
  }
}

/// A body at rest on the floor under its weight, as deep as Hertz says.
struct Resting {
  std::unique_ptr<World> world;
  double depth = 0, omega = 0;  ///< m; of small vertical swings, rad/s

  /// height: of the centre above the lowest point; radius: effective, m.
  Resting(const std::shared_ptr<const Shape>& shape, const Quat& q, double height, double radius, double e) {
    WorldOptions options = hertzOptions();
    options.gravity = {0, 0, -9.81};
    options.lawOptions.tension = true;
    world = makeWorld(options, contactOf({183e6, .2}, {infinity, .3}, e, 1e6));
    addFloor(*world);
    NewBody body;
    body.shapeIndex = world->addShape(shape);
    body.locks = lockRotation(0) | lockRotation(1) | lockRotation(2);
    const double weight = 2500 * shape->massProperties().volume * 9.81;
    depth =
        std::pow(weight / (4.0 / 3 * world->materials.constants(0, 0).parameters.modulus * std::sqrt(radius)), 2.0 / 3);
    omega = std::sqrt(1.5 * 9.81 / depth);
    body.pose = {{0, 0, height - depth}, q};
    body.density = 2500;
    world->addBody(body);
  }
};

TEST(Hertz, BodiesRestAsDeepAsTheirCurvatureSays) {
  // From half the depth, damped: e = .3, ten periods and more.
  const double a = 2.7e-3, b = 1.15e-3;
  const auto grain = makeShape("ellipsoid", std::vector{a, b, b});
  const Quat upright(Eigen::AngleAxisd(pi / 2, Vec3::UnitY()));
  const struct {
    const char* name;
    std::shared_ptr<const Shape> shape;
    Quat q;
    double height, radius;
  } rows[] = {{"sphere", sphereOf(1.15e-3), Quat::Identity(), 1.15e-3, 1.15e-3},
              {"ellipsoid on its waist", grain, Quat::Identity(), b, a},
              {"ellipsoid on its tip", grain, upright, a, b * b / a}};
  for (const auto& row : rows) {
    Resting resting(row.shape, row.q, row.height, row.radius, .3);
    resting.world->bodies.x(0).z() += 0.5 * resting.depth;
    runFor(*resting.world, .02 / resting.omega, 100 / resting.omega);
    const double depth = row.height - resting.world->bodies.x(0).z();
    verify('k', fmt::format("{} on a plane: depth at rest, um", row.name), 1e6 * resting.depth, 1e6 * depth,
           1e6 * resting.depth * 1e-6, "closed form (m g/(4/3 E* sqrt R))^(2/3); what swings on after 100 radians");
  }
}

TEST(Hertz, SwingsAtTheRatioOfItsStiffnesses) {
  // Sideways k_t = 8 G* a, up and down 2 E* a: omega_t^2/omega_n^2 = 2 (1 - nu)/(2 - nu). The leapfrog is fast by
  // (omega dt)^2/24, 2e-7 at .002; the amplitude of 1e-4 of the depth moves the stiffness by less than that.
  Resting resting(sphereOf(1.15e-3), Quat::Identity(), 1.15e-3, 1.15e-3, 1);
  World& world = *resting.world;
  move(world, 0, {1e-4 * resting.depth * resting.omega, 0, 0});
  const double dt = .002 / resting.omega;
  startHalfSteps(world, dt, 0, true);
  // The first crossings of x = 0 upwards, interpolated.
  std::vector<double> crossings;
  double before = world.bodies.x(0).x();
  while (crossings.size() < 11) {
    step(world, dt);
    const double now = world.bodies.x(0).x();
    if (before < 0 && now >= 0) crossings.push_back(world.time - dt * now / (now - before));
    before = now;
  }
  const double omega = 2 * pi * 10 / (crossings.back() - crossings.front());
  verify('k', "sphere held by friction: (omega_t/omega_n)^2", 2 * .8 / 1.8, std::pow(omega / resting.omega, 2), 1e-6,
         "Mindlin without slip: 2 (1 - nu)/(2 - nu); (omega dt)^2/12");
}

TEST(Hertz, DampedImpactHasItsRestitutionAtEverySpeed) {
  // .35/N of the step, as with the linear dashpot, which the contact is in the variable delta^(5/4).
  const double R = 1.15e-3, steps = 4000;
  for (const bool tension : {true, false}) {
    for (const double e : {.9, .5, .2}) {
      for (const double speed : {.1, 2.0}) {
        WorldOptions options = hertzOptions();
        options.lawOptions.tension = tension;
        auto world = makeWorld(options, contactOf({183e6, .2}, {183e6, .2}, e, 0));
        addFloor(*world);
        place(*world, sphereOf(R), {0, 0, R * (1 + 1e-12)});
        move(*world, 0, {0, 0, -speed});
        const double m = massOf(*world, 0), modulus = world->materials.constants(0, 0).parameters.modulus;
        const double time = 2.87 * std::pow(m * m / (R * modulus * modulus * speed), .2);
        ASSERT_TRUE(runThroughContact(*world, time / steps, 40000));
        verify('k', fmt::format("e = {}, {} m/s, {}: v'/v", e, speed, tension ? "attractive end" : "cut at 0"), e,
               velocityOf(*world, 0).z() / speed, 0.35 / steps, "asked for; .35/N of the step");
      }
    }
  }
}

}  // namespace
}  // namespace granular
