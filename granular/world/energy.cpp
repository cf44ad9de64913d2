// The stages of the energy ledger: what the kick at t_n did, contact by contact and body by body. Chunks are summed
// each by one thread and then added in their order, so that the sums don't depend on the number of threads.
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Velocities of a body's point before and after the kick.
struct PointKick {
  Vec3 before, after, spinBefore, spinAfter;
};
PointKick followPoint(const World& world, std::size_t i, const Vec3& arm) {
  const Bodies& bodies = world.bodies;
  if (!bodies.moves(i)) return {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  PointKick kick;
  kick.spinBefore = bodies.spinToWorld(i, world.spinBefore[i]);
  kick.spinAfter = bodies.spinToWorld(i, bodies.wHalfOf(i));
  kick.before = world.velocityBefore[i] + kick.spinBefore.cross(arm);
  kick.after = bodies.vHalf(i) + kick.spinAfter.cross(arm);
  return kick;
}

KickMotion followContact(const World& world, const Contact& contact) {
  const Bodies& bodies = world.bodies;
  const Vec3& point = contact.patch.point;
  const PointKick a = followPoint(world, at(contact.a), point - bodies.x(at(contact.a)));
  KickMotion motion;
  if (contact.b < 0) {
    const Wall& wall = *world.walls[at(-1 - contact.b)];
    motion.wallVelocity = wall.motion.velocityAt(point);
    motion.wallSpin = wall.motion.spin;
    motion.before = a.before - motion.wallVelocity;
    motion.after = a.after - motion.wallVelocity;
    motion.spinBefore = a.spinBefore - motion.wallSpin;
    motion.spinAfter = a.spinAfter - motion.wallSpin;
    return motion;
  }
  const PointKick b = followPoint(world, at(contact.b), point - bodies.x(at(contact.b)) - contact.shift);
  motion.before = a.before - b.before;
  motion.after = a.after - b.after;
  motion.spinBefore = a.spinBefore - b.spinBefore;
  motion.spinAfter = a.spinAfter - b.spinAfter;
  return motion;
}

/// The ledger's memory of a contact: of the pair, or of its spot, `nth` of the pair's contacts.
SpringEnergy& findEnergy(World& world, const Contact& contact, std::size_t nth) {
  PairMemory& memory = world.pairs.memory;
  if (contact.b < 0) return world.pairs.wallPairs[at(contact.pair)].spots[nth].energy;
  const std::size_t slot = at(world.pairs.pairs[at(contact.pair)].slot);
  if (contact.spot.ofClump()) return memory.clumps[slot].spots[nth].energy;
  if (world.options.rule.rule == PointRule::manifold) return memory.manifolds[slot].spots[nth].energy;
  return memory.energy[slot];
}

void bookChunk(double dt, World& world, World::Chunk& chunk) {
  chunk.booked = LedgerSums{};
  std::size_t nth = 0;
  for (std::size_t k = 0; k < chunk.contacts.size(); ++k) {
    const Contact& contact = chunk.contacts[k];
    nth = k > 0 && chunk.contacts[k - 1].pair == contact.pair ? nth + 1 : 0;
    bookContact(chunk.accounts[k], contact.force, followContact(world, contact), contact.touch.normal, dt,
                world.steps + 1, world.ledger.begun, findEnergy(world, contact, nth), chunk.booked);
  }
}

/// Springs of contacts between bodies at rest: they keep what they had, and are taken for seen.
void bookHeld(World& world, double& normal, double& tangential) {
  if (world.sleep.fallen == 0) return;
  const auto keep = [&](SpringEnergy& energy) {
    normal += energy.normal;
    tangential += energy.tangential;
    energy.step = world.steps + 1;
  };
  PairMemory& memory = world.pairs.memory;
  for (const Pair& pair : world.pairs.pairs) {
    bool single = false, several = false;
    memory.visitHeld(pair, [&](const Contact& contact) { (contact.spot.ofClump() ? several : single) = true; });
    if (single) keep(memory.energy[at(pair.slot)]);
    if (!several) continue;
    for (SpotHistory& spot : memory.clumps[at(pair.slot)].spots) keep(spot.energy);
  }
  for (WallPair& pair : world.pairs.wallPairs) {
    if (pair.held.empty()) continue;
    for (SpotHistory& spot : pair.spots) keep(spot.energy);
  }
}

}  // namespace

void rememberVelocities(World& world) {
  if (!world.options.energy) return;
  const Bodies& bodies = world.bodies;
  world.velocityBefore.resize(bodies.size());
  world.spinBefore.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    world.velocityBefore[i] = bodies.vHalf(i);
    world.spinBefore[i] = bodies.wHalfOf(i);
  }
}

void keepLedger(double dt, World& world) {
  if (!world.options.energy) return;
  world.pairs.memory.energy.resize(world.pairs.memory.size());

  // Contacts, in chunks.
  const auto chunks = static_cast<std::int64_t>(world.chunks.size());
#pragma omp parallel for schedule(dynamic) if (world.chunks.size() >= chunksForThreads)
  for (std::int64_t c = 0; c < chunks; ++c) bookChunk(dt, world, world.chunks[static_cast<std::size_t>(c)]);
  LedgerSums contacts;
  for (const World::Chunk& chunk : world.chunks) contacts.add(chunk.booked);

  // Bodies, in chunks.
  const std::size_t n = world.bodies.size();
  std::vector<BodySums> parts((n + World::chunkSize - 1) / World::chunkSize);
  const auto count = static_cast<std::int64_t>(parts.size());
#pragma omp parallel for schedule(static) if (n >= bodiesForThreads)
  for (std::int64_t c = 0; c < count; ++c) {
    const std::size_t first = static_cast<std::size_t>(c) * World::chunkSize;
    parts[static_cast<std::size_t>(c)] =
        bookBodies(world.bodies, world.velocityBefore, world.spinBefore, world.options.gravity, dt, first,
                   std::min(first + World::chunkSize, n));
  }
  BodySums bodies;
  for (const BodySums& part : parts) bodies.add(part);

  double heldNormal = 0, heldTangential = 0;
  bookHeld(world, heldNormal, heldTangential);
  world.ledger.close(contacts, bodies, heldNormal, heldTangential);
}

}  // namespace granular
