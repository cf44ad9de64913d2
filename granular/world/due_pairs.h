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

/// Makes all active pairs of chunk c due; quietWay has room for them.
void makeDue(World& world, std::size_t c);
/// Which active pairs of chunk c need a look, in their order; returns how many. None of them has contacts yet, and the
/// others have none. list: room for all of the chunk.
std::size_t listDue(World& world, std::size_t c, std::size_t* list);

}  // namespace granular
