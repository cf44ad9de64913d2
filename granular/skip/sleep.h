// Sleeping: a body whose mean motion has been slow for a stated time is taken out of the motion at a moment when its
// forces balance; it wakes when the mean force on it differs from the force when it fell asleep by more than a bound.
// The whole bed is one island: each body decides for itself. Forces are measured by the load that a body carries, its
// weight plus half the sum of its contact forces: a contact that is lost is not small against what holds a loaded body.
//
// Means, because a bed on which particles rain never rests from moment to moment: every impact sends waves through it,
// thousands of times a grain's weight where it strikes, that shake a body and leave it where it was. A mean motion that
// is slow goes nowhere; a mean force is an impulse per time, and what a wave brings it takes back.
#pragma once

#include <cstdint>
#include <vector>

#include "granular/body/bodies.h"

namespace granular {

struct SleepOptions {
  bool on = false;
  double energy = 1e-4;  ///< slow: energy of the mean motion below this times m g d (d: equal-volume diameter)
  double time = 2e-3;    ///< for so long, s; the motion is averaged over as long
  double balance = 0.1;  ///< then, once the net force is below this times the load, and the torque below that times d/2
  double wake = 0.3;     ///< woken when the net force changed by this times the load at sleep (torque: times d/2 too)
  double average = 1e-3;  ///< the change is averaged over so long, s
};

/// What sleeping remembers; part of a checkpoint.
struct SleepState {
  std::vector<double> calm;                     ///< how long a body has been slow, s
  std::vector<Vec3> velocity, spin;             ///< mean, of a body awake
  std::vector<Vec3> force, torque;              ///< net, when it fell asleep
  std::vector<Vec3> forceChange, torqueChange;  ///< mean, since it fell asleep
  std::vector<double> load;                     ///< when it fell asleep, N
  double energyLetGo = 0;                       ///< kinetic energy taken away so far, J
  std::uint64_t fallen = 0, woken = 0;          ///< events so far

  /// Calls visit(name, column, unit, note) for every array with an entry per slot.
  template <class Visitor>
  void visitColumns(Visitor&& visit) {
    visit("calm", calm, "s", "");
    visit("velocity", velocity, "m/s", "mean, of a body awake");
    visit("spin", spin, "rad/s", "mean, of a body awake");
    visit("force", force, "N", "net, when it fell asleep");
    visit("torque", torque, "N m", "");
    visit("force_change", forceChange, "N", "mean, since it fell asleep");
    visit("torque_change", torqueChange, "N m", "");
    visit("load", load, "N", "carried when it fell asleep");
  }

  /// Gives every slot its entries.
  void resize(std::size_t bodies);
  /// Of a body that wakes: it has not been slow yet.
  void startAwake(std::size_t i);
  /// As Bodies::rearrange; every slot has its entries, or none has.
  void rearrange(const std::vector<std::int32_t>& order);
};

/// Lets bodies fall asleep (mayFall: not in this call, if false) and wakes them, after the forces of a step are
/// gathered. slots, ascending: those whose forces were; others must be frozen, or asleep with the force they had. load:
/// what each slot carries now, N.
void updateSleep(const SleepOptions& options, double gravity, double dt, bool mayFall,
                 const std::vector<std::int32_t>& slots, const std::vector<double>& load, Bodies& bodies,
                 SleepState& state);

}  // namespace granular
