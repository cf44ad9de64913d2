// Closed forms, exact alignments, and random pairs against the exhaustive oracle.
#include <gtest/gtest.h>

#include "granular/core/tolerances.h"
#include "granular/narrow/kernels.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "narrow/scenes.h"

namespace granular {
namespace {

using testing::makeRock;
using testing::randomFrame;
using testing::setDepth;

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

/// How far the named part of a body stays behind its deepest point along n (body axes), and how far its faces' normals
/// are from n where it is a face.
double shortOf(const PolyhedronTables& t, const Vec3& n, TouchingFeature::Kind kind, TouchingFeature::Kind ownFace,
               std::int32_t index) {
  const double deepest = n.dot(t.vertices[static_cast<std::size_t>(t.supportVertex(n))]);
  const auto lag = [&](std::int32_t v) { return deepest - n.dot(t.vertices[static_cast<std::size_t>(v)]); };
  if (kind == TouchingFeature::edges) {
    const PolyhedronTables::Edge& edge = t.edges[static_cast<std::size_t>(index)];
    return std::max(lag(edge.a), lag(edge.b));
  }
  if (kind != ownFace) return lag(index);
  double worst = (t.faces[static_cast<std::size_t>(index)].normal - n).norm();
  for (const PolyhedronTables::Corner& corner : t.cornersOf(index)) worst = std::max(worst, lag(corner.vertex));
  return worst;
}

TEST(Touch, TheNamedFeatureIsTheDeepestOfEitherBody) {
  Random random(31);
  std::array<int, 4> seen{};
  for (int trial = 0; trial < 4000; ++trial) {
    const Cuboid box(Vec3(random.uniform(.5, 2), random.uniform(.5, 2), random.uniform(.5, 2)));
    const auto rock = makeRock(random, 5 + static_cast<int>(random.below(16)), 1, Vec3(1, 1, random.uniform(.5, 3)));
    const Cuboid other(Vec3(random.uniform(.5, 2), random.uniform(.5, 2), random.uniform(.5, 2)));
    const Polyhedron& a = trial % 3 == 0 ? static_cast<const Polyhedron&>(*rock) : box;
    const Polyhedron& b = trial % 2 == 0 ? static_cast<const Polyhedron&>(*rock) : other;
    const Frame frameA = randomFrame(random, 1);
    Frame frameB = randomFrame(random, 1);
    setDepth(a, frameA, b, random.direction(), 1e-3, frameB);
    Touch touch;
    WarmCache cache;
    NarrowCounts counts;
    if (!findTouch(a, frameA, b, frameB, false, cache, counts, touch)) continue;
    const TouchingFeature& f = touch.feature;
    ++seen[static_cast<std::size_t>(f.kind)];
    if (f.kind == TouchingFeature::unknown) continue;
    // Round-off of the positions, of order 1.
    const Vec3 inA = frameA.unrotate(touch.normal), inB = -frameB.unrotate(touch.normal);
    EXPECT_LT(shortOf(a.tables(), inA, f.kind, TouchingFeature::faceOfA, f.a), 1e-11) << trial;
    EXPECT_LT(shortOf(b.tables(), inB, f.kind, TouchingFeature::faceOfB, f.b), 1e-11) << trial;
  }
  for (const int count : {seen[1], seen[2], seen[3]}) EXPECT_GT(count, 300);
  EXPECT_LT(seen[0], 10);
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
                 const Touch& touch, const WarmCache& cache, double size) {
  if (!touches) {
    const bool swapped = a.kind() > b.kind();
    const Vec3 n = swapped ? Vec3(-frameB.rotate(cache.direction)) : frameA.rotate(cache.direction);
    EXPECT_NEAR(depthAlong(a, frameA, b, frameB, n), -cache.budget, 1e-14 * (size + (frameA.x - frameB.x).norm()));
    EXPECT_GE(cache.budget, 0);
    return;
  }
  const ExhaustiveDepth oracle = searchExhaustively(a, frameA, b, frameB);
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
    expectRight(a, frameA, b, frameB, touches, touch, cache, size);
  }
  EXPECT_GT(touching, trials / 3);
  EXPECT_EQ(counts.uncertified, 0u);
}

std::vector<std::unique_ptr<Shape>> makeOneOfEachKind(Random& random) {
  std::vector<std::unique_ptr<Shape>> shapes;
  shapes.push_back(std::make_unique<Sphere>(.8));
  shapes.push_back(std::make_unique<Ellipsoid>(Vec3(1, .7, .4)));
  shapes.push_back(std::make_unique<Cylinder>(.8, 1.6));
  shapes.push_back(std::make_unique<Cone>(.9, 1.5));
  shapes.push_back(std::make_unique<Cuboid>(Vec3(.5, .8, 1.1)));
  shapes.push_back(makeRock(random, 24, 1, Vec3::Ones()));
  return shapes;
}

TEST(Touch, EveryPairOfKindsAgreesWithTheExhaustiveSearch) {
  Random random(5);
  const auto shapes = makeOneOfEachKind(random);
  NarrowCounts counts;
  int touching = 0, trials = 0;
  for (const auto& a : shapes) {
    for (const auto& b : shapes) {
      for (int trial = 0; trial < 12; ++trial, ++trials) {
        const double size = std::min(a->size(), b->size());
        const Frame frameA = randomFrame(random, 1);
        Frame frameB = randomFrame(random, 1);
        const Vec3 d = random.direction();
        frameB.x = frameA.x + 1.5 * d;
        setDepth(*a, frameA, *b, d, (trial % 2 ? 1 : -1) * size * std::pow(10.0, random.uniform(-6, -1)), frameB);
        Touch touch;
        WarmCache cache;
        const bool touches = findTouch(*a, frameA, *b, frameB, false, cache, counts, touch);
        touching += touches;
        SCOPED_TRACE(a->describe() + " and " + b->describe() + " trial " + std::to_string(trial));
        expectRight(*a, frameA, *b, frameB, touches, touch, cache, size);
      }
    }
  }
  EXPECT_GT(touching, trials / 3);
  EXPECT_EQ(counts.uncertified, 0u);
}

TEST(Touch, SwappingTheBodiesTurnsTheTouchRound) {
  Random random(6);
  const auto shapes = makeOneOfEachKind(random);
  for (const auto& a : shapes) {
    for (const auto& b : shapes) {
      for (int trial = 0; trial < 20; ++trial) {
        const double size = std::min(a->size(), b->size());
        const Frame frameA = randomFrame(random, 1);
        Frame frameB = randomFrame(random, 1);
        frameB.x = frameA.x + (a->size() + b->size()) * random.uniform(.9, 1) * random.direction();
        Touch there, back;
        WarmCache cacheThere, cacheBack;
        NarrowCounts counts;
        const bool touches = findTouch(*a, frameA, *b, frameB, false, cacheThere, counts, there);
        ASSERT_EQ(touches, findTouch(*b, frameB, *a, frameA, false, cacheBack, counts, back));
        if (!touches) continue;
        SCOPED_TRACE(a->describe() + " and " + b->describe());
        EXPECT_NEAR(there.overlap, back.overlap, tolerance::certificate * size);
        // Deep pairs may have two equal minima; elsewhere the normals are opposite.
        if (there.overlap < .05 * size) {
          EXPECT_NEAR((there.normal + back.normal).norm(), 0, 1e-6);
        }
      }
    }
  }
}

TEST(Touch, MovingTurningAndScalingBothBodiesChangesNothingElse) {
  Random random(8);
  for (const double scale : {1e-6, 1e-3, 1e3}) {
    const Cuboid a(scale * Vec3(.5, .8, 1.1)), b(scale * Vec3(1, 1, 1)), unitA(Vec3(.5, .8, 1.1)), unitB(Vec3(1, 1, 1));
    const Ellipsoid c(scale * Vec3(1, .7, .4)), unitC(Vec3(1, .7, .4));
    const std::array<std::pair<const Shape*, const Shape*>, 3> same{{{&a, &unitA}, {&b, &unitB}, {&c, &unitC}}};
    for (int trial = 0; trial < 200; ++trial) {
      const auto& [shapeA, plainA] = same[random.below(3)];
      const auto& [shapeB, plainB] = same[random.below(3)];
      const Pose poseA{Vec3::Zero(), random.rotation()},
          poseB{random.uniform(1, 1.8) * random.direction(), random.rotation()};
      const Quat turn = random.rotation();
      const Vec3 shift = random.direction();
      const Frame frameA(Pose{scale * (turn * poseA.x + shift), turn * poseA.q});
      const Frame frameB(Pose{scale * (turn * poseB.x + shift), turn * poseB.q});
      Touch plain, moved;
      WarmCache cachePlain, cacheMoved;
      NarrowCounts counts;
      const bool touches = findTouch(*plainA, Frame(poseA), *plainB, Frame(poseB), false, cachePlain, counts, plain);
      ASSERT_EQ(touches, findTouch(*shapeA, frameA, *shapeB, frameB, false, cacheMoved, counts, moved));
      if (!touches) continue;
      EXPECT_NEAR(moved.overlap / scale, plain.overlap, tolerance::certificate);
      if (plain.overlap < .05) {
        EXPECT_NEAR((moved.normal - turn * plain.normal).norm(), 0, 1e-6);
      }
    }
  }
}

TEST(Touch, CrossedPlanksTouchFaceToFaceAlthoughNoVertexLiesInside) {
  const Cuboid plank(Vec3(3, .5, .2));
  const Frame below, above(Pose{Vec3(.3, -.2, .4 - 1e-5), Quat(Eigen::AngleAxisd(pi / 2, Vec3::UnitZ()))});
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k) corners.emplace_back(k & 1 ? 3 : -3, k & 2 ? .5 : -.5, k & 4 ? .2 : -.2);
  const Polyhedron hull(corners);
  for (const Shape* shape : {static_cast<const Shape*>(&plank), static_cast<const Shape*>(&hull)}) {
    Touch touch;
    WarmCache cache;
    NarrowCounts counts;
    for (int look = 0; look < 3; ++look) {
      ASSERT_TRUE(findTouch(*shape, below, *shape, above, false, cache, counts, touch));
      EXPECT_NEAR(touch.overlap, 1e-5, 1e-14);
      EXPECT_NEAR((touch.normal - Vec3::UnitZ()).norm(), 0, 1e-9);
    }
  }
}

TEST(Certificate, TheDiagonalAnswerForAlignedCubesIsCaughtAndReplaced) {
  const Cuboid cube(Vec3::Constant(1.5e-3));
  const double overlap = 1e-6;
  const Frame below, above(Mat3::Identity(), Vec3(0, 0, 3e-3 - overlap));
  Difference c(cube, below, cube, above);
  const PenetrationAnswer diagonal{true, Vec3::Ones() / std::sqrt(3.0), overlap / std::sqrt(3.0)};
  NarrowCounts counts;
  const SearchResult found = searchConvex(c, Vec3(.3, .2, .9).normalized(), &diagonal, counts);
  EXPECT_EQ(counts.fallbacks, 1u);
  EXPECT_EQ(counts.uncertified, 0u);
  EXPECT_NEAR(found.minimum.depth, overlap, 1e-17);
  EXPECT_NEAR((found.minimum.normal - Vec3::UnitZ()).norm(), 0, 1e-9);

  countProposal(c, diagonal, overlap, counts);
  EXPECT_EQ(counts.fallbacks, 2u);
}

TEST(Certificate, AnOverlapCalledSeparateIsCountedAndFoundAllTheSame) {
  const Cuboid cube(Vec3::Constant(1.5e-3));
  const Frame below, above(Pose{Vec3(2e-4, 1e-4, 3.1e-3), Quat(Eigen::AngleAxisd(.3, Vec3(1, 2, 3).normalized()))});
  Difference c(cube, below, cube, above);
  NarrowCounts counts;
  const SearchResult found = searchConvex(c, Vec3::UnitX(), std::make_unique<PenetrationAnswer>().get(), counts);
  EXPECT_FALSE(found.apart);
  EXPECT_EQ(counts.missed, 1u);
  EXPECT_NEAR(found.minimum.depth, searchExhaustively(cube, below, cube, above).depth, 1e-15);
}

TEST(Certificate, ConesOnACommonAxisAreCertifiedCoarselyAndCounted) {
  // Tip in tip: all directions of the circle of the side's normals are equally shallow.
  const double overlap = 5e-5;
  const Cone cone(1e-3, 2e-3);
  const Vec3 tip = cone.support(Vec3::UnitZ());
  const Frame upright, upsideDown(Pose{(2 * tip.z() - overlap) * Vec3::UnitZ(), Quat(0, 1, 0, 0)});
  const double exact = overlap / std::sqrt(5.0);  // the sine of half the opening angle
  Touch touch;
  WarmCache cache;
  NarrowCounts counts;
  ASSERT_TRUE(findTouch(cone, upright, cone, upsideDown, true, cache, counts, touch));
  EXPECT_NEAR(touch.overlap, exact, tolerance::coaxialCertificate * exact);
  EXPECT_EQ(counts.coarse, 1u);
  EXPECT_EQ(counts.uncertified, 0u);
}

}  // namespace
}  // namespace granular
