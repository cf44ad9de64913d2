// Joining grows from the largest face outward and measures against that face's plane alone, so that errors cannot add
// up along a curved surface. Flattening alternates between fitting planes and projecting every vertex onto the
// intersection of its planes (least squares), which converges geometrically because the faces are nearly flat to begin
// with.
#include "granular/shape/flat_faces.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "granular/shape/hull.h"

namespace granular {

namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

double faceArea(std::span<const Vec3> vertices, const FaceCorners& face) {
  const Vec3& origin = vertices[at(face[0])];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < face.size(); ++k) {
    sum += (vertices[at(face[k])] - origin).cross(vertices[at(face[k + 1])] - origin);
  }
  return sum.norm() / 2;
}

/// The face on the other side of a directed edge; -1 if there is none.
std::int32_t faceAcross(const std::vector<FaceSide>& sides, std::int32_t from, std::int32_t to) {
  const auto found = std::lower_bound(sides.begin(), sides.end(), FaceSide{to, from, -1});
  return found != sides.end() && found->from == to && found->to == from ? found->face : -1;
}

/// The outline of a group of faces, one simple loop, or empty if it is none. group: group of each face.
FaceCorners outline(const std::vector<FaceCorners>& faces, const std::vector<FaceSide>& sides,
                    const std::vector<std::int32_t>& members, const std::vector<std::int32_t>& group) {
  std::vector<std::pair<std::int32_t, std::int32_t>> border;
  for (std::int32_t f : members) {
    const FaceCorners& face = faces[at(f)];
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::int32_t a = face[k], b = face[(k + 1) % face.size()];
      const std::int32_t other = faceAcross(sides, a, b);
      if (other < 0 || group[at(other)] != group[at(f)]) border.emplace_back(a, b);
    }
  }
  std::sort(border.begin(), border.end());
  FaceCorners loop;
  if (border.empty()) return loop;
  for (std::int32_t v = border[0].first; loop.size() <= border.size();) {
    loop.push_back(v);
    const auto next = std::lower_bound(border.begin(), border.end(), std::pair(v, std::int32_t{-1}));
    // a vertex that the outline passes twice, or leaves nowhere
    if (next == border.end() || next->first != v) return {};
    if (next + 1 != border.end() && (next + 1)->first == v) return {};
    v = next->second;
    if (v == border[0].first) break;
  }
  return loop.size() == border.size() ? loop : FaceCorners{};
}

}  // namespace

std::vector<FaceSide> faceSides(const std::vector<FaceCorners>& faces) {
  std::vector<FaceSide> sides;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const FaceCorners& face = faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      sides.push_back({face[k], face[(k + 1) % face.size()], static_cast<std::int32_t>(f)});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

void dropIdleCorners(std::size_t vertexCount, std::vector<FaceCorners>& faces) {
  for (bool again = true; again;) {
    again = false;
    std::vector<int> uses(vertexCount, 0);
    for (const FaceCorners& face : faces) {
      for (std::int32_t c : face) ++uses[at(c)];
    }
    for (FaceCorners& face : faces) {
      const auto dropped = std::erase_if(face, [&](std::int32_t c) { return uses[at(c)] < 3; });
      again = again || dropped > 0;
    }
    const auto lost = std::erase_if(faces, [](const FaceCorners& face) { return face.size() < 3; });
    again = again || lost > 0;
  }
}

std::vector<FaceCorners> joinFlatFaces(std::span<const Vec3> vertices, const std::vector<FaceCorners>& faces,
                                       double flatness) {
  const std::vector<FaceSide> sides = faceSides(faces);
  std::vector<double> areas;
  for (const FaceCorners& face : faces) areas.push_back(faceArea(vertices, face));
  std::vector<std::int32_t> bySize(faces.size());
  std::iota(bySize.begin(), bySize.end(), 0);
  std::stable_sort(bySize.begin(), bySize.end(),
                   [&](std::int32_t a, std::int32_t b) { return areas[at(a)] > areas[at(b)]; });

  std::vector<std::int32_t> group(faces.size(), -1);
  std::vector<FaceCorners> joined;
  for (std::int32_t seed : bySize) {
    if (group[at(seed)] >= 0) continue;
    const Vec3 normal = polygonNormal(vertices, faces[at(seed)]);
    const Vec3& origin = vertices[at(faces[at(seed)][0])];
    const auto isFlat = [&](std::int32_t f) {
      return std::all_of(faces[at(f)].begin(), faces[at(f)].end(),
                         [&](std::int32_t c) { return std::abs(normal.dot(vertices[at(c)] - origin)) <= flatness; });
    };
    // flood over the neighbours
    std::vector<std::int32_t> members{seed};
    group[at(seed)] = seed;
    for (std::size_t k = 0; k < members.size(); ++k) {
      const FaceCorners& face = faces[at(members[k])];
      for (std::size_t j = 0; j < face.size(); ++j) {
        const std::int32_t other = faceAcross(sides, face[j], face[(j + 1) % face.size()]);
        if (other < 0 || group[at(other)] >= 0 || !isFlat(other)) continue;
        group[at(other)] = seed;
        members.push_back(other);
      }
    }
    FaceCorners loop = members.size() == 1 ? faces[at(seed)] : outline(faces, sides, members, group);
    if (!loop.empty()) {
      joined.push_back(std::move(loop));
    } else {
      for (std::int32_t f : members) joined.push_back(faces[at(f)]);
    }
  }
  return joined;
}

double flattenFaces(const std::vector<FaceCorners>& faces, std::vector<Vec3>& vertices) {
  struct Plane {
    Vec3 normal;
    double offset;
  };
  const std::vector<Vec3> before = vertices;
  double extent = 0;
  for (const Vec3& v : vertices) extent = std::max(extent, v.cwiseAbs().maxCoeff());
  const double planar = 2e-15 * extent;

  for (int round = 0; round < 100; ++round) {
    // planes of all faces that are not triangles (a triangle is planar whatever its corners do)
    std::vector<Mat3> normals(vertices.size(), Mat3::Zero());
    std::vector<Vec3> pulls(vertices.size(), Vec3::Zero());
    double worst = 0;
    for (const FaceCorners& face : faces) {
      if (face.size() == 3) continue;
      Plane plane{polygonNormal(vertices, face), 0};
      Vec3 middle = Vec3::Zero();
      for (std::int32_t c : face) middle += vertices[at(c)] / static_cast<double>(face.size());
      plane.offset = plane.normal.dot(middle);
      for (std::int32_t c : face) {
        const double off = plane.offset - plane.normal.dot(vertices[at(c)]);
        worst = std::max(worst, std::abs(off));
        normals[at(c)] += plane.normal * plane.normal.transpose();
        pulls[at(c)] += off * plane.normal;
      }
    }
    if (worst <= planar) {
      double moved = 0;
      for (std::size_t k = 0; k < vertices.size(); ++k) moved = std::max(moved, (vertices[k] - before[k]).norm());
      return moved;
    }
    // the least displacement that meets the planes best; directions no plane cares for (1e-6) stay
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      if (normals[k].isZero(0)) continue;
      const Eigen::SelfAdjointEigenSolver<Mat3> solver(normals[k]);
      for (int i = 0; i < 3; ++i) {
        const Vec3 direction = solver.eigenvectors().col(i);
        if (solver.eigenvalues()[i] > 1e-6) {
          vertices[k] += direction * (direction.dot(pulls[k]) / solver.eigenvalues()[i]);
        }
      }
    }
  }
  return infinity;
}

}  // namespace granular
