// A tower of cuboids on the ground: does it stand, and how quietly? (S section 7.1 and table 7.)
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
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
  bool stopped = false;  ///< by the watch, before its time
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

/// Called at every sample; false stops the run.
using StackObserver = std::function<bool(const StackSample&)>;

/// Where the state of a tower is kept while it runs.
struct StackCheckpoints {
  std::filesystem::path folder;  ///< which exists; empty: the state is not kept
  double every = 600;            ///< wall time between two of them, s
};

struct World;
class Archive;
class StackWatch;

/// A tower that runs to its end or its fall, and can be taken up again where it was stopped.
class StackRun {
 public:
  /// Builds the tower. Throws InputError for settings that can't be used.
  explicit StackRun(const StackSettings& settings);
  /// Goes on from a folder's newest checkpoint, to the same bits as if it had never stopped. time: simulated, s, in
  /// place of what was asked for. Throws InputError for a checkpoint that can't be used, and where the time is
  /// already over.
  static StackRun resumed(const std::filesystem::path& folder, std::optional<double> time = {});
  ~StackRun();
  StackRun(StackRun&&) noexcept;
  StackRun& operator=(StackRun&&) = delete;

  const StackSettings& settings() const { return chosen; }
  double time() const;  ///< simulated so far, s
  /// To the end, to the fall, or until watch returns false; to be called once. Checkpoints are written at samples, the
  /// first after `every` seconds of wall time, and when watch stops the run.
  StackResult run(const StackObserver& watch = {}, const StackCheckpoints& checkpoints = {});

 private:
  void save(const std::filesystem::path& folder);
  void visitState(Archive& archive);

  StackSettings chosen;
  std::unique_ptr<World> world;
  double dt = 0;
  std::unique_ptr<StackWatch> tower;
  double wall = 0;  ///< wall time of the run so far, s
};

/// Builds a tower and runs it to the end or to its fall.
StackResult runStack(const StackSettings& settings, const StackObserver& watch = {});
/// The same tower in Bullet alone: its own contacts, impulse solver and integrator, with the settings that it has.
StackResult runBulletStack(const StackSettings& settings, const StackObserver& watch = {});

}  // namespace granular
