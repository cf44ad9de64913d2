// What a packing run does about trouble: it watches its energy, keeps the last good state, and goes back to it.
#include <fmt/format.h>

#include <algorithm>

#include "granular/io/checkpoint.h"
#include "granular/run/packing_run.h"
#include "granular/run/world_archive.h"

namespace granular {

void PackingRun::save(const std::filesystem::path& out, RunEnd end) {
  // A run that may go back has to find the same state to go back to when it is resumed: that state is what is saved.
  const LimitSettings::Action action = settings.limits.onTrouble;
  const bool mayGoBack = action == LimitSettings::Action::smallerStep || action == LimitSettings::Action::remove;
  const bool isOver = end == RunEnd::rested || end == RunEnd::completed;
  if (end == RunEnd::trouble || (mayGoBack && !isOver)) return saveCheckpoint(out, *good);
  Archive archive;
  archive.visitGroup("scene", origin);
  visitState(archive);
  saveCheckpoint(out, archive);
}

void PackingRun::keepGood() {
  good.emplace();
  good->visitGroup("scene", origin);
  visitState(*good);
}

void PackingRun::watchEnergy() {
  // A wall that moves brings energy of its own.
  const bool moving =
      std::any_of(state->walls.begin(), state->walls.end(), [](const auto& wall) { return wall->moves(); });
  const Bodies& bodies = state->bodies;
  const double gravity = state->options.gravity.norm();
  // Without a weight there is nothing to measure what springs hold by.
  if (moving || gravity == 0 || std::isinf(settings.limits.maxGain)) return;
  double energy = 0, scale = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    energy += mechanicalEnergy(*state, i);
    scale += bodies.kineticEnergy(i) + weightTimesSize(bodies, i, gravity);
  }
  const double gain = counters.energy.look(state->time, energy, 200 * stepBound.contactTime);
  if (!(gain <= settings.limits.maxGain * scale))
    state->report.add({Trouble::Kind::energyGain, state->time, -1, -1, {}, gain});
}

bool PackingRun::answerTrouble() {
  // What a sixty-fourth of the step does not cure is no matter of the step; a bed is not told by what is left of it.
  constexpr std::size_t mostHalvings = 6;
  constexpr double mostRemoved = 0.1;
  const LimitSettings::Action action = settings.limits.onTrouble;
  const bool removes = action == LimitSettings::Action::remove;
  const auto present = static_cast<double>(state->bodies.size() + counters.removed.size());
  const bool exhausted = removes ? static_cast<double>(counters.removed.size() + 1) > mostRemoved * present
                                 : counters.answers.size() - counters.removed.size() >= mostHalvings;
  if (action == LimitSettings::Action::stop || exhausted) return false;
  // Of two bodies the lighter one goes.
  const Trouble met = state->report.troubles.front();
  const Bodies& bodies = state->bodies;
  const auto massOf = [&](std::int64_t id) {
    return bodies.mass[static_cast<std::size_t>(std::find(bodies.id.begin(), bodies.id.end(), id) - bodies.id.begin())];
  };
  const std::int64_t culprit = met.bodyB >= 0 && massOf(met.bodyB) < massOf(met.bodyA) ? met.bodyB : met.bodyA;
  if (removes && culprit < 0) return false;

  // From the state before, built as a resumed run is.
  PackingRun again(origin);
  Archive before = good->reopened();
  SceneSource source;
  before.visitGroup("scene", source);
  again.visitState(before);
  again.counters.answers = counters.answers;
  again.counters.removed = counters.removed;
  const std::string back = fmt::format("{}; back to t = {:.6g} s", describe(met), again.state->time);
  if (removes) {
    again.counters.removed.push_back(culprit);
    again.counters.answers.push_back(fmt::format("{}, particle {} taken out", back, culprit));
    again.takeOut();
  } else {
    again.dt = 0.5 * dt;
    again.limitSpeed();
    startHalfSteps(*again.state, again.dt, 0, true);
    again.counters.answers.push_back(fmt::format("{}, with half the time step: {:.4g} s", back, again.dt));
  }
  again.keepGood();
  *this = std::move(again);
  return true;
}

void PackingRun::takeOut() {
  if (counters.removed.empty()) return;
  const Bodies& bodies = state->bodies;
  std::vector<bool> gone(bodies.size(), false);
  bool any = false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto& out = counters.removed;
    gone[i] = std::find(out.begin(), out.end(), bodies.id[i]) != out.end();
    any = any || gone[i];
    if (gone[i]) counters.energy.add(-mechanicalEnergy(*state, i));
  }
  if (any) state->removeBodies(gone);
}

}  // namespace granular
