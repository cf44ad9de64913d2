// Overlaps at corners and crossing edges in closed form, against the walk over all cells.
#include "granular/point/corner_overlap.h"

#include <gtest/gtest.h>

#include "granular/narrow/narrow.h"
#include "narrow/scenes.h"

namespace granular {
namespace {

struct Scene {
  std::unique_ptr<Polyhedron> a, b;
  Frame frameA, frameB;
  Touch touch;
};

/// Two random rocks that overlap by `depth` (m; their radius is about 1 m).
Scene makeScene(Random& random, double depth) {
  Scene scene;
  const auto rock = [&random] {
    return testing::makeRock(random, 5 + static_cast<int>(random.below(16)), 1, Vec3(1, 1, random.uniform(0.5, 3)));
  };
  for (;;) {
    scene.a = rock();
    scene.b = rock();
    scene.frameA = testing::randomFrame(random, 1);
    scene.frameB = testing::randomFrame(random, 1);
    testing::setDepth(*scene.a, scene.frameA, *scene.b, random.direction(), depth, scene.frameB);
    WarmCache cache;
    NarrowCounts counts;
    if (findTouch(*scene.a, scene.frameA, *scene.b, scene.frameB, false, cache, counts, scene.touch) &&
        scene.touch.overlap < 2 * depth) {
      return scene;
    }
  }
}

void expectSame(const AreaMoments& fast, const AreaMoments& slow, double tolerance, const char* what) {
  // Lengths in units of the overlap's own extent: round-off of the clipped corners is relative to the bodies' size.
  const double side = std::sqrt(slow.area), height = slow.volume / slow.area;
  EXPECT_NEAR(fast.area, slow.area, tolerance * side * side) << what;
  EXPECT_NEAR((fast.first - slow.first).norm(), 0, tolerance * slow.area * side) << what;
  for (const auto& [x, y] : {std::pair{fast.xx, slow.xx}, {fast.yy, slow.yy}, {fast.xy, slow.xy}}) {
    EXPECT_NEAR(x, y, tolerance * slow.area * (side * side + slow.first.squaredNorm() / (slow.area * slow.area)))
        << what;
  }
  EXPECT_NEAR(fast.volume, slow.volume, tolerance * slow.volume) << what;
  EXPECT_NEAR((fast.firstOfVolume - slow.firstOfVolume).norm(), 0, tolerance * slow.volume * side) << what;
  EXPECT_NEAR(fast.square, slow.square, tolerance * slow.volume * height) << what;
  EXPECT_NEAR(fast.powers.below, slow.powers.below, tolerance * slow.area) << what;
  EXPECT_NEAR(fast.powers.above, slow.powers.above, tolerance * slow.area) << what;
  EXPECT_NEAR((fast.powers.firstAt - slow.powers.firstAt).norm(), 0, tolerance * slow.area * side) << what;
}

TEST(CornerOverlap, IsWhatTheWalkOverAllCellsFinds) {
  Random random(11);
  int served = 0, total = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const double depth = std::pow(10.0, random.uniform(-5, -1));
    const Scene scene = makeScene(random, depth);
    const ContactPlane plane(scene.touch);
    const SurfaceSide a(plane, *scene.a, scene.frameA, 1), b(plane, *scene.b, scene.frameB, -1);
    const double overlap = scene.touch.overlap;
    const PowerChoice power{4, overlap};
    OverlapArea fast, slow;
    ++total;
    if (!measureCorner(plane.feature, a, b, overlap, 1e-3 * overlap, power, fast)) continue;
    ASSERT_TRUE(measureByWalk(plane, *scene.a, scene.frameA, *scene.b, scene.frameB, overlap, power, 0, slow));
    ++served;
    // Round-off of heights over the extent of the overlap: 1e-15/depth, times the slenderness of slivers.
    expectSame(fast.moments, slow.moments, 1e-7, ("trial " + std::to_string(trial)).c_str());
    EXPECT_NEAR(fast.height, slow.height, 1e-6 * overlap + 1e-12);
    if (HasFailure()) break;
  }
  EXPECT_GT(served, total / 2);
  RecordProperty("served", served);
}

TEST(CornerOverlap, TheNamedFeatureGivesWhatTheSearchForItGives) {
  Random random(12);
  int named = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Scene scene = makeScene(random, std::pow(10.0, random.uniform(-5, -1)));
    if (scene.touch.feature.kind == TouchingFeature::unknown) continue;
    Touch nameless = scene.touch;
    nameless.feature = {};
    const double overlap = scene.touch.overlap;
    const PowerChoice power{4, overlap};
    OverlapArea byName, bySearch;
    const bool found = measureOverlap(ContactPlane(scene.touch), *scene.a, scene.frameA, *scene.b, scene.frameB,
                                      overlap, power, byName);
    ASSERT_EQ(found, measureOverlap(ContactPlane(nameless), *scene.a, scene.frameA, *scene.b, scene.frameB, overlap,
                                    power, bySearch));
    if (!found) continue;
    ++named;
    // As between the corner and the walk: one of the two may have taken the other way.
    expectSame(byName.moments, bySearch.moments, 1e-7, ("trial " + std::to_string(trial)).c_str());
    EXPECT_NEAR(byName.height, bySearch.height, 1e-6 * overlap + 1e-12);
    if (HasFailure()) break;
  }
  EXPECT_GT(named, 1000);
}

TEST(CornerOverlap, LeavesFacesAndDeepOverlapsToTheWalk) {
  const Cuboid cube(Vec3(1, 1, 1));
  const Frame below(Mat3::Identity(), Vec3(0, 0, 0)), above(Mat3::Identity(), Vec3(0.3, 0.2, 1.99));
  const Touch touch{Vec3::UnitZ(), 0.01, Vec3(0, 0, 1), Vec3(0, 0, 0.99), {}};
  const ContactPlane plane(touch);
  const SurfaceSide a(plane, cube, below, 1), b(plane, cube, above, -1);
  OverlapArea out;
  EXPECT_FALSE(measureCorner({}, a, b, touch.overlap, 1e-5, {}, out));
}

}  // namespace
}  // namespace granular
