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
  ContactLanes::Lane smallerRadius;
};

/// One sphere of each pair of a register.
struct Party {
  Triple<Wide> x;
  Wide radius;

  Party(const std::vector<BoundingSphere>& balls, const std::int32_t* slots) {
    std::array<const double*, wideSize> rows;
    for (std::size_t k = 0; k < wideSize; ++k) rows[k] = balls[at(slots[k])].x.data();
    std::array<Wide, 4> column;
    loadRows(rows, column);
    x = {column[0], column[1], column[2]};
    radius = column[3];
  }
};

/// Makes the contacts of a chunk.
class SphereLooks {
 public:
  SphereLooks(double dt, World& of, std::size_t c)
      : world(of),
        chunk(of.chunks[c]),
        active(&of.activePairs[c * World::chunkSize]),
        periodic(of.options.periods.any()),
        elastic(lawReadsCurvature(of.options.law)),
        batch(ownOfThread<SphereBatch>()) {
    batch.begin(dt, of);
    batch.childA.fill(-1);
    batch.childB.fill(-1);
    for (std::size_t k = 0; k < BriefBatch::capacity; k += wideSize) batch.shift.store(k, Triple<Wide>{});
  }

  /// From where they are to the law, those of the due pairs from this one on that a batch has room for; how many.
  std::size_t takeFrom(std::size_t first) {
    const std::size_t count = std::min(BriefBatch::capacity, chunk.due.count - first);
    for (std::size_t k = 0; k < count; ++k) take(first + k, k);
    batch.contacts.count = count;
    chunk.counts.warm += count;
    batch.fillRegister();
    for (std::size_t k = 0; k < count; k += wideSize) place(k);
    for (std::size_t k = 0; k < count; ++k) {
      if (!(batch.contacts.overlap[k] > 0)) part(k);
    }
    batch.dropApart(batch.smallerRadius, chunk);
    batch.press(chunk);
    return count;
  }

 private:
  void take(std::size_t due, std::size_t k) {
    fetch(due + ahead);
    SpherePair& spheres = chunk.due.spheres[due];
    batch.pair[k] = active[chunk.due.place[due]];
    batch.a[k] = spheres.a;
    batch.b[k] = spheres.b;
    batch.due[k] = due;
    batch.history[k] = &spheres.history;
    if (periodic) batch.shift.put(k, world.options.periods.shift(world.pairs.pairs[at(batch.pair[k])].image));
  }

  /// Who comes later: the motion of A is near, because neighbours in the list share it.
  void fetch(std::size_t due) const {
    if (due >= chunk.due.count) return;
    const auto b = at(chunk.due.spheres[due].b);
    __builtin_prefetch(&world.bodies.bounds[b]);
    fetchWhole(world.bodies.motion[b]);
  }

  /// Where the spheres of the register from lane k on touch (narrow/ball_touch.h).
  void place(std::size_t k) {
    const std::vector<BoundingSphere>& balls = world.bodies.bounds;
    const Party a(balls, &batch.a[k]), b(balls, &batch.b[k]);
    const Triple<Wide> between = b.x + batch.shift.load(k) - a.x;
    const Wide distance = between.norm(), radii = a.radius + b.radius, inside = radii - distance;
    const Mask<Wide> apart = distance > Wide{};
    const Triple<Wide> along = Wide(1 / choose(apart, distance, spread(1))) * between;
    const Triple<Wide> n = choose<Wide>(apart, along, {spread(1), Wide{}, Wide{}});
    if (elastic) batch.contacts.radius.store(k, a.radius * b.radius / radii);
    batch.smallerRadius.store(k, smaller(a.radius, b.radius));
    batch.place(k, {n, inside, a.x + Wide(a.radius - 0.5 * inside) * n}, a.x, b.x);
  }

  /// Waits for as long as the gap needs to close.
  void part(std::size_t k) {
    Pair& pair = world.pairs.pairs[at(batch.pair[k])];
    const double travel = world.bodies.travel[at(pair.a)] + world.bodies.travel[at(pair.b)];
    pair.quietUntil = travel + std::max(0.0, -batch.contacts.overlap[k]);
    *batch.history[k] = ContactHistory{};
  }

  static constexpr std::size_t ahead = 8;  // pairs whose motion is asked for in time

  World& world;
  World::Chunk& chunk;
  const std::int32_t* active;  // pairs of the chunk
  const bool periodic, elastic;
  SphereBatch& batch;
};

/// Contacts that were held while both bodies were at rest are no longer.
void forgetHeld(World& world, std::size_t c) {
  std::vector<Contact>& held = world.pairs.memory.held;
  if (held.empty()) return;
  const World::Chunk::Due& due = world.chunks[c].due;
  for (std::size_t k = 0; k < due.count; ++k) {
    const std::int32_t index = world.activePairs[c * World::chunkSize + due.place[k]];
    const std::size_t slot = at(world.pairs.pairs[at(index)].slot);
    if (slot < held.size()) held[slot].a = -1;
  }
}

}  // namespace

void makeSphereContacts(double dt, std::size_t c, World& world) {
  startChunk(world, c);
  const std::size_t count = refreshDue(world, c).count;
  forgetHeld(world, c);
  SphereLooks looks(dt, world, c);
  for (std::size_t k = 0; k < count;) k += looks.takeFrom(k);
}

}  // namespace granular
