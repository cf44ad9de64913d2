// Small worlds for the verification cases: a few bodies, one material, walls when asked for.
#pragma once

#include <memory>

#include "granular/shape/shape_table.h"
#include "granular/world/world.h"

namespace granular {

/// One material, no gravity, springs without tension and friction limited by the push alone, as exact impacts need; no
/// cut-off on overlaps or speeds.
inline WorldOptions plainOptions() {
  WorldOptions options;
  options.gravity.setZero();
  options.rule.rule = PointRule::patch;  // the towers' steps are made for it
  options.lawOptions.tension = false;
  options.lawOptions.frictionOfPush = true;
  options.deepOverlap = infinity;
  options.maxSpeed = infinity;
  return options;
}

inline std::unique_ptr<World> makeWorld(const WorldOptions& options, const ContactParameters& contact) {
  MaterialTable materials;
  materials.add("one", contact);
  return std::make_unique<World>(options, std::move(materials));
}

/// A body of a shape of its own at x, turned by q; returns its slot.
inline std::size_t place(World& world, const std::shared_ptr<const Shape>& shape, const Vec3& x,
                         const Quat& q = Quat::Identity(), double density = 2500) {
  NewBody body;
  body.shapeIndex = world.addShape(shape);
  body.pose = {x, q};
  body.density = density;
  return world.addBody(body);
}

inline void move(World& world, std::size_t i, const Vec3& velocity, const Vec3& spin = Vec3::Zero()) {
  world.bodies.v(i) = velocity;
  world.bodies.w(i) = spin;
}

/// The half space z > 0.
inline void addFloor(World& world) { world.walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ())); }

/// Velocity and spin (world axes) at the half step: exact once nothing touches.
inline Vec3 velocityOf(const World& world, std::size_t i) { return world.bodies.vHalf(i); }
inline Vec3 spinOf(const World& world, std::size_t i) {
  return world.bodies.orientationHalf(i) * world.bodies.wHalfOf(i);
}

/// Steps until the contact that comes has ended; false if it doesn't within `steps`.
inline bool runThroughContact(World& world, double dt, std::int64_t steps) {
  startHalfSteps(world, dt, 0, true);
  bool touched = false;
  for (std::int64_t n = 0; n < steps; ++n) {
    step(world, dt);
    const bool touching = world.contactCount() > 0;
    if (touched && !touching) return true;
    touched |= touching;
  }
  return false;
}

/// Steps for `time` s.
inline void runFor(World& world, double dt, double time) {
  startHalfSteps(world, dt, 0, true);
  const auto steps = static_cast<std::int64_t>(std::llround(time / dt));
  for (std::int64_t n = 0; n < steps; ++n) step(world, dt);
}

inline std::shared_ptr<const Shape> sphereOf(double radius) { return makeShape("sphere", std::vector{radius}); }
inline std::shared_ptr<const Shape> cuboidOf(const Vec3& half) {
  return makeShape("cuboid", std::vector{half.x(), half.y(), half.z()});
}

}  // namespace granular
