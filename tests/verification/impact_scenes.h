// Single impacts with exact answers, for the verification and for the benchmark of error against run time.
#pragma once

#include "verification/scenes.h"

namespace granular {

/// How an impact is computed.
struct ImpactChoice {
  PointRule rule = PointRule::patch;
  LawKind law = LawKind::linear;
  double steps = 2000;  ///< per contact time
  double lead = 0;      ///< phase of the step at which the bodies meet, 0 to 1
};

inline WorldOptions impactOptions(const ImpactChoice& choice) {
  WorldOptions options = plainOptions();
  options.rule.rule = choice.rule;
  options.law = choice.law;
  return options;
}

/// A sphere on the floor. Speeds in m/s, the normal one > 0. e_t = e_n: the tangential dashpot alone then exceeds
/// Coulomb's limit at first touch wherever the contact slides throughout, as rigid friction would; a spring alone
/// sticks until it is stretched, and the friction impulse falls short.
struct SphereImpact {
  double radius, normal, tangential, spin, friction, restitution;
  Vec3 velocity = Vec3::Zero(), turning = Vec3::Zero();  // after

  static constexpr double depth = 1e-4;  ///< largest overlap over the radius

  /// False if the contact does not end.
  bool run(const ImpactChoice& choice = {}) {
    // Stiffness for an overlap of `depth` radii: v t_c/pi = v sqrt(m/k).
    const double mass = 2500 * 4.0 / 3 * pi * std::pow(radius, 3);
    const double stiffness = mass * std::pow(normal / (depth * radius), 2);
    const double dt = pi * std::sqrt(mass / stiffness) / choice.steps;
    auto world = makeWorld(impactOptions(choice), {stiffness, restitution, restitution, friction});
    addFloor(*world);
    place(*world, sphereOf(radius), {0, 0, radius * (1 + 1e-9) + choice.lead * dt * normal});
    move(*world, 0, {tangential, 0, -normal}, {0, spin, 0});
    const bool parted = runThroughContact(*world, dt, static_cast<std::int64_t>(4 * choice.steps) + 4);
    velocity = velocityOf(*world, 0);
    turning = spinOf(*world, 0);
    return parted;
  }
};

/// What a body that falls on the floor with 1 m/s leaves with.
struct Rebound {
  double velocity = 0, spin = 0;  ///< upward, m/s; magnitude, rad/s
  double turn = 0;                ///< spin times the contact time, rad
  bool parted = false;
};

/// Drops a body that touches the floor with its lowest point; read at first separation. localMass: dashpots from the
/// mass that the contact point feels.
inline Rebound dropOnFloor(const std::shared_ptr<const Shape>& shape, const Quat& q, const ContactParameters& contact,
                           bool localMass, const ImpactChoice& choice) {
  WorldOptions options = impactOptions(choice);
  options.lawOptions.tension = true;
  options.lawOptions.localMass = localMass;
  auto world = makeWorld(options, contact);
  addFloor(*world);
  const double height = -(q * shape->support(q.conjugate() * Vec3(0, 0, -1))).z();
  const double duration = pi * std::sqrt(2500 * shape->massProperties().volume / contact.stiffness);
  const double dt = duration / choice.steps;
  place(*world, shape, {0, 0, height * (1 + 1e-12) + choice.lead * dt}, q);
  move(*world, 0, {0, 0, -1});
  // Edges under an elastic foundation last for many contact times.
  const bool parted = runThroughContact(*world, dt, static_cast<std::int64_t>(100 * choice.steps) + 4);
  const double spin = spinOf(*world, 0).norm();
  return {velocityOf(*world, 0).z(), spin, spin * duration, parted};
}

/// The wall's exact answer for a body of mass 1 that falls with 1 m/s, offset r and moment I: its contact point frozen.
struct FrozenContact {
  double velocity, spin;
};
inline FrozenContact solveFrozenContact(double e, double r, double inertia) {
  const double impulse = (1 + e) / (1 + r * r / inertia);
  return {impulse - 1, impulse * r / inertia};
}

/// The cylinder of verification (b): moment per mass about a diameter, and offset of its rim at a tilt, m.
struct TiltedCylinder {
  static constexpr double radius = 4e-3, height = 5.3e-3;
  static constexpr double moment = radius * radius / 4 + height * height / 12;
  static double offset(double tilt) { return radius * std::cos(tilt) - 0.5 * height * std::sin(tilt); }
  static std::shared_ptr<const Shape> make() { return makeShape("cylinder", std::vector{radius, height}); }
};
inline Quat tiltedBy(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitY())); }

/// A sphere that falls on the floor without friction, for the linear dashpot.
struct DashpotBounce {
  static constexpr double radius = 3e-3, speed = 0.3, stiffness = 1e6;
  static double mass() { return 2500 * 4.0 / 3 * pi * radius * radius * radius; }

  double restitution = 0, duration = 0;  ///< v'/v; s of push

  /// Duration of a contact of restitution e, s.
  static double contactTime(double e, bool tension) {
    const double z = dampingRatioFor(e, tension), w = std::sqrt(stiffness / mass());
    if (tension) return pi / (w * std::sqrt(1 - z * z));
    return z < 1 ? 2 * std::acos(z) / (w * std::sqrt(1 - z * z)) : 2 * std::acosh(z) / (w * std::sqrt(z * z - 1));
  }

  /// It touches after `lead` of a step.
  static DashpotBounce run(double e, bool tension, double dt, double lead) {
    WorldOptions options = plainOptions();
    options.lawOptions.tension = tension;
    auto world = makeWorld(options, {stiffness, e, 1, 0});
    addFloor(*world);
    place(*world, sphereOf(radius), {0, 0, radius + lead * dt * speed});
    move(*world, 0, {0, 0, -speed});
    startHalfSteps(*world, dt, 0, true);
    // Read at the first separation: nothing changes the velocity of the half step any more.
    double pushed = 0;
    bool touched = false;
    while (world->time < 1) {
      step(*world, dt);
      const bool touching = world->contactCount() > 0;
      if (touched && !touching) break;
      touched |= touching;
      if (touching) world->visitContacts([&](const Contact& c) { pushed += dt * (c.force.normalForce > 0); });
    }
    return {velocityOf(*world, 0).z() / speed, pushed};
  }
};

}  // namespace granular
