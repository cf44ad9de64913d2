// Free flight: a body whose grown bounds meet nobody's is moved when it must be, not step by step. Until it has used up
// its margin no contact can begin, and nothing but its weight acts on it; so the steps that were left out are taken one
// after the other in registers, with the arithmetic and so the bits of the steps they stand for. It lands for the next
// search, before its margin is used up, and whenever somebody asks.
#include <algorithm>
#include <cmath>

#include "granular/world/by_scheme.h"

namespace granular {
namespace {

/// So many predictions and advances of bodies aloft, one after the other: an advance after each prediction, but for a
/// last prediction alone.
struct Flight {
  double dt;  ///< s
  std::int64_t predictions, advances;
};

/// The steps of bodies on which gravity alone acts, one after the other in registers: the same bits as step by step.
template <class Scheme, class Place>
void flyBodies(const Flight& flight, const Scheme& scheme, const Place& place, Bodies& bodies) {
  using Real = typename Place::Real;
  const double dt = flight.dt;
  const Moments<Real> moments{place.read(bodies.inertia), place.read(bodies.inverseInertia)};
  const Triple<Real> acceleration = place.read(bodies.acceleration), torque = place.read(bodies.torque);
  HalfTurn<Real> half{place.read(bodies.qHalf), place.read(bodies.wHalf), place.read(bodies.alpha)};
  Turn<Real> now;
  SphereOf<Real> sphere = place.read(bodies.bounds);
  MotionAtHalf<Real> motion = place.readHalf(bodies.motion);
  Triple<Real> v;
  Real travel = place.read(bodies.travel);
  for (std::int64_t n = 0; n < flight.predictions; ++n) {
    predictTranslation(dt, motion.v, acceleration, sphere.x, v);
    now = scheme.predictRotation(dt, half);
    travel = travel + wayOfSurface(dt, motion.v, sphere.radius, half.w, now.w);
    motion.spin = half.q.rotate(half.w);
    if (n == flight.advances) break;
    advanceTranslation(dt, acceleration, motion.v);
    scheme.advanceRotation(dt, moments, torque, now, half);
  }
  place.write(travel, bodies.travel);
  writeState(sphere, v, now, motion, place, bodies);
  place.write(half.q, bodies.qHalf);
  place.write(half.w, bodies.wHalf);
  place.write(half.alpha, bodies.alpha);
}

/// The same for balls, which nothing turns.
template <class Place>
void flyBalls(const Flight& flight, const Place& place, Bodies& bodies) {
  using Real = typename Place::Real;
  const double dt = flight.dt;
  const Triple<Real> acceleration = place.read(bodies.acceleration);
  SphereOf<Real> sphere = place.read(bodies.bounds);
  Triple<Real> vHalf = place.read(bodies.motion, &MotionRow::vHalf), v;
  Real travel = place.read(bodies.travel);
  for (std::int64_t n = 0; n < flight.predictions; ++n) {
    predictTranslation(dt, vHalf, acceleration, sphere.x, v);
    travel = travel + dt * vHalf.norm();
    if (n == flight.advances) break;
    advanceTranslation(dt, acceleration, vHalf);
  }
  place.write(travel, bodies.travel);
  place.write(sphere, bodies.bounds);
  place.write(v, bodies.motion, &MotionRow::v);
  place.write(vHalf, bodies.motion, &MotionRow::vHalf);
  place.writePosition(sphere.x, bodies.frame);
}

/// Flights of fewer steps save nothing, and neither do a few bodies among many: the lists of who is stepped are made
/// anew for each flight.
constexpr std::int64_t shortestFlight = 16;
constexpr double fewestFlying = 0.125;

/// Steps that body i surely makes within its margin and below the speed that a run reports, on its weight alone.
std::int64_t stepsWithinMargin(const World& world, std::size_t i, double dt) {
  const Bodies& bodies = world.bodies;
  const double left = world.search.marginLeft(bodies, i, world.wallTravel);
  if (!(left > 0)) return 0;
  double turning = 0;
  if (!bodies.isBall(i)) {
    // No faster than with all of its energy about the axis of least inertia; a tenth more for what a scheme gains.
    const double energy = bodies.wHalf[i].dot(bodies.inertia[i].cwiseProduct(bodies.wHalf[i]));
    turning = 1.1 * bodies.boundingRadius(i) * std::sqrt(energy / bodies.inertia[i].minCoeff());
  }
  const double speed = bodies.vHalf(i).norm() + turning, gravity = world.options.gravity.norm();
  // The largest n with n dt (speed + g n dt) <= left: the speed grows by less than g dt in a step.
  const double way = speed * dt, gain = gravity * dt * dt;
  constexpr double most = 1e6;
  const double steps = std::floor(std::min(most, 2 * left / (way + std::sqrt(way * way + 4 * gain * left))));
  return speed + gravity * dt * (steps + 1) < world.options.maxSpeed ? static_cast<std::int64_t>(steps) : 0;
}

bool mayFly(const World& world) {
  const WorldOptions& options = world.options;
  if (!options.skips.flight || !options.skips.search) return false;
  // A ledger counts the work of every step, and sleep the mean motion.
  if (options.energy || options.sleep.on) return false;
  // The way of a wall counts as that of every body.
  return std::none_of(world.walls.begin(), world.walls.end(), [](const auto& wall) { return wall->moves(); });
}

/// Those steps of all that are aloft.
void fly(const Flight& flight, const WorldOptions& options, Bodies& bodies) {
  const Bodies::MovingSlots& slots = bodies.flying();
  visitByScheme(options, slots.byScheme,
                [&](const auto& scheme, const auto& place) { flyBodies(flight, scheme, place, bodies); });
  // Their spins stay as they are: the order of turns and moves does not matter, but frames are written by both.
  visitBalls(options, slots.balls, [&](const auto& place) { flyBalls(flight, place, bodies); });
  visitBalls(options, slots.orientedBalls, [&](const auto& place) {
    for (std::int64_t n = 0; n < flight.predictions; ++n) turnBalls(flight.dt, place, bodies);
  });
}

/// predicted: to where predict brought the others. False if nobody flies.
bool bringDown(bool predicted, World& world) {
  Bodies& bodies = world.bodies;
  if (!bodies.anyAloft()) return false;  // without asking for the lists: these are made anew after everybody who comes
  const std::vector<std::int32_t>& slots = bodies.flying().all;
  World::Aloft& aloft = world.aloft;
  const std::int64_t steps = world.steps - aloft.since;
  if (steps > 0 || predicted) fly({aloft.dt, steps + predicted, steps}, world.options, bodies);
  aloft.bodySteps += static_cast<std::uint64_t>(steps) * slots.size();
  aloft.until = World::Aloft::never;
  bodies.land();
  return true;
}

}  // namespace

void land(World& world) {
  if (!bringDown(false, world)) return;
  listGathered(world);
  world.aloft.notBefore = world.steps + 1;
}

void landPredicted(World& world) { bringDown(true, world); }

void landInTime(World& world) {
  if (world.steps >= world.aloft.until) land(world);
}

void letFly(double dt, World& world) {
  World::Aloft& aloft = world.aloft;
  if (world.steps < aloft.notBefore) return;
  aloft.notBefore = World::Aloft::never;  // until somebody lands, or the next search
  if (!mayFly(world)) return;
  const std::vector<std::int32_t>& moving = world.bodies.movingSlots();
  std::vector<std::int32_t> slots;
  std::int64_t least = World::Aloft::never;
  auto met = world.met.begin();
  for (const std::int32_t slot : moving) {
    while (met != world.met.end() && *met < slot) ++met;
    const auto i = static_cast<std::size_t>(slot);
    if ((met != world.met.end() && *met == slot) || world.bodies.locks[i] != 0) continue;
    const std::int64_t steps = stepsWithinMargin(world, i, dt);
    if (steps < shortestFlight) continue;
    slots.push_back(slot);
    least = std::min(least, steps);
  }
  if (slots.empty() || static_cast<double>(slots.size()) < fewestFlying * static_cast<double>(moving.size())) return;
  world.bodies.takeOff(slots);
  aloft.since = world.steps;
  aloft.until = world.steps + least;
  aloft.dt = dt;
  listGathered(world);
}

}  // namespace granular
