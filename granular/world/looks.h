// Looks at pairs of bodies, and what follows from them: shared by the ways to find contacts, one by one and in batches.
#pragma once

#include <algorithm>

#include "granular/world/world.h"

namespace granular {

/// Half-open range of one chunk's items.
struct Range {
  std::size_t first, last;
};
inline Range chunkRange(std::size_t chunk, std::size_t count) {
  const std::size_t first = chunk * World::chunkSize;
  return {first, std::min(first + World::chunkSize, count)};
}

/// A look at one pair of bodies that has begun.
struct Look {
  std::int32_t index;  ///< of the pair
  double travel;       ///< of both bodies so far
  bool touchedBefore;
  Vec3 shift;
  Frame frameB;  ///< next to A
};

/// How much further both bodies of a pair must move until a gap between them that was proven can have closed, m; 0 or
/// less: it may have.
inline double gapLeft(const World& world, const Pair& pair) {
  const std::vector<double>& travel = world.bodies.travel;
  return pair.quietUntil - (travel[static_cast<std::size_t>(pair.a)] + travel[static_cast<std::size_t>(pair.b)]);
}
/// True if the pair was proven apart by a gap that cannot have closed yet.
inline bool isQuiet(const World& world, const Pair& pair) {
  return world.options.skips.separation && gapLeft(world, pair) > 0;
}
/// Lists which of these active pairs need a look, without branches, which would be foretold badly; returns how many.
/// Those that need none have no contact. list: room for all of them.
inline std::size_t listDue(World& world, Range range, std::size_t* list) {
  const std::size_t all = world.activePairs.size();
  const std::int32_t* active = world.activePairs.data();
  const Pair* pairs = world.pairs.pairs.data();
  const double way = world.pairWay;
  double* quietWay = world.quietWay.data();
  // Most are known to be quiet for as long as the fastest body needs; of the others the bodies are asked. A large bed's
  // pairs are not near: those of the next chunk come while this one is worked on.
  std::size_t asked = 0;
  for (std::size_t p = range.first; p < range.last; ++p) {
    const std::size_t later = std::min(p + World::chunkSize, all - 1);
    const std::int32_t mask = -static_cast<std::int32_t>(!(way < quietWay[later]));
    __builtin_prefetch(&pairs[active[later] & mask]);  // the first pair stands for none
    list[asked] = p;
    asked += !(way < quietWay[p]);
  }
  const bool skips = world.options.skips.separation;
  std::size_t count = 0;
  for (std::size_t k = 0; k < asked; ++k) {
    const std::size_t p = list[k];
    const double left = gapLeft(world, pairs[active[p]]);
    const bool quiet = skips && left > 0;
    // A little less: round-off must not keep a pair quiet that its bodies' ways would not.
    quietWay[p] = quiet ? way + (1 - 1e-6) * left : -infinity;
    world.contactsOfPair[p] = {};
    list[count] = p;
    count += !quiet;
  }
  return count;
}
/// Calls take(position) for the active pairs of chunk c that need a look, and fetch(pair) for each some time before.
template <class Fetch, class Take>
void takeDue(World& world, std::size_t c, Fetch&& fetch, Take&& take) {
  constexpr std::size_t ahead = 8;
  std::array<std::size_t, World::chunkSize> due;
  const std::size_t count = listDue(world, chunkRange(c, world.activePairs.size()), due.data());
  for (std::size_t k = 0; k < count; ++k) {
    if (k + ahead < count) fetch(world.pairs.pairs[static_cast<std::size_t>(world.activePairs[due[k + ahead]])]);
    take(due[k]);
  }
}
/// Starts to bring into the cache what a look at a pair reads, in two steps: the shapes; if the pair will be looked at,
/// its memory, the frames, and the tables that the shapes point to.
void fetchShapes(const World& world, const Pair& pair);
void fetchPair(const World& world, const Pair& pair);
/// Begins a look: false where the pair needs none.
bool beginLook(World& world, std::int32_t index, Look& look);
/// What find() answers, with its pair noted where no bound could certify the answer.
template <class Find>
bool noteUncertified(const Look& look, World::Chunk& chunk, Find&& find) {
  const std::uint64_t before = chunk.counts.uncertified;
  const bool touching = find();
  if (chunk.counts.uncertified > before && chunk.uncertifiedPair < 0) chunk.uncertifiedPair = look.index;
  return touching;
}
/// Takes it by the pair's kernel.
bool takeLook(World& world, const Look& look, World::Chunk& chunk, Touch& touch);
/// Ends it with what was found: appends the contacts, or waits for as long as the gap needs to close.
void endLook(World& world, const Look& look, bool touching, const Touch& touch, World::Chunk& chunk);
/// The latter alone: the pair's memory of what touched is given up.
void waitForGap(World& world, const Look& look);

/// Finds and places the contacts of a chunk in which only cuboids meet, those that touched before in batches
/// (cuboid_contacts.cpp); others, and those of rules that the batches don't know, are left for placeContactPoints.
void findCuboidContacts(std::size_t c, World& world);
/// The same for polyhedra (polyhedron_contacts.cpp).
void findPolyhedronContacts(std::size_t c, World& world);
/// The same for a chunk in which only cuboids meet flat walls at rest (cuboids_at_walls.cpp).
void findCuboidsAtWalls(std::size_t c, World& world);

}  // namespace granular
