// Contacts of spheres and of clumps, which are made of spheres, in batches: found, placed and pressed without the
// machinery that other shapes need. A chunk's touching balls are laid out side by side, each quantity in a lane of its
// own (law/contact_lanes.h); where they touch is worked out for as many at once as a register holds, and the law goes
// on from there.
//
// Every number is made by the operations of lookAtPair, placeContact and the law in their order: the answers are the
// same bits, which Balls.InBatchesHaveTheSameBitsAsOneByOne holds this file to.
#include <algorithm>
#include <array>

#include "granular/law/contact_lanes.h"
#include "granular/narrow/ball_touch.h"
#include "granular/narrow/clump_pair.h"
#include "granular/point/witness.h"
#include "granular/world/clump_contacts.h"
#include "granular/world/looks.h"
#include "granular/world/spots.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// A pair of bodies whose balls are looked at.
struct BallPair {
  std::int32_t index, a, b;  ///< in the list; body slots
  Vec3 shift;                ///< of B's image
};

/// Two balls that touch.
struct TouchingBalls {
  std::int32_t childA, childB;  ///< as in Spot
  Vec3 centreA, between;        ///< of A's ball; from there to the centre of B's
  double distance, radiusA, radiusB;
  double overlap() const { return radiusA + radiusB - distance; }
};

/// A batch of contacts.
struct Batch {
  static constexpr std::size_t capacity = ContactLanes::capacity;

  std::array<std::int32_t, capacity> pair, a, b, childA, childB;
  std::array<ContactHistory*, capacity> history;
  ContactLanes::Lanes bodyA, bodyB, shift;  // centres of mass; of B's image
  ContactLanes::Lanes ballA, between;       // centre of A's ball; from there to the centre of B's
  ContactLanes::Lane distance, radiusA, radiusB;
  ContactLanes contacts;

  std::size_t count() const { return contacts.count; }
  void add(const BallPair& of, const TouchingBalls& touch, ContactHistory& memory) {
    const std::size_t k = contacts.count++;
    pair[k] = of.index;
    a[k] = of.a;
    b[k] = of.b;
    childA[k] = touch.childA;
    childB[k] = touch.childB;
    history[k] = &memory;
    shift.put(k, of.shift);
    ballA.put(k, touch.centreA);
    between.put(k, touch.between);
    distance[k] = touch.distance;
    radiusA[k] = touch.radiusA;
    radiusB[k] = touch.radiusB;
  }
  /// Lane k takes part in loading whole registers, as contact `last`, and in nothing else.
  void repeat(std::size_t last, std::size_t k) {
    a[k] = a[last];
    b[k] = b[last];
    history[k] = history[last];
  }
  void putConstants(std::size_t k, const World& world, std::int32_t materialA, std::int32_t materialB) {
    const WorldOptions& options = world.options;
    contacts.putConstants(k, world.materials.constants(materialA, materialB), options.lawOptions.tension,
                          lawReadsCurvature(options.law));
  }
};

/// What the law reads of where two balls touch (narrow/ball_touch.h).
void placeBalls(Batch& s) {
  for (std::size_t k = 0; k < s.count(); k += wideSize) {
    const Wide distance = s.distance.load(k), radiusA = s.radiusA.load(k), radiusB = s.radiusB.load(k);
    const Wide radii = radiusA + radiusB, inside = radii - distance;
    const Triple<Wide> between = s.between.load(k);
    const Mask<Wide> apart = distance > Wide{};
    const Wide divisor = choose(apart, distance, spread(1));
    const Triple<Wide> along = {between.x / divisor, between.y / divisor, between.z / divisor};
    const Triple<Wide> n = choose<Wide>(apart, along, {spread(1), Wide{}, Wide{}});
    const Triple<Wide> middle = s.ballA.load(k) + Wide(radiusA - 0.5 * inside) * n;
    const Triple<Wide> half = Wide(0.5 * inside) * n;
    const Triple<Wide> point = 0.5 * (middle + half + (middle - half));
    s.contacts.normal.store(k, n);
    s.contacts.overlap.store(k, inside);
    s.contacts.squaredDepth.store(k, inside * inside);
    s.contacts.radius.store(k, radiusA * radiusB / radii);
    s.contacts.a.arm.store(k, point - s.bodyA.load(k));
    s.contacts.b.arm.store(k, point - s.bodyB.load(k) - s.shift.load(k));
  }
}

/// What the law reads of the bodies and remembers of the contacts.
void loadBatch(const World& world, bool manyMaterials, Batch& batch) {
  const Bodies& bodies = world.bodies;
  ContactLanes& contacts = batch.contacts;
  const std::size_t count = batch.count();
  for (std::size_t k = count; k % wideSize != 0; ++k) batch.repeat(count - 1, k);
  for (std::size_t k = 0; k < count; k += wideSize) {
    std::array<const MotionRow*, wideSize> a, b;
    for (std::size_t i = 0; i < wideSize; ++i) {
      a[i] = &world.motionRows[at(batch.a[k + i])];
      b[i] = &world.motionRows[at(batch.b[k + i])];
    }
    contacts.a.put(k, a);
    contacts.b.put(k, b);
    contacts.putHistories(k, &batch.history[k]);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t a = at(batch.a[k]), b = at(batch.b[k]);
    batch.bodyA.put(k, bodies.x[a]);
    batch.bodyB.put(k, bodies.x[b]);
    if (manyMaterials) batch.putConstants(k, world, bodies.material[a], bodies.material[b]);
  }
}

/// Answers into the chunk, histories into the pairs' memory.
void storeBatch(const Batch& batch, World::Chunk& chunk) {
  const ContactLanes& contacts = batch.contacts;
  const std::size_t before = chunk.balls.size(), count = batch.count();
  chunk.balls.resize(before + count);
  chunk.pulls.resize(before + count);
  for (std::size_t k = 0; k < count; k += wideSize) {
    const std::size_t some = std::min(wideSize, count - k);
    std::array<ContactPull*, wideSize> pulls;
    std::array<double*, wideSize> balls;
    for (std::size_t i = 0; i < wideSize; ++i) {
      const std::size_t place = before + k + std::min(i, some - 1);
      pulls[i] = &chunk.pulls[place];
      balls[i] = chunk.balls[place].normal.data();
    }
    contacts.takeHistories(k, some, &batch.history[k]);
    contacts.takePulls(k, some, pulls.data());
    const Triple<Wide> n = contacts.normal.load(k);
    storeRows<5>({n.x, n.y, n.z, contacts.overlap.load(k), contacts.normalForce.load(k)}, balls, some);
  }
  for (std::size_t k = 0; k < count; ++k) {
    ContactPull& pull = chunk.pulls[before + k];
    pull.a = batch.a[k];
    pull.b = batch.b[k];
    BallContact& ball = chunk.balls[before + k];
    ball.pair = batch.pair[k];
    ball.childA = batch.childA[k];
    ball.childB = batch.childB[k];
    ball.sliding = contacts.sliding[k] != 0;
    ball.held = false;
  }
}

/// Makes the contacts of a chunk.
class BallLooks {
 public:
  BallLooks(double dt, World& of, World::Chunk& into)
      : world(of),
        chunk(into),
        law(lawInLanes(of.options.law, of.options.lawOptions)),
        manyMaterials(of.materials.count() > 1) {
    batch.contacts.count = 0;
    batch.contacts.dt = dt;
    for (std::size_t k = 0; k < Batch::capacity; ++k) {
      batch.contacts.share[k] = 1;
      batch.contacts.area[k] = 0;
      if (!manyMaterials) batch.putConstants(k, of, 0, 0);
    }
  }

  /// Looks at one pair; how many contacts it has.
  std::size_t take(std::int32_t index) {
    const Bodies& bodies = world.bodies;
    Pair& pair = world.pairs.pairs[at(index)];
    const std::size_t a = at(pair.a), b = at(pair.b);
    const double travel = bodies.travel[a] + bodies.travel[b];
    if (isQuiet(world, pair)) return 0;  // holds no contact either
    const bool ofClump = world.anyClump && (asClump(*bodies.shape[a]) || asClump(*bodies.shape[b]));
    forgetHeld(pair, ofClump);
    return ofClump ? lookAtChildren(index, travel, pair) : lookAtSpheres(index, travel, pair);
  }

  /// How many contacts there are so far.
  std::size_t count() const { return chunk.balls.size() + batch.count(); }

  /// Through the law with what waits.
  void finish() {
    if (batch.count() == 0) return;
    loadBatch(world, manyMaterials, batch);
    placeBalls(batch);
    law(world.options.lawOptions, batch.contacts);
    storeBatch(batch, chunk);
    batch.contacts.count = 0;
  }

 private:
  void forgetHeld(const Pair& pair, bool ofClump) {
    PairMemory& memory = world.pairs.memory;
    if (ofClump) return memory.clumps[at(pair.slot)].held.clear();
    if (at(pair.slot) < memory.held.size()) memory.held[at(pair.slot)].a = -1;
  }

  BallPair view(std::int32_t index, const Pair& pair) const {
    return {index, pair.a, pair.b, world.options.periods.shift(pair.image)};
  }

  void add(const BallPair& pair, const TouchingBalls& touch, double size, ContactHistory& history) {
    const double overlap = touch.overlap();
    if (overlap > chunk.deepest * size) {
      chunk.deepest = overlap / size;
      chunk.deepestContact = static_cast<std::int32_t>(count());
    }
    batch.add(pair, touch, history);
    if (batch.count() == Batch::capacity) finish();
  }

  std::size_t lookAtSpheres(std::int32_t index, double travel, Pair& pair) {
    const Bodies& bodies = world.bodies;
    const std::size_t a = at(pair.a), b = at(pair.b);
    const BallPair pairOfBalls = view(index, pair);
    ++chunk.counts.warm;
    const Vec3 between = (bodies.x[b] + pairOfBalls.shift) - bodies.x[a];
    const TouchingBalls touch{
        -1, -1, bodies.x[a], between, between.norm(), bodies.boundingRadius[a], bodies.boundingRadius[b]};
    ContactHistory& history = world.pairs.memory.history[at(pair.slot)];
    if (!(touch.overlap() > 0)) {
      pair.quietUntil = travel + std::max(0.0, -touch.overlap());
      history = ContactHistory{};
      return 0;
    }
    add(pairOfBalls, touch, std::min(touch.radiusA, touch.radiusB), history);
    return 1;
  }

  std::size_t lookAtChildren(std::int32_t index, double travel, Pair& pair) {
    const Bodies& bodies = world.bodies;
    const Shape &shapeA = *bodies.shape[at(pair.a)], &shapeB = *bodies.shape[at(pair.b)];
    const BallPair pairOfBalls = view(index, pair);
    Frame frameB = bodies.frame[at(pair.b)];
    frameB.x += pairOfBalls.shift;
    const ClumpPairView clumps{shapeA, bodies.frame[at(pair.a)], shapeB, frameB};
    ClumpMemory& memory = world.pairs.memory.clumps[at(pair.slot)];
    refreshChildren(world, clumps, travel, memory);

    // All children that touch: their histories are found together.
    touching.clear();
    const double quiet = visitNearChildren(world, travel, memory.children, [&](std::size_t k) {
      const ChildPair& children = memory.children.near[k];
      ++chunk.counts.warm;
      const PlacedBall ballA = placeBall(shapeA, clumps.frameA, children.childA);
      const PlacedBall ballB = placeBall(shapeB, frameB, children.childB);
      const Vec3 between = ballB.centre - ballA.centre;
      const TouchingBalls touch{children.childA, children.childB, ballA.centre, between,
                                between.norm(),  ballA.radius,    ballB.radius};
      if (touch.overlap() > 0) touching.push_back(touch);
      return touch.overlap();
    });
    if (touching.empty()) {
      pair.quietUntil = quiet;
      memory.spots.clear();
      return 0;
    }
    matchSpots(memory.spots, touching.size(), [&](std::size_t k) {
      return Spot{0, touching[k].childA, touching[k].childB};
    });
    const double size = std::min(shapeA.size(), shapeB.size());
    for (std::size_t k = 0; k < touching.size(); ++k) add(pairOfBalls, touching[k], size, memory.spots[k].history);
    return touching.size();
  }

  World& world;
  World::Chunk& chunk;
  const LawInLanes law;
  const bool manyMaterials;
  // Large, and kept from call to call.
  static thread_local Batch batch;
  static thread_local std::vector<TouchingBalls> touching;
};
thread_local Batch BallLooks::batch{};
thread_local std::vector<TouchingBalls> BallLooks::touching;

}  // namespace

void makeBallContacts(double dt, std::size_t c, World& world) {
  World::Chunk& chunk = world.chunks[c];
  startChunk(chunk);
  BallLooks looks(dt, world, chunk);
  const std::size_t first = c * World::chunkSize;
  const std::size_t last = std::min(first + World::chunkSize, world.activePairs.size());
  for (std::size_t p = first; p < last; ++p) {
    const std::size_t before = looks.count(), found = looks.take(world.activePairs[p]);
    world.contactsOfPair[p] = {static_cast<std::int32_t>(before), static_cast<std::int32_t>(found)};
  }
  looks.finish();
}

Contact World::describeBall(const Chunk& chunk, std::size_t k) const {
  const BallContact& ball = chunk.balls[k];
  const ContactPull& pull = chunk.pulls[k];
  const std::size_t a = at(pull.a);
  const PlacedBall ballA = placeBall(*bodies.shape[a], bodies.frame[a], ball.childA);
  Contact contact;
  contact.pair = ball.pair;
  contact.a = pull.a;
  contact.b = pull.b;
  contact.spot = {0, ball.childA, ball.childB};
  contact.shift = options.periods.shift(pairs.pairs[at(ball.pair)].image);
  fillBallTouch({ball.normal, ball.overlap}, ballA.centre, ballA.radius, contact.touch);
  placeWitness(contact.touch, contact.patch);
  contact.force = {pull.force, Vec3::Zero(), ball.normalForce, ball.sliding};
  contact.held = ball.held;
  contact.torqueA = pull.torqueA;
  contact.torqueB = pull.torqueB;
  return contact;
}

}  // namespace granular
