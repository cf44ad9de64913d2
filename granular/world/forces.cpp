// Stages of a step that make forces of contacts: the law of each, and the sum on each body.
#include <algorithm>
#include <limits>

#include "granular/body/lanes.h"
#include "granular/core/room.h"
#include "granular/core/share_out.h"
#include "granular/world/contact_radius.h"
#include "granular/world/law_batch.h"
#include "granular/world/spots.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// What a law reads of body i at a contact with this arm.
ContactBody viewBody(const Bodies& bodies, std::size_t i, const Vec3& arm, bool readsInertia) {
  ContactBody body;
  body.inverseMass = bodies.inverseMass(i);
  body.radiusRatio = bodies.radiusRatio(i);
  body.arm = arm;
  if (readsInertia && bodies.isBall(i)) {
    body.inverseInertia = bodies.inverseInertiaOf(i).asDiagonal();
  } else if (readsInertia) {
    const Mat3& R = bodies.frameOf(i).R;
    body.inverseInertia = R * bodies.inverseInertiaOf(i).asDiagonal() * R.transpose();
  }
  return body;
}

/// Both parties of a contact and how they move.
struct Encounter {
  ContactBody a, b;
  std::int32_t materialA = 0, materialB = 0;
  ContactMotion motion;
};

/// Geometry and velocities at t_{n+1}; slip and turn from the half step.
Encounter meet(const World& world, const Contact& contact, double dt) {
  const Bodies& bodies = world.bodies;
  const bool readsInertia = lawReadsInertia(world.options.law, world.options.lawOptions);
  const std::size_t a = at(contact.a);
  const Vec3& point = contact.patch.point;
  Encounter met;
  met.a = viewBody(bodies, a, point - bodies.x(a), readsInertia);
  met.materialA = bodies.material[a];

  // The other party: a body's image, or a wall.
  Vec3 velocityB, slipVelocityB, spinB, spinHalfB;
  if (contact.b < 0) {
    const Wall& wall = *world.walls[at(-1 - contact.b)];
    velocityB = wall.motion.velocityAt(point);
    slipVelocityB = wall.stepMotion.velocityAt(point);
    spinB = wall.motion.spin;
    spinHalfB = wall.stepMotion.spin;
    met.materialB = wall.material;
  } else {
    const std::size_t b = at(contact.b);
    met.b = viewBody(bodies, b, point - bodies.x(b) - contact.shift, readsInertia);
    velocityB = bodies.v(b) + bodies.w(b).cross(met.b.arm);
    slipVelocityB = bodies.vHalf(b) + bodies.spinHalf(b).cross(met.b.arm);
    spinB = bodies.w(b);
    spinHalfB = bodies.spinHalf(b);
    met.materialB = bodies.material[b];
  }

  ContactMotion& motion = met.motion;
  motion.normal = contact.touch.normal;
  motion.overlap = contact.patch.depth;
  motion.squaredDepth = contact.patch.squaredDepth;
  motion.velocity = bodies.v(a) + bodies.w(a).cross(met.a.arm) - velocityB;
  motion.slip = (bodies.vHalf(a) + bodies.spinHalf(a).cross(met.a.arm) - slipVelocityB) * dt;
  motion.spin = bodies.w(a) - spinB;
  motion.meanSpin = 0.5 * (bodies.w(a) + spinB);
  motion.turn = (bodies.spinHalf(a) - spinHalfB) * dt;
  motion.share = contact.share * contact.patch.share;
  motion.dt = dt;
  motion.centreArm = contact.patch.centre - point;
  motion.area = contact.patch.area;
  motion.u = contact.patch.u;
  motion.uu = contact.patch.uu;
  motion.vv = contact.patch.vv;
  motion.uv = contact.patch.uv;
  motion.rocking = rockingDamping(world.options.rule);
  if (lawReadsCurvature(world.options.law)) motion.radius = contactRadius(world, contact);
  return met;
}

/// The histories of a pair that may have several contacts.
std::vector<SpotHistory>& spotsOf(World& world, const Contact& contact) {
  if (contact.b < 0) return world.pairs.wallPairs[at(contact.pair)].spots;
  const std::size_t slot = at(world.pairs.pairs[at(contact.pair)].slot);
  PairMemory& memory = world.pairs.memory;
  return contact.spot.ofClump() ? memory.clumps[slot].spots : memory.manifolds[slot].spots;
}

/// True if a pair may have several contacts like this one.
bool keepsSpots(const World& world, const Contact& contact) {
  return contact.b < 0 || contact.spot.ofClump() || world.options.rule.rule == PointRule::manifold;
}

/// The history of contact k of a chunk. firstOfPair: index of the first contact of its pair, kept from call to call.
ContactHistory& findHistory(World& world, const World::Chunk& chunk, std::size_t k, std::size_t& firstOfPair) {
  const Contact& contact = chunk.contacts[k];
  if (!keepsSpots(world, contact)) return world.pairs.memory.history[at(world.pairs.pairs[at(contact.pair)].slot)];
  auto& spots = spotsOf(world, contact);
  if (k == 0 || chunk.contacts[k - 1].pair != contact.pair) {
    firstOfPair = k;
    std::size_t end = k + 1;
    while (end < chunk.contacts.size() && chunk.contacts[end].pair == contact.pair) ++end;
    matchSpots(spots, end - k, [&](std::size_t spot) { return chunk.contacts[k + spot].spot; });
  }
  return spots[k - firstOfPair].history;
}

/// The law for many contacts at once, or null where they go one by one.
LawInLanes chooseLanes(const WorldOptions& options) {
  return options.noBatches || options.energy ? nullptr : lawInLanes(options.law, options.lawOptions);
}

/// The law of every contact of a chunk, many at once.
void applyLawInLanes(double dt, LawInLanes law, World::Chunk& chunk, World& world) {
  thread_local LawBatch batch;
  batch.begin(dt, law, chunk, world);
  std::size_t firstOfPair = 0;
  for (std::size_t k = 0; k < chunk.contacts.size(); ++k) {
    batch.add(chunk.contacts[k], findHistory(world, chunk, k, firstOfPair));
  }
  batch.finish();
}

/// The law of every contact of a chunk, one by one. With a ledger each answer is accounted for as well; the forces are
/// the same bits.
template <bool keepsLedger>
void applyLaw(double dt, World::Chunk& chunk, World& world) {
  const WorldOptions& options = world.options;
  const Law law = lawFunction(options.law);
  std::size_t firstOfPair = 0;
  if constexpr (keepsLedger) chunk.accounts.resize(chunk.contacts.size());
  for (std::size_t k = 0; k < chunk.contacts.size(); ++k) {
    Contact& contact = chunk.contacts[k];
    Encounter met = meet(world, contact, dt);
    const LawConstants& constants = world.materials.constants(met.materialA, met.materialB);
    ContactHistory& history = findHistory(world, chunk, k, firstOfPair);
    [[maybe_unused]] ContactHistory before;
    if constexpr (keepsLedger) before = history;
    law(constants, options.lawOptions, met.a, met.b, met.motion, history, contact.force);
    contact.torqueA = met.a.arm.cross(contact.force.force) + contact.force.couple;
    contact.torqueB = -met.b.arm.cross(contact.force.force) - contact.force.couple;
    deliver(
        1, [&](std::size_t) { return pullOf(contact); }, chunk, world);
    if constexpr (keepsLedger) {
      chunk.accounts[k] = accountContact(options.law, constants, options.lawOptions, met.a, met.b, met.motion, before,
                                         history, contact.force);
    }
  }
}

/// Of all contacts of each wall that a servo presses, N/m; 0 for the others.
void measureWallStiffness(World& world) {
  world.wallStiffness.assign(world.walls.size(), 0);
  const auto isHeld = [](const auto& wall) { return wall->heldBy() != nullptr; };
  if (std::none_of(world.walls.begin(), world.walls.end(), isHeld)) return;
  for (std::size_t c = world.wallChunkBegin; c < world.chunks.size(); ++c) {
    for (const Contact& contact : world.chunks[c].contacts) {
      const std::size_t k = at(-1 - contact.b);
      const int bodyMaterial = world.bodies.material[at(contact.a)];
      const LawConstants& constants = world.materials.constants(bodyMaterial, world.walls[k]->material);
      double stiffness = constants.parameters.stiffness;
      if (lawSetsStiffness(world.options.law)) {
        const ContactBody body = viewBody(world.bodies, at(contact.a), Vec3::Zero(), false);
        const double radius = lawReadsCurvature(world.options.law) ? contactRadius(world, contact) : 0;
        stiffness =
            stiffnessOf(world.options.law, constants, {}, body, {}, contact.touch.normal, contact.patch.depth, radius)
                .normal;
      }
      world.wallStiffness[k] += contact.share * contact.patch.share * stiffness;
    }
  }
}

/// What is summed of a body.
struct Sums {
  Vec3 force, torque;
  double load;  ///< for sleep alone
};

/// Weight, and for a sleeper the contacts at rest: before the contacts of the step are added.
Sums beginSums(const World& world, std::size_t i) {
  const Bodies& bodies = world.bodies;
  Sums sums{bodies.mass[i] * world.options.gravity, Vec3::Zero(), 0};
  if (world.options.sleep.on) sums.load = sums.force.norm();
  if (bodies.state[i] == BodyState::asleep && !world.heldForce.empty()) {
    sums.force += world.heldForce[i];
    sums.torque += world.heldTorque[i];
  }
  return sums;
}
void keepSums(const Sums& sums, std::size_t i, World& world) {
  world.bodies.force[i] = sums.force;
  world.bodies.torque[i] = sums.torque;
  if (world.options.sleep.on) world.load[i] = sums.load;
}

/// The same for a run of the gathered: in lanes where there are weights alone.
void beginSums(World& world, std::size_t first, std::size_t last) {
  if (world.options.sleep.on || !world.heldForce.empty()) {
    for (std::size_t g = first; g < last; ++g)
      keepSums(beginSums(world, at(world.gathered[g])), at(world.gathered[g]), world);
    return;
  }
  Bodies& bodies = world.bodies;
  const Vec3& g = world.options.gravity;
  visitBodies(world.gathered.data() + first, last - first, world.options.noBatches, false,
              [&]<class Place>(const Place& place) {
                using Real = typename Place::Real;
                const Real mass = place.read(bodies.mass);
                place.write(Triple<Real>{mass * g.x(), mass * g.y(), mass * g.z()}, bodies.force);
                place.write(Triple<Real>{}, bodies.torque);
              });
}

/// Which run of chunks names each body first, for so many runs.
void layOutRuns(std::size_t runs, World& world) {
  world.runs = runs;
  for (World::Chunk& chunk : world.chunks) chunk.run = 0;
  discard(world.firstRun);
  if (runs == 1) return;
  constexpr std::uint16_t none = std::numeric_limits<std::uint16_t>::max();
  world.firstRun.assign(world.bodies.size(), none);
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t end = beginOfRun(run + 1, runs, world.chunks.size());
    for (std::size_t c = beginOfRun(run, runs, world.chunks.size()); c < end; ++c) {
      world.chunks[c].run = run;
      visitBodiesOfChunk(c, world, [&](std::int32_t body) {
        std::uint16_t& first = world.firstRun[at(body)];
        if (first == none) first = static_cast<std::uint16_t>(run);
      });
    }
  }
}

/// Adds what is left of the pulls of all chunks to bodies from slot `lowest` to slot `highest`.
void addPulls(std::int32_t lowest, std::int32_t highest, World& world) {
  const auto isOwn = [=](std::int32_t body) { return lowest <= body && body <= highest; };
  for (const World::Chunk& chunk : world.chunks) {
    if (chunk.highest < lowest || highest < chunk.lowest) continue;
    for (const ContactPull& pull : chunk.pulls) addPull(pull, world, isOwn);
  }
}

}  // namespace

void applyForceLaws(double dt, std::size_t c, World& world) {
  World::Chunk& chunk = world.chunks[c];
  if (const LawInLanes law = chooseLanes(world.options)) return applyLawInLanes(dt, law, chunk, world);
  world.options.energy ? applyLaw<true>(dt, chunk, world) : applyLaw<false>(dt, chunk, world);
}

void beginForces(World& world) {
  if (world.options.sleep.on) world.load.resize(world.bodies.size());
  const bool shared = world.chunks.size() >= chunksForThreads;
  const std::size_t runs = shared ? static_cast<std::size_t>(omp_get_max_threads()) : 1;
  if (runs != world.runs) layOutRuns(runs, world);
  const std::size_t count = world.gathered.size();
  const std::size_t parts = count >= bodiesForThreads ? static_cast<std::size_t>(omp_get_max_threads()) : 1;
  const auto begin = [&](std::size_t k) { return k == parts ? count : k * (count / wideSize) / parts * wideSize; };
  shareOutEvenly(parts, parts > 1, [&](std::size_t k) { beginSums(world, begin(k), begin(k + 1)); });
}

void gatherForces(World& world) {
  std::size_t left = 0;
  for (const World::Chunk& chunk : world.chunks) left += chunk.pulls.size();
  const std::size_t parts = left >= pullsForThreads ? static_cast<std::size_t>(omp_get_max_threads()) : 1;
  const auto begin = [&](std::size_t k) {
    return static_cast<std::int32_t>(beginOfRun(k, parts, world.bodies.size()));
  };
  if (left > 0) shareOutEvenly(parts, parts > 1, [&](std::size_t k) { addPulls(begin(k), begin(k + 1) - 1, world); });

  // Walls are few: their sums run over all their contacts in order.
  world.wallForces.assign(world.walls.size(), Vec3::Zero());
  for (std::size_t c = world.wallChunkBegin; c < world.chunks.size(); ++c) {
    for (const Contact& contact : world.chunks[c].contacts) world.wallForces[at(-1 - contact.b)] -= contact.force.force;
  }
  measureWallStiffness(world);
}

}  // namespace granular
