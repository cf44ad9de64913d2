// The lists of pairs that are due, kept from step to step, against the bodies' ways asked in every step.
#include "granular/world/due_pairs.h"

#include <gtest/gtest.h>

#include "granular/shape/sphere.h"
#include "world/heap.h"

namespace granular {
namespace {

struct Tally {
  std::size_t due = 0, quiet = 0, wrong = 0;
};

/// Compares the lists of all chunks with the answers of isQuiet. Listing twice in a step changes nothing.
void compareLists(World& world, Tally& tally) {
  std::array<std::size_t, World::chunkSize> list;
  for (std::size_t c = 0; c < world.wallChunkBegin; ++c) {
    const Range range = chunkRange(c, world.activePairs.size());
    const std::size_t count = listDue(world, c, list.data());
    std::size_t next = 0;
    for (std::size_t position = range.first; position < range.last; ++position) {
      const Pair& pair = world.pairs.pairs[static_cast<std::size_t>(world.activePairs[position])];
      const bool listed = next < count && list[next] == position;
      next += listed;
      const bool quiet = isQuiet(world, pair);
      ++(quiet ? tally.quiet : tally.due);
      tally.wrong += listed == quiet;
    }
    EXPECT_EQ(next, count) << "out of order, or of another chunk";
  }
}

/// A step by its stages, with the lists looked at in between.
void stepAndCompare(World& world, double dt, Tally& tally) {
  predict(dt, world);
  refreshPairs(dt, world);
  compareLists(world, tally);
  beginForces(world);
  makeContacts(dt, world);
  gatherForces(world);
  advance(dt, world.options, world.bodies);
  world.time += dt;
  ++world.steps;
}

Tally tallyHeap(const Skips& skips) {
  constexpr double dt = 1e-5;
  WorldOptions options;
  options.skips = skips;
  const auto world = testing::makeEmptyWorld(options);
  world->addShape(std::make_shared<Sphere>(1e-3));
  testing::addBoxOfPlanes(7e-3, *world);
  testing::addLattice({0}, 6, 2.2e-3, 0, *world);
  startHalfSteps(*world, dt, 0, true);
  Tally tally;
  for (int n = 0; n < 2000; ++n) stepAndCompare(*world, dt, tally);
  return tally;
}

TEST(DuePairs, OfAFallingHeapAreThoseWhoseGapMayHaveClosed) {
  const Tally tally = tallyHeap({});
  EXPECT_EQ(tally.wrong, 0u);
  EXPECT_GT(tally.due, 100000u);
  EXPECT_GT(tally.quiet, 100000u);
}

TEST(DuePairs, AreAllPairsWhereNoGapIsKept) {
  Skips skips;
  skips.separation = false;
  const Tally tally = tallyHeap(skips);
  EXPECT_EQ(tally.wrong, 0u);
  EXPECT_EQ(tally.quiet, 0u);
}

// A history of 56 bytes for each of six or seven pairs would be a fifth of what a sphere takes.
TEST(DuePairs, OfSpheresHoldTheirHistoriesAndNobodyElseHasRoomForThem) {
  const auto world = testing::makeEmptyWorld({});
  world->addShape(std::make_shared<Sphere>(1e-3));
  testing::addLattice({0}, 6, 1.99e-3, 0, *world);
  startHalfSteps(*world, 1e-5, 0, true);
  step(*world, 1e-5);
  std::size_t held = 0;
  for (const World::Chunk& chunk : world->chunks) held += chunk.due.spheres.size();
  EXPECT_GE(held, 3u * 6 * 6 * 5);  // of neighbours in the lattice
  EXPECT_EQ(world->pairs.memory.history.capacity(), 0u);
}

}  // namespace
}  // namespace granular
