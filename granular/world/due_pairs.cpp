// In a bed most pairs stay as they are for hundreds of steps: they touch, or a gap lies between them. So each chunk
// keeps the list of those that are due from step to step. A pair that parted is taken out; one that was quiet comes in
// when it may no longer be. Of most of these a single number tells that they are: the way that the fastest bodies made.
#include "granular/world/due_pairs.h"

#include "granular/core/room.h"
#include "granular/core/wide.h"

namespace granular {
namespace {

const Pair& activePair(const World& world, std::size_t position) {
  return world.pairs.pairs[static_cast<std::size_t>(world.activePairs[position])];
}

/// True if the active pair with this position is quiet; then quietWay and its chunk's `due` know for how long.
bool goesQuiet(World& world, std::size_t position, World::Chunk::Due& due) {
  const double left = gapLeft(world, activePair(world, position));
  const bool quiet = world.options.skips.separation && left > 0;
  // A little less: round-off must not keep a pair quiet that its bodies' ways would not.
  world.quietWay[position] = quiet ? world.pairWay + (1 - 1e-6) * left : infinity;
  due.quietUntil = std::min(due.quietUntil, world.quietWay[position]);
  return quiet;
}

/// Takes out the pairs that had no contact in the last step and are quiet.
void dropQuiet(World& world, std::size_t first, World::Chunk::Due& due) {
  if (due.apart.none()) return;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < due.count; ++k) {
    if (due.apart[k] && goesQuiet(world, first + due.place[k], due)) continue;
    due.place[kept] = due.place[k];
    if (due.ofSpheres) due.spheres[kept] = due.spheres[k];
    ++kept;
  }
  due.count = kept;
  due.apart.reset();
  if (!due.ofSpheres) return;
  due.spheres.resize(kept);
  trim(due.spheres);  // the first looks at a new bed take out most of its pairs
}

void insert(const World& world, std::size_t first, std::size_t place, World::Chunk::Due& due) {
  const auto end = due.place.begin() + static_cast<std::ptrdiff_t>(due.count++);
  const auto at = std::upper_bound(due.place.begin(), end, place);
  std::copy_backward(at, end, end + 1);
  *at = static_cast<std::uint16_t>(place);
  if (!due.ofSpheres) return;
  const Pair& pair = activePair(world, first + place);
  reserveClosely(due.spheres, due.count);
  due.spheres.insert(due.spheres.begin() + (at - due.place.begin()), SpherePair{ContactHistory{}, pair.a, pair.b});
}

/// Asks those whose number is used up whether they are quiet.
void askQuiet(World& world, std::size_t first, World::Chunk::Due& due) {
  const double* quietWay = world.quietWay.data() + first;
  const double way = world.pairWay;
  Wide least = spread(infinity);
  due.quietUntil = infinity;
  for (std::size_t k = 0; k < World::chunkSize; k += wideSize) {
    const Wide quiet = loadWide(quietWay + k);
    const Mask<Wide> asked = quiet <= way;
    if (any(asked)) {
      for (std::size_t i = 0; i < wideSize; ++i) {
        if (asked[i] != 0 && !goesQuiet(world, first + k + i, due)) insert(world, first, k + i, due);
      }
    }
    least = smaller(least, choose(asked, spread(infinity), quiet));
  }
  for (std::size_t i = 0; i < wideSize; ++i) due.quietUntil = std::min(due.quietUntil, least[i]);
}

}  // namespace

void makeDue(World& world, std::size_t c) {
  const Range range = chunkRange(c, world.activePairs.size());
  World::Chunk::Due& due = world.chunks[c].due;
  due.count = 0;
  due.apart.reset();
  due.quietUntil = infinity;
  for (std::size_t position = range.first; position < range.last; ++position) {
    if (!goesQuiet(world, position, due)) due.place[due.count++] = static_cast<std::uint16_t>(position - range.first);
  }
  discard(due.spheres);
  if (!due.ofSpheres) return;
  due.spheres.reserve(due.count);
  for (std::size_t k = 0; k < due.count; ++k) {
    const Pair& pair = activePair(world, range.first + due.place[k]);
    due.spheres.push_back({ContactHistory{}, pair.a, pair.b});
  }
}

World::Chunk::Due& refreshDue(World& world, std::size_t c) {
  const std::size_t first = c * World::chunkSize;
  World::Chunk::Due& due = world.chunks[c].due;
  dropQuiet(world, first, due);
  if (!(world.pairWay < due.quietUntil)) askQuiet(world, first, due);
  return due;
}

std::size_t listDue(World& world, std::size_t c, std::size_t* list) {
  const std::size_t first = c * World::chunkSize;
  const World::Chunk::Due& due = refreshDue(world, c);
  // A large bed's pairs are not near: they come while those before them are worked on.
  for (std::size_t k = 0; k < due.count; ++k) {
    list[k] = first + due.place[k];
    __builtin_prefetch(&activePair(world, list[k]));
  }
  return due.count;
}

}  // namespace granular
