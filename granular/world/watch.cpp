// The last stage of a step: what a user must be told. Counted always, named the first few times.
#include "granular/world/by_scheme.h"
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

/// Names the bodies whose speed is too large or no number: one comparison catches both.
void nameTooFast(World& world) {
  const Bodies& bodies = world.bodies;
  for (const std::int32_t slot : bodies.movingSlots()) {
    const OneBody place(static_cast<std::size_t>(slot));
    const double square = squareSpeed(place.read(bodies.motion, &MotionRow::v),
                                      place.read(bodies.motion, &MotionRow::w), place.read(bodies.bounds).radius);
    if (square <= world.options.maxSpeed * world.options.maxSpeed) continue;
    const Trouble::Kind kind = std::isfinite(square) ? Trouble::Kind::tooFast : Trouble::Kind::nonFinite;
    world.report.add({kind, world.time, bodies.id[place.at(0)], -1, {}, std::sqrt(square)});
  }
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

  report.bodySteps += bodies.movingSlots().size() + bodies.flying().all.size();
  if (!world.predicted.withinLimit) nameTooFast(world);
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
