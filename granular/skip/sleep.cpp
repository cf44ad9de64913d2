#include "granular/skip/sleep.h"

namespace granular {

void SleepState::remove(const std::vector<bool>& gone) {
  const auto compact = [&](auto& column) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < column.size(); ++i) {
      if (!gone[i]) column[kept++] = column[i];
    }
    column.resize(kept);
  };
  compact(calm);
  compact(force);
  compact(torque);
  compact(load);
}

void updateSleep(const SleepOptions& options, double gravity, double dt, const std::vector<std::int32_t>& slots,
                 const std::vector<double>& load, Bodies& bodies, SleepState& state) {
  const std::size_t n = bodies.size();
  state.calm.resize(n, 0);
  state.force.resize(n, Vec3::Zero());
  state.torque.resize(n, Vec3::Zero());
  state.load.resize(n, 0);
  for (const std::int32_t slot : slots) {
    const auto i = static_cast<std::size_t>(slot);
    const double weight = bodies.mass[i] * gravity;
    const double size = bodies.shape[i]->size();
    if (bodies.state[i] == BodyState::asleep) {
      const double bound = options.wake * state.load[i];
      if ((bodies.force[i] - state.force[i]).squaredNorm() <= bound * bound &&
          (bodies.torque[i] - state.torque[i]).squaredNorm() <= bound * bound * size * size) {
        continue;
      }
      bodies.release(i);
      state.calm[i] = 0;
      ++state.woken;
      continue;
    }
    const Vec3 spin = bodies.frame[i].unrotate(bodies.w[i]);
    const double energy =
        0.5 * (bodies.mass[i] * bodies.v[i].squaredNorm() + spin.dot(bodies.inertia[i].cwiseProduct(spin)));
    state.calm[i] = energy <= options.energy * weight * 2 * size ? state.calm[i] + dt : 0;
    if (state.calm[i] < options.time) continue;
    const double balance = options.balance * load[i];
    if (bodies.force[i].squaredNorm() > balance * balance ||
        bodies.torque[i].squaredNorm() > balance * balance * size * size) {
      continue;
    }
    state.force[i] = bodies.force[i];
    state.torque[i] = bodies.torque[i];
    state.load[i] = load[i];
    state.energyLetGo += energy;
    ++state.fallen;
    bodies.hold(i, BodyState::asleep);
  }
}

}  // namespace granular
