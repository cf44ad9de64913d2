// Occupancy, arc sampling, filling height and solid fractions on lattices and single particles with known answers.
#include <gtest/gtest.h>

#include "analysis/lattice.h"
#include "granular/analysis/bed_analysis.h"
#include "granular/analysis/reference_profile.h"
#include "granular/core/errors.h"
#include "granular/core/random.h"

namespace granular::test {
namespace {

/// Discs that cut equal spheres of diameter 1 at a step h, in step with their layers: the midpoint rule on pi (1/4 -
/// z^2) is off by h^2/24 times the jump of its slope, 2 pi, per sphere and unit of height.
double boundDiscError(double h) { return 2 * pi * h * h / 24; }

/// Random points on curves: each curve's share is off by a spacing at most, the signs are random.
constexpr double samplingError = 5e-4;

AnalysisOptions useFineSteps() {
  AnalysisOptions options;
  options.unitLength = 1;
  options.ringStep = 0.02;
  options.arcStep = 0.04;
  return options;
}

TEST(Occupancy, AgreesWithASearchOverAllParticles) {
  Random random(7);
  const auto plate = std::make_shared<Cuboid>(Vec3(1.0, 0.6, 0.1));
  OwnedBed owned{plate, {}};
  for (int k = 0; k < 60; ++k)
    owned.add({random.uniform(0, 6), random.uniform(0, 6), random.uniform(0, 6)}, random.rotation().toRotationMatrix());
  const Occupancy occupancy(owned.bed);
  int inside = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 p(random.uniform(-1, 7), random.uniform(-1, 7), random.uniform(-1, 7));
    bool expected = false;
    for (const Frame& frame : owned.bed.frames) expected = expected || plate->contains(frame.toBody(p));
    ASSERT_EQ(occupancy.contains(p), expected);
    inside += expected;
  }
  EXPECT_GT(inside, 500);
}

TEST(Occupancy, PeriodicImagesContinueParticlesAcrossTheBoundary) {
  OwnedBed owned{std::make_shared<Sphere>(0.5), {}};
  owned.add({0.1, 3.9, 2.0});
  owned.bed.vessel = makeBox(Vec3::Constant(4), Vessel::Kind::periodic);
  owned.bed.vessel.periodicHeight = true;
  const Occupancy occupancy(owned.bed);
  Random random(3);
  for (int k = 0; k < 20000; ++k) {
    const Vec3 p(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-6, 6));
    Vec3 d = p - owned.bed.frames[0].x;
    for (int a = 0; a < 3; ++a) d[a] -= 4 * std::round(d[a] / 4);
    ASSERT_EQ(occupancy.contains(p), d.norm() <= 0.5);
  }
}

TEST(Occupancy, ImagesStandOnlyAlongTheAxesThatRepeat) {
  for (const int repeating : {0, 1}) {
    OwnedBed owned{std::make_shared<Sphere>(0.5), {}};
    owned.add({0.1, 0.2, 2.0});
    owned.bed.vessel = makeBox(Vec3::Constant(4), Vessel::Kind::periodic);
    owned.bed.vessel.periodicX = repeating == 0;
    owned.bed.vessel.periodicY = repeating == 1;
    const Occupancy occupancy(owned.bed);
    Random random(4);
    for (int k = 0; k < 20000; ++k) {
      const Vec3 p(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(0, 4));
      Vec3 d = p - owned.bed.frames[0].x;
      d[repeating] -= 4 * std::round(d[repeating] / 4);
      ASSERT_EQ(occupancy.contains(p), d.norm() <= 0.5);
    }
  }
}

TEST(Occupancy, RefusesAnEmptyBed) { EXPECT_THROW(Occupancy(Bed{}), InputError); }

TEST(SolidFraction, SimpleCubicSpheresFillPiOverSix) {
  OwnedBed owned = makeCubicSpheres({4, 4, 4});
  makePeriodic(owned.bed);
  const AnalysisOptions options = useFineSteps();
  const BedAnalysis a = analyseBed(owned.bed, options);
  EXPECT_NEAR(*a.solid.overall, pi / 6, 1e-12);
  EXPECT_NEAR(*a.solid.sampled, pi / 6, boundDiscError(2 * options.ringStep) + samplingError);
}

TEST(SolidFraction, FaceCentredCubicSpheresFillPiOverRootEighteen) {
  OwnedBed owned = makeLattice(std::make_shared<Sphere>(0.5), {3, 3, 3}, std::sqrt(2.0), faceCentred);
  makePeriodic(owned.bed);
  const AnalysisOptions options = useFineSteps();
  const BedAnalysis a = analyseBed(owned.bed, options);
  EXPECT_NEAR(*a.solid.overall, pi / std::sqrt(18.0), 1e-12);
  EXPECT_NEAR(*a.solid.sampled, pi / std::sqrt(18.0), 1.5 * boundDiscError(2 * options.ringStep) + samplingError);
}

TEST(SolidFraction, DoesNotDependOnWhereThePeriodIsCut) {
  OwnedBed owned = makeLattice(std::make_shared<Sphere>(0.5), {3, 3, 3}, std::sqrt(2.0), faceCentred);
  makePeriodic(owned.bed);
  for (Frame& frame : owned.bed.frames) frame.x += Vec3(0.31, -0.77, 5.123);
  const BedAnalysis a = analyseBed(owned.bed, useFineSteps());
  EXPECT_NEAR(*a.solid.sampled, pi / std::sqrt(18.0), 1.5 * boundDiscError(0.04) + samplingError);
}

TEST(SolidFraction, CubesThatFillTheBoxLeaveNoVoid) {
  OwnedBed owned = makeCubes({6, 6, 16});
  AnalysisOptions options;
  options.unitLength = 1;
  const BedAnalysis a = analyseBed(owned.bed, options);
  EXPECT_NEAR(a.filling.equivalent, 16, 1e-9);
  EXPECT_NEAR(a.filling.halfFraction, 16, 2 * options.ringStep * options.unitLength);
  EXPECT_NEAR(*a.solid.overall, 1, 1e-9);
  EXPECT_NEAR(*a.solid.below, 1, 1e-9);
  EXPECT_NEAR(*a.solid.sampled, 1, 1e-9);
  EXPECT_NEAR(*a.solid.nearWall, 1, 1e-9);
}

TEST(FillingHeight, OfAFlatToppedSphereLatticeIsItsTop) {
  // The bulk is 9 - 2 * 2 periods high; the cos^2 weight leaves less than 1/1000 of the layering in its mean fraction.
  OwnedBed owned = makeCubicSpheres({4, 4, 9});
  const BedAnalysis a = analyseBed(owned.bed, useFineSteps());
  EXPECT_NEAR(a.filling.equivalent, 9, 0.01);
  EXPECT_NEAR(a.filling.highestPoint, 9, 1e-12);
  EXPECT_NEAR(*a.solid.overall, pi / 6, 0.01 / 9 * pi / 6 + 1e-12);
}

TEST(FillingHeight, OfATopWithHalfALayerIsHalfALayerHigher) {
  OwnedBed owned = makeCubes({4, 4, 12});
  for (int k = 0; k < 8; ++k) owned.add({0.5 + k % 4, k < 4 ? 0.5 : 2.5, 12.5});
  owned.bed.vessel.hi.z() = 20;
  AnalysisOptions options = useFineSteps();
  const BedAnalysis a = analyseBed(owned.bed, options);
  // Within the arc sampling of the half layer: its edges are straight lines along which the rectangles run.
  EXPECT_NEAR(a.filling.equivalent, 12.5, 0.01);
  EXPECT_NEAR(*a.solid.overall, 1, 0.001);
}

TEST(FillingHeight, StartsAtTheFloorWhereverThatIs) {
  OwnedBed owned = makeCubes({4, 4, 10});
  for (Frame& frame : owned.bed.frames) frame.x.z() -= 3.25;
  owned.bed.vessel.floor = -3.25;
  AnalysisOptions options;
  options.unitLength = 1;
  EXPECT_NEAR(analyseBed(owned.bed, options).filling.equivalent, 10, 1e-9);
}

TEST(SolidFraction, AParticleCutByTheHeightCountsByItsPart) {
  OwnedBed owned{std::make_shared<Sphere>(1.0), {}};
  owned.add({0, 0, 1});
  // A cap of height h holds pi h^2 (3 - h) / 3.
  for (const double h : {0.3, 0.5, 1.0, 1.6})
    EXPECT_NEAR(measureVolumeBelow(owned.bed, h), pi * h * h * (3 - h) / 3, 0.01);
  EXPECT_EQ(measureVolumeBelow(owned.bed, 2.5), owned.shape->massProperties().volume);
  EXPECT_EQ(measureVolumeBelow(owned.bed, -0.5), 0);
}

TEST(RadialPorosity, OfACentredSphereIsItsChord) {
  OwnedBed owned{std::make_shared<Sphere>(1.0), {}};
  owned.add({0.2, -0.1, 1});
  Vessel& vessel = owned.bed.vessel;
  vessel.kind = Vessel::Kind::cylinder;
  vessel.axis = {0.2, -0.1};
  vessel.radius = 1.5;
  const Occupancy occupancy(owned.bed);
  const CrossSection section(vessel, occupancy.bounds());
  const RingGrid grid{0, 2, 0.01, 0.05, 0.05};
  const RingSamples samples = sampleRings(occupancy, section, grid, ArcRule::spacing);
  for (std::size_t k = 0; k < samples.rings; ++k) {
    const double r = 1.5 - samples.distance(k);
    const double expected = r < 1 ? std::sqrt(1 - r * r) : 0;
    EXPECT_NEAR(samples.meanOfRing(k, 0, 2), expected, 0.5 * grid.discStep + 1e-12) << "at radius " << r;
  }
}

TEST(RadialPorosity, ArcsOfAnEccentricSphereAreExact) {
  // Through the centre of a sphere of radius b at distance c from the axis, the circle of radius r lies inside it over
  // the angle 2 acos((r^2 + c^2 - b^2) / (2 r c)).
  OwnedBed owned{std::make_shared<Sphere>(0.5), {}};
  owned.add({1, 0, 0.5});
  Vessel& vessel = owned.bed.vessel;
  vessel.kind = Vessel::Kind::cylinder;
  vessel.radius = 2;
  const Occupancy occupancy(owned.bed);
  const CrossSection section(vessel, occupancy.bounds());
  const RingGrid grid{0, 1, 1, 0.1, 0.05};
  const RingSamples spaced = sampleRings(occupancy, section, grid, ArcRule::spacing);
  const RingSamples paper = sampleRings(occupancy, section, grid, ArcRule::paper);
  const RingSamples refined = sampleRings(occupancy, section, grid, ArcRule::refined);
  for (std::size_t k = 0; k < spaced.rings; ++k) {
    const double r = 2 - spaced.distance(k);
    const double cosine = (r * r + 1 - 0.25) / (2 * r);
    const double expected = cosine < 1 ? std::acos(cosine) / pi : 0;
    const double spacing = 1 / std::max(8.0, std::ceil(2 * pi * r / grid.arcStep));
    EXPECT_NEAR(spaced.at(0, k), expected, spacing);
    EXPECT_NEAR(refined.at(0, k), expected, 2 * spacing / 1024);
    // The paper's segments lose the part of a spacing at either end of the arc.
    EXPECT_LE(paper.at(0, k), expected + 1e-12);
    EXPECT_GE(paper.at(0, k), expected - 2 * spacing);
  }
}

TEST(RadialPorosity, StacksOfCubesAreSquaresInEveryDisc) {
  // A square of half side b: a circle of radius r in (b, b sqrt 2) leaves it over 8 acos(b / r).
  OwnedBed owned{std::make_shared<Cuboid>(Vec3::Constant(1.0)), {}};
  for (int k = 0; k < 10; ++k) owned.add({0, 0, 2.0 * k + 1});
  Vessel& vessel = owned.bed.vessel;
  vessel.kind = Vessel::Kind::cylinder;
  vessel.radius = 1.6;
  AnalysisOptions options = useFineSteps();
  const BedAnalysis a = analyseBed(owned.bed, options);
  // Every disc is sampled at other phases: the mean over some hundreds of them is good to a few thousandths of a
  // spacing.
  EXPECT_NEAR(a.filling.equivalent, 20, 1e-3);
  EXPECT_EQ(*findQuantity(a, "vessel_radius_m"), 1.6);
  EXPECT_FALSE(findQuantity(a, "vessel_lo_x_m").has_value());
  const Table* table = findTable(a, "radial_porosity");
  ASSERT_NE(table, nullptr);
  for (const std::vector<double>& row : table->rows) {
    const double r = 1.6 - row[0];
    const double outside = r <= 1 ? 0 : std::min(1.0, 8 * std::acos(1 / r) / (2 * pi));
    EXPECT_NEAR(row[2], outside, 0.002) << "at radius " << r;
  }
  EXPECT_NEAR(*a.solid.overall, 4 / (pi * 1.6 * 1.6), 1e-4);
}

TEST(Regions, ALowBedHasNoCoreAndSaysSo) {
  OwnedBed owned = makeCubicSpheres({6, 6, 5});
  const BedAnalysis a = analyseBed(owned.bed);
  EXPECT_FALSE(a.solid.core.has_value());
  EXPECT_TRUE(a.solid.nearWall.has_value());
  ASSERT_FALSE(a.notes.empty());
  EXPECT_NE(a.notes[0].find("less than 8"), std::string::npos);
}

TEST(Regions, ANarrowVesselHasNoCoreAndSaysSo) {
  OwnedBed owned = makeCubicSpheres({4, 4, 10});
  const BedAnalysis a = analyseBed(owned.bed);
  EXPECT_FALSE(a.solid.core.has_value());
  ASSERT_FALSE(a.notes.empty());
  EXPECT_NE(a.notes[0].find("no core"), std::string::npos);
}

TEST(Regions, TheCoreOfALatticeHasItsFraction) {
  OwnedBed owned = makeCubicSpheres({8, 8, 12});
  const BedAnalysis a = analyseBed(owned.bed, useFineSteps());
  ASSERT_TRUE(a.solid.core.has_value());
  // The filling height moves the ends of the region by up to .01 off the planes between layers.
  EXPECT_NEAR(*a.solid.core, pi / 6, boundDiscError(0.04) + samplingError + 1e-3);
  EXPECT_NEAR(*a.solid.nearWall, pi / 6, boundDiscError(0.04) + samplingError + 1e-3);
}

TEST(VoxelField, HoldsTheVolumeOfItsParticles) {
  OwnedBed owned = makeCubes({3, 2, 4});
  AnalysisOptions options;
  options.unitLength = 1;
  options.voxel = 0.5;
  const VoxelField field = analyseBed(owned.bed, options).voxels;
  EXPECT_EQ(field.count, (std::array<int, 3>{6, 4, 8}));
  for (std::size_t k = 0; k < field.solid.size(); ++k) {
    EXPECT_EQ(field.solid[k], 1);
    EXPECT_EQ(field.vessel[k], 1);
  }
}

TEST(VoxelField, KnowsWhichPartOfAVoxelIsVessel) {
  OwnedBed owned{std::make_shared<Sphere>(0.5), {}};
  owned.add({0, 0, 0.5});
  owned.bed.vessel.kind = Vessel::Kind::cylinder;
  owned.bed.vessel.radius = 1;
  const VoxelField field = measureVoxels(owned.bed, Occupancy(owned.bed), 0.05, 3);
  double solid = 0, vessel = 0;
  for (std::size_t k = 0; k < field.solid.size(); ++k) {
    solid += field.solid[k] * std::pow(0.05, 3);
    vessel += field.vessel[k] * std::pow(0.05, 3);
  }
  EXPECT_NEAR(solid, pi / 6, 0.002);
  EXPECT_NEAR(vessel, pi, 0.01);
}

TEST(ReferenceProfile, DeKlerkHasItsPublishedExtrema) {
  EXPECT_NEAR(evaluateDeKlerk(0), 1, 1e-12);
  EXPECT_NEAR(evaluateDeKlerk(0.59), 0.252, 1e-3);
  EXPECT_NEAR(evaluateDeKlerk(1.0), 0.587, 5e-3);
  EXPECT_NEAR(evaluateDeKlerk(1.4), 0.301, 5e-3);
  EXPECT_NEAR(evaluateDeKlerk(30), 0.37, 1e-6);
  EXPECT_NEAR(evaluateMeanPorosity(10), 0.404, 5e-4);
}

}  // namespace
}  // namespace granular::test
