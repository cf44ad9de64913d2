#include "granular/mesh/rock.h"

#include <nlohmann/json.hpp>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/mesh/mesh_file.h"
#include "mesh/generated.h"

namespace granular {
namespace {

using namespace granular::testing;

std::string refusalOf(const std::string& path, const RockOptions& options) {
  try {
    makeRock(path, options);
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    return error.what();
  }
  return "accepted";
}

std::string writeScratch(const std::string& name, const TriangleMesh& mesh) {
  const std::string path = scratchFile(name);
  writeMesh(path, mesh);
  return path;
}

// A cube with a smaller cube cut out of one corner: volume 7, hull volume 8 - 1/6.
TriangleMesh makeNotchedCube() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {0, 2, 2},
                   {2, 2, 1}, {2, 1, 1}, {1, 1, 1}, {1, 2, 1}, {2, 1, 2}, {1, 1, 2}, {1, 2, 2}};
  const std::vector<std::vector<int>> faces = {{0, 3, 2, 1},   {0, 1, 5, 4},    {0, 4, 6, 3},   {7, 10, 9, 8},
                                               {11, 8, 9, 12}, {13, 12, 9, 10}, {8, 7, 2, 1},   {8, 1, 5, 11},
                                               {10, 3, 2, 7},  {10, 13, 6, 3},  {12, 4, 5, 11}, {12, 13, 6, 4}};
  for (const std::vector<int>& f : faces) {
    for (std::size_t k = 1; k + 1 < f.size(); ++k) mesh.triangles.push_back({f[0], f[k], f[k + 1]});
  }
  return mesh;
}

TEST(Rock, NotchedCubeHasItsClosedFormVolumes) {
  // Orientation is left to the repair.
  const RockReport report = analyseMesh(writeScratch("notched.obj", makeNotchedCube()), {});
  EXPECT_TRUE(report.kept.closed);
  EXPECT_NEAR(report.meshVolume, 7, 1e-9);
  EXPECT_NEAR(report.hullVolume, 8 - 1.0 / 6, 1e-9);
  EXPECT_NEAR(report.convexity, 7 / (8 - 1.0 / 6), 1e-9);
  ASSERT_EQ(report.warnings.size(), 1u);
  for (const char* word : {"0.894", "hull", "clump", "convex pieces"})
    EXPECT_NE(report.warnings[0].find(word), std::string::npos) << word;
}

TEST(Rock, ExactBodyHasTheMassOfTheMeshAndTheHullForContacts) {
  RockOptions options;
  options.use = RockUse::exact;
  RockReport report;
  const auto body = makeRock(writeScratch("notched.obj", makeNotchedCube()), options, &report);
  EXPECT_NEAR(body->massProperties().volume, 7, 1e-9);
  EXPECT_EQ(body->tables().vertexCount(), 10);
  EXPECT_NEAR(body->massProperties().inertia.sum(), report.meshInertia.sum(), 1e-9);
  // The notched cube: cube of 8 about its centre less the small cube, moved to the common centre of mass.
  // sum of principal moments = 2 * integral of r^2 = 2 (8 * 3 * 4/12 - (3/12 + 3 * .25) - 7 * 3 * (1/14)^2)
  EXPECT_NEAR(report.meshInertia.sum(), 2 * (8 - 1 - 21.0 / 196), 1e-9);
  // The origin is the mesh's centre of mass, not the hull's: the corner at the origin lies 13/14 from it along each
  // axis.
  EXPECT_NEAR(body->boundingRadius(), std::sqrt(std::pow(13.0 / 14, 2) + 2 * std::pow(15.0 / 14, 2)), 1e-6);
}

TEST(Rock, UnitsScaleAndTargetsGiveTheLengthAskedFor) {
  const std::string path = writeScratch("box.stl", makeBox({0, 0, 0}, {3, 4, 12}));
  RockOptions options;
  options.unit = "mm";
  EXPECT_NEAR(makeRock(path, options)->massProperties().volume, 144e-9, 1e-16);
  options.scale = 2;
  EXPECT_NEAR(makeRock(path, options)->massProperties().volume, 8 * 144e-9, 1e-15);
  options.longestExtent = 0.026;
  EXPECT_NEAR(makeRock(path, options)->longestExtent(), 0.026, 1e-15);
  EXPECT_NEAR(makeRock(path, options)->massProperties().volume, 8 * 144e-9, 1e-13);
  options.longestExtent = 0;
  options.equalVolumeDiameter = 0.01;
  RockReport report;
  const auto body = makeRock(path, options, &report);
  EXPECT_NEAR(body->massProperties().volume, pi * 1e-6 / 6, 1e-19);
  EXPECT_NEAR(report.meshVolume, pi * 1e-6 / 6, 1e-13);
}

TEST(Rock, OptionsOutsideTheirRangeAreRefusedWithTheValue) {
  const std::string path = writeScratch("box.obj", makeBox({0, 0, 0}, {1, 1, 1}));
  const auto refused = [&](auto change, const std::string& word) {
    RockOptions options;
    change(options);
    EXPECT_THROW(makeRock(path, options), InputError) << word;
    try {
      makeRock(path, options);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused([](RockOptions& o) { o.scale = -1; }, "-1");
  refused([](RockOptions& o) { o.unit = "parsec"; }, "parsec");
  refused([](RockOptions& o) { o.vertexBudget = 3; }, "3");
  refused([](RockOptions& o) { o.longestExtent = std::nan(""); }, "nan");
  refused([](RockOptions& o) { o.longestExtent = o.equalVolumeDiameter = 1; }, "give one");
}

TEST(Rock, MeshesThatCannotBeABodyAreRefusedWithTheReason) {
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_NE(refusalOf(writeScratch("flat.obj", flat), {}).find("flat"), std::string::npos);
  TriangleMesh point = makeBox({1, 1, 1}, {1, 1, 1});
  EXPECT_NE(refusalOf(writeScratch("point.obj", point), {}).find("flat or empty"), std::string::npos);
  TriangleMesh far = makeBox({1e7, 1e7, 0}, {1e7 + 100, 1e7 + 100, 100});
  EXPECT_NE(refusalOf(writeScratch("far.obj", far), {}).find("too far from its origin"), std::string::npos);
}

TEST(Rock, OpenMeshIsAHullWithAWarningAndNoExactBody) {
  TriangleMesh open = makeBall(3);
  open.triangles.pop_back();
  const std::string path = writeScratch("open.obj", open);
  RockOptions options;
  options.use = RockUse::exact;
  EXPECT_NE(refusalOf(path, options).find("3 open"), std::string::npos);
  EXPECT_NE(analyseMesh(path, options).whyNotExact.find("3 open"), std::string::npos);
  options.use = RockUse::hull;
  RockReport report;
  const auto body = makeRock(path, options, &report);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NEAR(body->massProperties().volume, report.hullVolume, 1e-12);
}

TEST(Rock, GeneratedRocksHaveTheirDocumentedDefects) {
  const auto rock = [](const char* name) {
    return (std::filesystem::path(GRANULAR_SOURCE_DIR) / "meshes" / name).string();
  };
  RockOptions millimetres;
  millimetres.unit = "mm";
  for (const char* name : {"boulder.obj", "shard.ply", "slab.obj", "bitten.obj"}) {
    const RockReport report = analyseMesh(rock(name), {});
    MeshDefects clean;
    clean.parts = 1;
    clean.euler = 2;
    expectCounts(report.defects, clean, name);
    EXPECT_EQ(report.triangles, 5120) << name;
  }
  EXPECT_LT(analyseMesh(rock("bitten.obj"), {}).convexity, convexityWarning);
  EXPECT_EQ(analyseMesh(rock("pebble_mm.stl"), millimetres).kept.closed, true);
  EXPECT_EQ(analyseMesh(rock("cracked.off"), {}).kept.openEdges, 16);
  MeshDefects dirty;
  dirty.duplicateVertices = 23;
  dirty.unreferencedVertices = 11;
  dirty.degenerateTriangles = 9;
  dirty.duplicateTriangles = 13;
  dirty.flippedTriangles = 17;
  dirty.slivers = 5;
  dirty.nonManifoldEdges = dirty.finTriangles = 4;
  dirty.openEdges = 8;
  dirty.parts = 4;
  dirty.droppedParts = 3;
  dirty.droppedTriangles = 240;
  dirty.euler = 8;
  const RockReport report = analyseMesh(rock("dirty.obj"), {});
  expectCounts(report.defects, dirty, "dirty.obj");
  EXPECT_TRUE(report.kept.closed);
}

TEST(Rock, ReportNamesEveryDefectInTextAndJson) {
  MeshDefects expected;
  TriangleMesh mesh = makeCleanMesh(expected);
  for (const Defect& defect : allDefects()) {
    if (std::string(defect.name) != "nonFiniteVertices") defect.inject(mesh, expected);
  }
  const RockReport report = analyseMesh(writeScratch("dirty.obj", mesh), {});
  const std::string text = formatReport(report);
  for (const char* line :
       {"8 duplicate vertices: welded", "5 unreferenced vertices: dropped", "4 degenerate triangles: dropped",
        "4 duplicate triangles: dropped", "2 slivers", "5 open edges", "1 non-manifold edges",
        "6 flipped triangles: turned", "2 separate smaller parts: dropped", "inside out"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
  }
  const auto json = nlohmann::json::parse(reportToJson(report));
  EXPECT_EQ(json["defects"]["duplicate_vertices"], 8);
  EXPECT_EQ(json["defects"]["inside_out"], true);
  EXPECT_EQ(json["mesh"]["open_edges"], 3);
  EXPECT_NEAR(json["convexity"].get<double>(), report.convexity, 1e-15);
}

TEST(Reduction, HullWithinItsBudgetIsUnchanged) {
  const TriangleMesh box = makeBox({0, 0, 0}, {1, 2, 3});
  const ConvexHull hull = convexHull(box.vertices);
  const HullReduction reduction = reduceHull(hull, {60, true});
  EXPECT_EQ(reduction.hull.vertices, hull.vertices);
  EXPECT_EQ(reduction.volumeError, 0);
  EXPECT_THROW(reduceHull(hull, {3, true}), InputError);
}

TEST(Reduction, SubsetLiesInsideAndItsMeasuredErrorIsRight) {
  const TriangleMesh ball = makeBall(3, 0.05);
  const ConvexHull hull = convexHull(ball.vertices);
  const HullReduction reduction = reduceHull(hull, {60, false});
  EXPECT_EQ(reduction.hull.vertices.size(), 60u);
  for (const Vec3& v : reduction.hull.vertices) {
    EXPECT_TRUE(std::find(hull.vertices.begin(), hull.vertices.end(), v) != hull.vertices.end());
  }
  // Inside, the symmetric difference is the volume lost; both by separate routes.
  EXPECT_LT(reduction.volumeError, 0);
  EXPECT_NEAR(reduction.symmetricDifference, -reduction.volumeError, 1e-6);
  EXPECT_NEAR(reduction.inside, 0, 1e-9);
}

TEST(Reduction, LosesLessThanFarthestPointInsertion) {
  const ConvexHull hull = convexHull(makeBall(3, 0.05).vertices);
  for (const int budget : {12, 30, 60}) {
    // The oracle: each step the vertex furthest from those chosen.
    std::vector<Vec3> chosen = {hull.vertices.front()};
    while (chosen.size() < static_cast<std::size_t>(budget)) {
      double most = -1;
      Vec3 best = Vec3::Zero();
      for (const Vec3& v : hull.vertices) {
        double nearest = infinity;
        for (const Vec3& c : chosen) nearest = std::min(nearest, (v - c).norm());
        if (nearest > most) {
          most = nearest;
          best = v;
        }
      }
      chosen.push_back(best);
    }
    const HullReduction reduction = reduceHull(hull, {budget, false});
    EXPECT_GT(reduction.subsetVolume, hullVolume(convexHull(chosen))) << budget;
  }
}

TEST(Reduction, TwelveVerticesOfASphereComeWithinAPercentOfTheIcosahedron) {
  // The icosahedron is the largest polyhedron of 12 vertices in a sphere: volume 2.53615; the fine ball holds it
  // exactly.
  const HullReduction reduction = reduceHull(convexHull(makeBall(3).vertices), {12, false});
  EXPECT_GT(reduction.subsetVolume, 0.99 * 2.53615);
  EXPECT_LT(reduction.subsetVolume, 2.53616);
}

TEST(Reduction, MatchedVolumeHalvesTheSymmetricDifference) {
  const ConvexHull hull = convexHull(makeBall(4, 0.05).vertices);
  const HullReduction inside = reduceHull(hull, {60, false}), matched = reduceHull(hull, {60, true});
  EXPECT_NEAR(matched.volumeError, 0, 1e-12);
  EXPECT_LT(matched.symmetricDifference, 0.6 * inside.symmetricDifference);
  // Against a count of random points inside exactly one of the two.
  const auto holds = [](const ConvexHull& h, const Vec3& p) {
    for (std::size_t f = 0; f < h.faces.size(); ++f) {
      if (h.normals[f].dot(p - h.vertices[h.faces[f][0]]) > 0) return false;
    }
    return true;
  };
  Random random(2);
  const int count = 20000;
  int one = 0;
  for (int k = 0; k < count; ++k) {
    const Vec3 p(random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3));
    one += holds(hull, p) != holds(matched.hull, p);
  }
  const double box = std::pow(2.6, 3), share = double(one) / count;
  const double sigma = std::sqrt(share * (1 - share) / count);
  EXPECT_NEAR(matched.symmetricDifference * matched.fullVolume, share * box, 5 * sigma * box);
}

}  // namespace
}  // namespace granular
