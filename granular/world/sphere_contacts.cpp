// Contacts of spheres in batches, a register full at a time from the centres to the law. In a bed nearly all pairs that
// are looked at touch.
//
// Every number is made by the operations of lookAtPair, placeContact and the law in their order: the answers are the
// same bits, which Balls.InBatchesHaveTheSameBitsAsOneByOne holds this file to.
#include <algorithm>

#include "granular/core/placed_axes.h"
#include "granular/core/prefetch.h"
#include "granular/world/brief_batch.h"
#include "granular/world/looks.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// A batch of contacts, and what their places are made of.
struct SphereBatch : BriefBatch {
  std::array<std::size_t, capacity> position;  // of the pair among the active ones
  ContactLanes::Lane radiusA, radiusB, smallerRadius;

  void fillRegister() {
    BriefBatch::fillRegister();
    const std::size_t last = count() - 1;
    for (std::size_t k = count(); k % wideSize != 0; ++k) {
      radiusA[k] = radiusA[last];
      radiusB[k] = radiusB[last];
    }
  }
};

Triple<Wide> loadCentres(const Bodies& bodies, const std::int32_t* slots) {
  std::array<const Vec3*, wideSize> centres;
  for (std::size_t k = 0; k < wideSize; ++k) centres[k] = &bodies.x[at(slots[k])];
  return loadVectors(centres);
}

/// Where the spheres of the register from lane k on touch (narrow/ball_touch.h). elastic: lawReadsCurvature.
void placeSpheres(const Bodies& bodies, bool elastic, std::size_t k, SphereBatch& s) {
  const Triple<Wide> xA = loadCentres(bodies, &s.a[k]), xB = loadCentres(bodies, &s.b[k]);
  const Triple<Wide> between = xB + s.shift.load(k) - xA;
  const Wide distance = between.norm(), radiusA = s.radiusA.load(k), radiusB = s.radiusB.load(k);
  const Wide radii = radiusA + radiusB, inside = radii - distance;
  const Mask<Wide> apart = distance > Wide{};
  const Triple<Wide> along = Wide(1 / choose(apart, distance, spread(1))) * between;
  const Triple<Wide> n = choose<Wide>(apart, along, {spread(1), Wide{}, Wide{}});
  if (elastic) s.contacts.radius.store(k, radiusA * radiusB / radii);
  s.smallerRadius.store(k, smaller(radiusA, radiusB));
  s.place(k, {n, inside, xA + Wide(radiusA - 0.5 * inside) * n}, xA, xB);
}

/// Makes the contacts of a chunk.
class SphereLooks {
 public:
  SphereLooks(double dt, World& of, World::Chunk& into)
      : world(of),
        chunk(into),
        anyHeld(!of.pairs.memory.held.empty()),
        elastic(lawReadsCurvature(of.options.law)),
        batch(ownOfThread<SphereBatch>()) {
    batch.begin(dt, of);
  }

  /// Looks at a pair that is due; position: among the active ones.
  void take(std::size_t position) {
    const std::int32_t index = world.activePairs[position];
    const Pair& pair = world.pairs.pairs[at(index)];
    PairMemory& memory = world.pairs.memory;
    if (anyHeld && at(pair.slot) < memory.held.size()) memory.held[at(pair.slot)].a = -1;
    const std::size_t k = batch.add({index, pair.a, pair.b, -1, -1}, memory.history[at(pair.slot)]);
    batch.position[k] = position;
    batch.shift.put(k, world.options.periods.shift(pair.image));
    batch.radiusA[k] = world.bodies.boundingRadius[at(pair.a)];
    batch.radiusB[k] = world.bodies.boundingRadius[at(pair.b)];
    if (batch.count() == BriefBatch::capacity) finish();
  }

  /// Finds where those that wait touch, and presses them.
  void finish() {
    if (batch.count() == 0) return;
    chunk.counts.warm += batch.count();
    batch.fillRegister();
    for (std::size_t k = 0; k < batch.count(); k += wideSize) placeSpheres(world.bodies, elastic, k, batch);
    for (std::size_t k = 0; k < batch.count(); ++k) {
      if (!(batch.contacts.overlap[k] > 0)) part(k);
    }
    batch.dropApart(batch.position, batch.smallerRadius, world, chunk);
    batch.press(chunk);
  }

 private:
  /// Waits for as long as the gap needs to close.
  void part(std::size_t k) {
    Pair& pair = world.pairs.pairs[at(batch.pair[k])];
    const double travel = world.bodies.travel[at(pair.a)] + world.bodies.travel[at(pair.b)];
    pair.quietUntil = travel + std::max(0.0, -batch.contacts.overlap[k]);
    *batch.history[k] = ContactHistory{};
  }

  World& world;
  World::Chunk& chunk;
  const bool anyHeld;  ///< contacts between bodies at rest
  const bool elastic;
  SphereBatch& batch;
};

}  // namespace

void makeSphereContacts(double dt, std::size_t c, World& world) {
  World::Chunk& chunk = startChunk(world, c);
  SphereLooks looks(dt, world, chunk);
  const auto fetch = [&](const Pair& pair) {
    __builtin_prefetch(&world.pairs.memory.history[at(pair.slot)]);
    __builtin_prefetch(&world.bodies.x[at(pair.b)]);
    fetchWhole(world.motionRows[at(pair.b)]);
  };
  takeDue(world, c, fetch, [&](std::size_t position) { looks.take(position); });
  looks.finish();
}

}  // namespace granular
