// Where the histories of contacts lie: in the memory of the pairs, except those of chunks of spheres, which lie with
// the pairs that are due, in their order, and nowhere else.
#include <algorithm>

#include "granular/core/room.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Calls visit(history with a chunk, history of the same pair in its memory).
template <class Visitor>
void visitKeptHistories(World& world, const Visitor& visit) {
  PairMemory& memory = world.pairs.memory;
  for (std::size_t c = 0; c < world.wallChunkBegin && c < world.chunks.size(); ++c) {
    World::Chunk::Due& due = world.chunks[c].due;
    for (std::size_t k = 0; k < due.spheres.size(); ++k) {
      const Pair& pair = world.pairs.pairs[at(world.activePairs[c * World::chunkSize + due.place[k]])];
      visit(due.spheres[k].history, memory.history[at(pair.slot)]);
    }
  }
}

}  // namespace

void fileHistories(World& world) {
  world.pairs.memory.makeHistories();
  if (world.historiesFiled) return;
  world.historiesFiled = true;
  visitKeptHistories(world, [](ContactHistory& kept, ContactHistory& filed) { filed = kept; });
}

void takeHistories(World& world) {
  PairMemory& memory = world.pairs.memory;
  memory.makeHistories();
  visitKeptHistories(world, [](ContactHistory& kept, ContactHistory& filed) {
    kept = filed;
    filed = ContactHistory{};  // it may part before it is filed again
  });
  world.historiesFiled = false;
  // Pairs at rest, and those of other chunks, leave theirs where they are.
  const auto end = world.chunks.begin() + static_cast<std::ptrdiff_t>(world.wallChunkBegin);
  const auto ofSpheres = [](const World::Chunk& chunk) { return chunk.due.ofSpheres; };
  if (world.activePairs.size() == world.pairs.pairs.size() && std::all_of(world.chunks.begin(), end, ofSpheres))
    discard(memory.history);
}

const ContactHistory& World::historyOf(std::int32_t index) const {
  const auto position =
      static_cast<std::size_t>(std::lower_bound(activePairs.begin(), activePairs.end(), index) - activePairs.begin());
  const bool active = !historiesFiled && position < activePairs.size() && activePairs[position] == index;
  if (active && chunks[position / chunkSize].due.ofSpheres) {
    const Chunk::Due& due = chunks[position / chunkSize].due;
    const auto end = due.place.begin() + static_cast<std::ptrdiff_t>(due.count);
    const auto place = std::lower_bound(due.place.begin(), end, position % chunkSize);
    return due.spheres[static_cast<std::size_t>(place - due.place.begin())].history;
  }
  return pairs.memory.history[at(pairs.pairs[at(index)].slot)];
}

}  // namespace granular
