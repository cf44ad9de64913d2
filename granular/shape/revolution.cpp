// Rings of vertices between two poles; neighbouring rings are joined by two triangles per segment.
#include "granular/shape/revolution.h"

#include <algorithm>
#include <vector>

#include "granular/core/errors.h"

namespace granular {

void requireLength(const std::string& shape, const std::string& parameter, double metres) {
  char value[32];
  std::snprintf(value, sizeof value, "%.6g", metres);
  require(std::isfinite(metres) && metres > 0,
          shape + ": " + parameter + " is " + value + " m; it must be finite and above 0");
}

const RimAngles& rimAngles() {
  static const RimAngles angles = [] {
    RimAngles all;
    for (int k = 0; k < faceSamples; ++k) {
      const double angle = 2 * pi * k / faceSamples;
      all.cosine[k] = std::cos(angle);
      all.sine[k] = std::sin(angle);
    }
    return all;
  }();
  return angles;
}

Vec3 rimPoint(double radius, double z, const Vec2& first, int k) {
  const double cosine = rimAngles().cosine[k], sine = rimAngles().sine[k];
  return {radius * (first.x() * cosine - first.y() * sine), radius * (first.x() * sine + first.y() * cosine), z};
}

TriangleMesh revolve(std::span<const Vec2> profile, int segments) {
  const int around = std::max(3, segments);
  const int rings = static_cast<int>(profile.size()) - 2;
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0, 0, profile.front().y());
  for (int r = 0; r < rings; ++r) {
    const Vec2& p = profile[static_cast<std::size_t>(r) + 1];
    for (int s = 0; s < around; ++s) {
      const double angle = 2 * pi * s / around;
      mesh.vertices.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    }
  }
  mesh.vertices.emplace_back(0, 0, profile.back().y());

  const auto ring = [around](int r, int s) { return 1 + r * around + s % around; };
  const int top = 1 + rings * around;
  for (int s = 0; s < around; ++s) {
    mesh.triangles.push_back({0, ring(0, s + 1), ring(0, s)});
    for (int r = 0; r + 1 < rings; ++r) {
      mesh.triangles.push_back({ring(r, s), ring(r, s + 1), ring(r + 1, s + 1)});
      mesh.triangles.push_back({ring(r, s), ring(r + 1, s + 1), ring(r + 1, s)});
    }
    mesh.triangles.push_back({top, ring(rings - 1, s), ring(rings - 1, s + 1)});
  }
  return mesh;
}

TriangleMesh ellipsoidMesh(const Vec3& semiAxes, int resolution) {
  const int bands = std::max(2, resolution / 2);
  std::vector<Vec2> profile;
  for (int k = 0; k <= bands; ++k) {
    const double polar = pi * k / bands;
    profile.emplace_back(k == 0 || k == bands ? 0 : std::sin(polar), -std::cos(polar));
  }
  TriangleMesh mesh = revolve(profile, resolution);
  for (Vec3& v : mesh.vertices) v = v.cwiseProduct(semiAxes);
  return mesh;
}

}  // namespace granular
