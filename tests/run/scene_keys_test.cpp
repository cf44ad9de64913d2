// Keys of a scene do what their texts say.
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "granular/run/packing_report.h"
#include "run/scene_texts.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

class SceneKeys : public RunTest {
 protected:
  const std::string pour = "[insertion]\nkind = \"batches\"\ncount = 30\nbatch = 30\n";

  std::string rocks(const std::string& keys) const {
    const std::string meshes = std::string(GRANULAR_SOURCE_DIR) + "/meshes/";
    return "[vessel]\nkind = \"cylinder\"\nradius = \"20 mm\"\n" + commonText +
           "[[particles]]\nshape = \"mesh\"\nunit = \"m\"\nmax_vertices = 20\nfiles = [\"" + meshes +
           "boulder.obj\", \"" + meshes + "slab.obj\"]\n" + keys + pour;
  }

  /// Sizes of the particles that are poured, each once.
  static std::set<double> sizesOf(const PackingRun& run) {
    std::set<double> sizes;
    for (std::int64_t k = 0; k < run.inserter().count(); ++k) sizes.insert(run.inserter().makeShape(k)->size());
    return sizes;
  }
};

TEST_F(SceneKeys, TheSceneOfTheUserGuideIsValid) {
  std::ifstream guide(std::string(GRANULAR_SOURCE_DIR) + "/docs/guide.md");
  std::string line, text;
  for (bool inside = false; std::getline(guide, line);) {
    inside = (inside || line == "    [vessel]") && (line.empty() || line.starts_with("    ")) &&
             line.find("build/release") == std::string::npos;
    if (inside) text += line + "\n";
  }
  const PackingRun run(write(text));
  EXPECT_EQ(run.inserter().count(), 1000);
}

TEST_F(SceneKeys, VariantsOfMeshesAreSoManyShapes) {
  const std::string extent = "extent = [\"3 mm\", \"5 mm\"]\n";
  EXPECT_EQ(sizesOf(PackingRun(write(rocks(extent)))).size(), 30u);
  const auto three = sizesOf(PackingRun(write(rocks(extent + "variants = 3\n"))));
  EXPECT_GE(three.size(), 2u);
  EXPECT_LE(three.size(), 3u);
}

TEST_F(SceneKeys, DiametersOfMeshesAreDiameters) {
  const std::string size =
      "[particles.size]\nas = \"diameter\"\ndistribution = \"uniform\"\nmin = \"3 mm\"\nmax = \"5 mm\"\n";
  for (const double radius : sizesOf(PackingRun(write(rocks(size))))) {
    EXPECT_GE(2 * radius, 3e-3 * (1 - 1e-12));
    EXPECT_LE(2 * radius, 5e-3 * (1 + 1e-12));
  }
  expectMentions(complaintOf(rocks("extent = \"4 mm\"\n" + size)), {"particles.0.size.as", "extent", "one of them"});
}

TEST_F(SceneKeys, NoContactsMeansNeitherTheirTableNorTheirNetwork) {
  for (const std::string wanted : {"true", "false"}) {
    std::ofstream(folder / "poses.txt") << "0 0 1.4999e-3 1 0 0 0\n";
    const std::string poses = "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
    PackingRun run(write(narrowBox + commonText + spheres + poses, {"output.contacts=" + wanted}));
    const auto out = makeFolder("out_" + wanted);
    ASSERT_EQ(run.run(out, never), RunEnd::rested);
    writeReport(run, RunEnd::rested, 1, out);
    EXPECT_TRUE(fs::exists(out / "frames" / "particles.pvd"));
    for (const char* file : {"contacts.csv", "frames/contacts.pvd", "frames/contacts_00000.vtp"})
      EXPECT_EQ(fs::exists(out / file), wanted == "true") << file;
  }
}

}  // namespace
}  // namespace granular
