// Coordination, fabric, forces and pair distribution of lattices and of random points.
#include <gtest/gtest.h>
#include <omp.h>

#include "analysis/lattice.h"
#include "granular/analysis/bed_analysis.h"
#include "granular/core/errors.h"
#include "granular/core/random.h"

namespace granular::test {
namespace {

BedContact makeContact(int a, int b, const Vec3& force = Vec3::Zero()) {
  BedContact contact;
  contact.a = a;
  contact.b = b;
  contact.force = force;
  return contact;
}

OwnedBed makeRow(int count) {
  OwnedBed owned{std::make_shared<Sphere>(0.5), {}};
  for (int k = 0; k < count; ++k) owned.add({0.0, 0.0, 0.5 + k});
  return owned;
}

TEST(Coordination, OfASimpleCubicLatticeIsSixAndItsFabricIsotropic) {
  OwnedBed owned = makeCubicSpheres({3, 3, 3});
  makePeriodic(owned.bed);
  touchNeighbours(owned.bed, 1 + 1e-9);
  const ContactNetwork network = analyseContacts(owned.bed);
  EXPECT_EQ(network.coordination, 6);
  EXPECT_EQ(*network.coordinationHeld, 6);
  EXPECT_EQ(network.rattlers, 0u);
  EXPECT_NEAR((network.fabric - Mat3::Identity() / 3).norm(), 0, 1e-12);
  EXPECT_NEAR(*network.meanNormalForce, 1, 1e-12);
  EXPECT_NEAR(network.largestRelativeOverlap, 1e-3 / 0.5, 1e-12);
}

TEST(Coordination, OfAFaceCentredLatticeIsTwelveAndItsFabricIsotropic) {
  OwnedBed owned = makeLattice(std::make_shared<Sphere>(0.5), {2, 2, 2}, std::sqrt(2.0), faceCentred);
  makePeriodic(owned.bed);
  touchNeighbours(owned.bed, 1 + 1e-9);
  const ContactNetwork network = analyseContacts(owned.bed);
  EXPECT_EQ(network.coordination, 12);
  EXPECT_NEAR((network.fabric - Mat3::Identity() / 3).norm(), 0, 1e-12);
}

TEST(Coordination, APairWithSeveralContactsIsOneNeighbour) {
  OwnedBed owned = makeRow(2);
  owned.bed.contacts = {makeContact(0, 1), makeContact(1, 0), makeContact(0, 1), makeContact(0, -1),
                        makeContact(0, -1)};
  const ContactNetwork network = analyseContacts(owned.bed);
  EXPECT_EQ(network.pairs, 1u);
  EXPECT_EQ(network.particleContacts, 3u);
  EXPECT_EQ(network.coordination, 1);
  EXPECT_EQ(network.wallContactCount, 2u);
  EXPECT_EQ(network.particlesAtWalls, 1u);
}

TEST(Coordination, RattlersAreTakenAwayUntilNoneIsLeft) {
  // 0-1-2 form a ring; 3 hangs on 2, 4 hangs on 3: taking 4 away makes a rattler of 3. 5 touches nothing.
  OwnedBed owned = makeRow(6);
  owned.bed.contacts = {makeContact(0, 1), makeContact(1, 2), makeContact(2, 0), makeContact(2, 3), makeContact(3, 4)};
  const ContactNetwork network = analyseContacts(owned.bed);
  EXPECT_EQ(network.rattler, (std::vector<std::uint8_t>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(network.rattlers, 3u);
  EXPECT_NEAR(network.coordination, 10.0 / 6, 1e-12);
  EXPECT_EQ(*network.coordinationHeld, 2);
}

TEST(Coordination, HistogramCountsEveryParticle) {
  OwnedBed owned = makeRow(4);
  owned.bed.contacts = {makeContact(0, 1), makeContact(1, 2), makeContact(2, 3), makeContact(0, -1)};
  const Table table = tabulateCoordination(analyseContacts(owned.bed));
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[1], (std::vector<double>{1, 2, 0.5, 1, 1.0 / 3}));
  EXPECT_EQ(table.rows[2], (std::vector<double>{2, 2, 0.5, 2, 2.0 / 3}));
}

TEST(Coordination, RefusesAContactWithAParticleThatIsNotThere) {
  OwnedBed owned = makeRow(2);
  owned.bed.contacts = {makeContact(0, 2)};
  EXPECT_THROW(analyseContacts(owned.bed), InputError);
}

TEST(ContactForces, DensityIntegratesToOneAndHasMeanOne) {
  OwnedBed owned = makeRow(2);
  Random random(5);
  for (int k = 0; k < 20000; ++k) owned.bed.contacts.push_back(makeContact(0, 1, Vec3(0.3, 0, -3 * random.uniform())));
  const Table table = tabulateForces(owned.bed, 0.1);
  double sum = 0, mean = 0;
  for (const std::vector<double>& row : table.rows) {
    sum += row[1] * 0.1;
    mean += row[1] * 0.1 * row[0];
  }
  EXPECT_NEAR(sum, 1, 1e-9);
  // Bins stand for their middles; a uniform force keeps its mean.
  EXPECT_NEAR(mean, 1, 2e-3);
  EXPECT_NEAR(table.rows[5][1], 0.5, 0.05);
}

TEST(PairDistribution, OfACubicLatticeCountsItsShells) {
  OwnedBed owned = makeCubicSpheres({6, 6, 6});
  makePeriodic(owned.bed);
  const Table table = measurePairDistribution(owned.bed, 6, 1, 2.9, 0.05).table;
  const auto neighboursWithin = [&](double r) {
    return table.rows[static_cast<std::size_t>(std::lround(r / 0.05)) - 1][3];
  };
  EXPECT_NEAR(neighboursWithin(0.95), 0, 1e-12);
  EXPECT_NEAR(neighboursWithin(1.05), 6, 1e-9);
  EXPECT_NEAR(neighboursWithin(1.45), 6 + 12, 1e-9);
  EXPECT_NEAR(neighboursWithin(1.75), 6 + 12 + 8, 1e-9);
  EXPECT_NEAR(neighboursWithin(2.05), 6 + 12 + 8 + 6, 1e-9);
}

/// Independent uniform points: g must be one in every bin within five standard errors of the pairs counted.
void expectNoStructure(const Bed& bed, double filling) {
  const PairDistribution result = measurePairDistribution(bed, filling, 1, 2, 0.1);
  ASSERT_EQ(result.table.rows.size(), 20u);
  for (const std::vector<double>& row : result.table.rows) {
    const double shell = 4 * pi * row[0] * row[0] * 0.1;
    const double pairs = 0.5 * static_cast<double>(result.centres) * result.density * shell;
    // Up to half of the shells lies outside, which halves the pairs; 256 rays leave half a percent.
    EXPECT_NEAR(row[2], 1, 5 * std::sqrt(2 / pairs) + 0.005) << "at r = " << row[0];
  }
}

TEST(PairDistribution, OfIndependentPointsIsOneInACylinder) {
  OwnedBed owned{std::make_shared<Sphere>(0.01), {}};
  owned.bed.vessel.kind = Vessel::Kind::cylinder;
  owned.bed.vessel.radius = 2.01;
  Random random(17);
  for (int k = 0; k < 4000; ++k) {
    const double r = 2 * std::sqrt(random.uniform()), azimuth = random.uniform(0, 2 * pi);
    owned.add({r * std::cos(azimuth), r * std::sin(azimuth), 0.01 + 3 * random.uniform()});
  }
  expectNoStructure(owned.bed, 3.02);
}

TEST(PairDistribution, OfIndependentPointsIsOneInABox) {
  OwnedBed owned{std::make_shared<Sphere>(0.01), {}};
  owned.bed.vessel = makeBox(Vec3(2.02, 3.02, 9));
  Random random(18);
  for (int k = 0; k < 4000; ++k)
    owned.add({0.01 + 2 * random.uniform(), 0.01 + 3 * random.uniform(), 0.01 + 4 * random.uniform()});
  expectNoStructure(owned.bed, 4.02);
}

TEST(PairDistribution, OfIndependentPointsIsOneBetweenWallsAlongOneAxis) {
  OwnedBed owned{std::make_shared<Sphere>(0.01), {}};
  owned.bed.vessel = makeBox(Vec3(6, 1.02, 9), Vessel::Kind::periodic);
  owned.bed.vessel.periodicY = false;
  Random random(19);
  for (int k = 0; k < 4000; ++k)
    owned.add({6 * random.uniform(), 0.01 + random.uniform(), 0.01 + 4 * random.uniform()});
  expectNoStructure(owned.bed, 4.02);
}

TEST(BedAnalysis, GivesTheSameBitsForAnyNumberOfThreads) {
  Random random(23);
  OwnedBed owned{std::make_shared<Cuboid>(Vec3(0.3, 0.2, 0.5)), {}};
  owned.bed.vessel.kind = Vessel::Kind::cylinder;
  owned.bed.vessel.radius = 3;
  for (int k = 0; k < 300; ++k) {
    const double r = 2.5 * std::sqrt(random.uniform()), azimuth = random.uniform(0, 2 * pi);
    owned.add({r * std::cos(azimuth), r * std::sin(azimuth), random.uniform(0.5, 9)},
              random.rotation().toRotationMatrix());
  }
  AnalysisOptions options;
  options.voxel = 0.5;
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const BedAnalysis one = analyseBed(owned.bed, options);
  for (const int threads : {2, 4}) {
    omp_set_num_threads(threads);
    const BedAnalysis many = analyseBed(owned.bed, options);
    ASSERT_EQ(many.quantities.size(), one.quantities.size());
    for (std::size_t k = 0; k < one.quantities.size(); ++k)
      EXPECT_EQ(many.quantities[k].value, one.quantities[k].value) << one.quantities[k].name;
    for (const char* name : {"radial_porosity", "axial_porosity", "pair_distribution"})
      EXPECT_EQ(findTable(many, name)->rows, findTable(one, name)->rows) << name;
    EXPECT_EQ(many.voxels.solid, one.voxels.solid);
  }
  omp_set_num_threads(before);
}

TEST(BedAnalysis, EveryTableIsRectangularAndDefined) {
  OwnedBed owned = makeCubicSpheres({3, 3, 9});
  touchNeighbours(owned.bed, 1 + 1e-9);
  for (const Table& table : analyseBed(owned.bed).tables) {
    EXPECT_FALSE(table.definition.empty()) << table.name;
    EXPECT_FALSE(table.rows.empty()) << table.name;
    for (const std::vector<double>& row : table.rows) EXPECT_EQ(row.size(), table.columns.size()) << table.name;
  }
}

TEST(BedAnalysis, RefusesOptionsWithoutMeaning) {
  OwnedBed owned = makeCubicSpheres({2, 2, 2});
  AnalysisOptions options;
  options.ringStep = 0;
  EXPECT_THROW(analyseBed(owned.bed, options), InputError);
}

}  // namespace
}  // namespace granular::test
