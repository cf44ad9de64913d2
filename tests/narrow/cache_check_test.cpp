#include "granular/narrow/cache_check.h"

#include <gtest/gtest.h>

#include "stress/pair_samples.h"

namespace granular {
namespace {

using namespace granular::stress;

TEST(CacheCheck, AcceptsWhateverKernelsRemember) {
  // Pairs of every kind, degenerate ones among them, through motions that make them touch and part.
  HardShapes shapes(0);
  int kinds[6] = {};
  for (std::uint64_t k = 0; k < 1000; ++k) {
    PairSample pair = drawPair(shapes, 21, k);
    Random random(k);
    WarmCache cache;
    NarrowCounts counts;
    Touch touch;
    const double motion = pair.size() * std::pow(10.0, random.uniform(-4, 0));
    for (int look = 0; look < 6; ++look) {
      findTouch(*pair.a, Frame(pair.poseA), *pair.b, Frame(pair.poseB), false, cache, counts, touch);
      ASSERT_TRUE(cacheFits(cache, *pair.a, *pair.b)) << k << ": kind " << cache.kind << ", features " << cache.featureA
                                                      << " and " << cache.featureB << "; " << pair.describe();
      ++kinds[cache.kind];
      pair.poseB.x += motion * random.direction();
      pair.poseB.q = rotationFromVector(0.3 * random.uniform() * random.direction()) * pair.poseB.q;
      pair.poseB.q.normalize();
    }
  }
  for (int kind = WarmCache::cold; kind <= WarmCache::smooth; ++kind) EXPECT_GT(kinds[kind], 0) << kind;
}

TEST(CacheCheck, RefusesFeaturesThatAShapeLacks) {
  const Cuboid box(Vec3(1, 1, 1));
  const Polyhedron octahedron(std::vector<Vec3>{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
  const Sphere ball(1);
  const Cylinder rod(1, 1);
  WarmCache cache;
  cache.kind = WarmCache::faceOfA;
  cache.touched = 1;
  EXPECT_TRUE(cacheFits(cache, box, octahedron));
  cache.featureA = 5;
  cache.featureB = 5;
  EXPECT_TRUE(cacheFits(cache, box, octahedron));
  EXPECT_TRUE(cacheFits(cache, octahedron, box)) << "the table's order counts, not the caller's";
  cache.featureA = 6;  // a cuboid has six faces
  EXPECT_FALSE(cacheFits(cache, box, octahedron));
  cache.featureA = 0;
  cache.featureB = 6;  // an octahedron has six corners
  EXPECT_FALSE(cacheFits(cache, box, octahedron));
  EXPECT_FALSE(cacheFits(cache, box, box)) << "a cuboid has three axes";
  cache.kind = WarmCache::faceOfB;
  EXPECT_TRUE(cacheFits(cache, ball, octahedron));
  cache.featureB = 8;
  EXPECT_FALSE(cacheFits(cache, ball, octahedron));
  cache.kind = WarmCache::smooth;
  cache.featureA = 7 << 24 | 2;  // the third cap of a cylinder
  cache.featureB = 0;
  EXPECT_FALSE(cacheFits(cache, rod, octahedron));
  cache.kind = 6;
  EXPECT_FALSE(cacheFits(cache, ball, ball));
}

}  // namespace
}  // namespace granular
