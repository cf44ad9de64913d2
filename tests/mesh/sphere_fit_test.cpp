// Clumps fitted to meshes: a ball needs one sphere, errors fall with more of them, and what is reported is what is.
#include "granular/mesh/sphere_fit.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/shape/ellipsoid.h"
#include "mesh/generated.h"

namespace granular {
namespace {

using namespace granular::testing;

SphereFit fit(const TriangleMesh& mesh, int count, bool match = true, int cells = 32) {
  SphereFitOptions options;
  options.count = count;
  options.matchVolume = match;
  options.cells = cells;
  return fitSpheres(mesh, options);
}

TEST(SphereFit, ABallIsOneSphereOfItsVolume) {
  const TriangleMesh ball = Sphere(2e-3).surface(48);
  const SphereFit one = fit(ball, 1);
  ASSERT_EQ(one.spheres.size(), 1u);
  EXPECT_LT(one.spheres[0].centre.norm(), 0.02e-3);
  EXPECT_NEAR(one.volumeError, 0, 1e-8);
  EXPECT_NEAR(one.spheres[0].radius, 2e-3, 0.01e-3);
  EXPECT_LT(one.inertiaError, 0.01);
  EXPECT_LT(one.symmetricDifference, 0.05);
}

TEST(SphereFit, InscribedSpheresLieInsideAndFillMoreAsTheyAreMore) {
  const TriangleMesh mesh = Ellipsoid(Vec3(3e-3, 1.5e-3, 1e-3)).surface(32);
  const Ellipsoid around(Vec3(3e-3, 1.5e-3, 1e-3) * (1 + 1e-6));
  Random random(3);
  double before = 1;
  for (const int count : {3, 10, 30, 100}) {
    const SphereFit found = fit(mesh, count, false);
    EXPECT_LE(static_cast<int>(found.spheres.size()), count);
    EXPECT_LT(found.empty, before);
    EXPECT_NEAR(found.volumeError, -found.empty, 1e-12);
    EXPECT_EQ(found.growth, 0);
    EXPECT_EQ(found.parts, countParts(found.spheres));
    before = found.empty;
    for (const ChildSphere& child : found.spheres) {
      for (int n = 0; n < 50; ++n) EXPECT_TRUE(around.contains(child.centre + child.radius * random.direction()));
    }
  }
  EXPECT_LT(before, 0.08);
}

TEST(SphereFit, GrowthMatchesTheVolumeAndBringsTheInertiaNear) {
  const TriangleMesh box = makeBox(Vec3(-2e-3, -1e-3, -1e-3), Vec3(2e-3, 1e-3, 1e-3));
  double before = 1;
  for (const int count : {4, 20, 80}) {
    const SphereFit found = fit(box, count);
    EXPECT_NEAR(found.volumeError, 0, 1e-8);
    EXPECT_NEAR(found.clump.principal.volume, 16e-9, 1e-16);
    EXPECT_GT(found.growth, 0);
    EXPECT_LT(found.symmetricDifference, before);
    before = found.symmetricDifference;
  }
  EXPECT_LT(before, 0.15);
  EXPECT_LT(fit(box, 80).inertiaError, 0.08);
}

TEST(SphereFit, AsManySpheresAsTheErrorNeeds) {
  const TriangleMesh rock = makeBall(3, 0.2);
  SphereFitOptions options;
  options.volumeError = 0.15;
  options.cells = 32;
  const SphereFit found = fitSpheres(rock, options);
  EXPECT_LE(found.empty, 0.15);
  EXPECT_GT(found.spheres.size(), 3u);
  options.mostSpheres = 2;
  EXPECT_THROW(fitSpheres(rock, options), InputError);
  options.volumeError = 0;
  EXPECT_THROW(fitSpheres(rock, options), InputError);
}

TEST(SphereFit, IsTheSameEveryTimeAndAtEveryScale) {
  const TriangleMesh rock = makeBall(3, 0.2);
  TriangleMesh small = rock;
  for (Vec3& v : small.vertices) v *= 0x1p-10;
  const SphereFit first = fit(rock, 12), second = fit(rock, 12), third = fit(small, 12);
  ASSERT_EQ(first.spheres.size(), second.spheres.size());
  ASSERT_EQ(first.spheres.size(), third.spheres.size());
  for (std::size_t k = 0; k < first.spheres.size(); ++k) {
    EXPECT_EQ(first.spheres[k].centre, second.spheres[k].centre);
    EXPECT_LT((third.spheres[k].centre * 0x1p10 - first.spheres[k].centre).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace granular
