// What can't be run is refused before the first step, with a message that says what, where and how much.
#include <gtest/gtest.h>

#include "granular/io/output_file.h"
#include "run/scene_texts.h"

namespace granular {
namespace {

class BadInput : public RunTest {
 protected:
  const std::string pour = "[insertion]\nkind = \"batches\"\ncount = 5\n";
  const std::string good = narrowBox + commonText + spheres + pour;

  std::string meshScene(const std::string& file, const std::string& use = "hull") const {
    return narrowBox + commonText + "[[particles]]\nshape = \"mesh\"\nname = \"stones\"\nfiles = [\"" + file +
           "\"]\nunit = \"mm\"\nuse = \"" + use + "\"\n" + pour;
  }
  std::string poseScene(const std::string& poses) const {
    std::ofstream(folder / "poses.txt") << poses;
    return narrowBox + commonText + spheres + "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
  }
  void writeFile(const std::string& name, const std::string& content) const { std::ofstream(folder / name) << content; }
};

TEST_F(BadInput, TheSceneTheOthersVaryIsGood) { EXPECT_EQ(complaintOf(good), ""); }

TEST_F(BadInput, AnUnknownKeyIsNamedWithItsPlace) {
  expectMentions(complaintOf(good + "[settle]\nkind = \"none\"\nfreze = 1\n"), {"scene.toml:", "settle.freze"});
}

TEST_F(BadInput, AWrongUnitIsNamedWithTheOneExpected) {
  expectMentions(complaintOf(good, {"particles.0.radius=\"3 kg\""}), {"particles.0.radius", "kg"});
}

TEST_F(BadInput, ANegativeSizeIsNamedWithItsLimit) {
  expectMentions(complaintOf(good, {"particles.0.radius=-1e-3"}), {"particles.0.radius", "-0.001", "> 0"});
}

TEST_F(BadInput, ClumpsThatCantBeMadeAreNamedWithTheReason) {
  const auto complaint = [this](const std::string& keys) {
    return complaintOf(narrowBox + commonText + "[[particles]]\nshape = \"clump\"\n" + keys + pour);
  };
  const std::string chain = "construction = \"ellipsoid\"\n";
  const std::string size = "half_length = \"2 mm\"\nhalf_width = \"0.4 mm\"\n";
  EXPECT_EQ(complaint(chain + size + "spheres = 11\n"), "");
  expectMentions(complaint(""), {"particles.0", "needs radii", "needs centres"});
  expectMentions(complaint("radii = []\ncentres = []\n"), {"particles.0", "needs radii"});
  expectMentions(complaint("radii = [\"-1 mm\"]\ncentres = [[0, 0, 0]]\n"), {"radii", "-1 mm", "> 0"});
  expectMentions(complaint("radii = [\"1 mm\", \"1 mm\"]\ncentres = [[0, 0, 0]]\n"), {"1 centres for 2 radii"});
  expectMentions(complaint("radii = [\"1 mm\"]\ncentres = [[0, 0, 0]]\nspheres = 5\n"),
                 {"particles.0.spheres", "isn't used"});
  expectMentions(complaint(chain + size + "spheres = 12\n"), {"particles.0.spheres", "12", "odd"});
  expectMentions(complaint(chain + size + "spheres = 9\n"),
                 {"aspect ratio 5", "gaps", "smallest number that works is 11"});
  expectMentions(complaint(chain + "half_length = \"1 mm\"\nhalf_width = \"1 mm\"\nspheres = 5\n"),
                 {"particles.0.half_length", "longer than wide"});
}

TEST_F(BadInput, AMassOfZeroIsNamed) {
  const std::string material = "[[material]]\nname = \"glass\"\ndensity = 0\n";
  expectMentions(complaintOf(good + material), {"scene.toml:", "material.0.density", "> 0"});
}

TEST_F(BadInput, ARestitutionOfZeroIsNamed) {
  expectMentions(complaintOf(good, {"contact_default.restitution=0"}), {"contact_default.restitution", "0", "> 0"});
}

TEST_F(BadInput, AStepAboveTheBoundIsNamedWithTheBound) {
  expectMentions(complaintOf(good, {"time.step=1e-3"}),
                 {"scene.toml", "time.step", "0.001 s", "stability bound", "sphere"});
}

TEST_F(BadInput, AParticleLargerThanTheVesselIsNamedWithBothSizes) {
  expectMentions(complaintOf(good, {"particles.0.radius=8e-3"}),
                 {"particles.0", "larger than the vessel", "0.008", "0.0075"});
  // A mesh by the extent asked for.
  const std::string slab = std::string(GRANULAR_SOURCE_DIR) + "/meshes/slab.obj";
  expectMentions(complaintOf(meshScene(slab), {"particles.0.extent=16e-3"}),
                 {"larger than the vessel", "0.008", "0.0075"});
}

TEST_F(BadInput, AWallsMotionThatCannotBeIsNamedWithItsKey) {
  const std::string wall = "[[wall]]\nkind = \"plane\"\nnormal = [0, 0, -1]\npoint = [0, 0, 0.09]\n";
  expectMentions(complaintOf(good + wall + "velocity = [0, 0, -0.1]\n"), {"wall.0.stop", "time.max_time"});
  expectMentions(complaintOf(good + wall + "velocity = [0, 0, -0.1]\nstart = 2\nstop = 1\n"),
                 {"wall.0.stop", "above start", "2 s"});
  expectMentions(complaintOf(good + wall + "frequency = \"20 Hz\"\nstop = 1\n"), {"wall.0.amplitude"});
  expectMentions(complaintOf(good + wall + "force = \"1 N\"\n"), {"wall.0.direction"});
  expectMentions(complaintOf(good + wall + "direction = [0, 0, -1]\n"), {"wall.0.force"});
}

TEST_F(BadInput, AMissingSceneIsNamed) {
  try {
    SceneSource::read(folder / "absent.toml", {});
    FAIL();
  } catch (const InputError& error) {
    expectMentions(error.what(), {"absent.toml", "can't be read"});
  }
}

TEST_F(BadInput, AMissingMeshIsNamedWithItsGroup) {
  expectMentions(complaintOf(meshScene("absent.obj")), {"absent.obj", "scene.toml:"});
}

TEST_F(BadInput, AnEmptyMeshIsNamed) {
  writeFile("empty.obj", "");
  expectMentions(complaintOf(meshScene("empty.obj")), {"scene.toml:", "stones", "empty.obj", "empty"});
}

TEST_F(BadInput, AnOpenMeshIsNotAnExactBody) {
  const std::string cracked = std::string(GRANULAR_SOURCE_DIR) + "/meshes/cracked.off";
  expectMentions(complaintOf(meshScene(cracked, "exact"), {"particles.0.extent=5e-3"}),
                 {"scene.toml:", "stones", "cracked.off", "exact", "16 open"});
}

TEST_F(BadInput, AClumpOfAMeshNeedsSpheresAndAClosedMesh) {
  const std::string meshes = std::string(GRANULAR_SOURCE_DIR) + "/meshes/";
  expectMentions(complaintOf(meshScene(meshes + "boulder.obj", "clump"), {"particles.0.extent=5e-3"}),
                 {"particles.0", "clump", "spheres"});
  expectMentions(complaintOf(meshScene(meshes + "boulder.obj"), {"particles.0.extent=5e-3", "particles.0.spheres=5"}),
                 {"particles.0.spheres", "clump"});
  expectMentions(
      complaintOf(meshScene(meshes + "cracked.off", "clump"), {"particles.0.extent=5e-3", "particles.0.spheres=5"}),
      {"scene.toml:", "stones", "cracked.off", "no clump", "16 open"});
}

TEST_F(BadInput, ACoordinateThatIsNoNumberIsNamed) {
  writeFile("holey.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  expectMentions(complaintOf(meshScene("holey.obj")), {"scene.toml:", "stones", "holey.obj", "finite"});
}

TEST_F(BadInput, ATextIsNotAMesh) {
  writeFile("letter.obj", "Dear reader,\nthis is not a mesh.\n");
  expectMentions(complaintOf(meshScene("letter.obj")), {"scene.toml:", "stones", "letter.obj"});
  writeFile("letter.stl", "Dear reader,\nthis is not a mesh either.\n");
  expectMentions(complaintOf(meshScene("letter.stl")), {"scene.toml:", "stones", "letter.stl"});
}

TEST_F(BadInput, OverlappingPosesAreNamedWithTheirDepth) {
  // Centres 2.5 mm apart, radii 1.5 mm: .5 mm deep, a third of the size.
  const std::string message = complaintOf(poseScene("0 0 2e-3 1 0 0 0\n2.5e-3 0 2e-3 1 0 0 0\n-5e-3 0 2e-3 1 0 0 0\n"));
  expectMentions(message, {"poses.txt", "1 pair", "0 and 1", "0.0005 m", "0.333", "0.01"});
}

TEST_F(BadInput, APoseInsideAWallIsNamedWithItsDepth) {
  expectMentions(complaintOf(poseScene("0 0 1e-3 1 0 0 0\n")), {"poses.txt", "particle 0", "floor", "0.0005 m"});
}

TEST_F(BadInput, ABedOfUnknownMaterialIsNamed) {
  PackingRun run(write(good + "[[material]]\nname = \"glass\"\n"));
  run.run(makeFolder("first"), atOnce);
  const std::string bed = narrowBox + commonText + spheres + "[insertion]\nkind = \"bed\"\nfile = \"first\"\n";
  expectMentions(complaintOf(bed), {"scene.toml", "first", "'glass'"});
}

TEST_F(BadInput, AFolderBelowAFileCannotBeWritten) {
  writeFile("plain", "x");
  try {
    prepareOutputFolder(folder / "plain" / "out");
    FAIL();
  } catch (const InputError& error) {
    expectMentions(error.what(), {"plain/out", "output folder"});
  }
}

TEST_F(BadInput, ARunDoesNotWriteOverTheBedItStartsFrom) {
  PackingRun run(write(good));
  const auto first = makeFolder("first");
  run.run(first, atOnce);
  const std::string bed = "[insertion]\nkind = \"bed\"\nfile = \"first\"\n";
  PackingRun second(write(narrowBox + commonText + spheres + bed));
  try {
    second.run(first, atOnce);
    FAIL();
  } catch (const InputError& error) {
    expectMentions(error.what(), {"first", "choose another"});
  }
}

}  // namespace
}  // namespace granular
