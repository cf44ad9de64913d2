// One time step, as a straight line of stages (docs/architecture.md has a heading for each).
#include <algorithm>
#include <chrono>

#include "granular/core/share_out.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

using Clock = std::chrono::steady_clock;

/// Seconds since the last lap.
class Stopwatch {
 public:
  double lap() {
    const auto now = Clock::now();
    const std::chrono::duration<double> passed = now - last;
    last = now;
    return passed.count();
  }

 private:
  Clock::time_point last = Clock::now();
};

/// Adds the time since the last lap to a stage.
class LapTimer {
 public:
  explicit LapTimer(Report& target) : report(target) {}
  void lap(Stage stage) { book(stage, watch.lap()); }
  /// To the stages of the contacts, as the chunks spent it, on however many threads.
  void lapContacts(const std::vector<World::Chunk>& chunks) {
    const double passed = watch.lap();
    std::array<double, 3> spent{};
    for (const World::Chunk& chunk : chunks) {
      for (std::size_t k = 0; k < 3; ++k) spent[k] += chunk.seconds[k];
    }
    const double all = spent[0] + spent[1] + spent[2];
    constexpr std::array<Stage, 3> stages = {Stage::contacts, Stage::points, Stage::laws};
    for (std::size_t k = 0; k < 3; ++k) book(stages[k], all > 0 ? passed * spent[k] / all : 0);
  }

 private:
  void book(Stage stage, double seconds) { report.seconds[static_cast<std::size_t>(stage)] += seconds; }
  Report& report;
  Stopwatch watch;
};

}  // namespace

void makeContacts(double dt, World& world) {
  layOutMotion(world);
  shareOut(world.chunks.size(), world.chunks.size() >= chunksForThreads, [&](std::size_t c) {
    auto& seconds = world.chunks[c].seconds;
    seconds = {};
    Stopwatch watch;
    if (world.chunks[c].ofBalls) {
      makeBallContacts(dt, c, world);  // all three at once
      seconds[2] = watch.lap();
      return;
    }
    findContacts(c, world);  // normal, overlap
    seconds[0] = watch.lap();
    placeContactPoints(c, world);  // clip, centroid, moments
    seconds[1] = watch.lap();
    applyForceLaws(dt, c, world);  // rotate springs, force, couple
    seconds[2] = watch.lap();
  });
}

void step(World& world, double dt) {
  LapTimer timer(world.report);
  moveWalls(dt, world);
  timer.lap(Stage::walls);
  predict(dt, world.options, world.bodies);  // x, q, v, w at t_{n+1}
  timer.lap(Stage::predict);
  refreshPairs(dt, world);  // only after the skin is used up
  timer.lap(Stage::search);
  makeContacts(dt, world);  // findContacts, placeContactPoints, applyForceLaws
  timer.lapContacts(world.chunks);
  gatherForces(world);          // fixed order per body
  applyLocks(0, world.bodies);  // only bodies that have some
  timer.lap(Stage::gather);
  rememberVelocities(world);                 // only for the ledger
  advance(dt, world.options, world.bodies);  // half-step velocities, q
  timer.lap(Stage::advance);
  keepLedger(dt, world);  // only if the scene asks for it
  letSleep(dt, world);    // only if the scene asks for it
  watch(world);           // non-finite, deep overlap
  timer.lap(Stage::watch);
  world.time += dt;
  ++world.steps;
}

}  // namespace granular
