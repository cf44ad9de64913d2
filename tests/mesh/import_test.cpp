#include "granular/mesh/import.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/stat.h>

#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>
#include <fstream>
#include <sstream>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/core/sanitizer.h"
#include "granular/mesh/mesh_file.h"
#include "granular/mesh/rock.h"
#include "mesh/generated.h"

namespace granular {
namespace {

using namespace granular::testing;

std::string writeBytes(const std::string& name, const std::string& content) {
  const std::string path = scratchFile(name);
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

std::string readBytes(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

// The message of the InputError that importing the file ends in; it must name the file.
std::string refusalOf(const std::string& path) {
  try {
    importMesh(path);
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << path << " was accepted";
  return "";
}

void expectRefused(const std::string& path, const std::string& reason) {
  const std::string message = refusalOf(path);
  EXPECT_NE(message.find(reason), std::string::npos) << message;
}

TEST(Import, FormatsGiveTheSameTriangles) {
  const TriangleMesh ball = makeBall(2, 0.05);
  for (const char* name : {"ball.obj", "ball.ply", "ball.off", "ball.stl"}) {
    const std::string path = scratchFile(name);
    writeMesh(path, ball);
    const RepairedMesh repaired = repairMesh(importMesh(path));
    ASSERT_EQ(repaired.mesh.triangles.size(), ball.triangles.size()) << name;
    EXPECT_TRUE(repaired.kept.closed) << name;
    EXPECT_NEAR(signedVolume(repaired.mesh.vertices, repaired.mesh.triangles),
                signedVolume(ball.vertices, ball.triangles), 1e-6)
        << name;
  }
}

TEST(Import, GltfIsReadWithItsNodeTransformations) {
  const std::string ply = scratchFile("ball.ply");
  writeMesh(ply, makeBall(2));
  Assimp::Importer importer;
  const aiScene* read = importer.ReadFile(ply, aiProcess_Triangulate | aiProcess_GenNormals);
  ASSERT_NE(read, nullptr);
  aiMatrix4x4::Scaling(aiVector3D(2, 1, 1), importer.GetScene()->mRootNode->mTransformation);
  for (const char* format : {"glb2", "gltf2"}) {
    const std::string path = scratchFile(std::string("ball.") + (std::string(format) == "glb2" ? "glb" : "gltf"));
    Assimp::Exporter exporter;
    ASSERT_EQ(exporter.Export(read, format, path), AI_SUCCESS);
    const RepairedMesh repaired = repairMesh(importMesh(path));
    EXPECT_TRUE(repaired.kept.closed) << format;
    const TriangleMesh ball = makeBall(2);
    EXPECT_NEAR(signedVolume(repaired.mesh.vertices, repaired.mesh.triangles),
                2 * signedVolume(ball.vertices, ball.triangles), 1e-5);
  }
}

TEST(Import, FilesThatAreNoMeshAreRefusedWithTheReason) {
  expectRefused(scratchFile("none.obj"), "no such file");
  expectRefused(std::filesystem::path(scratchFile("x")).parent_path().string(), "is not a file");
  expectRefused(writeBytes("rock.3ds", "whatever"), "unsupported format '.3ds'");
  for (const char* name : {"a.obj", "a.stl", "a.ply", "a.off", "a.gltf", "a.glb"})
    expectRefused(writeBytes(name, ""), "is empty");
  const std::string prose =
      "This is a text about rocks, long enough to be mistaken for the header of a binary file of triangles.\n";
  for (const char* name : {"b.obj", "b.ply", "b.off", "b.gltf", "b.glb"})
    expectRefused(writeBytes(name, prose), "is not a mesh");
  expectRefused(writeBytes("b.stl", prose), "truncated or not an STL");
  expectRefused(writeBytes("points.obj", "v 0 0 0\nv 1 0 0\n"), "no face");
  expectRefused(writeBytes("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), "vertex 4 of 3");
}

TEST(Import, CountsThatAFileCannotHoldAreRefusedBeforeLoading) {
  const std::string plyEnd =
      "property float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  expectRefused(writeBytes("a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n" + plyEnd),
                "announces 4000000000");
  expectRefused(writeBytes("b.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n" + plyEnd),
                "no count");
  expectRefused(writeBytes("a.off", "OFF\n2000000000 2000000000 0\n0 0 0\n"), "announces 2000000000");
  std::string stl(84, ' ');
  stl.replace(80, 4, "\xff\xff\xff\x7f");
  expectRefused(writeBytes("a.stl", stl + std::string(50, 'x')), "announces 2147483647");
  expectRefused(
      writeBytes(
          "a.gltf",
          R"({"asset":{"version":"2.0"},"accessors":[{"count":4000000000,"componentType":5126,"type":"VEC3"}],"meshes":[{}]})"),
      "announces 4000000000");
}

TEST(Import, TruncatedFilesAreRefused) {
  for (const char* name : {"ball.ply", "ball.off", "ball.stl"}) {
    const std::string path = scratchFile(name);
    writeMesh(path, makeBall(2, 0.05));
    const std::string whole = readBytes(path);
    for (const double part : {0.1, 0.5, 0.9, 0.99}) {
      writeBytes(name, whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
      EXPECT_THROW(importMesh(path), InputError) << name << " " << part;
    }
  }
}

TEST(Import, IndicesOutOfRangeAreRefusedInEveryFormat) {
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
  expectRefused(writeBytes("a.off", "OFF\n3 1 0\n" + corners + "3 0 1 7\n"), "uses vertex '7' of 3");
  expectRefused(writeBytes("b.off", "OFF\n3 1 0\n" + corners + "2000000000 0 1 2\n"), "face 0 of 1");
  expectRefused(
      writeBytes("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                     corners + "3 0 1 7\n"),
      "a vertex that is missing");
}

TEST(Import, DamagedFilesNeverTakeTheProcessDown) {
  Random random(9);
  for (const char* name : {"ball.obj", "ball.ply", "ball.off", "ball.stl"}) {
    const std::string path = scratchFile(name);
    writeMesh(path, makeBall(1, 0.05));
    const std::string whole = readBytes(path);
    for (int round = 0; round < 40; ++round) {
      // A few bytes overwritten at random, half of them in the first 200, where the header is.
      std::string damaged = whole;
      for (int k = 0; k < 5; ++k) {
        damaged[random.below(k % 2 == 0 ? 200 : damaged.size())] = static_cast<char>(random.below(256));
      }
      writeBytes(name, damaged);
      try {
        analyseMesh(path, {});
      } catch (const InputError& error) {
        EXPECT_FALSE(std::string(error.what()).empty());
      }
    }
  }
}

TEST(Import, LoaderOutOfMemoryOrTimeIsAnInputErrorNotACrash) {
  const std::string path = scratchFile("ball.obj");
  writeMesh(path, makeBall(6));
  if (!anySanitizer) {
    EXPECT_THROW(importMesh(path, {true, 1 << 20, 60}), InputError);
  }
  EXPECT_THROW(importMesh(path, {true, 0, 1e-4}), InputError);
}

TEST(Import, LoaderThatAbortsIsAnInputErrorNamingTheFile) {
  // Found by fuzzing: assimp fails an assertion of its own on it.
  const std::string input = readBytes(std::string(GRANULAR_SOURCE_DIR) + "/tests/fuzz/corpus/mesh/ply_abort");
  ASSERT_GT(input.size(), 1u);
  expectRefused(writeBytes("abort.ply", input.substr(1)), "the loader crashed on it");
}

TEST(Import, InThisProcessIsTheSameAsInAChild) {
  for (const char* name : {"ball.obj", "ball.ply", "ball.off", "ball.stl"}) {
    const std::string path = scratchFile(name);
    writeMesh(path, makeBall(2, 0.05));
    const RawMesh child = importMesh(path), here = importMesh(path, {false, 0, 60});
    EXPECT_EQ(child.vertices, here.vertices) << name;
    EXPECT_EQ(child.triangles, here.triangles) << name;
  }
}

/// A glTF triangle whose numbers lie in a file of that address.
std::string makeGltf(const std::string& address) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
         address + "\"}]}";
}

TEST(Import, NoFileOutsideTheMeshsFolderIsRead) {
  namespace fs = std::filesystem;
  const fs::path outside = fs::path(scratchFile("x")).parent_path(), inside = outside / "inside";
  fs::create_directories(inside / "deeper");
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string numbers(reinterpret_cast<const char*>(corners), sizeof corners);
  for (const fs::path& place : {outside, inside, inside / "deeper"})
    std::ofstream(place / "numbers.bin", std::ios::binary) << numbers;
  fs::remove(inside / "link.bin");
  fs::create_symlink(outside / "numbers.bin", inside / "link.bin");
  const auto write = [&](const std::string& address) { return writeBytes("inside/a.gltf", makeGltf(address)); };

  EXPECT_EQ(importMesh(write("numbers.bin")).triangles.size(), 1u);
  EXPECT_EQ(importMesh(write("deeper/numbers.bin")).triangles.size(), 1u);
  EXPECT_EQ(importMesh(write("deeper/../numbers.bin")).triangles.size(), 1u);
  for (const std::string& address :
       {std::string("../numbers.bin"), std::string("deeper/../../numbers.bin"), (outside / "numbers.bin").string(),
        std::string("link.bin"), std::string("/dev/zero"), std::string("file:///etc/passwd")}) {
    const std::string message = refusalOf(write(address));
    const bool named = message.find("outside the mesh's folder") != std::string::npos ||
                       message.find("is missing") != std::string::npos;
    EXPECT_TRUE(named && message.find(address) != std::string::npos) << message;
  }
  // A pipe that nobody writes into would hold a loader up for ever.
  const fs::path pipe = inside / "pipe.bin";
  fs::remove(pipe);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expectRefused(write("pipe.bin"), "is missing");
}

TEST(Import, MaterialLibrariesAreNotLookedFor) {
  namespace fs = std::filesystem;
  // Opening it for reading would wait for a writer until the loader's time is over.
  const fs::path pipe = scratchFile("colours.mtl");
  fs::remove(pipe);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& library : {pipe.filename().string(), pipe.string(), "../" + pipe.filename().string()}) {
    const std::string path =
        writeBytes("coloured.obj", "mtllib " + library + "\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(importMesh(path, {true, 0, 2}).triangles.size(), 1u) << library;
  }
}

TEST(Import, NonFiniteVerticesAreRefusedWithTheirCount) {
  for (const char* name : {"nan.obj", "nan.ply", "nan.off", "nan.stl"}) {
    TriangleMesh ball = makeBall(2);
    ball.vertices[5].y() = std::nan("");
    ball.vertices[77].x() = infinity;
    const std::string path = scratchFile(name);
    writeMesh(path, ball);
    try {
      makeRock(path, {});
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("2 vertices"), std::string::npos) << error.what();
    }
    EXPECT_THROW(importTriangles(path), InputError);
  }
}

TEST(Import, WallTrianglesKeepTheirOrientationAndMayBeOpen) {
  const std::string path =
      writeBytes("floor.obj", "v 0 0 0\nv 1000 0 0\nv 1000 1000 0\nv 0 1000 0\nf 1 2 3 4\nf 1 2 2\n");
  const TriangleMesh floor = importTriangles(path, "mm", 2);
  EXPECT_EQ(floor.vertices.size(), 4u);
  ASSERT_EQ(floor.triangles.size(), 2u);
  EXPECT_NEAR(surfaceArea(floor.vertices, floor.triangles), 4, 1e-12);
  for (const Triangle& t : floor.triangles) {
    const Vec3 normal =
        (floor.vertices[t[1]] - floor.vertices[t[0]]).cross(floor.vertices[t[2]] - floor.vertices[t[0]]);
    EXPECT_GT(normal.z(), 0);
  }
  EXPECT_THROW(importTriangles(path, "furlong"), InputError);
  EXPECT_THROW(importTriangles(path, "m", 0), InputError);
}

}  // namespace
}  // namespace granular
