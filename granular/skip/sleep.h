// Sleeping: a body that has been slow, with its forces balanced, for a stated time is taken out of the motion; it wakes when
// the force on it differs from the force when it fell asleep by more than a bound. (design 2.4)
// The whole bed is one island: each body decides for itself.
#pragma once

#include <cstdint>
#include <vector>

#include "granular/body/bodies.h"

namespace granular {

struct SleepOptions {
  bool on = false;
  double energy = 1e-6;   ///< slow: kinetic energy below this times m g d (d: equal-volume diameter)
  double balance = 1e-2;  ///< balanced: net force below this times m g, net torque below this times m g d/2
  double time = 1e-2;     ///< for so long, s
  double wake = 5e-2;     ///< woken when the net force changed by this times m g (torque: times m g d/2)
};

/// What sleeping remembers; part of a checkpoint.
struct SleepState {
  std::vector<double> calm;                ///< how long a body has been slow and balanced, s
  std::vector<Vec3> force, torque;         ///< net, when it fell asleep
  double energyLetGo = 0;                  ///< kinetic energy taken away so far, J
  std::uint64_t fallen = 0, woken = 0;     ///< events so far
};

/// Lets bodies fall asleep and wakes them, after the forces of a step are gathered. Bodies whose state changed are
/// appended to `fallen`.
void updateSleep(const SleepOptions& options, double gravity, double dt, Bodies& bodies, SleepState& state,
                 std::vector<std::int32_t>& fallen);

}  // namespace granular
