// Stages of a step that move bodies and walls, and the start of the half steps.
#include "granular/world/by_scheme.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

/// How a body moves in a step: bounds on the way of any point of its surface, m, and on the square of its speed at the
/// end, m^2/s^2.
template <class Real>
struct Move {
  Real way, squareSpeed;
};

/// What threads find of many moves.
class Moves {
 public:
  explicit Moves(double squareLimit) : limit(squareLimit), of(ownOfThread<std::vector<OfThread>>()) {
    of.assign(static_cast<std::size_t>(omp_get_max_threads()), OfThread{});
  }
  // A speed that is no number is not within the limit.
  void take(const Move<double>& one) {
    OfThread& found = mine();
    found.way = larger(found.way, one.way);
    found.within = found.within && one.squareSpeed <= limit;
  }
  void take(const Move<Wide>& several) {
    OfThread& found = mine();
    found.ways = larger(found.ways, several.way);
    found.within = found.within && all(several.squareSpeed <= spread(limit));
  }
  Predicted get() const {
    Predicted all{0, true};
    for (const OfThread& found : of) {
      all.way = larger(all.way, found.way);
      for (std::size_t k = 0; k < wideSize; ++k) all.way = larger(all.way, found.ways[k]);
      all.withinLimit = all.withinLimit && found.within;
    }
    return all;
  }

 private:
  struct alignas(64) OfThread {
    Wide ways{};
    double way = 0;
    bool within = true;
  };
  OfThread& mine() { return of[static_cast<std::size_t>(omp_get_thread_num())]; }
  const double limit;
  std::vector<OfThread>& of;
};

/// State at t_{n+1} of the bodies in a place (body/lanes.h).
template <class Scheme, class Place>
Move<typename Place::Real> predictBodies(double dt, const Scheme& scheme, const Place& place, Bodies& bodies) {
  using Real = typename Place::Real;
  const HalfTurn<Real> half{place.read(bodies.qHalf), place.read(bodies.wHalf), place.read(bodies.alpha)};
  MotionAtHalf<Real> motion = place.readHalf(bodies.motion);
  motion.spin = half.q.rotate(half.w);
  SphereOf<Real> sphere = place.read(bodies.bounds);
  Triple<Real> v;
  predictTranslation(dt, motion.v, place.read(bodies.acceleration), sphere.x, v);
  const Turn<Real> next = scheme.predictRotation(dt, half);
  const Real way = wayOfSurface(dt, motion.v, sphere.radius, half.w, next.w);
  place.write(place.read(bodies.travel) + way, bodies.travel);
  writeState(sphere, v, next, motion, place, bodies);
  return {way, squareSpeed(v, next.w, sphere.radius)};
}

/// The same for balls: their spins are in world axes, and a turn moves no surface.
template <class Place>
Move<typename Place::Real> predictBalls(double dt, const Place& place, Bodies& bodies) {
  using Real = typename Place::Real;
  const MotionAtHalf<Real> half = place.readHalf(bodies.motion);
  SphereOf<Real> sphere = place.read(bodies.bounds);
  Triple<Real> v;
  predictTranslation(dt, half.v, place.read(bodies.acceleration), sphere.x, v);
  const Triple<Real> w = half.spin + 0.5 * dt * place.read(bodies.alpha);
  const Real way = dt * half.v.norm();
  place.write(place.read(bodies.travel) + way, bodies.travel);
  place.write(sphere, bodies.bounds);
  place.writeNow(v, w, bodies.motion);
  place.writePosition(sphere.x, bodies.frame);
  return {way, squareSpeed(v, w, sphere.radius)};
}

/// Memory of the next half step of the bodies in a place.
template <class Scheme, class Place>
void advanceBodies(double dt, const Scheme& scheme, const Place& place, Bodies& bodies) {
  using Real = typename Place::Real;
  MotionAtHalf<Real> motion = place.readHalf(bodies.motion);
  const Triple<Real> acceleration = motion.inverseMass * place.read(bodies.force);
  advanceTranslation(dt, acceleration, motion.v);
  HalfTurn<Real> half{place.read(bodies.qHalf), place.read(bodies.wHalf), place.read(bodies.alpha)};
  scheme.advanceRotation(dt, Moments<Real>{place.read(bodies.inertia), place.read(bodies.inverseInertia)},
                         place.read(bodies.torque),
                         Turn<Real>{place.read(bodies.q), place.read(bodies.motion, &MotionRow::w)}, half);
  place.write(acceleration, bodies.acceleration);
  place.writeHalf(motion, bodies.motion);
  place.write(half.q, bodies.qHalf);
  place.write(half.w, bodies.wHalf);
  place.write(half.alpha, bodies.alpha);
}

/// The same for balls.
template <class Place>
void advanceBalls(double dt, const Place& place, Bodies& bodies) {
  using Real = typename Place::Real;
  MotionAtHalf<Real> half = place.readHalf(bodies.motion);
  const Triple<Real> acceleration = half.inverseMass * place.read(bodies.force);
  const Triple<Real> alpha = Real(1 / half.inertia) * place.read(bodies.torque);
  advanceTranslation(dt, acceleration, half.v);
  advanceTranslation(dt, alpha, half.spin);
  place.write(acceleration, bodies.acceleration);
  place.writeHalf(half, bodies.motion);
  place.write(alpha, bodies.alpha);
}

/// The largest distance of any body's surface from the axis of a turning wall: further out no part of it is met.
double furthestFrom(const WallMotion& turning, const Bodies& bodies) {
  const double rate = turning.spin.norm();
  if (rate == 0) return 0;
  double furthest = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double distance = (bodies.x(i) - turning.reference).cross(turning.spin).norm() / rate;
    furthest = std::max(furthest, distance + bodies.boundingRadius(i));
  }
  return furthest;
}

/// Steps from one look for who may fall asleep to the next: each time somebody does the contacts are laid out anew, and
/// together they need it once.
constexpr std::int64_t fallEvery = 16;

/// Nothing sleeps at a wall that is on its way: its contacts are looked at with bodies that move alone.
void wakeNearMovingWalls(World& world) {
  if (!world.options.sleep.on) return;
  for (const WallPair& pair : world.pairs.wallPairs) {
    const Wall& wall = *world.walls[static_cast<std::size_t>(pair.wall)];
    if (wall.stepMotion.velocity.isZero(0) && wall.stepMotion.spin.isZero(0)) continue;
    const auto i = static_cast<std::size_t>(pair.body);
    if (i < world.sleep.calm.size()) world.sleep.startAwake(i);
    if (world.bodies.state[i] != BodyState::asleep) continue;
    world.bodies.release(i);
    ++world.sleep.woken;
    world.layoutStale = true;
  }
}

/// The angular acceleration, world axes, that solves F^T I alpha = F^T torque in the free directions F; `torque` has
/// none in the others.
Vec3 freeAcceleration(Locks locks, const Mat3& inertia, const Vec3& torque) {
  std::array<int, 3> free;
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(locks & lockRotation(axis))) free[static_cast<std::size_t>(count++)] = axis;
  }
  Vec3 alpha = Vec3::Zero();
  if (count == 1) {
    alpha[free[0]] = torque[free[0]] / inertia(free[0], free[0]);
  } else if (count == 2) {
    const int k = free[0], l = free[1];
    const double det = inertia(k, k) * inertia(l, l) - inertia(k, l) * inertia(l, k);
    alpha[k] = (inertia(l, l) * torque[k] - inertia(k, l) * torque[l]) / det;
    alpha[l] = (inertia(k, k) * torque[l] - inertia(l, k) * torque[k]) / det;
  }
  return alpha;
}

}  // namespace

void moveWalls(double dt, World& world) {
  double way = 0;
  for (std::size_t k = 0; k < world.walls.size(); ++k) {
    Wall& wall = *world.walls[k];
    if (!wall.moves()) {
      wall.stepMotion = wall.motion;  // a surface may run along itself
      continue;
    }
    if (const WallServo* servo = wall.heldBy(); servo && !world.wallForces.empty()) {
      wall.servoSpeed = servo->speedFor(-world.wallForces[k].dot(servo->direction), world.wallStiffness[k]);
      wall.servoWay += wall.servoSpeed * dt;
    }
    const double speedBefore = wall.motion.velocity.norm();
    wall.place(world.time + dt);
    const double speed = std::max(speedBefore, wall.motion.velocity.norm());
    way = std::max(way, dt * (speed + wall.stepMotion.spin.norm() * furthestFrom(wall.stepMotion, world.bodies)));
  }
  if (way == 0) return;
  world.wallTravel += way;
  wakeNearMovingWalls(world);
}

Predicted predict(double dt, const WorldOptions& options, Bodies& bodies) {
  Moves moves(options.maxSpeed * options.maxSpeed);
  const Bodies::MovingSlots& slots = bodies.stepped();
  visitByScheme(options, slots.byScheme,
                [&](const auto& scheme, const auto& place) { moves.take(predictBodies(dt, scheme, place, bodies)); });
  visitBalls(options, slots.balls, [&](const auto& place) { moves.take(predictBalls(dt, place, bodies)); });
  visitBalls(options, slots.orientedBalls, [&](const auto& place) { turnBalls(dt, place, bodies); });
  return moves.get();
}

void predict(double dt, World& world) {
  world.predicted = predict(dt, world.options, world.bodies);
  world.pairWay += 2 * world.predicted.way;
}

void advance(double dt, const WorldOptions& options, Bodies& bodies) {
  const Bodies::MovingSlots& slots = bodies.stepped();
  visitByScheme(options, slots.byScheme,
                [&](const auto& scheme, const auto& place) { advanceBodies(dt, scheme, place, bodies); });
  visitBalls(options, slots.balls, [&](const auto& place) { advanceBalls(dt, place, bodies); });
}

// With rotation locked about some world axes, Euler's equation holds along the others alone: the angular acceleration
// is the one in the free directions F that F^T (I alpha + w x I w - T) = 0 gives; the locks supply the rest of the
// torque, which does no work. The torque is replaced by the one that makes a free body turn like that, so that every
// scheme of integration serves.
void applyLocks(std::size_t first, Bodies& bodies) {
  if (!bodies.anyLocked()) return;
  for (const std::int32_t slot : bodies.movingSlots()) {
    const auto i = static_cast<std::size_t>(slot);
    const Locks locks = bodies.locks[i];
    if (locks == 0 || i < first) continue;
    bodies.force[i] = freeTranslation(locks, bodies.force[i]);
    if (locks < lockRotation(0)) continue;
    if (bodies.isBall(i)) {
      bodies.torque[i] = freeRotation(locks, bodies.torque[i]);
      bodies.spinHalf(i) = freeRotation(locks, bodies.spinHalf(i));
      continue;
    }
    const Mat3& R = bodies.frame[i].R;
    const Mat3 inertia = R * bodies.inertia[i].asDiagonal() * R.transpose();
    const Vec3 gyroscopic = bodies.w(i).cross(inertia * bodies.w(i));
    const Vec3 alpha = freeAcceleration(locks, inertia, freeRotation(locks, bodies.torque[i] - gyroscopic));
    bodies.torque[i] = inertia * alpha + gyroscopic;
    // Rounding must not pile up in the locked directions.
    bodies.wHalf[i] = bodies.qHalf[i].conjugate() * freeRotation(locks, bodies.qHalf[i] * bodies.wHalf[i]);
  }
}

void letSleep(double dt, World& world) {
  if (!world.options.sleep.on) return;
  Bodies& bodies = world.bodies;
  const std::uint64_t before = world.sleep.fallen + world.sleep.woken;
  const bool mayFall = world.steps % fallEvery == 0;
  updateSleep(world.options.sleep, world.options.gravity.norm(), dt, mayFall, world.gathered, world.load, bodies,
              world.sleep);
  if (world.sleep.fallen + world.sleep.woken == before) return;
  world.layoutStale = true;
  // A contact between bodies that both rest keeps its force until one of them wakes.
  for (World::Chunk& chunk : world.chunks) {
    for (Contact& contact : chunk.contacts) {
      if (bodies.moves(static_cast<std::size_t>(contact.a))) continue;
      if (contact.b >= 0 && bodies.moves(static_cast<std::size_t>(contact.b))) continue;
      holdContact(contact, world);
    }
    for (std::size_t k = 0; k < chunk.briefs.size(); ++k) {
      const auto [a, b] = world.partiesOf(chunk, k);
      if (bodies.moves(static_cast<std::size_t>(a)) || bodies.moves(static_cast<std::size_t>(b))) continue;
      chunk.briefs[k].held = true;
      Contact contact = world.describeBrief(chunk, k);
      holdContact(contact, world);
    }
  }
}

void wakeAll(World& world) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies.state[i] == BodyState::asleep) world.bodies.release(i);
  }
  world.layoutStale = true;
}

void startHalfSteps(World& world, double dt, std::size_t first, bool withContacts) {
  Bodies& bodies = world.bodies;
  land(world);
  if (withContacts) {
    refreshPairs(dt, world);
    beginForces(world);
    makeContacts(0, world);  // no time passes: springs stay as they are
    gatherForces(world);
  } else {
    for (std::size_t i = first; i < bodies.size(); ++i) {
      if (!bodies.moves(i)) continue;
      bodies.force[i] = bodies.mass[i] * world.options.gravity;
      bodies.torque[i] = Vec3::Zero();
    }
  }
  applyLocks(first, bodies);
  const RotationScheme& scheme = rotationScheme(world.options.integrator);
  for (std::size_t i = first; i < bodies.size(); ++i) {
    if (!bodies.moves(i)) continue;
    bodies.acceleration[i] = bodies.inverseMass(i) * bodies.force[i];
    startTranslation(dt, bodies.acceleration[i], bodies.v(i), bodies.vHalf(i));
    if (bodies.isBall(i)) {
      bodies.alpha[i] = bodies.inverseInertiaOf(i).cwiseProduct(bodies.torque[i]);
      startTranslation(dt, bodies.alpha[i], bodies.w(i), bodies.spinHalf(i));
      continue;
    }
    scheme.start(dt, bodies.inertia[i], bodies.inverseInertia[i], bodies.torque[i], bodies.q[i], bodies.w(i),
                 {bodies.qHalf[i], bodies.wHalf[i], bodies.alpha[i]});
    bodies.spinHalf(i) = bodies.qHalf[i] * bodies.wHalf[i];
  }
}

}  // namespace granular
