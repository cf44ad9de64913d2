// Clumps from a scene file to a bed at rest.
#include <gtest/gtest.h>

#include "granular/analysis/contact_network.h"
#include "granular/mesh/rock.h"
#include "granular/mesh/sphere_fit.h"
#include "granular/run/bed_of_world.h"
#include "granular/shape/clump.h"
#include "run/scene_texts.h"

namespace granular {
namespace {

class ClumpRun : public RunTest {
 protected:
  const std::string dumbbells = R"(
[[particles]]
shape = "clump"
radii = ["1.2 mm", "1.2 mm"]
centres = [["-0.9 mm", "0 mm", "0 mm"], ["0.9 mm", "0 mm", "0 mm"]]
)";
};

TEST_F(ClumpRun, ThreeHundredDumbbellsPourIntoAVesselAndRest) {
  const std::string vessel = "[vessel]\nkind = \"cylinder\"\nradius = \"12 mm\"\n";
  const std::string pour = "[insertion]\nkind = \"batches\"\ncount = 300\nbatch = 60\n";
  PackingRun run(write(vessel + commonText + dumbbells + pour));
  ASSERT_EQ(run.run(makeFolder("bed"), never), RunEnd::rested);
  const World& world = run.world();
  ASSERT_EQ(world.bodies.size(), 300u);
  EXPECT_TRUE(world.report.troubles.empty());
  EXPECT_LT(world.report.deepestOverlap, 0.1);
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Aabb box = world.bodies.shape[i]->bounds(world.bodies.frameOf(i));
    EXPECT_GT(box.lo.z(), -2e-4);
    EXPECT_LT(world.bodies.x(i).head<2>().norm(), 12e-3);
  }
  // Floor and vessel carry the weight of all, and what little the bed still swings.
  const Bodies& bodies = world.bodies;
  double weight = 0, swing = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    weight += 9.81 * bodies.mass[i];
    swing += bodies.mass[i] * bodies.acceleration[i].z();
  }
  EXPECT_NEAR(-world.wallForces[0].z() - world.wallForces[1].z(), weight + swing, 1e-12 * weight);
  EXPECT_LT(std::abs(swing), 0.1 * weight);
  // Spheres touch more often than particles do.
  const ContactNetwork network = analyseContacts(makeBed(world, Vessel{}));
  EXPECT_GT(network.coordination, 4);
  EXPECT_LT(network.coordination, 10);
  EXPECT_GT(network.particleContacts, network.pairs);
}

TEST_F(ClumpRun, LockedParticlesStayInTheirPlane) {
  std::ofstream(folder / "poses.txt") << "0 0 2e-3 1 0 0 0\n1e-3 0 6e-3 .8 0 .6 0\n-1e-3 0 1e-2 .6 0 .8 0\n";
  const std::string poses = "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
  const std::string locks = "lock_translation = \"y\"\nlock_rotation = [\"x\", \"z\"]\n";
  PackingRun run(write(narrowBox + commonText + dumbbells + locks + poses));
  ASSERT_EQ(run.run(makeFolder("plane"), never), RunEnd::rested);
  const Bodies& bodies = run.world().bodies;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(bodies.x(i).y(), 0);
    EXPECT_LT(std::abs(bodies.frameOf(i).R(1, 0)) + std::abs(bodies.frameOf(i).R(1, 2)), 1e-9);
  }
}

TEST_F(ClumpRun, ARockPoursAsSpheresOfItsVolume) {
  const std::string boulder = std::string(GRANULAR_SOURCE_DIR) + "/meshes/boulder.obj";
  const double extent = 4e-3;
  const std::string rocks = "[[particles]]\nshape = \"mesh\"\nunit = \"mm\"\nfiles = [\"" + boulder +
                            "\"]\nuse = \"clump\"\nspheres = 12\nextent = \"4 mm\"\n";
  const std::string pour = "[insertion]\nkind = \"batches\"\ncount = 8\nbatch = 8\n";
  PackingRun run(write(narrowBox + commonText + rocks + pour));
  ASSERT_EQ(run.run(makeFolder("rocks"), never), RunEnd::rested);

  RockOptions options;
  options.longestExtent = extent;
  SphereFitOptions spheres;
  spheres.count = 12;
  const SphereFit fit = fitSpheres(loadRock(boulder, options).mesh, spheres);
  const double toExtent = extent / Clump(fit.spheres).longestExtent();
  for (const Shape* shape : run.world().bodies.shape) {
    const Clump* clump = asClump(*shape);
    ASSERT_NE(clump, nullptr);
    EXPECT_EQ(clump->children().size(), 12u);
    EXPECT_NEAR(clump->longestExtent(), extent, 1e-12);
    EXPECT_NEAR(clump->massProperties().volume / (fit.mesh.principal.volume * std::pow(toExtent, 3)),
                1 + fit.volumeError, 1e-6);
  }
}

}  // namespace
}  // namespace granular
