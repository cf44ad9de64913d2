// Small piles, from settings to numbers.
#include "granular/run/pile.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "granular/core/errors.h"
#include "granular/io/scene_file.h"
#include "run/demo_outcome.h"
#include "run/resume_fixture.h"

namespace granular {
namespace {

class Pile : public RunTest {
 protected:
  /// Soft grains, long steps, dropped fast from a little above: a heap in seconds.
  static PileSettings makeQuick() {
    PileSettings s;
    s.count = 30;
    s.young = 4e6;
    s.damping = 2000;
    s.height = 0.05;
    s.interval = 0.025;
    s.rest = 0.05;
    s.friction = 0.6;
    s.sleep = 0;
    return s;
  }

  SceneSource writeScene(const PileSettings& settings, const std::string& name) {
    const auto out = makeFolder(name);
    if (settings.space) writeHopper(settings, out);
    std::ofstream(out / "pile.toml") << formatPileScene(settings) << "picture = false\n";
    return SceneSource::read(out / "pile.toml", {"output.picture=false"});
  }
};

TEST_F(Pile, SceneSaysWhatThePaperSays) {
  const Scene scene = parseScene(formatPileScene({}), folder / "pile.toml", {});
  EXPECT_EQ(scene.model.law, "hertz");
  EXPECT_EQ(scene.insertion.kind, InsertionSettings::Kind::drop);
  EXPECT_DOUBLE_EQ(scene.insertion.rate, 25);
  EXPECT_DOUBLE_EQ(scene.insertion.from.x(), 2.70001e-3);
  EXPECT_NEAR(scene.insertion.to.x() - scene.insertion.from.x(), 1e-4, 1e-12);
  EXPECT_EQ(scene.insertion.turn, InsertionSettings::Turn::y);
  // Table 1: mass and moments of inertia.
  PackingRun run(writeScene({}, "paper"));
  const auto shape = run.inserter().makeShape(0);
  const double density = scene.materials[0].density;
  EXPECT_NEAR(density * shape->massProperties().volume, 2e-5, 1e-12);
  EXPECT_NEAR(density * shape->massProperties().inertia.maxCoeff(), 3.445e-11, 5e-15);
  EXPECT_NEAR(density * shape->massProperties().inertia.minCoeff(), 1.058e-11, 5e-15);
  // A clump keeps them.
  PileSettings settings;
  settings.shape = PileSettings::Shape::clump;
  settings.spheres = 3;
  PackingRun clumps(writeScene(settings, "clumps"));
  const auto clump = clumps.inserter().makeShape(0);
  EXPECT_NEAR(density * clump->massProperties().inertia.maxCoeff(), 3.445e-11, 5e-15);
}

TEST_F(Pile, SettingsOutOfRangeAreRefusedByName) {
  const auto refusal = [](auto change) {
    PileSettings s;
    change(s);
    try {
      formatPileScene(s);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal([](PileSettings&) {}), "");
  EXPECT_NE(refusal([](PileSettings& s) { s.count = 0; }).find("count = 0"), std::string::npos);
  EXPECT_NE(refusal([](PileSettings& s) { s.height = 1e-3; }).find("height"), std::string::npos);
  EXPECT_NE(refusal([](PileSettings& s) { s.sleep = -1; }).find("sleep"), std::string::npos);
  EXPECT_NE(refusal([](PileSettings& s) {
              s.space = true;
              s.orifice = 4e-3;
            }).find("orifice"),
            std::string::npos);
  const auto even = [](PileSettings& s) {
    s.shape = PileSettings::Shape::clump;
    s.spheres = 4;
  };
  EXPECT_NE(refusal(even).find("odd"), std::string::npos) << refusal(even);
}

TEST_F(Pile, OfEllipsoidsAndOfClumpsIsMeasured) {
  for (const bool clump : {false, true}) {
    PileSettings settings = makeQuick();
    if (clump) {
      settings.shape = PileSettings::Shape::clump;
      settings.spheres = 5;
    }
    const std::string name = clump ? "clump" : "ellipsoid";
    PackingRun run(writeScene(settings, name));
    const RunEnd end = run.run(folder / name, never);
    ASSERT_NE(end, RunEnd::trouble);
    const World& world = run.world();
    ASSERT_EQ(world.bodies.size(), 30u);
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      EXPECT_EQ(world.bodies.x(i).y(), 0);
      EXPECT_GT(world.bodies.x(i).x(), 0);
    }
    const PileResult result = writePileReport(run, end, 1, folder / name);
    ASSERT_TRUE(result.angle && result.porosity && result.porositySmooth);
    // Thirty grains come to rest anywhere between -6 and 30 degrees (seeds 1 to 10), and round-off decides where.
    EXPECT_LT(std::abs(*result.angle), 60);
    EXPECT_GT(*result.porosity, 0);
    EXPECT_LT(*result.porosity, .5);
    EXPECT_GE(result.coordinationSpheres, result.coordinationParticles * (1 - 1e-12));
    EXPECT_GT(result.potentialContacts, result.coordinationParticles);

    std::ifstream file(folder / name / "result.json");
    const auto json = nlohmann::json::parse(file);
    for (const char* key :
         {"repose_angle_deg", "triangle_angle_deg", "base_angle_deg", "porosity", "porosity_smooth",
          "coordination_particles", "coordination_spheres", "potential_contacts_per_particle", "wall_s"})
      EXPECT_TRUE(json.at(key).is_number()) << key;
    // The sections of five spheres leave out 8.5 % of the ellipse's area.
    const double area = clump ? 0.9148 : 1;
    EXPECT_NEAR((1 - *result.porosity) / (1 - *result.porositySmooth), area, 1e-3);
    // The triangle's area is half of height times base, the pile's that of the sections without the voids.
    const double standing = 30 - json.at("counters").at("particles_in_flight").get<double>();
    const double section = pi * settings.halfLength * settings.halfWidth;
    const double pileArea = standing * section / (1 - *result.porositySmooth);
    const double base = *result.height / std::tan(*result.triangleAngle * pi / 180);
    EXPECT_NEAR(0.5 * *result.height * base, pileArea, 1e-9 * pileArea);
    EXPECT_TRUE(std::filesystem::exists(folder / name / "pile.json"));
    EXPECT_TRUE(std::filesystem::exists(folder / name / "surface.csv"));
  }
}

TEST_F(Pile, GoesOnFromItsCheckpointToTheSameBits) {
  PileSettings ellipsoids = makeQuick();
  ellipsoids.count = 12;
  PileSettings sleepers = ellipsoids, clumps = ellipsoids, space = ellipsoids;
  sleepers.sleep = 1e-2;
  clumps.shape = PileSettings::Shape::clump;
  clumps.spheres = 5;
  space.space = true;
  space.interval = 0.01;
  for (const PileSettings& settings : {ellipsoids, sleepers, clumps, space}) {
    SCOPED_TRACE(formatPileScene(settings));
    PackingRun whole(writeScene(settings, "whole"));
    whole.run(folder / "whole", never);
    SceneSource source = writeScene(settings, "parts");
    source.overrides.push_back("time.max_time=0.15");
    PackingRun first(source);
    ASSERT_EQ(first.run(folder / "parts", never), RunEnd::outOfTime);
    omp_set_num_threads(2);
    PackingRun second = PackingRun::resumed(folder / "parts", {"time.max_time=inf"});
    second.run(folder / "parts", never);
    omp_set_num_threads(1);
    expectSameState(whole, second);
  }
}

TEST_F(Pile, InSpaceRunsThroughTheHopper) {
  PileSettings settings = makeQuick();
  settings.space = true;
  settings.count = 20;
  settings.interval = 0.01;
  settings.rest = 0.3;
  PackingRun run(writeScene(settings, "cone"));
  ASSERT_NE(run.run(folder / "cone", never), RunEnd::trouble);
  // All fell through, none through the hopper's sides.
  for (const BoundingSphere& sphere : run.world().bodies.bounds) EXPECT_LT(sphere.x.z(), settings.outlet);
  const PileResult result = writePileReport(run, RunEnd::rested, 1, folder / "cone");
  EXPECT_FALSE(result.porosity);
  EXPECT_GT(result.height.value_or(0), 0);
}

TEST_F(Pile, OfAnySceneIsMeasuredByTheDemo) {
  if (!std::filesystem::exists(GRANULAR_PILE)) GTEST_SKIP() << GRANULAR_PILE << " is not built";
  const auto scene = folder / "rocks.toml";
  std::ofstream(scene) << commonText << R"(
[vessel]
kind = "none"
[[wall]]
kind = "plane"
name = "floor"
normal = [0, 0, 1]
[[particles]]
shape = "mesh"
unit = "m"
files = [")" << GRANULAR_SOURCE_DIR
                       << R"(/meshes/boulder.obj"]
use = "clump"
spheres = 5
count = 12
[particles.size]
as = "diameter"
value = 0.005
[insertion]
kind = "drop"
rate = 400
from = [-0.002, -0.002, 0.01]
to = [0.002, 0.002, 0.03]
)";
  const std::string out = (folder / "heap").string();
  const std::string words = "--scene " + scene.string() + " --no-picture --out " + out;
  const DemoOutcome done = runDemo(GRANULAR_PILE, words + " --set time.max_time=0.1");
  EXPECT_EQ(done.code, 0) << done.text;
  std::ifstream file(out + "/result.json");
  const auto result = nlohmann::json::parse(file);
  EXPECT_TRUE(result.contains("repose_angle_deg"));
  EXPECT_GT(result.at("pile_height_m").get<double>(), 0);
  EXPECT_EQ(result.at("particles"), 12);

  const DemoOutcome both = runDemo(GRANULAR_PILE, words + " --count 5");
  EXPECT_EQ(both.code, 1);
  EXPECT_NE(both.text.find("--count: not beside --scene"), std::string::npos) << both.text;
}

}  // namespace
}  // namespace granular
