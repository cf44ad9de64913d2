#include "granular/mesh/mesh_file.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "granular/core/errors.h"

namespace granular {
namespace {

std::string stlBytes(const TriangleMesh& mesh, double unit) {
  std::string out = "granular mesh, binary STL";
  out.resize(80, ' ');
  const auto append = [&](const void* data, std::size_t bytes) { out.append(static_cast<const char*>(data), bytes); };
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  append(&count, 4);
  for (const std::array<int, 3>& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vec3 normal = (b - a).cross(c - a).normalized();
    for (const Vec3& p : {normal, Vec3(a / unit), Vec3(b / unit), Vec3(c / unit)}) {
      const Eigen::Vector3f single = p.cast<float>();
      append(single.data(), 12);
    }
    const std::uint16_t attributes = 0;
    append(&attributes, 2);
  }
  return out;
}

// Rows of vertices and triangles, each led by a word.
std::string rows(const TriangleMesh& mesh, double unit, const std::string& vertexWord, const std::string& faceWord,
                 int firstIndex) {
  std::string out;
  for (const Vec3& v : mesh.vertices) {
    out += fmt::format("{}{:.9g} {:.9g} {:.9g}\n", vertexWord, v.x() / unit, v.y() / unit, v.z() / unit);
  }
  for (const std::array<int, 3>& t : mesh.triangles) {
    out += fmt::format("{}{} {} {}\n", faceWord, t[0] + firstIndex, t[1] + firstIndex, t[2] + firstIndex);
  }
  return out;
}

}  // namespace

void writeMesh(const std::string& path, const TriangleMesh& mesh, double metresPerUnit) {
  const std::string extension = std::filesystem::path(path).extension().string();
  std::string content;
  if (extension == ".stl") {
    content = stlBytes(mesh, metresPerUnit);
  } else if (extension == ".obj") {
    content = rows(mesh, metresPerUnit, "v ", "f ", 1);
  } else if (extension == ".off") {
    content = fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size()) +
              rows(mesh, metresPerUnit, "", "3 ", 0);
  } else if (extension == ".ply") {
    content = fmt::format(
                  "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                  mesh.vertices.size(), mesh.triangles.size()) +
              rows(mesh, metresPerUnit, "", "3 ", 0);
  } else {
    throw InputError("mesh " + path + ": can't write format '" + extension + "'; allowed: .stl .obj .ply .off");
  }
  std::ofstream out(path, std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (!out) throw InputError("mesh " + path + ": can't be written");
}

}  // namespace granular
