#include "granular/insert/pose_check.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

std::string refusal(std::span<const PlacedShape> particles, std::span<const std::int64_t> ids, const Periods& periods,
                    std::span<const Wall* const> walls, double allowed) {
  try {
    checkPoses(particles, ids, periods, walls, allowed);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PoseCheck, OverlappingPosesAreNamedWithTheirDepth) {
  const Sphere sphere(1e-3);
  const std::vector<PlacedShape> particles = {{&sphere, Frame(Pose{{0, 0, 1e-3}, Quat::Identity()})},
                                              {&sphere, Frame(Pose{{5e-3, 0, 1e-3}, Quat::Identity()})},
                                              {&sphere, Frame(Pose{{1.75e-3, 0, 1e-3}, Quat::Identity()})}};
  const std::vector<std::int64_t> ids = {12, 13, 7};
  const std::vector<PoseOverlap> deep = findOverlaps(particles, ids, Periods{}, 0);
  ASSERT_EQ(deep.size(), 1u);
  EXPECT_EQ(deep[0].a, 7);
  EXPECT_EQ(deep[0].b, 12);
  EXPECT_NEAR(deep[0].overlap, 0.25e-3, 1e-12);
  EXPECT_NEAR(deep[0].fraction, 0.25, 1e-9);

  const std::string message = refusal(particles, ids, Periods{}, {}, 0.01);
  EXPECT_NE(message.find("7 and 12 by 0.00025 m"), std::string::npos) << message;
  EXPECT_EQ(refusal(particles, ids, Periods{}, {}, 0.3), "");
}

TEST(PoseCheck, DeepestOverlapComesFirst) {
  const Cuboid cube(Vec3::Constant(1));
  std::vector<PlacedShape> particles;
  std::vector<std::int64_t> ids;
  double z = 1;
  for (int k = 0; k < 30; ++k) {
    particles.push_back({&cube, Frame(Pose{{0, 0, z}, Quat::Identity()})});
    ids.push_back(k);
    z += 2 - 0.01 * (k + 1);
  }
  const std::vector<PoseOverlap> deep = findOverlaps(particles, ids, Periods{}, 1e-6);
  ASSERT_EQ(deep.size(), 29u);
  for (int k = 0; k < 29; ++k) EXPECT_NEAR(deep[static_cast<std::size_t>(k)].overlap, 0.01 * (29 - k), 1e-9);
  const std::string message = refusal(particles, ids, Periods{}, {}, 1e-6);
  EXPECT_NE(message.find("29 pairs"), std::string::npos) << message;
  EXPECT_NE(message.find("..."), std::string::npos) << message;
}

TEST(PoseCheck, TouchingCubesAreAllowed) {
  const Cuboid cube(Vec3::Constant(1));
  const std::vector<PlacedShape> particles = {{&cube, Frame(Pose{{0, 0, 1}, Quat::Identity()})},
                                              {&cube, Frame(Pose{{0, 0, 3}, Quat::Identity()})}};
  const std::vector<std::int64_t> ids = {0, 1};
  const auto floor = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  const std::vector<const Wall*> walls = {floor.get()};
  EXPECT_EQ(refusal(particles, ids, Periods{}, walls, 1e-9), "");
}

TEST(PoseCheck, OverlapsAcrossPeriodicSidesAreFoundOnceEach) {
  const Sphere sphere(1);
  Periods periods;
  periods.length = {20, 20, 20};
  periods.origin = Vec3::Constant(-10);
  // Across a side, an edge, a corner; and one position given a period away.
  const std::vector<Vec3> positions = {{9.5, 0, 0}, {-9.5, 0, 0},     {9.5, 9.6, 5}, {-9.4, -9.7, 5},
                                       {9, 9, 9},   {-10, -10, -9.9}, {0, 0, 0},     {20.5, 20.5, -20}};
  std::vector<PlacedShape> particles;
  std::vector<std::int64_t> ids;
  for (const Vec3& p : positions) {
    particles.push_back({&sphere, Frame(Pose{p, Quat::Identity()})});
    ids.push_back(std::int64_t(ids.size()));
  }
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  for (const PoseOverlap& each : findOverlaps(particles, ids, periods, 0)) pairs.emplace_back(each.a, each.b);
  std::sort(pairs.begin(), pairs.end());
  const std::vector<std::pair<std::int64_t, std::int64_t>> expected = {{0, 1}, {2, 3}, {4, 5}, {6, 7}};
  EXPECT_EQ(pairs, expected);
}

TEST(PoseCheck, ParticleInAWallIsNamed) {
  const Sphere sphere(1e-3);
  auto floor = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  floor->name = "floor";
  const std::vector<const Wall*> walls = {floor.get()};
  const std::vector<std::int64_t> ids = {41};
  std::vector<PlacedShape> particles = {{&sphere, Frame(Pose{{0, 0, 0.5e-3}, Quat::Identity()})}};
  const std::string touching = refusal(particles, ids, Periods{}, walls, 0.01);
  EXPECT_NE(touching.find("particle 41"), std::string::npos) << touching;
  EXPECT_NE(touching.find("floor by 0.0005 m"), std::string::npos) << touching;
  particles[0].frame.x.z() = -0.5;
  EXPECT_NE(refusal(particles, ids, Periods{}, walls, 0.01).find("behind the wall floor"), std::string::npos);
}

TEST(PoseCheck, ParticleAboveTheRimIsNamed) {
  const Sphere sphere(1e-3);
  const std::vector<std::int64_t> ids = {41};
  const std::vector<PlacedShape> particles = {{&sphere, Frame(Pose{{0, 0, 5e-3}, Quat::Identity()})}};
  EXPECT_NO_THROW(checkBelow(6e-3, particles, ids, 0.01));
  EXPECT_NO_THROW(checkBelow(infinity, particles, ids, 0.01));
  try {
    checkBelow(5.5e-3, particles, ids, 0.01);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const char* part : {"particle 41", "0.006 m", "rim at 0.0055 m"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace granular
