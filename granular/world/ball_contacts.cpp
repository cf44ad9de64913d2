// Contacts of spheres in batches: found, placed and pressed without the machinery that other shapes need. A chunk's
// touching pairs are laid out side by side, each quantity in a lane of its own (law/contact_lanes.h); where they touch
// is worked out for as many at once as a register holds, and the law goes on from there.
//
// Every number is made by the operations of lookAtPair, placeContact and the law in their order: the answers are the
// same bits, which Balls.InBatchesHaveTheSameBitsAsOneByOne holds this file to.
#include <algorithm>
#include <array>

#include "granular/law/contact_lanes.h"
#include "granular/narrow/ball_touch.h"
#include "granular/point/witness.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// A batch of touching pairs.
struct Batch {
  static constexpr std::size_t capacity = ContactLanes::capacity;

  std::array<std::int32_t, capacity> pair, a, b, slot;
  ContactLanes::Lanes xA, xB, shift, between;  // centres; of B's image; from A's centre to B's
  ContactLanes::Lane distance, radiusA, radii;
  ContactLanes contacts;

  std::size_t count() const { return contacts.count; }
};

/// What the law reads of where two balls touch (narrow/ball_touch.h).
void placeBalls(Batch& s) {
  for (std::size_t k = 0; k < s.count(); k += wideSize) {
    const Wide distance = s.distance.load(k), inside = s.radii.load(k) - distance;
    const Triple<Wide> between = s.between.load(k);
    const Mask<Wide> apart = distance > Wide{};
    const Wide divisor = choose(apart, distance, spread(1));
    const Triple<Wide> along = {between.x / divisor, between.y / divisor, between.z / divisor};
    const Triple<Wide> n = choose<Wide>(apart, along, {spread(1), Wide{}, Wide{}});
    const Triple<Wide> centreA = s.xA.load(k);
    const Triple<Wide> middle = centreA + Wide(s.radiusA.load(k) - 0.5 * inside) * n;
    const Triple<Wide> half = Wide(0.5 * inside) * n;
    const Triple<Wide> point = 0.5 * (middle + half + (middle - half));
    s.contacts.normal.store(k, n);
    s.contacts.overlap.store(k, inside);
    s.contacts.a.arm.store(k, point - centreA);
    s.contacts.b.arm.store(k, point - s.xB.load(k) - s.shift.load(k));
  }
}

/// What the law reads of the bodies and remembers of the contacts.
void loadBatch(const World& world, Batch& batch) {
  const Bodies& bodies = world.bodies;
  ContactLanes& contacts = batch.contacts;
  for (std::size_t k = 0; k < batch.count(); ++k) {
    const std::size_t a = at(batch.a[k]), b = at(batch.b[k]);
    batch.xA.put(k, bodies.x[a]);
    batch.xB.put(k, bodies.x[b]);
    contacts.a.put(k, bodies, a);
    contacts.b.put(k, bodies, b);
    contacts.putConstants(k, world.materials.constants(bodies.material[a], bodies.material[b]),
                          world.options.lawOptions.tension);
    contacts.putHistory(k, world.pairs.memory.history[at(batch.slot[k])]);
    contacts.share[k] = 1;
    contacts.area[k] = 0;
  }
}

/// Answers into the chunk, histories into the pairs' memory.
void storeBatch(const Batch& batch, World& world, World::Chunk& chunk) {
  const ContactLanes& contacts = batch.contacts;
  for (std::size_t k = 0; k < batch.count(); ++k) {
    contacts.takeHistory(k, world.pairs.memory.history[at(batch.slot[k])]);
    BallContact& ball = chunk.balls.emplace_back();
    ball.pair = batch.pair[k];
    ball.sliding = contacts.sliding[k] != 0;
    ball.held = false;
    ball.normal = contacts.normal.take(k);
    ball.overlap = contacts.overlap[k];
    ball.normalForce = contacts.normalForce[k];
    contacts.takePull(k, batch.a[k], batch.b[k], chunk.pulls.emplace_back());
  }
}

void runBatch(LawInLanes law, Batch& batch, World& world, World::Chunk& chunk) {
  loadBatch(world, batch);
  placeBalls(batch);
  law(world.options.lawOptions, batch.contacts);
  storeBatch(batch, world, chunk);
  batch.contacts.count = 0;
}

/// Looks at one pair; adds it to the batch if it touches.
void lookAtBallPair(World& world, std::int32_t index, World::Chunk& chunk, Batch& batch) {
  const Bodies& bodies = world.bodies;
  Pair& pair = world.pairs.pairs[at(index)];
  const std::size_t a = at(pair.a), b = at(pair.b), slot = at(pair.slot);
  std::vector<Contact>& held = world.pairs.memory.held;
  if (slot < held.size()) held[slot].a = -1;
  const double travel = bodies.travel[a] + bodies.travel[b];
  if (world.options.skips.separation && travel < pair.quietUntil) return;

  ++chunk.counts.warm;
  const Vec3 shift = world.options.periods.shift(pair.image);
  const Vec3 between = (bodies.x[b] + shift) - bodies.x[a];
  const double distance = between.norm();
  const double radiusA = bodies.boundingRadius[a], radiusB = bodies.boundingRadius[b];
  const double overlap = radiusA + radiusB - distance;
  if (!(overlap > 0)) {
    pair.quietUntil = travel + std::max(0.0, -overlap);
    world.pairs.memory.history[slot] = ContactHistory{};
    return;
  }
  const std::size_t k = batch.contacts.count++;
  batch.pair[k] = index;
  batch.a[k] = pair.a;
  batch.b[k] = pair.b;
  batch.slot[k] = pair.slot;
  batch.shift.put(k, shift);
  batch.between.put(k, between);
  batch.distance[k] = distance;
  batch.radiusA[k] = radiusA;
  batch.radii[k] = radiusA + radiusB;
  const double size = std::min(radiusA, radiusB);
  if (overlap > chunk.deepest * size) {
    chunk.deepest = overlap / size;
    chunk.deepestContact = static_cast<std::int32_t>(chunk.balls.size() + k);
  }
}

}  // namespace

void makeBallContacts(double dt, std::size_t c, World& world) {
  World::Chunk& chunk = world.chunks[c];
  startChunk(chunk);
  const LawInLanes law = lawInLanes(world.options.law, world.options.lawOptions);
  thread_local Batch batch{};
  batch.contacts.count = 0;
  batch.contacts.dt = dt;
  const std::size_t first = c * World::chunkSize;
  const std::size_t last = std::min(first + World::chunkSize, world.activePairs.size());
  for (std::size_t p = first; p < last; ++p) {
    const auto before = static_cast<std::int32_t>(chunk.balls.size() + batch.count());
    lookAtBallPair(world, world.activePairs[p], chunk, batch);
    const auto after = static_cast<std::int32_t>(chunk.balls.size() + batch.count());
    world.contactsOfPair[p] = {before, after - before};
    if (batch.count() == Batch::capacity) runBatch(law, batch, world, chunk);
  }
  runBatch(law, batch, world, chunk);
}

Contact World::describeBall(const Chunk& chunk, std::size_t k) const {
  const BallContact& ball = chunk.balls[k];
  const ContactPull& pull = chunk.pulls[k];
  const std::size_t a = at(pull.a);
  Contact contact;
  contact.pair = ball.pair;
  contact.a = pull.a;
  contact.b = pull.b;
  contact.shift = options.periods.shift(pairs.pairs[at(ball.pair)].image);
  fillBallTouch({ball.normal, ball.overlap}, bodies.x[a], bodies.boundingRadius[a], contact.touch);
  placeWitness(contact.touch, contact.patch);
  contact.force = {pull.force, Vec3::Zero(), ball.normalForce, ball.sliding};
  contact.held = ball.held;
  contact.torqueA = pull.torqueA;
  contact.torqueB = pull.torqueB;
  return contact;
}

}  // namespace granular
