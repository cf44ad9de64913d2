// Energy that appears from nothing: kinetic and potential energy together only ever fall, but for what springs give
// back within a contact time, for bodies put in and for walls that move. A step too long for its contacts makes them
// rise.
#pragma once

#include <algorithm>

#include "granular/shape/shape.h"
#include "granular/world/world.h"

namespace granular {

/// Kinetic and potential energy of a slot, J; the potential from the origin of the scene.
inline double mechanicalEnergy(const World& world, std::size_t i) {
  const Bodies& bodies = world.bodies;
  return bodies.kineticEnergy(i) - bodies.mass[i] * world.options.gravity.dot(bodies.x(i));
}

/// The energy that lifts a body by its own size, J.
inline double weightTimesSize(const Bodies& bodies, std::size_t i, double gravity) {
  return bodies.mass[i] * gravity * 2 * bodies.shape[i]->size();
}

struct EnergyWatch {
  double before = infinity;  ///< largest kinetic and potential energy in the block of time before this one, J
  double now = -infinity;    ///< largest in this block so far, J
  double until = 0;          ///< end of this block, s

  /// Of bodies put in or taken out, J.
  void add(double energy) {
    before += energy;
    now += energy;
  }
  /// Takes the present energy (J) down; returns by how much it is above all of the block before. A block must be long
  /// against the time for which springs hold energy.
  double look(double time, double energy, double block) {
    const double gain = energy - before;
    if (time >= until) {
      before = now > -infinity ? std::max(now, energy) : infinity;
      now = energy;
      until = time + block;
    }
    now = std::max(now, energy);
    return gain;
  }
};

}  // namespace granular
