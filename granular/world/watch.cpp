// The last stage of a step: what a user must be told. Counted always, named the first few times.
#include "granular/body/lanes.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

/// Names both parties of a contact, as in Contact.
Trouble troubleOf(const World& world, const std::array<std::int32_t, 2>& parties, Trouble::Kind kind, double value) {
  const auto [a, b] = parties;
  Trouble trouble{kind, world.time, world.bodies.id[static_cast<std::size_t>(a)], -1, {}, value};
  if (b >= 0) {
    trouble.bodyB = world.bodies.id[static_cast<std::size_t>(b)];
  } else {
    trouble.wall = world.walls[static_cast<std::size_t>(-1 - b)]->name;
  }
  return trouble;
}

/// Square of a bound on the speed of the surface, m^2/s^2.
template <class Place>
typename Place::Real squareSpeed(const Bodies& bodies, const Place& place) {
  const auto motion = place.readNow(bodies.motion);
  const auto radius = place.read(bodies.bounds).radius;
  return motion.v.dot(motion.v) + motion.w.dot(motion.w) * radius * radius;
}

}  // namespace

void watch(World& world) {
  Report& report = world.report;
  const Bodies& bodies = world.bodies;

  // Contacts: the certificate and the deepest overlap.
  double deepest = 0;
  const World::Chunk* deepestChunk = nullptr;
  for (const World::Chunk& chunk : world.chunks) {
    report.contactSteps += chunk.contacts.size() + chunk.briefs.size();
    report.narrow += chunk.counts;
    if (chunk.uncertifiedPair >= 0) {
      const Pair& pair = world.pairs.pairs[static_cast<std::size_t>(chunk.uncertifiedPair)];
      report.add({Trouble::Kind::uncertified,
                  world.time,
                  bodies.id[static_cast<std::size_t>(pair.a)],
                  bodies.id[static_cast<std::size_t>(pair.b)],
                  {},
                  0});
    }
    if (chunk.deepestContact >= 0 && chunk.deepest > deepest) {
      deepest = chunk.deepest;
      deepestChunk = &chunk;
    }
  }
  if (deepestChunk && (deepest > report.deepestOverlap || deepest > world.options.deepOverlap)) {
    const auto parties = world.partiesOf(*deepestChunk, static_cast<std::size_t>(deepestChunk->deepestContact));
    const Trouble trouble = troubleOf(world, parties, Trouble::Kind::deepOverlap, deepest);
    if (deepest > report.deepestOverlap) {
      report.deepestOverlap = deepest;
      report.deepestTime = world.time;
      report.deepestA = trouble.bodyA;
      report.deepestB = trouble.bodyB;
    }
    if (deepest > world.options.deepOverlap) report.add(trouble);
  }

  // Bodies: one comparison catches speeds that are too large and those that are not numbers.
  const double limit = world.options.maxSpeed * world.options.maxSpeed;
  report.bodySteps += bodies.movingSlots().size() + bodies.flying().all.size();
  visitBodies(bodies.movingSlots(), world.options.noBatches, false, [&]<class Place>(const Place& place) {
    if (all(squareSpeed(bodies, place) <= limit + typename Place::Real{})) return;
    for (std::size_t k = 0; k < place.count; ++k) {
      const double square = squareSpeed(bodies, OneBody(place.at(k)));
      if (square <= limit) continue;
      const bool finite = std::isfinite(square);
      report.add({finite ? Trouble::Kind::tooFast : Trouble::Kind::nonFinite,
                  world.time,
                  bodies.id[place.at(k)],
                  -1,
                  {},
                  std::sqrt(square)});
    }
  });
}

void checkDomain(World& world) {
  const Bodies& bodies = world.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t k = 0; k < world.vesselWalls; ++k) {
      if (world.walls[k]->admits(bodies.x(i))) continue;
      world.report.add({Trouble::Kind::escaped, world.time, bodies.id[i], -1, world.walls[k]->name, 0});
    }
  }
}

}  // namespace granular
