// Hard pairs against the exhaustive search, and under every contact-point rule. benchmarks/random_pairs.cpp runs the
// same trials by the million.
#include <gtest/gtest.h>

#include "stress/pair_trial.h"

namespace granular::stress {
namespace {

void expectRight(const PairSample& pair, const TrialOutcome& out) {
  EXPECT_EQ(out.fault, "") << pair.describe();
  for (std::size_t rule = 0; rule < out.ruleFaults.size(); ++rule)
    EXPECT_EQ(out.ruleFaults[rule], "") << pointRuleName(static_cast<PointRule>(rule)) << ", " << pair.describe();
}

TEST(HardPairs, AreAnsweredAsByTheExhaustiveSearchAndPlacedInBothBodies) {
  HardShapes shapes(0);
  NarrowCounts counts;
  int touching = 0;
  constexpr std::uint64_t pairs = 400, seed = 7;
  for (std::uint64_t k = 0; k < pairs; ++k) {
    const PairSample pair = drawPair(shapes, seed, k);
    const TrialOutcome out = tryPair(pair, seed, k, k % 4 == 0);
    SCOPED_TRACE(k);
    expectRight(pair, out);
    counts += out.counts;
    touching += out.touches;
  }
  EXPECT_EQ(counts.uncertified, 0u);
  EXPECT_GT(touching, static_cast<int>(pairs) / 3);
}

TEST(HardPairs, HullsOfTwoThousandCornersAreCertifiedToo) {
  HardShapes shapes(2000);
  int found = 0;
  constexpr std::uint64_t seed = 8;
  for (std::uint64_t k = 0; found < 12; ++k) {
    const PairSample pair = drawPair(shapes, seed, k);
    const auto isLarge = [](const Shape& shape) {
      return shape.kind() == ShapeKind::polyhedron &&
             static_cast<const Polyhedron&>(shape).tables().vertexCount() > 1000;
    };
    if (!isLarge(*pair.a) && !isLarge(*pair.b)) continue;
    ++found;
    SCOPED_TRACE(k);
    const TrialOutcome out = tryPair(pair, seed, k, false);
    expectRight(pair, out);
  }
}

struct OnceWrong {
  std::uint64_t seed, number;
  const char* what;
};

class HardPairsOnceWrong : public testing::TestWithParam<OnceWrong> {};

TEST_P(HardPairsOnceWrong, AreRight) {
  SCOPED_TRACE(GetParam().what);
  static HardShapes shapes(2000);
  const PairSample pair = drawPair(shapes, GetParam().seed, GetParam().number);
  const TrialOutcome out = tryPair(pair, GetParam().seed, GetParam().number, false);
  expectRight(pair, out);
  EXPECT_EQ(out.counts.uncertified, 0u) << pair.describe();
}

INSTANTIATE_TEST_SUITE_P(
    Pairs, HardPairsOnceWrong,
    testing::Values(
        OnceWrong{1, 13143, "crossed faces of two needles: deepest point beside one of them"},
        OnceWrong{1, 15827, "the edge of a needle across the corner of a plate"},
        OnceWrong{1, 21273, "faces tilted by round-off, their deepest corner beside the other"},
        OnceWrong{1, 73343, "edges that cross next to a corner"},
        OnceWrong{1, 33271, "the side of a cylinder along an edge"},
        OnceWrong{1, 74746, "a corner on the slope of a cone"}, OnceWrong{1, 85309, "a face across the side of a disk"},
        OnceWrong{1, 14438, "one end of an edge in the slab of face_centroid"},
        OnceWrong{1, 37348, "the same on a cylinder's cap"},
        OnceWrong{1, 39417, "an edge between faces that are nearly one"},
        OnceWrong{1, 92900, "the same around each other's centre"},
        OnceWrong{1, 96372, "the gap along a product of nearly parallel edges"},
        OnceWrong{1, 31417, "a corner on a cone a hundredfold smaller, uncertified"},
        OnceWrong{1, 72854, "the same, cold"}, OnceWrong{3, 3069, "depths of round-off, many times the overlap"},
        OnceWrong{3, 24133, "nearly parallel faces that no feature owns up to"},
        OnceWrong{3, 44592, "the same, aligned"}, OnceWrong{3, 145689, "two needles tip on tip, uncertified"},
        OnceWrong{3, 176236, "a descent that ended beside the minimum, warm"},
        OnceWrong{3, 87657, "an overlap of nothing between faces that are nearly one"},
        OnceWrong{5, 899914, "an axis across edges that are nearly parallel, of a cuboid five hundred times larger"},
        OnceWrong{6, 131104, "the same, half as large"}, OnceWrong{7, 703099, "a pressure of nothing over nothing"},
        OnceWrong{4, 191161, "a cylinder's side along the edge between two faces"},
        OnceWrong{6, 672052, "the same along an edge whose other face is too steep to count"},
        OnceWrong{3, 431803, "a sliver of an overlap of 1e-10 of the size"}, OnceWrong{8, 941998, "the same"},
        OnceWrong{5, 889038, "a ball whose centre is just outside a cone"},
        OnceWrong{12, 925862, "a thin ellipsoid beside the edge of a tetrahedron a hundredfold larger"},
        OnceWrong{8, 770584, "the same beside another"},
        OnceWrong{12, 579034, "a needle's rim at the corner of a cube a hundredfold larger, uncertified"}),
    [](const auto& instance) {
      return "Seed" + std::to_string(instance.param.seed) + "Pair" + std::to_string(instance.param.number);
    });

TEST(HardPairs, ConcentricBodiesAreCertifiedToAPartOfTheirOverlap) {
  // Depths all around are nearly the same; the closed form is the sum of the least half-widths.
  const Sphere sphere(1);
  const Ellipsoid egg(Vec3(1, 1, 2)), flat(Vec3(1, .7, .02));
  const Cylinder rod(.1, 4), disk(1, .2);
  const Cone cone(.5, 1);
  const struct {
    const Shape &a, &b;
    double depth;
  } cases[] = {{sphere, egg, 2}, {sphere, flat, 1.02}, {egg, egg, 2},       {egg, rod, 1.1},
               {rod, rod, .2},   {disk, disk, .2},     {egg, flat, 1.7},    {sphere, disk, 1.1},
               {rod, disk, 1.1}, {disk, flat, .12},    {cone, sphere, 1.25}};
  for (const auto& pair : cases) {
    WarmCache cache;
    NarrowCounts counts;
    Touch touch;
    ASSERT_TRUE(findTouch(pair.a, Frame(), pair.b, Frame(), false, cache, counts, touch));
    SCOPED_TRACE(pair.a.describe() + " and " + pair.b.describe());
    EXPECT_EQ(counts.uncertified, 0u);
    EXPECT_NEAR(touch.overlap, pair.depth, 1e-9);
  }
}

TEST(HardPairs, TipsAndRimsOnACommonAxisAreCertified) {
  // A whole circle of normals has the same depth: cone tip over cone tip, cone tip into a pyramid's.
  const Cone cone(1, 1);
  const Polyhedron octahedron(std::vector<Vec3>{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
  const double top = cone.support(Vec3::UnitZ()).z();
  const Quat over(Eigen::AngleAxisd(pi, Vec3::UnitX()));
  for (const double depth : {1e-6, 1e-4, 1e-2}) {
    const struct {
      const Shape& other;
      double reach;
    } cases[] = {{cone, top}, {octahedron, 1}};
    for (const auto& c : cases) {
      const Frame above(Pose{Vec3(0, 0, top + c.reach - depth), over});
      WarmCache cache;
      NarrowCounts counts;
      Touch touch;
      ASSERT_TRUE(findTouch(cone, Frame(), c.other, above, false, cache, counts, touch));
      EXPECT_EQ(counts.uncertified, 0u) << c.other.describe() << " " << depth;
      // Both have sides at 45 degrees or, the octahedron's, steeper to the axis.
      EXPECT_NEAR(touch.overlap, depth * std::sqrt(.5), 1e-9) << c.other.describe();
    }
  }
}

}  // namespace
}  // namespace granular::stress
