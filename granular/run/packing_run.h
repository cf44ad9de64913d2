// A packing from scene to rest: insertion, steps, settling, frames, checkpoints, trouble.
#pragma once

#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "granular/energy/series.h"
#include "granular/insert/inserter.h"
#include "granular/io/archive.h"
#include "granular/io/scene.h"
#include "granular/io/vtk_writer.h"
#include "granular/run/energy_watch.h"
#include "granular/world/time_step.h"
#include "granular/world/world.h"

namespace granular {

/// Where a scene comes from: enough to read it again, which a checkpoint does.
struct SceneSource {
  std::filesystem::path file;
  std::string text;                    ///< of the file
  std::vector<std::string> overrides;  ///< "key.path=value"

  static SceneSource read(const std::filesystem::path& file, const std::vector<std::string>& overrides);
  Scene parse() const;
};

/// How a run ended.
/// completed: a wall never stops, so that there is no rest to wait for, and time.max_time is reached.
enum class RunEnd { rested, completed, notRested, trouble, interrupted, outOfTime };
std::string_view runEndName(RunEnd end);

/// Counters of the run itself; with the world and the inserter's state, all there is to save.
struct RunProgress {
  double calm = 0;                  ///< how long the kinetic energy has been below the bound in question, s
  double batchStart = 0;            ///< when the present batch came, s
  double pouredAt = -1;             ///< when the last particle came, s; -1: not yet
  bool consolidated = true;         ///< the batch before is at rest
  bool awake = false;               ///< the final wait has begun: all sleepers were woken, none sleeps again
  std::int64_t frozenBelow = 0;     ///< ids below this are frozen
  std::int64_t lateBatches = 0;     ///< batches that were not consolidated in their time
  std::int64_t frames = 0;          ///< written so far
  double nextFrame = 0;             ///< s
  double nextCheckpoint = 0;        ///< simulated, s
  double wall = 0;                  ///< wall time of earlier runs, s
  double smallestBound = infinity;  ///< smallest step bound seen with the contacts at hand, s
  EnergyWatch energy;
  std::vector<std::string> answers;   ///< to troubles: what was met and what was done
  std::vector<std::int64_t> removed;  ///< ids of particles taken out because of trouble
};

class PackingRun {
 public:
  /// Builds everything the scene names. Throws InputError for what can't be.
  explicit PackingRun(SceneSource source);
  /// Continues from the newest checkpoint of a folder, to the same bits as if it had never stopped. Overrides may
  /// change what does not touch the motion: threads, time.max_time, and the keys of rest, output and limits; others
  /// throw InputError.
  static PackingRun resumed(const std::filesystem::path& folder, const std::vector<std::string>& overrides = {});

  const Scene& scene() const { return settings; }
  World& world() { return *state; }
  const World& world() const { return *state; }
  const Inserter& inserter() const { return *pour; }
  double timeStep() const { return dt; }
  const TimeStepBound& bound() const { return stepBound; }
  const RunProgress& progress() const { return counters; }
  const EnergySeries& energySeries() const { return energies; }
  const std::vector<FrameSeries::Entry>& frameEntries() const { return frames; }
  Vessel vessel() const;

  /// What this run will do, in lines: particles, vessel, time step and why, what is skipped, memory and time expected.
  std::string describePlan() const;

  /// Goes on until the bed is at rest, or trouble that is not answered otherwise, or `stop` becomes nonzero. `out`:
  /// folder of frames and checkpoints, which exists.
  RunEnd run(const std::filesystem::path& out, const volatile std::sig_atomic_t& stop);

  /// Kinetic energy of the moving bodies over the sum of m g d of the particles poured last (d: equal-volume diameter).
  double restlessness() const;
  /// True if the kinetic energy has been below this times m g d for so long, s, and for longer than a particle that
  /// begins to fall could.
  bool isCalm(double energy, double time) const;
  /// When the last wall stops on its way, s; infinity if one never does. Waiting for rest begins then.
  double settlesFrom() const;

 private:
  void makePour();
  void chooseTimes();
  void placePoses();
  void addParticle(const NewParticle& particle);
  void insertDue();
  void freezeConsolidated();
  void observe(double interval);
  bool isResting() const;
  double shareDone() const;
  std::string describeProgress() const;
  void save(const std::filesystem::path& out, RunEnd end);
  void keepGood();
  void watchEnergy();
  bool answerTrouble();
  void takeOut();
  void limitSpeed();
  void visitState(Archive& archive);
  void checkFolder(const std::filesystem::path& out) const;

  SceneSource origin;
  Scene settings;
  std::unique_ptr<World> state;
  std::unique_ptr<Inserter> pour;
  std::vector<std::int32_t> materialOfGroup;
  std::vector<double> densityOfGroup;
  std::vector<Locks> locksOfGroup;
  TimeStepBound stepBound;
  double dt = 0;
  RunProgress counters;
  EnergySeries energies;
  std::vector<FrameSeries::Entry> frames;  // of particles.pvd so far
  double smallestSize = infinity;          // of a particle, m
  std::optional<Archive> good;             // the last state kept without trouble
};

}  // namespace granular
