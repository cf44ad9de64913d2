// Stages of a step that make the contacts: pairs, touches, points.
#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>

#include "granular/core/prefetch.h"
#include "granular/core/room.h"
#include "granular/narrow/bullet_manifold.h"
#include "granular/point/patch_lanes.h"
#include "granular/point/witness.h"
#include "granular/shape/polyhedron.h"
#include "granular/world/clump_contacts.h"
#include "granular/world/looks.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// How many pairs ahead of the one looked at.
constexpr std::size_t farAhead = 8, nextAhead = 2;

std::size_t chunkCount(std::size_t items) { return (items + World::chunkSize - 1) / World::chunkSize; }

/// Bodies near walls, in the order of bodies; spots of surviving pairs are kept.
void refreshWallPairs(World& world) {
  const Bodies& bodies = world.bodies;
  std::vector<WallPair> found;
  std::size_t old = 0;
  auto& list = world.pairs.wallPairs;
  const auto before = [](const WallPair& p, std::int32_t body, std::int32_t wall) {
    return p.body != body ? p.body < body : p.wall < wall;
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.state[i] == BodyState::frozen) continue;
    for (std::size_t k = 0; k < world.walls.size(); ++k) {
      const double reach = bodies.boundingRadius(i) + world.search.margin(i);
      if (world.walls[k]->clearance(bodies.x(i), reach) >= 0) continue;
      const auto body = static_cast<std::int32_t>(i);
      const auto wall = static_cast<std::int32_t>(k);
      while (old < list.size() && before(list[old], body, wall)) ++old;
      if (old < list.size() && list[old].body == body && list[old].wall == wall) {
        found.push_back(std::move(list[old++]));
      } else {
        found.push_back({body, wall, -infinity, {}, {}, {}});
      }
    }
  }
  list.swap(found);
}

/// The pairs with a body that moves.
void listActivePairs(World& world) {
  const Bodies& bodies = world.bodies;
  world.activePairs.clear();
  world.activeWallPairs.clear();
  std::int32_t index = 0;
  for (const Pair& pair : world.pairs.pairs) {
    if (bodies.moves(at(pair.a)) || bodies.moves(at(pair.b))) world.activePairs.push_back(index);
    ++index;
  }
  index = 0;
  for (const WallPair& pair : world.pairs.wallPairs) {
    if (bodies.moves(at(pair.body))) world.activeWallPairs.push_back(index);
    ++index;
  }
  trim(world.activePairs);
  trim(world.activeWallPairs);
}

/// Which bodies are part of active pairs.
void listMet(World& world) {
  std::vector<bool> isMet(world.bodies.size(), false);
  for (const std::int32_t p : world.activePairs) {
    const Pair& pair = world.pairs.pairs[at(p)];
    isMet[at(pair.a)] = isMet[at(pair.b)] = true;
  }
  for (const std::int32_t p : world.activeWallPairs) isMet[at(world.pairs.wallPairs[at(p)].body)] = true;
  world.met.clear();
  for (std::size_t i = 0; i < isMet.size(); ++i) {
    if (isMet[i]) world.met.push_back(static_cast<std::int32_t>(i));
  }
}

const World::PairsOfBodies& listPairsOfBodies(World& world) {
  World::PairsOfBodies& of = world.pairsOfBodies;
  if (!of.begin.empty()) return of;
  of.begin.assign(world.bodies.size() + 1, 0);
  for (const Pair& pair : world.pairs.pairs) {
    ++of.begin[at(pair.a) + 1];
    ++of.begin[at(pair.b) + 1];
  }
  std::partial_sum(of.begin.begin(), of.begin.end(), of.begin.begin());
  of.index.resize(2 * world.pairs.pairs.size());
  std::vector<std::int32_t> next(of.begin.begin(), of.begin.end() - 1);
  std::int32_t index = 0;
  for (const Pair& pair : world.pairs.pairs) {
    of.index[at(next[at(pair.a)]++)] = index;
    of.index[at(next[at(pair.b)]++)] = index++;
  }
  return of;
}
/// Calls visit(index) for the pairs of a body, ascending.
template <class Visitor>
void visitPairsOf(World& world, std::int32_t body, const Visitor& visit) {
  const World::PairsOfBodies& of = listPairsOfBodies(world);
  for (std::int32_t k = of.begin[at(body)]; k < of.begin[at(body) + 1]; ++k) visit(of.index[at(k)]);
}

/// Sums the contacts between bodies at rest, which a step does not look at, on those whose forces it sums.
void sumHeldForces(World& world) {
  if (world.sleep.fallen == 0) return;
  const Bodies& bodies = world.bodies;
  world.heldForce.resize(bodies.size());
  world.heldTorque.resize(bodies.size());
  std::vector<bool> isDisturbed(bodies.size(), false);
  PairMemory& memory = world.pairs.memory;
  memory.held.resize(memory.size());
  for (const std::int32_t body : world.gathered) {
    if (bodies.state[at(body)] != BodyState::asleep) continue;
    isDisturbed[at(body)] = true;
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    visitPairsOf(world, body, [&](std::int32_t index) {
      const Pair& pair = world.pairs.pairs[at(index)];
      if (bodies.moves(at(pair.a)) || bodies.moves(at(pair.b))) return;
      memory.visitHeld(pair, [&](const Contact& contact) {
        force += pair.a == body ? contact.force.force : -contact.force.force;
        torque += pair.a == body ? contact.torqueA : contact.torqueB;
      });
    });
    world.heldForce[at(body)] = force;
    world.heldTorque[at(body)] = torque;
  }
  for (const WallPair& pair : world.pairs.wallPairs) {
    if (!isDisturbed[at(pair.body)]) continue;
    for (const Contact& contact : pair.held) {
      world.heldForce[at(pair.body)] += contact.force.force;
      world.heldTorque[at(pair.body)] += contact.torqueA;
    }
  }
}

/// True if all bodies of these active pairs are of a kind: isOne(shape).
template <class IsOne>
bool areAll(const World& world, Range range, IsOne&& isOne) {
  const auto& shape = world.bodies.shape;
  for (std::size_t p = range.first; p < range.last; ++p) {
    const Pair& pair = world.pairs.pairs[at(world.activePairs[p])];
    if (!isOne(*shape[at(pair.a)]) || !isOne(*shape[at(pair.b)])) return false;
  }
  return true;
}
bool areAll(ShapeKind kind, const World& world, Range range) {
  return areAll(world, range, [kind](const Shape& shape) { return shape.kind() == kind; });
}

/// What finds the contacts of these active pairs in batches, or null: flat-faced bodies or cylinders, of one kind.
auto chooseLooks(const World& world, Range range) -> decltype(World::Chunk::find) {
  const WorldOptions& options = world.options;
  if (options.noBatches || !options.skips.feature || options.rule.rule == PointRule::manifold) return nullptr;
  if (areAll(ShapeKind::cuboid, world, range)) return findCuboidContacts;
  if (areAll(ShapeKind::polyhedron, world, range)) return findPolyhedronContacts;
  return areAll(ShapeKind::cylinder, world, range) ? findCylinderContacts : nullptr;
}
/// The same for active wall pairs: cuboids at flat walls at rest.
auto chooseLooksAtWalls(const World& world, Range range) -> decltype(World::Chunk::find) {
  if (world.options.noBatches || !world.options.skips.feature) return nullptr;
  if (!placesInLanes(ruleAtWalls(world.options.rule).rule)) return nullptr;
  for (std::size_t p = range.first; p < range.last; ++p) {
    const WallPair& pair = world.pairs.wallPairs[at(world.activeWallPairs[p])];
    if (world.bodies.shape[at(pair.body)]->kind() != ShapeKind::cuboid || !world.walls[at(pair.wall)]->asPlane())
      return nullptr;
  }
  return findCuboidsAtWalls;
}

/// What makes the contacts of these active pairs in batches, or null: balls alone or ellipsoids alone, a law that works
/// on many contacts at once, and nobody who asks for more than forces.
auto chooseBatches(const World& world, Range range) -> decltype(World::Chunk::make) {
  const WorldOptions& options = world.options;
  const bool plain = lawInLanes(options.law, options.lawOptions) && !options.energy;
  // These rules place the contacts of smooth bodies to round-off only, keep several of them, or are unknown here.
  const PointRule rule = options.rule.rule;
  const bool deepest = rule != PointRule::faceCentroid && rule != PointRule::manifold && !isUsersRule(rule);
  if (options.noBatches || !plain || !deepest) return nullptr;
  if (areAll(ShapeKind::sphere, world, range)) return makeSphereContacts;
  if (areAll(world, range, isOfBalls)) return makeBallContacts;
  return options.skips.feature && areAll(ShapeKind::ellipsoid, world, range) ? makeEllipsoidContacts : nullptr;
}

/// True if the contacts of any chunk of pairs are found from caches: batches of balls are not.
bool readsCaches(const World& world) {
  const auto last = world.chunks.begin() + static_cast<std::ptrdiff_t>(world.wallChunkBegin);
  return std::any_of(world.chunks.begin(), last, [](const World::Chunk& chunk) {
    return chunk.make != makeSphereContacts && chunk.make != makeBallContacts;
  });
}

void layOutChunk(std::size_t c, World& world) {
  World::Chunk& chunk = world.chunks[c];
  const bool atWalls = c >= world.wallChunkBegin;
  const Range range = atWalls ? chunkRange(c - world.wallChunkBegin, world.activeWallPairs.size())
                              : chunkRange(c, world.activePairs.size());
  chunk.make = atWalls ? nullptr : chooseBatches(world, range);
  chunk.find = atWalls ? chooseLooksAtWalls(world, range) : chooseLooks(world, range);
  chunk.due.ofSpheres = chunk.make == makeSphereContacts;
  chunk.lowest = std::numeric_limits<std::int32_t>::max();
  chunk.highest = -1;
  visitBodiesOfChunk(c, world, [&](std::int32_t body) {
    chunk.lowest = std::min(chunk.lowest, body);
    chunk.highest = std::max(chunk.highest, body);
  });
  if (!atWalls) makeDue(world, c);
  trim(chunk.contacts);
  trim(chunk.briefs);
  trim(chunk.children);
  trim(chunk.touches);
  trim(chunk.pulls);
}

}  // namespace

// The moving, and sleepers near them. Other sleepers keep their force, a frozen body needs none, and what flies has its
// weight.
void listGathered(World& world) {
  const Bodies& bodies = world.bodies;
  const auto isDisturbed = [&](std::int32_t slot) { return bodies.state[at(slot)] == BodyState::asleep; };
  std::vector<std::int32_t> disturbed;
  std::copy_if(world.met.begin(), world.met.end(), std::back_inserter(disturbed), isDisturbed);
  const std::vector<std::int32_t>& moving = bodies.movingSlots();
  world.gathered.clear();
  std::merge(moving.begin(), moving.end(), disturbed.begin(), disturbed.end(), std::back_inserter(world.gathered));
}

World::Chunk& startChunk(World& world, std::size_t c) {
  World::Chunk& chunk = world.chunks[c];
  if (world.bodies.size() >= bodiesBeyondCaches) {
    // What the last step left here, about as much as this one will write.
    fetchAll(chunk.contacts);
    fetchAll(chunk.briefs);
    fetchAll(chunk.touches);
    fetchAll(chunk.pulls);
  }
  chunk.contacts.clear();
  chunk.briefs.clear();
  chunk.children.clear();
  chunk.touches.clear();
  chunk.pulls.clear();
  chunk.counts = NarrowCounts{};
  chunk.deepest = 0;
  chunk.deepestContact = -1;
  chunk.uncertifiedPair = -1;
  return chunk;
}

bool beginLook(World& world, std::int32_t index, Look& look) {
  const Bodies& bodies = world.bodies;
  const Pair& pair = world.pairs.pairs[at(index)];
  if (isQuiet(world, pair)) return false;  // holds no contact either
  const std::size_t a = at(pair.a), b = at(pair.b);
  std::vector<Contact>& held = world.pairs.memory.held;
  if (at(pair.slot) < held.size()) held[at(pair.slot)].a = -1;
  look.travel = bodies.travel[a] + bodies.travel[b];
  look.index = index;
  look.shift = world.options.periods.shift(pair.image);
  look.frameB = bodies.frameOf(b);
  look.frameB.x += look.shift;
  // Contacts of balls made in batches keep no cache.
  look.touchedBefore =
      world.pairs.memory.cache[at(pair.slot)].touched != 0 || bodies.shape[a]->kind() == ShapeKind::sphere;
  return true;
}

bool takeLook(World& world, const Look& look, World::Chunk& chunk, Touch& touch) {
  const Bodies& bodies = world.bodies;
  const Pair& pair = world.pairs.pairs[at(look.index)];
  const std::size_t a = at(pair.a), b = at(pair.b);
  return noteUncertified(look, chunk, [&] {
    return findTouch(*bodies.shape[a], bodies.frameOf(a), *bodies.shape[b], look.frameB, !world.options.skips.feature,
                     world.pairs.memory.cache[at(pair.slot)], chunk.counts, touch);
  });
}

void fetchShapes(const World& world, const Pair& pair) {
  const Bodies& bodies = world.bodies;
  constexpr std::size_t line = 64;
  for (const std::int32_t body : {pair.a, pair.b}) {
    const auto* shape = reinterpret_cast<const std::byte*>(bodies.shape[at(body)]);
    for (std::size_t k = 0; k < sizeof(Polyhedron); k += line) __builtin_prefetch(shape + k);
  }
}
void fetchPair(const World& world, const Pair& pair) {
  const Bodies& bodies = world.bodies;
  if (isQuiet(world, pair)) return;
  const std::size_t a = at(pair.a), b = at(pair.b);
  __builtin_prefetch(&world.pairs.memory.cache[at(pair.slot)]);
  for (const std::size_t i : {a, b}) {
    if (!bodies.frame.empty()) __builtin_prefetch(&bodies.frame[i]);
    if (const PolyhedronTables* tables = tablesOf(*bodies.shape[i])) tables->fetchAhead();
  }
}

void waitForGap(World& world, const Look& look) {
  Pair& pair = world.pairs.pairs[at(look.index)];
  PairMemory& memory = world.pairs.memory;
  pair.quietUntil = look.travel + memory.cache[at(pair.slot)].budget;
  if (!look.touchedBefore) return;
  memory.history[at(pair.slot)] = ContactHistory{};
  if (at(pair.slot) < memory.manifolds.size()) memory.manifolds[at(pair.slot)] = ManifoldMemory{};
}

void endLook(World& world, const Look& look, bool touching, const Touch& touch, World::Chunk& chunk) {
  if (!touching) return waitForGap(world, look);
  const Bodies& bodies = world.bodies;
  const Pair& pair = world.pairs.pairs[at(look.index)];
  const std::size_t a = at(pair.a), b = at(pair.b);
  // One contact, or several of a manifold.
  std::array<ManifoldContact, 4> several;
  int count = 1;
  if (world.options.rule.rule == PointRule::manifold) {
    count = refreshManifold(*bodies.shape[a], bodies.frameOf(a), *bodies.shape[b], look.frameB, touch,
                            world.pairs.memory.manifolds[at(pair.slot)].manifold, several);
  } else {
    several[0] = {touch, 0, 1};
  }
  for (int k = 0; k < count; ++k) {
    const ManifoldContact& found = several[static_cast<std::size_t>(k)];
    Contact& contact = chunk.contacts.emplace_back();
    contact.pair = look.index;
    contact.a = pair.a;
    contact.b = pair.b;
    contact.spot.number = found.spot;
    contact.share = found.share;
    contact.shift = look.shift;
    contact.touch = found.touch;
  }
  chunk.noteDepth(touch.overlap, std::min(bodies.shape[a]->size(), bodies.shape[b]->size()));
}

namespace {

/// Looks at one pair of bodies; appends its contact if it touches.
void lookAtPair(World& world, std::int32_t index, World::Chunk& chunk) {
  const Bodies& bodies = world.bodies;
  const Pair& pair = world.pairs.pairs[at(index)];
  if (isQuiet(world, pair)) return;
  const std::size_t a = at(pair.a), b = at(pair.b);
  const bool hasClump = world.anyClump && (asClump(*bodies.shape[a]) || asClump(*bodies.shape[b]));
  if (hasClump) world.pairs.memory.clumps[at(pair.slot)].held.clear();
  Look look;
  if (!beginLook(world, index, look)) return;
  if (hasClump) return lookAtClumpPair(world, index, look.travel, chunk);

  Touch touch;
  const bool touching = takeLook(world, look, chunk, touch);
  endLook(world, look, touching, touch, chunk);
}

/// Looks at one body near a wall; appends its contacts in the order of their spots.
void lookAtWallPair(World& world, std::int32_t index, World::Chunk& chunk) {
  const Bodies& bodies = world.bodies;
  WallPair& pair = world.pairs.wallPairs[at(index)];
  const std::size_t i = at(pair.body);
  pair.held.clear();
  const double travel = bodies.travel[i] + world.wallTravel;
  if (world.options.skips.separation && travel < pair.quietUntil) return;

  const Wall& wall = *world.walls[at(pair.wall)];
  if (world.anyClump && asClump(*bodies.shape[i])) return lookAtClumpAtWall(world, index, travel, chunk);
  chunk.wallTouches.clear();
  wall.touch(ruleAtWalls(world.options.rule), *bodies.shape[i], bodies.frameOf(i), chunk.wallTouches);
  if (chunk.wallTouches.empty()) {
    pair.quietUntil = travel + std::max(0.0, wall.clearance(bodies.x(i), bodies.boundingRadius(i)));
    pair.spots.clear();
    return;
  }
  addWallContacts(pair, index, bodies.shape[i]->size(), chunk);
}

}  // namespace

void addWallContacts(const WallPair& pair, std::int32_t index, double size, World::Chunk& chunk) {
  for (const WallTouch& found : chunk.wallTouches) {
    Contact& contact = chunk.contacts.emplace_back();
    contact.pair = index;
    contact.a = pair.body;
    contact.b = -1 - pair.wall;
    contact.spot = {found.spot, found.child, -1};
    contact.share = found.share;
    contact.shift = Vec3::Zero();
    contact.touch.normal = found.normal;
    contact.touch.overlap = found.overlap;
    contact.patch = found.patch;
    contact.touch.placeAbout(contact.patch.point);
    chunk.noteDepth(found.overlap, size);
  }
}

void refreshPairs(double dt, World& world) {
  if (world.search.isDue(world.bodies, world.wallTravel)) {
    landPredicted(world);
    fileHistories(world);
    world.search.refreshPairs(world.bodies, dt, world.wallTravel, world.pairs);
    world.pairsOfBodies = {};
    refreshWallPairs(world);
    world.layoutStale = true;
    world.aloft.notBefore = world.steps + 2;  // in the next step bodies may change places (order.cpp)
  }
  if (world.layoutStale) layOutContacts(world);
}

void layOutContacts(World& world) {
  fileHistories(world);
  PairMemory& memory = world.pairs.memory;
  if (world.options.rule.rule == PointRule::manifold) resizeClosely(memory.manifolds, memory.size());
  if (world.anyClump) resizeClosely(memory.clumps, memory.size());
  listActivePairs(world);
  listMet(world);
  listGathered(world);
  sumHeldForces(world);
  world.wallChunkBegin = chunkCount(world.activePairs.size());
  world.chunks.resize(world.wallChunkBegin + chunkCount(world.activeWallPairs.size()));
  world.runs = 0;
  world.pairWay = 0;
  world.quietWay.assign(world.wallChunkBegin * World::chunkSize, infinity);
  for (std::size_t c = 0; c < world.chunks.size(); ++c) layOutChunk(c, world);
  if (readsCaches(world)) resizeClosely(memory.cache, memory.size());
  takeHistories(world);
  world.layoutStale = false;
}

void findContacts(std::size_t c, World& world) {
  const std::size_t pairCount = world.activePairs.size();
  World::Chunk& chunk = startChunk(world, c);
  const bool atWalls = c >= world.wallChunkBegin;
  const Range range =
      atWalls ? chunkRange(c - world.wallChunkBegin, world.activeWallPairs.size()) : chunkRange(c, pairCount);
  if (chunk.find) return chunk.find(c, world);
  for (std::size_t p = range.first; p < range.last; ++p) {
    if (atWalls) {
      lookAtWallPair(world, world.activeWallPairs[p], chunk);
    } else {
      if (p + farAhead < range.last) fetchShapes(world, world.pairs.pairs[at(world.activePairs[p + farAhead])]);
      if (p + nextAhead < range.last) fetchPair(world, world.pairs.pairs[at(world.activePairs[p + nextAhead])]);
      lookAtPair(world, world.activePairs[p], chunk);
    }
  }
}

void placeContactPoints(std::size_t c, World& world) {
  if (c >= world.wallChunkBegin) return;  // a wall places its own
  const Bodies& bodies = world.bodies;
  // The points of a manifold are where they were found.
  RuleOptions rule = world.options.rule;
  if (rule.rule == PointRule::manifold) rule.rule = PointRule::witness;
  for (Contact& contact : world.chunks[c].contacts) {
    if (contact.placed) continue;
    const std::size_t a = at(contact.a);
    const std::size_t b = at(contact.b);
    Frame frameB = bodies.frameOf(b);
    frameB.x += contact.shift;
    const bool ofBalls = contact.spot.childA >= 0 && contact.spot.childB >= 0;
    if (ofBalls && rule.rule != PointRule::faceCentroid) {
      placeWitness(contact.touch, contact.patch);  // what all these rules make of two balls
      continue;
    }
    if (contact.spot.ofClump()) {
      const PlacedChild childA = placeChild(*bodies.shape[a], bodies.frameOf(a), contact.spot.childA);
      const PlacedChild childB = placeChild(*bodies.shape[b], frameB, contact.spot.childB);
      placeContact(rule, *childA.shape, childA.frame, *childB.shape, childB.frame, contact.touch, contact.patch);
      continue;
    }
    placeContact(rule, *bodies.shape[a], bodies.frameOf(a), *bodies.shape[b], frameB, contact.touch, contact.patch);
  }
}

void holdContact(Contact& contact, World& world) {
  contact.held = true;
  if (contact.b < 0) {
    world.pairs.wallPairs[at(contact.pair)].held.push_back(contact);
    return;
  }
  const std::size_t slot = at(world.pairs.pairs[at(contact.pair)].slot);
  if (contact.spot.ofClump()) {
    world.pairs.memory.clumps[slot].held.push_back(contact);
    return;
  }
  auto& held = world.pairs.memory.held;
  held.resize(world.pairs.memory.size());
  held[slot] = contact;
}

}  // namespace granular
