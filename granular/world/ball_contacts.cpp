// Contacts of clumps, which are made of spheres, and of spheres among them, in batches: found, placed and pressed
// without the machinery that other shapes need. A chunk's touching balls are laid out side by side, each quantity in a
// lane of its own (law/contact_lanes.h); where they touch is worked out for as many at once as a register holds, and
// the law goes on from there.
//
// Every number is made by the operations of lookAtPair, placeContact and the law in their order: the answers are the
// same bits, which Balls.InBatchesHaveTheSameBitsAsOneByOne holds this file to.
#include <algorithm>

#include "granular/narrow/clump_pair.h"
#include "granular/world/brief_batch.h"
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

/// A batch of contacts, and what their places are made of.
struct BallBatch : BriefBatch {
  ContactLanes::Lanes bodyA, bodyB;    // centres of mass
  ContactLanes::Lanes ballA, between;  // centre of A's ball; from there to the centre of B's
  ContactLanes::Lane distance, radiusA, radiusB;

  void add(const BallPair& of, const TouchingBalls& touch, ContactHistory& memory) {
    const std::size_t k = BriefBatch::add({of.index, of.a, of.b, touch.childA, touch.childB}, memory);
    shift.put(k, of.shift);
    ballA.put(k, touch.centreA);
    between.put(k, touch.between);
    distance[k] = touch.distance;
    radiusA[k] = touch.radiusA;
    radiusB[k] = touch.radiusB;
  }
};

/// Where two balls touch (narrow/ball_touch.h). elastic: lawReadsCurvature.
void placeBalls(const Bodies& bodies, bool elastic, BallBatch& s) {
  for (std::size_t k = 0; k < s.count(); ++k) {
    s.bodyA.put(k, bodies.x(at(s.a[k])));
    s.bodyB.put(k, bodies.x(at(s.b[k])));
  }
  for (std::size_t k = 0; k < s.count(); k += wideSize) {
    const Wide distance = s.distance.load(k), radiusA = s.radiusA.load(k), radiusB = s.radiusB.load(k);
    const Wide radii = radiusA + radiusB, inside = radii - distance;
    const Triple<Wide> between = s.between.load(k);
    const Mask<Wide> apart = distance > Wide{};
    const Triple<Wide> along = Wide(1 / choose(apart, distance, spread(1))) * between;
    const Triple<Wide> n = choose<Wide>(apart, along, {spread(1), Wide{}, Wide{}});
    const Triple<Wide> middle = s.ballA.load(k) + Wide(radiusA - 0.5 * inside) * n;
    if (elastic) s.contacts.radius.store(k, radiusA * radiusB / radii);
    s.place(k, {n, inside, middle}, s.bodyA.load(k), s.bodyB.load(k));
  }
}

/// Makes the contacts of a chunk.
class BallLooks {
 public:
  BallLooks(double dt, World& of, World::Chunk& into)
      : world(of), chunk(into), batch(ownOfThread<BallBatch>()), touching(ownOfThread<std::vector<TouchingBalls>>()) {
    batch.begin(dt, of);
  }

  /// Looks at a pair that is due; true if it has contacts.
  bool take(std::int32_t index) {
    const Bodies& bodies = world.bodies;
    Pair& pair = world.pairs.pairs[at(index)];
    const std::size_t a = at(pair.a), b = at(pair.b);
    const double travel = bodies.travel[a] + bodies.travel[b];
    const bool ofClump = world.anyClump && (asClump(*bodies.shape[a]) || asClump(*bodies.shape[b]));
    forgetHeld(pair, ofClump);
    return ofClump ? lookAtChildren(index, travel, pair) : lookAtSpheres(index, travel, pair);
  }

  /// Through the law with what waits.
  void finish() {
    placeBalls(world.bodies, lawReadsCurvature(world.options.law), batch);
    batch.press(chunk);
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
    if (touch.overlap() > chunk.deepest * size)
      chunk.noteDepth(touch.overlap(), size, chunk.briefs.size() + batch.count());
    batch.add(pair, touch, history);
    if (batch.count() == BriefBatch::capacity) finish();
  }

  bool lookAtSpheres(std::int32_t index, double travel, Pair& pair) {
    const Bodies& bodies = world.bodies;
    const std::size_t a = at(pair.a), b = at(pair.b);
    const BallPair pairOfBalls = view(index, pair);
    ++chunk.counts.warm;
    const Vec3 between = (bodies.x(b) + pairOfBalls.shift) - bodies.x(a);
    const TouchingBalls touch{
        -1, -1, bodies.x(a), between, between.norm(), bodies.boundingRadius(a), bodies.boundingRadius(b)};
    ContactHistory& history = world.pairs.memory.history[at(pair.slot)];
    if (!(touch.overlap() > 0)) {
      pair.quietUntil = travel + std::max(0.0, -touch.overlap());
      history = ContactHistory{};
      return false;
    }
    add(pairOfBalls, touch, std::min(touch.radiusA, touch.radiusB), history);
    return true;
  }

  bool lookAtChildren(std::int32_t index, double travel, Pair& pair) {
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
      return false;
    }
    matchSpots(memory.spots, touching.size(), [&](std::size_t k) {
      return Spot{0, touching[k].childA, touching[k].childB};
    });
    const double size = std::min(shapeA.size(), shapeB.size());
    for (std::size_t k = 0; k < touching.size(); ++k) add(pairOfBalls, touching[k], size, memory.spots[k].history);
    return true;
  }

  World& world;
  World::Chunk& chunk;
  BallBatch& batch;
  std::vector<TouchingBalls>& touching;
};

}  // namespace

void makeBallContacts(double dt, std::size_t c, World& world) {
  World::Chunk& chunk = startChunk(world, c);
  BallLooks looks(dt, world, chunk);
  const PairMemory& memory = world.pairs.memory;
  const auto fetch = [&](const Pair& pair) {
    if (at(pair.slot) < memory.clumps.size()) __builtin_prefetch(&memory.clumps[at(pair.slot)]);
    __builtin_prefetch(&world.bodies.frame[at(pair.b)]);
  };
  takeDue(world, c, fetch, [&](std::size_t position, std::size_t k) {
    if (!looks.take(world.activePairs[position])) chunk.due.apart.set(k);
  });
  looks.finish();
}

}  // namespace granular
