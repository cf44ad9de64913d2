// Closed forms, exact alignments, and random pairs against the exhaustive oracle.
#include <gtest/gtest.h>

#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "narrow/scenes.h"

namespace granular {
namespace {

using testing::randomFrame;
using testing::setDepth;

std::unique_ptr<Polyhedron> makeRock(Random& random, int points, double radius, const Vec3& stretch) {
  std::vector<Vec3> cloud;
  for (int k = 0; k < points; ++k) cloud.push_back((radius * random.direction()).cwiseProduct(stretch));
  return std::make_unique<Polyhedron>(cloud);
}

TEST(Touch, TwoSpheresOverlapByTheirRadiiLessTheirDistance) {
  const Sphere a(1.5e-3), b(1e-3);
  Touch touch;
  WarmCache cache;
  NarrowCounts counts;
  const Frame frameA(Mat3::Identity(), Vec3(1, 2, 3)), frameB(Mat3::Identity(), Vec3(1, 2, 3 + 2.4e-3));
  ASSERT_TRUE(findTouch(a, frameA, b, frameB, false, cache, counts, touch));
  EXPECT_NEAR(touch.overlap, 1e-4, 1e-15);
  EXPECT_NEAR((touch.normal - Vec3::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR((touch.onA - touch.onB - touch.overlap * touch.normal).norm(), 0, 1e-15);
}

TEST(Touch, AlignedCubesTouchAlongTheirFaceNormal) {
  const Cuboid cube(Vec3::Constant(1.5e-3));
  for (const double overlap : {1e-4, 1e-6, 1e-9, 1e-12}) {
    for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(1e-18, -1e-18, 0), Vec3(3e-4, 0, 0), Vec3(1.5e-3, -1.5e-3, 0)}) {
      Touch touch;
      WarmCache cache;
      NarrowCounts counts;
      const Frame below, above(Mat3::Identity(), offset + Vec3(0, 0, 3e-3 - overlap));
      for (int look = 0; look < 3; ++look) {
        ASSERT_TRUE(findTouch(cube, below, cube, above, false, cache, counts, touch)) << overlap;
        EXPECT_NEAR(touch.overlap, overlap, 4e-18) << offset.transpose();
        EXPECT_NEAR((touch.normal - Vec3::UnitZ()).norm(), 0, 1e-12) << offset.transpose();
      }
      EXPECT_EQ(counts.uncertified, 0u);
    }
  }
}

/// The claim of the narrow phase, checked against the oracle: the depth is the depth along the normal, no direction the
/// oracle looks at is shallower, and what is called apart is separated by the cached direction.
void expectRight(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, bool touches,
                 const Touch& touch, double size) {
  const ExhaustiveDepth oracle = searchExhaustively(a, frameA, b, frameB);
  if (!touches) {
    EXPECT_LT(oracle.depth, 1e-13 * size);
    return;
  }
  const double roundOff = 2e-15 * (size + a.boundingRadius() + b.boundingRadius());
  EXPECT_NEAR(touch.normal.norm(), 1, 1e-14);
  EXPECT_NEAR(depthAlong(a, frameA, b, frameB, touch.normal), touch.overlap, roundOff);
  EXPECT_LT(touch.overlap, oracle.depth + 1e-12 * size + 1e-9 * touch.overlap);
  EXPECT_NEAR((touch.onA - touch.onB - touch.overlap * touch.normal).norm(), 0, roundOff + 1e-15 * frameA.x.norm());
}

TEST(Touch, RandomPolyhedraAgreeWithTheExhaustiveSearch) {
  Random random(3);
  std::vector<std::unique_ptr<Polyhedron>> shapes;
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, 1, 1)));
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, 1, 3)));
  shapes.push_back(std::make_unique<Cuboid>(Vec3(1, 1, .02)));
  shapes.push_back(makeRock(random, 4, 1, Vec3::Ones()));
  shapes.push_back(makeRock(random, 12, 1, Vec3(1, 1, 3)));
  shapes.push_back(makeRock(random, 40, 1, Vec3::Ones()));
  NarrowCounts counts;
  int touching = 0;
  const int trials = 3000;
  for (int trial = 0; trial < trials; ++trial) {
    const Shape& a = *shapes[random.below(shapes.size())];
    const Shape& b = *shapes[random.below(shapes.size())];
    const double size = std::min(a.size(), b.size());
    const Frame frameA = randomFrame(random, 1);
    Frame frameB = randomFrame(random, 1);
    const Vec3 d = random.direction();
    frameB.x = frameA.x + 1.5 * d;
    const double wanted = (random.below(2) ? 1 : -1) * size * std::pow(10.0, random.uniform(-6, -1));
    setDepth(a, frameA, b, d, wanted, frameB);
    Touch touch;
    WarmCache cache;
    const bool touches = findTouch(a, frameA, b, frameB, false, cache, counts, touch);
    touching += touches;
    SCOPED_TRACE(trial);
    expectRight(a, frameA, b, frameB, touches, touch, size);
  }
  EXPECT_GT(touching, trials / 3);
  EXPECT_EQ(counts.uncertified, 0u);
}

}  // namespace
}  // namespace granular
