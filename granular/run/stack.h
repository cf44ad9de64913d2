// A tower of cuboids on the ground: does it stand, and how quietly? (S section 7.1 and table 7.)
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "granular/run/stack_settings.h"

namespace granular {

/// The tower at one time; averages over the interval since the sample before.
struct StackSample {
  double time = 0;           ///< s
  double kineticEnergy = 0;  ///< mean, J
  double speed = 0;          ///< mean over time and cuboids, m/s
  double drift = 0;          ///< largest horizontal way of a cuboid from its place, over its side
  double tilt = 0;           ///< largest angle of a cuboid's upright axis to what it was, rad
};

struct StackResult {
  bool standing = true;
  double fellAt = -1;    ///< s; negative: it stands
  double simulated = 0;  ///< s
  double step = 0;       ///< s
  std::int64_t steps = 0;
  double maxDrift = 0;       ///< largest of the run, over the side
  double maxTilt = 0;        ///< rad
  double kineticEnergy = 0;  ///< mean over the last tenth of a second, J
  double energyTrend = 0;    ///< d ln E/dt between the last two windows of the trend, 1/s
  double worstInterlayer =
      0;                ///< largest |F/(weight above) - 1| over the interfaces, means over the last tenth of a second
  double wallTime = 0;  ///< s
  double nsPerContact = 0;
  double deepestOverlap = 0;  ///< over size
  std::uint64_t uncertified = 0;
  std::vector<StackSample> samples;
  std::vector<Pose> poses;  ///< at the end
};

/// Builds the tower and runs it to the end or to its fall. watch is called at every sample; false stops the run.
/// Throws InputError for settings that can't be used.
StackResult runStack(const StackSettings& settings, const std::function<bool(const StackSample&)>& watch = {});
/// The same tower in Bullet alone: its own contacts, impulse solver and integrator, with the settings that it has.
StackResult runBulletStack(const StackSettings& settings, const std::function<bool(const StackSample&)>& watch = {});

}  // namespace granular
