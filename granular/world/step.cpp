// One time step, as a straight line of stages (docs/architecture.md has a heading for each).
#include <algorithm>
#include <chrono>

#include "granular/world/stages.h"

namespace granular {
namespace {

/// Adds the time since the last lap to a stage.
class LapTimer {
 public:
  explicit LapTimer(Report& target) : report(target) {}
  void lap(Stage stage) {
    const auto now = Clock::now();
    report.seconds[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - last).count();
    last = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Report& report;
  Clock::time_point last = Clock::now();
};

}  // namespace

void step(World& world, double dt) {
  LapTimer timer(world.report);
  moveWalls(dt, world);
  timer.lap(Stage::walls);
  predict(dt, world.options, world.bodies);  // x, q, v, w at t_{n+1}
  timer.lap(Stage::predict);
  refreshPairs(dt, world);  // only after the skin is used up
  timer.lap(Stage::search);
  findContacts(world);  // normal, overlap
  timer.lap(Stage::contacts);
  placeContactPoints(world);  // clip, centroid, moments
  timer.lap(Stage::points);
  applyForceLaws(dt, world);  // rotate springs, force, couple
  timer.lap(Stage::laws);
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
