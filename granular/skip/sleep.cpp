#include "granular/skip/sleep.h"

#include <type_traits>

#include "granular/core/pick.h"

namespace granular {

void SleepState::rearrange(const std::vector<std::int32_t>& order) {
  visitColumns([&](const char*, auto& column, auto&&...) {
    if (!column.empty()) column = pick(column, order);
  });
}

void SleepState::resize(std::size_t bodies) {
  visitColumns([&](const char*, auto& column, auto&&...) {
    if constexpr (std::is_same_v<decltype(column), std::vector<double>&>) {
      column.resize(bodies, 0);
    } else {
      column.resize(bodies, Vec3::Zero());
    }
  });
}

void SleepState::startAwake(std::size_t i) {
  calm[i] = 0;
  velocity[i].setZero();
  spin[i].setZero();
}

void updateSleep(const SleepOptions& options, double gravity, double dt, bool mayFall,
                 const std::vector<std::int32_t>& slots, const std::vector<double>& load, Bodies& bodies,
                 SleepState& state) {
  state.resize(bodies.size());
  const double newForce = dt >= options.average ? 1 : dt / options.average;
  const double newMotion = dt >= options.time ? 1 : dt / options.time;
  for (const std::int32_t slot : slots) {
    const auto i = static_cast<std::size_t>(slot);
    const double size = bodies.shape[i]->size();
    if (bodies.state[i] == BodyState::asleep) {
      state.forceChange[i] += newForce * (bodies.force[i] - state.force[i] - state.forceChange[i]);
      state.torqueChange[i] += newForce * (bodies.torque[i] - state.torque[i] - state.torqueChange[i]);
      const double bound = options.wake * state.load[i];
      if (state.forceChange[i].squaredNorm() > bound * bound ||
          state.torqueChange[i].squaredNorm() > bound * bound * size * size) {
        bodies.release(i);
        state.startAwake(i);
        ++state.woken;
      }
      continue;
    }
    state.velocity[i] += newMotion * (bodies.v(i) - state.velocity[i]);
    state.spin[i] += newMotion * (bodies.w(i) - state.spin[i]);
    const double energy = bodies.kineticEnergy(i, state.velocity[i], bodies.frameOf(i).unrotate(state.spin[i]));
    state.calm[i] = energy <= options.energy * bodies.mass[i] * gravity * 2 * size ? state.calm[i] + dt : 0;
    if (!mayFall || state.calm[i] < options.time) continue;
    const double balance = options.balance * load[i];
    if (bodies.force[i].squaredNorm() > balance * balance ||
        bodies.torque[i].squaredNorm() > balance * balance * size * size) {
      continue;
    }
    state.force[i] = bodies.force[i];
    state.torque[i] = bodies.torque[i];
    state.forceChange[i].setZero();
    state.torqueChange[i].setZero();
    state.load[i] = load[i];
    state.energyLetGo += bodies.kineticEnergy(i);
    ++state.fallen;
    bodies.hold(i, BodyState::asleep);
  }
}

}  // namespace granular
