// One time step, as a straight line of stages (docs/architecture.md has a heading for each).
#include <algorithm>
#include <chrono>

#include "granular/core/share_out.h"
#include "granular/world/order.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

using Clock = std::chrono::steady_clock;

/// Reading the clock for every chunk and stage costs small scenes some per cent: one step in so many is timed, and
/// counts for all of them. Odd, so that it meets what is done every so many steps as often as others do.
constexpr std::int64_t timedEvery = 7;
bool isTimed(const World& world) { return world.steps % timedEvery == 0; }

/// Seconds since the last lap; 0 where nothing is timed.
class Stopwatch {
 public:
  explicit Stopwatch(bool runs) : running(runs) {
    if (running) last = Clock::now();
  }
  double lap() {
    if (!running) return 0;
    const auto now = Clock::now();
    const std::chrono::duration<double> passed = now - last;
    last = now;
    return passed.count();
  }

 private:
  bool running;
  Clock::time_point last;
};

/// Adds the time since the last lap to a stage.
class LapTimer {
 public:
  LapTimer(bool runs, Report& target) : report(target), watch(runs) {}
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
  void book(Stage stage, double seconds) { report.seconds[static_cast<std::size_t>(stage)] += timedEvery * seconds; }
  Report& report;
  Stopwatch watch;
};

}  // namespace

void makeContacts(double dt, World& world) {
  const bool timed = isTimed(world);
  shareOut(world.chunks.size(), world.chunks.size() >= chunksForThreads, [&](std::size_t c, bool own) {
    world.chunks[c].addsAtOnce = own;
    auto& seconds = world.chunks[c].seconds;
    seconds = {};
    Stopwatch watch(timed);
    if (const auto make = world.chunks[c].make) {
      make(dt, c, world);  // all three at once
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
  LapTimer timer(isTimed(world), world.report);
  moveWalls(dt, world);
  timer.lap(Stage::walls);
  landInTime(world);   // only if somebody flies
  predict(dt, world);  // x, q, v, w at t_{n+1}
  timer.lap(Stage::predict);
  layInOrder(world);        // only if neighbours lie far apart in memory
  refreshPairs(dt, world);  // only after the skin is used up
  timer.lap(Stage::search);
  beginForces(world);  // weights
  timer.lap(Stage::gather);
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
  letFly(dt, world);  // only bodies that meet nobody for a while
}

}  // namespace granular
