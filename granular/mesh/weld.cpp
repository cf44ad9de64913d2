// The first half of the repair: vertices and single triangles.
#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "granular/mesh/repair.h"

namespace granular {
namespace {

using Triangle = std::array<int, 3>;

bool isLess(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

// Positions that are exactly equal get one number, in the order of first appearance; -1 for vertices left out.
struct Joined {
  std::vector<int> numberOf;    // per vertex
  std::vector<Vec3> positions;  // per number
};

Joined joinEqual(const std::vector<Vec3>& vertices, const std::vector<bool>& takesPart) {
  Joined joined;
  joined.numberOf.assign(vertices.size(), -1);
  std::vector<int> order;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (takesPart[v]) order.push_back(static_cast<int>(v));
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    if (isLess(vertices[a], vertices[b])) return true;
    return !isLess(vertices[b], vertices[a]) && a < b;
  });
  // The first of each run of equals stands for it.
  std::vector<int> first(vertices.size(), -1);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && vertices[order[k]] == vertices[order[k - 1]];
    first[order[k]] = same ? first[order[k - 1]] : order[k];
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (first[v] == static_cast<int>(v)) {
      joined.numberOf[v] = static_cast<int>(joined.positions.size());
      joined.positions.push_back(vertices[v]);
    }
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (first[v] >= 0) joined.numberOf[v] = joined.numberOf[first[v]];
  }
  return joined;
}

// Joins positions closer than distance to the first such one before them. Cells of 16 distances: nearly always
// one look-up per position.
Joined joinNear(const std::vector<Vec3>& positions, const Vec3& lo, double distance) {
  Joined joined;
  std::unordered_map<std::uint64_t, std::vector<int>> cells;
  const double cell = 16 * distance;
  const auto indexOf = [&](double coordinate, int axis) {
    return static_cast<std::uint64_t>(std::max(0.0, std::floor((coordinate - lo[axis]) / cell)));
  };
  for (const Vec3& p : positions) {
    // Every cell that the ball about p reaches.
    std::array<std::uint64_t, 3> from{}, to{};
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = indexOf(p[axis] - distance, axis);
      to[axis] = indexOf(p[axis] + distance, axis);
    }
    int found = -1;
    for (std::uint64_t x = from[0]; x <= to[0]; ++x) {
      for (std::uint64_t y = from[1]; y <= to[1]; ++y) {
        for (std::uint64_t z = from[2]; z <= to[2]; ++z) {
          const auto at = cells.find((x << 42) | (y << 21) | z);
          if (at == cells.end()) continue;
          for (const int k : at->second) {
            if ((joined.positions[k] - p).norm() <= distance && (found < 0 || k < found)) found = k;
          }
        }
      }
    }
    if (found < 0) {
      found = static_cast<int>(joined.positions.size());
      joined.positions.push_back(p);
      cells[(indexOf(p.x(), 0) << 42) | (indexOf(p.y(), 1) << 21) | indexOf(p.z(), 2)].push_back(found);
    }
    joined.numberOf.push_back(found);
  }
  return joined;
}

// Non-finite and unreferenced vertices; returns which vertices take part in the weld.
std::vector<bool> sortOutVertices(const RawMesh& raw, MeshDefects& defects) {
  std::vector<bool> takesPart(raw.vertices.size(), false);
  for (const Triangle& triangle : raw.triangles) {
    for (const int corner : triangle) takesPart[corner] = true;
  }
  defects.unreferencedVertices = std::count(takesPart.begin(), takesPart.end(), false);
  std::vector<std::array<std::uint64_t, 3>> nonFinite;
  for (std::size_t v = 0; v < raw.vertices.size(); ++v) {
    if (raw.vertices[v].allFinite()) continue;
    takesPart[v] = false;
    std::array<std::uint64_t, 3> bits{};
    std::memcpy(bits.data(), raw.vertices[v].data(), sizeof bits);
    nonFinite.push_back(bits);
  }
  // Listed per corner, copies of one vertex carry the same bits.
  if (raw.perCorner) {
    std::sort(nonFinite.begin(), nonFinite.end());
    nonFinite.erase(std::unique(nonFinite.begin(), nonFinite.end()), nonFinite.end());
  }
  defects.nonFiniteVertices = static_cast<std::int64_t>(nonFinite.size());
  if (raw.file) {
    defects.unreferencedVertices = raw.file->unreferenced;
    defects.nonFiniteVertices = std::max(raw.file->nonFinite, defects.nonFiniteVertices);
  }
  return takesPart;
}

// True for every triangle that repeats the corners of an earlier one.
std::vector<bool> findDuplicates(const std::vector<Triangle>& triangles) {
  std::vector<Triangle> sorted = triangles;
  for (Triangle& triangle : sorted) std::sort(triangle.begin(), triangle.end());
  std::vector<int> order(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::tie(sorted[a], a) < std::tie(sorted[b], b); });
  std::vector<bool> duplicate(triangles.size(), false);
  for (std::size_t k = 1; k < order.size(); ++k) duplicate[order[k]] = sorted[order[k]] == sorted[order[k - 1]];
  return duplicate;
}

void dropTriangles(std::vector<Triangle>& triangles, const std::vector<bool>& drop) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!drop[t]) triangles[kept++] = triangles[t];
  }
  triangles.resize(kept);
}

// Triangles without area whose corners differ: dropped while that opens no more edges than it removes.
void dropZeroArea(TriangleMesh& mesh, MeshDefects& defects) {
  for (bool dropped = true; dropped;) {
    dropped = false;
    std::vector<bool> flat(mesh.triangles.size(), false);
    for (std::size_t t = 0; t < flat.size(); ++t) {
      flat[t] = measureTriangle(mesh, mesh.triangles[t]).altitude <= defects.weldDistance;
    }
    defects.zeroAreaKept = std::count(flat.begin(), flat.end(), true);
    if (defects.zeroAreaKept == 0) return;
    // How many of each flat triangle's edges would vanish, and how many would open.
    std::vector<int> vanish(flat.size(), 0), open(flat.size(), 0);
    forEachEdge(listEdgeUses(mesh.triangles), [&](const EdgeUse* first, const EdgeUse* last) {
      for (const EdgeUse* use = first; use != last; ++use) {
        if (last - first == 1) ++vanish[use->triangle];
        if (last - first == 2) ++open[use->triangle];
      }
    });
    for (std::size_t t = 0; t < flat.size(); ++t) flat[t] = flat[t] && open[t] <= vanish[t];
    const auto count = std::count(flat.begin(), flat.end(), true);
    dropTriangles(mesh.triangles, flat);
    defects.degenerateTriangles += count;
    defects.zeroAreaKept -= count;
    dropped = count > 0;
  }
}

}  // namespace

TriangleMeasure measureTriangle(const TriangleMesh& mesh, const Triangle& triangle) {
  const Vec3 &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]], &c = mesh.vertices[triangle[2]];
  TriangleMeasure measure;
  measure.longestEdge = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  if (measure.longestEdge > 0) measure.altitude = (b - a).cross(c - a).norm() / measure.longestEdge;
  return measure;
}

std::vector<EdgeUse> listEdgeUses(const std::vector<Triangle>& triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint64_t>(triangles[t][k]),
                 b = static_cast<std::uint64_t>(triangles[t][(k + 1) % 3]);
      uses.push_back({(std::min(a, b) << 32) | std::max(a, b), static_cast<std::int32_t>(t), a < b});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.edge, a.triangle) < std::tie(b.edge, b.triangle);
  });
  return uses;
}

void dropUnusedVertices(TriangleMesh& mesh) {
  std::vector<int> number(mesh.vertices.size(), -1);
  for (const Triangle& triangle : mesh.triangles) {
    for (const int corner : triangle) number[corner] = 0;
  }
  int kept = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    mesh.vertices[static_cast<std::size_t>(kept)] = mesh.vertices[v];
    number[v] = kept++;
  }
  mesh.vertices.resize(static_cast<std::size_t>(kept));
  for (Triangle& triangle : mesh.triangles) {
    for (int& corner : triangle) corner = number[corner];
  }
}

TriangleMesh weldMesh(const RawMesh& raw, MeshDefects& defects) {
  const std::vector<bool> takesPart = sortOutVertices(raw, defects);
  TriangleMesh mesh;

  // The weld distance from the extent of what is used.
  Aabb box;
  std::int64_t used = 0;
  for (std::size_t v = 0; v < raw.vertices.size(); ++v) {
    if (!takesPart[v]) continue;
    box.include(raw.vertices[v]);
    ++used;
  }
  if (used == 0) return mesh;
  const double largest = std::max(box.lo.cwiseAbs().maxCoeff(), box.hi.cwiseAbs().maxCoeff());
  defects.coordinateStep = static_cast<double>(std::numeric_limits<float>::epsilon()) * largest;
  defects.weldDistance = std::max(weldFraction * (box.hi - box.lo).norm(), defects.coordinateStep);

  // Equal positions first, then close ones. (No distance: all vertices are in one place.)
  Joined equal = joinEqual(raw.vertices, takesPart);
  const std::int64_t distinct = static_cast<std::int64_t>(equal.positions.size());
  if (defects.weldDistance > 0) {
    Joined near = joinNear(equal.positions, box.lo, defects.weldDistance);
    for (int& number : equal.numberOf) number = number < 0 ? -1 : near.numberOf[number];
    equal.positions = std::move(near.positions);
  }
  mesh.vertices = std::move(equal.positions);
  const std::int64_t listed = raw.file ? raw.file->usable : raw.perCorner ? distinct : used;
  defects.duplicateVertices = listed - static_cast<std::int64_t>(mesh.vertices.size());

  // Triangles over welded vertices.
  for (const Triangle& old : raw.triangles) {
    const Triangle triangle = {equal.numberOf[old[0]], equal.numberOf[old[1]], equal.numberOf[old[2]]};
    if (std::min({triangle[0], triangle[1], triangle[2]}) < 0) continue;
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      ++defects.degenerateTriangles;
    } else {
      mesh.triangles.push_back(triangle);
    }
  }
  const std::vector<bool> duplicate = findDuplicates(mesh.triangles);
  defects.duplicateTriangles = std::count(duplicate.begin(), duplicate.end(), true);
  dropTriangles(mesh.triangles, duplicate);
  dropZeroArea(mesh, defects);

  for (const Triangle& triangle : mesh.triangles) {
    const TriangleMeasure measure = measureTriangle(mesh, triangle);
    if (measure.altitude > defects.weldDistance && measure.altitude < sliverFraction * measure.longestEdge)
      ++defects.slivers;
  }
  dropUnusedVertices(mesh);
  return mesh;
}

}  // namespace granular
