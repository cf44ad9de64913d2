// Looks at pairs of bodies, and what follows from them: shared by the ways to find contacts, one by one and in batches.
#pragma once

#include <algorithm>

#include "granular/world/due_pairs.h"

namespace granular {

/// A look at one pair of bodies that has begun.
struct Look {
  std::int32_t index;  ///< of the pair
  double travel;       ///< of both bodies so far
  bool touchedBefore;
  Vec3 shift;
  Frame frameB;  ///< next to A
};

/// Calls take(position, k) for the active pairs of chunk c that need a look, the k-th that are due, and fetch(pair) for
/// each some time before. Who turns out to have no contact is to be named in Due::apart.
template <class Fetch, class Take>
void takeDue(World& world, std::size_t c, Fetch&& fetch, Take&& take) {
  constexpr std::size_t ahead = 8;
  std::array<std::size_t, World::chunkSize> due;
  const std::size_t count = listDue(world, c, due.data());
  for (std::size_t k = 0; k < count; ++k) {
    if (k + ahead < count) fetch(world.pairs.pairs[static_cast<std::size_t>(world.activePairs[due[k + ahead]])]);
    take(due[k], k);
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
/// The same for polyhedra (polyhedron_contacts.cpp), and for cylinders (cylinder_contacts.cpp).
void findPolyhedronContacts(std::size_t c, World& world);
void findCylinderContacts(std::size_t c, World& world);
/// The same for a chunk in which only cuboids meet flat walls at rest (cuboids_at_walls.cpp).
void findCuboidsAtWalls(std::size_t c, World& world);

}  // namespace granular
