#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <array>
#include <assimp/Importer.hpp>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/io/mesh_export.h"
#include "granular/io/result.h"
#include "granular/io/vtk_writer.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "scratch_folder.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

std::string readText(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

/// Runs Debian's python3, which has VTK; returns what it prints.
std::string runPython(const fs::path& folder, const std::string& script) {
  std::ofstream(folder / "script.py") << script;
  const std::string command = "cd '" + folder.string() + "' && /usr/bin/python3 script.py 2>&1";
  std::string text;
  if (FILE* pipe = popen(command.c_str(), "r")) {
    std::array<char, 256> buffer;
    while (fgets(buffer.data(), buffer.size(), pipe)) text += buffer.data();
    pclose(pipe);
  }
  return text;
}

bool hasVtk(const fs::path& folder) { return runPython(folder, "import vtk\nprint('yes')\n") == "yes\n"; }

/// Cubes of 3 mm side in a row along x, 4 mm apart, and a sphere of 1 mm at the end.
class OutputTest : public ScratchFolder {
 protected:
  const Cuboid cube{Vec3::Constant(1.5e-3)};
  const Sphere sphere{1e-3};
  std::vector<const Shape*> shapes{&cube, &cube, &sphere};
  std::vector<Frame> frames{{Mat3::Identity(), {0, 0, 0}},
                            {rotationFromVector({0, 0, pi / 2}).toRotationMatrix(), {4e-3, 0, 0}},
                            {Mat3::Identity(), {8e-3, 0, 2e-3}}};
  std::vector<std::int64_t> ids{5, 7, 9};
};

using VtkTest = OutputTest;

TEST_F(VtkTest, SurfacesReadBackWithPointsTrianglesAndParticleArrays) {
  const VtkArray id{"id", ids};
  const VtkArray velocity{"velocity", std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}, 3};
  const VtkPolyData data = makeSurfaces(shapes, frames, std::vector<VtkArray>{id, velocity}, 12);
  writePolyData(folder / "bed.vtp", data);
  if (!hasVtk(folder)) GTEST_SKIP() << "no VTK for /usr/bin/python3";
  std::istringstream answer(runPython(folder, R"(
import vtk
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName('bed.vtp')
reader.Update()
bed = reader.GetOutput()
print(bed.GetNumberOfPoints(), bed.GetNumberOfPolys(), bed.GetNumberOfLines())
ids = bed.GetCellData().GetArray('id')
v = bed.GetCellData().GetArray('velocity')
n = ids.GetNumberOfTuples()
print(n, ids.GetValue(0), ids.GetValue(12), ids.GetValue(n - 1), v.GetNumberOfComponents(), v.GetTuple(n - 1)[2])
print(*bed.GetBounds())
mass = vtk.vtkMassProperties()
mass.SetInputData(bed)
print(mass.GetVolume())
)"));
  std::size_t points, polys, lines, tuples;
  int first, second, last, components;
  double component, bounds[6], volume;
  answer >> points >> polys >> lines >> tuples >> first >> second >> last >> components >> component;
  for (double& b : bounds) answer >> b;
  answer >> volume;
  ASSERT_TRUE(answer) << answer.str();
  EXPECT_EQ(points, data.points.size());
  EXPECT_EQ(polys, data.triangles.size());
  EXPECT_EQ(lines, 0u);
  EXPECT_EQ(tuples, polys);
  EXPECT_EQ(first, 5);
  EXPECT_EQ(second, 7) << "a cube has twelve triangles";
  EXPECT_EQ(last, 9);
  EXPECT_EQ(components, 3);
  EXPECT_EQ(component, 9);
  EXPECT_NEAR(bounds[0], -1.5e-3, 1e-9);
  EXPECT_NEAR(bounds[1], 9e-3, 1e-4);
  EXPECT_NEAR(bounds[5], 3e-3, 1e-4);
  // Two cubes and an inscribed polyhedron of the sphere: outward triangles add up.
  const double sphereVolume = 4.0 / 3 * pi * 1e-9;
  EXPECT_LT(volume, 54e-9 + sphereVolume);
  EXPECT_GT(volume, 54e-9 + 0.7 * sphereVolume);
}

TEST_F(VtkTest, ForceNetworkReadsBackAsSegments) {
  Bed bed;
  bed.shapes = shapes;
  bed.frames = frames;
  bed.contacts = {{0, 1, {2e-3, 0, 0}, Vec3::UnitX(), {-3, 4, 0}, 1e-6},
                  {2, -1, {9e-3, 0, 2e-3}, Vec3::UnitX(), {-2, 0, 0}, 0}};
  writePolyData(folder / "forces.vtp", makeForceNetwork(bed));
  if (!hasVtk(folder)) GTEST_SKIP() << "no VTK for /usr/bin/python3";
  EXPECT_EQ(runPython(folder, R"(
import vtk
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName('forces.vtp')
reader.Update()
net = reader.GetOutput()
force, normal = net.GetCellData().GetArray('force_N'), net.GetCellData().GetArray('normal_force_N')
print(net.GetNumberOfLines(), force.GetValue(0), normal.GetValue(0), force.GetValue(1))
print(['%.4f' % x for x in net.GetPoint(3)])
)"),
            "2 5.0 3.0 2.0\n['0.0090', '0.0000', '0.0020']\n");
}

TEST_F(VtkTest, EmptyBedIsAValidFile) {
  writePolyData(folder / "empty.vtp", makeSurfaces({}, {}, {}, 12));
  if (!hasVtk(folder)) GTEST_SKIP() << "no VTK for /usr/bin/python3";
  EXPECT_EQ(runPython(folder, R"(
import vtk
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName('empty.vtp')
reader.Update()
print(reader.GetOutput().GetNumberOfCells(), reader.GetErrorCode())
)"),
            "0 0\n");
}

TEST_F(VtkTest, VoxelsReadBackWithXRunningFastest) {
  VoxelField field;
  field.origin = {1, 2, 3};
  field.edge = 0.5;
  field.count = {2, 3, 4};
  for (int k = 0; k < 24; ++k) {
    field.solid.push_back(static_cast<float>(k) / 32);
    field.vessel.push_back(k == 0 ? 0.0f : 0.75f);
  }
  writeVoxels(folder / "porosity.vti", field);
  if (!hasVtk(folder)) GTEST_SKIP() << "no VTK for /usr/bin/python3";
  EXPECT_EQ(runPython(folder, R"(
import vtk
reader = vtk.vtkXMLImageDataReader()
reader.SetFileName('porosity.vti')
reader.Update()
field = reader.GetOutput()
print(field.GetNumberOfCells(), *field.GetBounds())
solid, porosity = field.GetCellData().GetArray('solid'), field.GetCellData().GetArray('porosity')
cell = field.FindCell([1.75, 2.75, 4.25], None, 0, 0, vtk.reference(0), [0] * 3, [0] * 8)
print(cell, solid.GetValue(cell) * 32, porosity.GetValue(0), porosity.GetValue(12))
)"),
            "24 1.0 2.0 2.0 3.5 3.0 5.0\n15 15.0 1.0 0.5\n");
}

TEST_F(VtkTest, SeriesListsEveryFrameWithItsTime) {
  fs::create_directories(folder / "frames");
  FrameSeries series(folder / "bed.pvd");
  for (int k = 0; k < 2; ++k) {
    const fs::path file = folder / "frames" / ("bed_" + std::to_string(k) + ".vtp");
    writePolyData(file, makeSurfaces(shapes, frames, {}, 12));
    series.add(0.1 * k, file);
  }
  const std::string text = readText(folder / "bed.pvd");
  EXPECT_NE(text.find("timestep=\"0\" part=\"0\" file=\"frames/bed_0.vtp\""), std::string::npos) << text;
  EXPECT_NE(text.find("timestep=\"0.1\" part=\"0\" file=\"frames/bed_1.vtp\""), std::string::npos) << text;

  // A resumed run goes on where the first stopped.
  FrameSeries resumed(folder / "bed.pvd");
  resumed.restore(series.entries());
  resumed.add(0.2, folder / "frames" / "bed_2.vtp");
  EXPECT_NE(readText(folder / "bed.pvd").find("frames/bed_1.vtp"), std::string::npos);
}

using MeshExportTest = OutputTest;

double volumeOf(const aiMesh& mesh) {
  double volume = 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    Vec3 p[3];
    for (unsigned c = 0; c < 3; ++c) {
      const aiVector3D& v = mesh.mVertices[mesh.mFaces[f].mIndices[c]];
      p[c] = {v.x, v.y, v.z};
    }
    volume += p[0].dot(p[1].cross(p[2])) / 6;
  }
  return volume;
}

TEST_F(MeshExportTest, StlHoldsTheVolumeOfTheBed) {
  exportBed(folder / "bed.stl", shapes, frames, ids);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(folder / "bed.stl", 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1u);
  const double sphereVolume = 4.0 / 3 * pi * 1e-9;
  EXPECT_NEAR(volumeOf(*scene->mMeshes[0]), 54e-9 + sphereVolume, 0.05 * sphereVolume);
  // Binary: 80 bytes, the number of triangles, 50 bytes for each.
  EXPECT_EQ(fs::file_size(folder / "bed.stl"), 84 + 50 * scene->mMeshes[0]->mNumFaces);
}

TEST_F(MeshExportTest, GapScalesEveryParticleAboutItsCentre) {
  exportBed(folder / "bed.stl", std::span(shapes).first(2), std::span(frames).first(2), ids, {24, 0, 0.1});
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(folder / "bed.stl", 0);
  ASSERT_NE(scene, nullptr);
  EXPECT_NEAR(volumeOf(*scene->mMeshes[0]), 54e-9 * 0.729, 1e-13);
}

TEST_F(MeshExportTest, GlbHoldsEachParticleUnderItsNameInItsPlaceWithYUp) {
  exportBed(folder / "bed.glb", shapes, frames, ids);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(folder / "bed.glb", 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  EXPECT_EQ(scene->mNumMeshes, 2u) << "two particles have one shape";
  for (std::size_t k = 0; k < 3; ++k) {
    const aiNode* node = scene->mRootNode->FindNode(("particle_" + std::to_string(ids[k])).c_str());
    ASSERT_NE(node, nullptr);
    aiMatrix4x4 world;
    for (const aiNode* n = node; n; n = n->mParent) world = n->mTransformation * world;
    const aiMesh& mesh = *scene->mMeshes[node->mMeshes[0]];
    // Bounds in glTF's axes: (x, y, z) of the bed is (x, z, -y) there.
    Aabb found;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = world * mesh.mVertices[v];
      found.include({p.x, -p.z, p.y});
    }
    const Aabb expected = shapes[k]->bounds(frames[k]);
    const double facets = shapes[k] == &sphere ? 2e-5 : 1e-8;  // an inscribed polyhedron of 24 segments around
    EXPECT_LT((found.lo - expected.lo).cwiseAbs().maxCoeff(), facets) << k;
    EXPECT_LT((found.hi - expected.hi).cwiseAbs().maxCoeff(), facets) << k;
  }
}

TEST_F(MeshExportTest, GlbHoldsAShapeOnceHoweverManyParticlesHaveIt) {
  std::vector<const Shape*> many(400, &sphere);
  std::vector<Frame> places(many.size());
  std::vector<std::int64_t> numbers(many.size());
  for (std::size_t k = 0; k < many.size(); ++k) {
    places[k].x = Vec3(3e-3 * static_cast<double>(k), 0, 0);
    numbers[k] = static_cast<std::int64_t>(k);
  }
  exportBed(folder / "one.glb", std::span(many).first(1), std::span(places).first(1), std::span(numbers).first(1));
  exportBed(folder / "many.glb", many, places, numbers);
  // A node takes some 200 bytes, the sphere some tens of thousands.
  EXPECT_LT(fs::file_size(folder / "many.glb"), fs::file_size(folder / "one.glb") + 400 * 400);
}

TEST_F(MeshExportTest, GlbOfTooManyShapesPutsThemTogether) {
  exportBed(folder / "bed.glb", shapes, frames, ids, {24, 1, 0});
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(folder / "bed.glb", 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1u);
  const double scale = 1e-6 * 1e-6 * 1e-6;
  const double sphereVolume = 4.0 / 3 * pi * 1e-9;
  EXPECT_NEAR(scale * volumeOf(*scene->mMeshes[0]), 54e-9 + sphereVolume, 0.05 * sphereVolume);
}

TEST_F(MeshExportTest, OtherEndingsAndEmptyBedsAreRefused) {
  EXPECT_THROW(exportBed(folder / "bed.obj", shapes, frames, ids), InputError);
  EXPECT_THROW(exportBed(folder / "bed.stl", {}, {}, {}), InputError);
  EXPECT_THROW(exportBed(folder / "nowhere/bed.stl", shapes, frames, ids), InputError);
}

using ResultTest = OutputTest;

TEST_F(ResultTest, JsonHasTheStableKeys) {
  RunResult result;
  result.name = "bed \xff";
  result.version = "0.1.0";
  result.particles = 3;
  result.steps = 100;
  result.dt = 1e-5;
  result.wall = 2;
  result.particleSteps = 300;
  result.solidOverall = 0.6;
  result.contacts.fallbacks = 4;
  result.quantities = {{"mean_force", "N", "mean of all", 2.5}, {"angle", "rad", "none here", std::nullopt}};
  writeResult(folder / "result.json", result);
  const auto json = nlohmann::json::parse(readText(folder / "result.json"));
  for (const char* key : {"particles", "steps", "dt_s", "simulated_s", "wall_s", "particle_steps_per_s",
                          "solid_fraction", "filling_height_m", "coordination_number", "max_overlap_over_size",
                          "kinetic_energy_j", "state_hash", "contacts", "energy", "seed", "threads", "version"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["particle_steps_per_s"], 150);
  EXPECT_EQ(json["solid_fraction"]["overall"], 0.6);
  EXPECT_TRUE(json["solid_fraction"]["core"].is_null());
  EXPECT_EQ(json["contacts"]["fallbacks"], 4);
  for (const char* key : {"now", "uncertified", "normal_flips"}) EXPECT_TRUE(json["contacts"].contains(key)) << key;
  EXPECT_TRUE(json["energy"]["residual_relative"].is_null());
  EXPECT_EQ(json["quantities"]["mean_force"]["value"], 2.5);
  EXPECT_TRUE(json["quantities"]["angle"]["value"].is_null());
}

TEST_F(ResultTest, ARunWithoutTimeHasNoSpeed) {
  const auto json = nlohmann::json::parse(formatResult({}));
  EXPECT_TRUE(json["particle_steps_per_s"].is_null());
}

TEST_F(ResultTest, TableKeepsAllDigitsAndLeavesMissingCellsEmpty) {
  const Table table{"t", "two numbers", {"a_m", "b"}, {{0.1, 1.0 / 3}, {std::nan(""), -5}}};
  writeTable(folder / "t.csv", table);
  EXPECT_EQ(readText(folder / "t.csv"), "# two numbers\na_m,b\n0.1,0.3333333333333333\n,-5\n");
}

TEST_F(ResultTest, ParticleAndContactTablesNameIds) {
  Bodies bodies;
  for (std::size_t k = 0; k < 3; ++k) {
    bodies.id.push_back(ids[k]);
    bodies.bounds.push_back({frames[k].x, 1});
    bodies.q.push_back(Quat(frames[k].R));
    bodies.motion.emplace_back();
    bodies.v(k) = Vec3(1, 2, 3);
    bodies.w(k) = Vec3(4, 5, 6);
    bodies.mass.push_back(0.5);
    bodies.shape.push_back(shapes[k]);
    bodies.shapeIndex.push_back(static_cast<std::int32_t>(k));
    bodies.material.push_back(0);
    bodies.state.push_back(BodyState::moving);
  }
  const Table particles = tabulateParticles(bodies, {1, 2, 0});
  ASSERT_EQ(particles.rows.size(), 3u);
  for (const auto& row : particles.rows) EXPECT_EQ(row.size(), particles.columns.size());
  EXPECT_EQ(particles.rows[1][0], 7);
  EXPECT_EQ(particles.rows[1][1], 4e-3);
  EXPECT_EQ(particles.rows[2][15], sphere.size());
  EXPECT_EQ(particles.rows[1][18], 2);

  Bed bed;
  bed.shapes = shapes;
  bed.frames = frames;
  bed.contacts = {{0, 2, {1, 2, 3}, Vec3::UnitZ(), {0, 0, -1}, 1e-6},
                  {1, -1, {1, 2, 3}, Vec3::UnitZ(), {0, 0, -1}, 1e-6}};
  const Table contacts = tabulateContacts(bed, ids);
  for (const auto& row : contacts.rows) EXPECT_EQ(row.size(), contacts.columns.size());
  EXPECT_EQ(contacts.rows[0][0], 5);
  EXPECT_EQ(contacts.rows[0][1], 9);
  EXPECT_EQ(contacts.rows[1][1], -1);
}

}  // namespace
}  // namespace granular
