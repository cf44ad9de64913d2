#include "granular/search/search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

/// What is round is looked for as a ball, or by its box alone as everything else.
enum class As { boxes, balls };

/// Bodies at random places of a box, some fast.
Bodies makeBodies(int count, double width, const Shape& shape, Random& random, As as = As::boxes) {
  Bodies bodies;
  for (int k = 0; k < count; ++k) {
    NewBody body;
    body.id = k;
    body.pose.x = Vec3(random.uniform(0, width), random.uniform(0, width), random.uniform(0, width));
    body.pose.q = random.rotation();
    body.velocity = random.direction() * random.uniform(0, 2);
    bodies.add(body, shape, as == As::balls ? Bodies::Turning::ball : Bodies::Turning::byScheme);
  }
  return bodies;
}

using Key = std::tuple<std::int32_t, std::int32_t, Image>;
std::set<Key> keysOf(const PairList& list) {
  std::set<Key> keys;
  for (const Pair& pair : list.pairs) keys.insert({pair.a, pair.b, pair.image});
  return keys;
}

/// Boxes of bodies that move about and become more, in the tree and in the oracle: both must find the same.
struct MovingBoxes {
  double largest = 1;    ///< size of one box in ten, over that of the others
  double offset = 0;     ///< of the middle of all, m
  bool endless = false;  ///< some boxes have no end, and some are not numbers
};
void compareWithBruteForce(std::size_t count, const MovingBoxes& moving) {
  Random random(1);
  const auto tree = makeBoxTree();
  const auto brute = makeBruteForceBroadPhase();
  std::vector<std::array<std::int32_t, 2>> fromTree, fromBrute;
  std::vector<std::int32_t> nearInTree, nearInBrute;
  std::size_t placed = 0, met = 0;
  for (int round = 0; round < 20; ++round) {
    const double staying = round % 3 == 0 ? 0.5 : 0.97;  // few that move go another way than many
    for (std::size_t k = 0; k < placed; ++k) {
      if (random.uniform() < staying) continue;
      const double half = 1.5e-3 * random.uniform(1, 2) * (random.uniform() < 0.1 ? moving.largest : 1);
      const Vec3 centre = Vec3(moving.offset, 0, 0) + 0.04 * Vec3(random.uniform(), random.uniform(), random.uniform());
      Aabb box{centre.array() - half, centre.array() + half};
      if (moving.endless && k % 50 == 5) box = {Vec3::Constant(-1e300), Vec3::Constant(1e300)};
      if (moving.endless && k % 50 == 6) box = {Vec3::Constant(1e300), Vec3::Constant(1.1e300)};
      if (moving.endless && k % 50 == 7) box.hi.setConstant(infinity);
      if (moving.endless && k % 50 == 9) box.lo.y() = std::nan("");
      tree->place(k, box);
      brute->place(k, box);
    }
    // The first ones, then some that come, one by one and at once.
    const std::size_t all = round == 0 ? count / 2 : std::min(count, placed + (round % 5 == 4 ? count / 4 : 1));
    for (; placed < all; ++placed) {
      const Vec3 centre = Vec3(moving.offset, 0, 0) + 0.04 * Vec3(random.uniform(), random.uniform(), random.uniform());
      tree->place(placed, {centre.array() - 2e-3, centre.array() + 2e-3});
      brute->place(placed, {centre.array() - 2e-3, centre.array() + 2e-3});
    }
    for (std::size_t k = 0; k < placed && round % 2 == 1; k += 7) {
      tree->query(brute->bounds()[k], nearInTree);
      brute->query(brute->bounds()[k], nearInBrute);
      std::sort(nearInTree.begin(), nearInTree.end());
      ASSERT_EQ(nearInTree, nearInBrute) << round;
    }
    tree->collect(fromTree);
    brute->collect(fromBrute);
    std::sort(fromTree.begin(), fromTree.end());
    ASSERT_EQ(fromTree, fromBrute) << round;
    met += fromBrute.size();
  }
  EXPECT_EQ(placed, count);
  EXPECT_TRUE(met > 0 || count < 10);
}

TEST(BroadPhase, TheTreeFindsExactlyThePairsOfBruteForceWhateverTheNumberOfBoxes) {
  for (const std::size_t count : {0, 1, 2, 7, 8, 9, 17, 64, 65, 400, 520}) compareWithBruteForce(count, {});
}

TEST(BroadPhase, TheTreeFindsExactlyThePairsOfBruteForceOfUnequalFarAndEndlessBoxes) {
  compareWithBruteForce(400, {.largest = 20});
  compareWithBruteForce(400, {.offset = 1e5});  // .01 m in single precision, if it were from 0
  compareWithBruteForce(400, {.offset = -1e12});
  compareWithBruteForce(400, {.largest = 5, .endless = true});
}

TEST(BroadPhase, TheTreeFindsBoxesThatAreAllTheSame) {
  const auto tree = makeBoxTree();
  for (std::size_t k = 0; k < 100; ++k) tree->place(k, {Vec3::Zero(), Vec3::Zero()});
  std::vector<std::array<std::int32_t, 2>> pairs;
  tree->collect(pairs);
  EXPECT_EQ(pairs.size(), 4950u);
}

/// A search that remembers as much as a checkpoint does, and so must look at everybody.
Search forgetWhoStayed(Search& search, const SearchOptions& options, const Bodies& bodies) {
  Search other(options);
  search.packBoxes();
  const auto columns = [](auto& of) {
    std::tuple<std::vector<double>*, std::vector<double>*, std::vector<Vec3>*, std::vector<Vec3>*> all{};
    of.visitState([&](const std::string& name, auto& column) {
      if constexpr (std::is_same_v<decltype(column), std::vector<double>&>) {
        (name == "margin" ? std::get<0>(all) : std::get<1>(all)) = &column;
      } else {
        (name == "lowest" ? std::get<2>(all) : std::get<3>(all)) = &column;
      }
    });
    return all;
  };
  const auto from = columns(search), to = columns(other);
  *std::get<0>(to) = *std::get<0>(from);
  *std::get<1>(to) = *std::get<1>(from);
  *std::get<2>(to) = *std::get<2>(from);
  *std::get<3>(to) = *std::get<3>(from);
  other.restoreBoxes(bodies);
  return other;
}

/// Moves a few of many bodies about for many refreshes; the list must be that of a search that looks at everybody.
void compareWithFullSearches(const SearchOptions& options, As as) {
  Random random(5);
  const Sphere sphere(1e-3);
  Bodies bodies = makeBodies(400, 0.02, sphere, random, as);
  for (std::size_t i = 0; i < 40; ++i) bodies.hold(10 * i, BodyState::frozen);
  Search search(options);
  PairList list;
  const double dt = 1e-5;
  search.refreshPairs(bodies, dt, 0, list);
  std::size_t came = 0;
  for (int n = 0; n < 60; ++n) {
    for (std::size_t i = static_cast<std::size_t>(n % 3) + 1; i < bodies.size(); i += 20) {
      const Vec3 way = 2e-3 * random.uniform() * random.direction();
      bodies.x(i) += way;
      if (bodies.haveOrientations()) bodies.frame[i].x = bodies.x(i);
      bodies.travel[i] += way.norm();
    }
    if (n == 30) bodies.release(200);  // at rest among others at rest: nobody looked for its pairs with them
    PairList same = list;
    Search full = forgetWhoStayed(search, options, bodies);
    full.refreshPairs(bodies, dt, 0, same);
    const std::set<Key> before = keysOf(list);
    search.refreshPairs(bodies, dt, 0, list);
    ASSERT_EQ(list.pairs.size(), same.pairs.size()) << n;
    for (std::size_t k = 0; k < list.pairs.size(); ++k) {
      const Pair &p = list.pairs[k], &q = same.pairs[k];
      ASSERT_TRUE(!comesBefore(p, q) && !comesBefore(q, p) && p.slot == q.slot) << n << ", pair " << k;
      came += !before.count({p.a, p.b, p.image});
    }
    ASSERT_EQ(list.memory.free, same.memory.free);
  }
  EXPECT_GT(came, 500u);
}

TEST(Search, AtTheCostOfAFewFindsThePairsOfAll) {
  compareWithFullSearches({}, As::boxes);
  compareWithFullSearches({}, As::balls);
}

TEST(Search, AtTheCostOfAFewFindsThePairsOfAllAcrossPeriods) {
  SearchOptions options;
  options.periods.length = Vec3(0.02, 0.02, 0);
  compareWithFullSearches(options, As::boxes);
  compareWithFullSearches(options, As::balls);
}

void lookForMissedPairs(As as) {
  Random random(2);
  const Sphere sphere(1e-3);
  Bodies bodies = makeBodies(300, 0.02, sphere, random, as);
  SearchOptions options;
  Search search(options);
  PairList list;
  const double dt = 1e-5;
  int refreshed = 0;
  for (int n = 0; n < 400; ++n) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      bodies.x(i) += dt * bodies.vHalf(i);
      bodies.travel[i] += dt * bodies.vHalf(i).norm();
      if (bodies.haveOrientations()) bodies.frame[i].x = bodies.x(i);
    }
    if (search.isDue(bodies, 0)) {
      search.refreshPairs(bodies, dt, 0, list);
      ++refreshed;
    }
    const std::set<Key> keys = keysOf(list);
    for (std::int32_t i = 0; i < 300; ++i) {
      for (std::int32_t j = i + 1; j < 300; ++j) {
        if ((bodies.x(static_cast<std::size_t>(i)) - bodies.x(static_cast<std::size_t>(j))).norm() < 2e-3) {
          ASSERT_TRUE(keys.count({i, j, Image{0, 0, 0}})) << i << " " << j << " step " << n;
        }
      }
    }
  }
  EXPECT_LT(refreshed, 100);
}
TEST(Search, NoOverlappingPairIsMissedWhileBodiesMoveWithinTheirSkin) {
  lookForMissedPairs(As::boxes);
  lookForMissedPairs(As::balls);
}

TEST(Search, BallsAreListedIfTheyMayMeetBeforeTheNextSearchAndOnlyThen) {
  Random random(6);
  const double width = 0.02;
  const Sphere sphere(1e-3);
  for (const double period : {0.0, width}) {
    const Bodies bodies = makeBodies(300, width, sphere, random, As::balls);
    SearchOptions options;
    options.periods.length = Vec3(period, period, 0);
    Search search(options);
    PairList list;
    search.refreshPairs(bodies, 1e-5, 0, list);
    const std::set<Key> keys = keysOf(list);
    std::size_t expected = 0;
    for (std::int32_t i = 0; i < 300; ++i) {
      for (std::int32_t j = i + 1; j < 300; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        Vec3 between = bodies.x(b) - bodies.x(a);
        Image image{0, 0, 0};
        for (int k = 0; k < 2 && period > 0; ++k) {
          image[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(-std::round(between[k] / period));
        }
        between += options.periods.shift(image);
        const bool may = between.norm() <= 2 * sphere.boundingRadius() + search.margin(a) + search.margin(b);
        ASSERT_EQ(keys.count({i, j, image}) == 1, may) << i << " " << j;
        expected += may;
      }
    }
    EXPECT_EQ(keys.size(), expected);
    EXPECT_GT(expected, 300u);
  }
}

void lookForImages(As as) {
  Random random(3);
  const double width = 0.01;
  const Sphere sphere(0.8e-3);
  Bodies bodies = makeBodies(150, width, sphere, random, as);
  // Some bodies have left the domain: their images must still be found.
  for (std::size_t i = 0; i < bodies.size(); i += 5) {
    bodies.x(i) += Vec3(3 * width, -width, 0);
    if (bodies.haveOrientations()) bodies.frame[i].x = bodies.x(i);
  }
  SearchOptions options;
  options.periods.length = Vec3(width, width, 0);
  options.skin = 0.01;
  options.lookAhead = 0;
  Search search(options);
  PairList list;
  search.refreshPairs(bodies, 1e-6, 0, list);

  std::set<Key> touching;
  for (const Pair& pair : list.pairs) {
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    const Vec3 between = bodies.x(b) + options.periods.shift(pair.image) - bodies.x(a);
    if (between.norm() >= 1.6e-3) continue;
    EXPECT_TRUE(touching.insert({pair.a, pair.b, Image{0, 0, 0}}).second);
  }
  std::size_t expected = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      Vec3 d = bodies.x(j) - bodies.x(i);
      for (int k = 0; k < 2; ++k) d[k] -= width * std::round(d[k] / width);
      if (d.norm() < 1.6e-3) ++expected;
    }
  }
  EXPECT_EQ(touching.size(), expected);
  EXPECT_GT(expected, 50u);
}
TEST(Search, PeriodicImagesAreFoundOnceEach) {
  lookForImages(As::boxes);
  lookForImages(As::balls);
}

TEST(Search, RestoredBetweenARemovalAndTheNextSearchBeginsAnew) {
  Random random(8);
  const double width = 0.01;
  const Sphere sphere(0.8e-3);
  SearchOptions options;
  options.periods.length = Vec3(width, 0, 0);
  const Bodies many = makeBodies(150, width, sphere, random), few = makeBodies(20, width, sphere, random);
  Search search(options);
  PairList list;
  search.refreshPairs(many, 1e-6, 0, list);
  search.invalidate();
  search.packBoxes();
  search.restoreBoxes(few);
  PairList found, expected;
  search.refreshPairs(few, 1e-6, 0, found);
  Search(options).refreshPairs(few, 1e-6, 0, expected);
  EXPECT_EQ(keysOf(found), keysOf(expected));
  EXPECT_GT(keysOf(found).size(), 3u);
}

TEST(Search, MemoryOfAPairSurvivesARefresh) {
  const Sphere sphere(1e-3);
  Bodies bodies;
  for (int k = 0; k < 3; ++k) {
    NewBody body;
    body.id = k;
    body.pose.x = Vec3(1.9e-3 * k, 0, 0);
    bodies.add(body, sphere);
  }
  SearchOptions options;
  options.everyStep = true;
  Search search(options);
  PairList list;
  search.refreshPairs(bodies, 1e-6, 0, list);
  ASSERT_EQ(list.pairs.size(), 2u);
  list.memory.makeHistories();
  const std::int32_t slot = list.pairs[1].slot;
  list.memory.history[static_cast<std::size_t>(slot)].twist = 7;
  bodies.x(0).x() -= 5e-3;  // the first pair goes
  if (bodies.haveOrientations()) bodies.frame[0].x = bodies.x(0);
  search.refreshPairs(bodies, 1e-6, 0, list);
  ASSERT_EQ(list.pairs.size(), 1u);
  EXPECT_EQ(list.pairs[0].slot, slot);
  EXPECT_EQ(list.memory.history[static_cast<std::size_t>(slot)].twist, 7);
}

}  // namespace
}  // namespace granular
