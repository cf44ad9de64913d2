// The same bits whatever the number of threads and whatever is left out, with every family of shapes at once.
#include <gtest/gtest.h>
#include <omp.h>

#include <functional>

#include "granular/io/state_hash.h"
#include "granular/shape/clump.h"
#include "granular/shape/shape_table.h"
#include "world/heap.h"

namespace granular {
namespace {

using testing::makeEmptyWorld;
using testing::run;

/// Spheres, ellipsoids, cylinders, cones, cuboids, polyhedra and clumps, or spheres alone, falling together in a box.
std::unique_ptr<World> makeMixture(const WorldOptions& options, int perSide, bool spheresAlone = false) {
  auto world = makeEmptyWorld(options, {2e3, .7, .7, .4});
  const double pitch = 3.9e-3, r = 1.4e-3;
  testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  std::vector<std::int32_t> shapes;
  const auto add = [&](const char* name, const std::vector<double>& numbers) {
    shapes.push_back(world->addShape(makeShape(name, numbers)));
  };
  add("sphere", {r});
  add("sphere", {1.1 * r});
  if (!spheresAlone) {
    add("ellipsoid", {r, 1.2 * r, 0.8 * r});
    add("cylinder", {0.8 * r, 2 * r});
    add("cone", {r, 2 * r});
    add("cuboid", {r, 0.8 * r, 0.7 * r});
    add("polyhedron", {r, r, r, r, -r, -r, -r, r, -r, -r, -r, r});
    add("clump", {0, 0, 0, 0.8 * r, r, 0, 0, 0.6 * r});
  }
  testing::addLattice(shapes, perSide, pitch, 20, *world);
  return world;
}

TEST(SameAnswer, OfEveryFamilyWithOneTwoAndFourThreads) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    // Enough bodies and pairs for every stage to use its threads.
    auto world = makeMixture({}, 17);
    run(*world, 1e-5, 60);
    EXPECT_GT(world->report.contactSteps, 1000u);
    EXPECT_GE(world->bodies.movingSlots().size(), bodiesForThreads);
    EXPECT_GE(world->chunks.size(), chunksForThreads);
    hashes.push_back(hashState(world->bodies));
  }
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

/// The world after some steps, with a change of the options.
std::unique_ptr<World> runWith(const std::function<void(WorldOptions&)>& change, int steps, bool spheresAlone = false) {
  WorldOptions options;
  change(options);
  auto world = makeMixture(options, 4, spheresAlone);
  run(*world, 1e-5, steps);
  return world;
}

const auto asItIs = [](WorldOptions&) {};
const auto searchEveryStep = [](WorldOptions& o) { o.skips.search = false; };
const auto lookAtEveryPair = [](WorldOptions& o) { o.skips.separation = false; };
const auto searchFromNothing = [](WorldOptions& o) { o.skips.feature = false; };
const auto followOrientations = [](WorldOptions& o) { o.skips.orientation = false; };
const auto oneByOne = [](WorldOptions& o) { o.noBatches = true; };
const auto everyPairWithEveryOther = [](WorldOptions& o) { o.bruteForce = true; };

TEST(SameAnswer, InBatchesOrNotAndWithTheBoxTreeOrBruteForce) {
  const auto reference = runWith(asItIs, 2500);
  EXPECT_GT(reference->report.contactSteps, 10000u);
  for (const auto& change : std::vector<std::function<void(WorldOptions&)>>{oneByOne, everyPairWithEveryOther})
    EXPECT_EQ(hashState(runWith(change, 2500)->bodies), hashState(reference->bodies));
}

TEST(SameAnswer, OfSpheresWhateverIsLeftOut) {
  const auto reference = runWith(asItIs, 2500, true);
  EXPECT_GT(reference->report.contactSteps, 5000u);
  for (const auto& change :
       std::vector<std::function<void(WorldOptions&)>>{searchEveryStep, lookAtEveryPair, searchFromNothing})
    EXPECT_EQ(hashState(runWith(change, 2500, true)->bodies), hashState(reference->bodies));
}

TEST(SameAnswer, OfSpheresWhetherSomebodyFollowsHowTheyLieOrNot) {
  for (const bool localMass : {false, true}) {
    const auto with = [&](bool orientation) {
      return runWith(
          [&](WorldOptions& o) {
            o.skips.orientation = !orientation;
            o.lawOptions.localMass = localMass;
          },
          2500, true);
    };
    const auto left = with(false), followed = with(true);
    EXPECT_GT(left->report.contactSteps, 5000u);
    for (std::size_t i = 0; i < left->bodies.size(); ++i) {
      EXPECT_EQ(left->bodies.x(i), followed->bodies.x(i));
      EXPECT_EQ(left->bodies.w(i), followed->bodies.w(i));
      EXPECT_EQ(left->bodies.frameOf(i).R, Mat3::Identity());
      EXPECT_NE(followed->bodies.frameOf(i).R, Mat3::Identity());
    }
  }
}

TEST(SameAnswer, OfEveryFamilyWithinWhatOverlapsAreCertifiedToWhateverIsLeftOut) {
  // Where a search begins is what the pair remembers. Overlaps of round bodies with edges are certified to 1e-9 of the
  // size: an error that a contact keeps for a time T moves a body of mass m by up to k T^2/(2 m) times as far. After
  // the first impacts, and before deviations have grown by many of them.
  const int steps = 300;
  const double size = 1.4e-3, time = steps * 1e-5, stiffness = 2e3;
  const auto reference = runWith(asItIs, steps);
  EXPECT_GT(reference->report.contactSteps, 500u);
  for (const auto& change : std::vector<std::function<void(WorldOptions&)>>{searchEveryStep, lookAtEveryPair,
                                                                            searchFromNothing, followOrientations}) {
    const auto world = runWith(change, steps);
    for (std::size_t i = 0; i < reference->bodies.size(); ++i) {
      const double limit = 1e-9 * size * (1 + stiffness * time * time / (2 * reference->bodies.mass[i]));
      EXPECT_LT((reference->bodies.x(i) - world->bodies.x(i)).norm(), limit) << i;
    }
  }
}

}  // namespace
}  // namespace granular
