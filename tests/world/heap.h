// Small worlds for whole steps: empty ones, heaps that fall together between walls, and their state to the bit.
#pragma once

#include <cstring>
#include <memory>
#include <vector>

#include "granular/core/random.h"
#include "granular/world/stages.h"
#include "granular/world/world.h"

namespace granular::testing {

inline std::unique_ptr<World> makeEmptyWorld(const WorldOptions& options = {}, const ContactParameters& contact = {}) {
  MaterialTable materials;
  materials.add("rock", contact);
  return std::make_unique<World>(options, std::move(materials));
}

/// A floor at z = 0 and four planes around a square of this half-width, m.
inline void addBoxOfPlanes(double half, World& world) {
  world.walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  for (const double sign : {-1.0, 1.0}) {
    world.walls.push_back(makePlaneWall({sign * half, 0, 0}, {-sign, 0, 0}));
    world.walls.push_back(makePlaneWall({0, sign * half, 0}, {0, -sign, 0}));
  }
}

/// Bodies of the given shapes in turn on a cubic lattice of perSide^3 places about the z axis, above z = 0, turned and
/// moving at random. pitch: m; spin: of each, about a random axis, rad/s.
inline void addLattice(const std::vector<std::int32_t>& shapes, int perSide, double pitch, double spin, World& world) {
  const double half = 0.5 * pitch * perSide;
  Random random(5);
  for (int k = 0; k < perSide * perSide * perSide; ++k) {
    NewBody body;
    body.shapeIndex = shapes[static_cast<std::size_t>(k) % shapes.size()];
    const int row = k / perSide % perSide, layer = k / perSide / perSide;
    body.pose.x = Vec3((k % perSide + 0.5) * pitch - half, (row + 0.5) * pitch - half, (layer + 0.55) * pitch);
    body.pose.q = random.rotation();
    body.velocity = Vec3(0.3 * random.normal(), 0.3 * random.normal(), -0.3);
    if (spin > 0) body.spin = spin * random.direction();
    world.addBody(body);
  }
}

/// Steps from the present state at t_n.
inline void run(World& world, double dt, int steps) {
  startHalfSteps(world, dt, 0, true);
  for (int n = 0; n < steps; ++n) step(world, dt);
}

/// All bits of positions, orientations and spins.
inline std::vector<double> stateOf(const World& world) {
  std::vector<double> state;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    for (int k = 0; k < 3; ++k) state.push_back(world.bodies.x(i)[k]);
    for (int k = 0; k < 4; ++k) state.push_back(world.bodies.orientation(i).coeffs()[k]);
    for (int k = 0; k < 3; ++k) state.push_back(world.bodies.w(i)[k]);
  }
  return state;
}

inline bool isSameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), 8 * a.size()) == 0);
}

}  // namespace granular::testing
