// Which pairs of bodies a step must look at.
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

/// Lists the pairs of chunk c that are due anew, without their histories; quietWay has room for all active pairs.
void makeDue(World& world, std::size_t c);
/// Brings that list up to date: once a step, before any of its pairs is looked at.
World::Chunk::Due& refreshDue(World& world, std::size_t c);
/// The same, and the positions of those pairs among the active ones; returns how many. list: room for all of the chunk.
std::size_t listDue(World& world, std::size_t c, std::size_t* list);

}  // namespace granular
