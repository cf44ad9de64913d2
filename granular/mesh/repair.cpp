// The second half of the repair: edges, fins, orientation, parts.
#include "granular/mesh/repair.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace granular {
namespace {

using Triangle = std::array<int, 3>;

struct EdgeCounts {
  std::int64_t edges = 0, open = 0, nonManifold = 0;
};

EdgeCounts countEdges(const std::vector<Triangle>& triangles) {
  EdgeCounts counts;
  forEachEdge(listEdgeUses(triangles), [&](const EdgeUse* first, const EdgeUse* last) {
    ++counts.edges;
    if (last - first == 1) ++counts.open;
    if (last - first > 2) ++counts.nonManifold;
  });
  return counts;
}

double areaOf(const TriangleMesh& mesh, const Triangle& t) {
  return 0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
}

// Signed tetrahedra about a point of the part: exact for a closed part, an estimate for one with small holes.
double volumeOf(const TriangleMesh& mesh, const std::vector<int>& triangles) {
  Vec3 origin = Vec3::Zero();
  for (const int t : triangles) origin += mesh.vertices[mesh.triangles[t][0]];
  origin /= static_cast<double>(std::max<std::size_t>(triangles.size(), 1));
  double six = 0;
  for (const int t : triangles) {
    const Triangle& c = mesh.triangles[t];
    six += (mesh.vertices[c[0]] - origin).dot((mesh.vertices[c[1]] - origin).cross(mesh.vertices[c[2]] - origin));
  }
  return six / 6;
}

// Pieces: triangles connected across edges of exactly two triangles.
struct Pieces {
  std::vector<int> labelOf;                 // per triangle
  std::vector<std::vector<int>> triangles;  // per piece, ascending
  std::vector<double> areas;                // per piece
};

Pieces findPieces(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses) {
  // Union-find over the two-triangle edges.
  std::vector<int> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  forEachEdge(uses, [&](const EdgeUse* first, const EdgeUse* last) {
    if (last - first != 2) return;
    const int a = root(first[0].triangle), b = root(first[1].triangle);
    parent[std::max(a, b)] = std::min(a, b);
  });
  // Labels in the order of each piece's first triangle.
  Pieces pieces;
  pieces.labelOf.assign(mesh.triangles.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int r = root(static_cast<int>(t));
    if (pieces.labelOf[r] < 0) {
      pieces.labelOf[r] = static_cast<int>(pieces.triangles.size());
      pieces.triangles.emplace_back();
      pieces.areas.push_back(0);
    }
    const int label = pieces.labelOf[t] = pieces.labelOf[r];
    pieces.triangles[label].push_back(static_cast<int>(t));
    pieces.areas[label] += areaOf(mesh, mesh.triangles[t]);
  }
  return pieces;
}

// Triangles of open pieces that are the smallest at a non-manifold edge where several pieces meet.
std::vector<bool> findFins(const std::vector<EdgeUse>& uses, const Pieces& pieces) {
  // A piece is open when it uses some edge an odd number of times.
  std::vector<bool> isOpen(pieces.triangles.size(), false), isFin(pieces.triangles.size(), false);
  forEachEdge(uses, [&](const EdgeUse* first, const EdgeUse* last) {
    for (const EdgeUse* use = first; use != last; ++use) {
      const int label = pieces.labelOf[use->triangle];
      const auto count =
          std::count_if(first, last, [&](const EdgeUse& u) { return pieces.labelOf[u.triangle] == label; });
      if (count % 2 != 0) isOpen[label] = true;
    }
  });
  forEachEdge(uses, [&](const EdgeUse* first, const EdgeUse* last) {
    if (last - first < 3) return;
    std::set<int> labels;
    for (const EdgeUse* use = first; use != last; ++use) labels.insert(pieces.labelOf[use->triangle]);
    const int least = *std::min_element(labels.begin(), labels.end(),
                                        [&](int a, int b) { return pieces.areas[a] < pieces.areas[b]; });
    if (labels.size() > 1 && isOpen[least]) isFin[least] = true;
  });
  std::vector<bool> fin(pieces.labelOf.size());
  for (std::size_t t = 0; t < fin.size(); ++t) fin[t] = isFin[pieces.labelOf[t]];
  return fin;
}

// Drops fins as long as that leaves fewer open and non-manifold edges.
void dropFins(TriangleMesh& mesh, MeshDefects& defects) {
  EdgeCounts before = countEdges(mesh.triangles);
  while (before.nonManifold > 0) {
    const std::vector<EdgeUse> uses = listEdgeUses(mesh.triangles);
    const std::vector<bool> fin = findFins(uses, findPieces(mesh, uses));
    std::vector<Triangle> rest;
    for (std::size_t t = 0; t < fin.size(); ++t) {
      if (!fin[t]) rest.push_back(mesh.triangles[t]);
    }
    const EdgeCounts after = countEdges(rest);
    if (rest.empty() || after.open + after.nonManifold >= before.open + before.nonManifold) return;
    defects.finTriangles += static_cast<std::int64_t>(mesh.triangles.size() - rest.size());
    mesh.triangles = std::move(rest);
    before = after;
  }
}

// Gives every piece one orientation, that of its majority, by a walk across the two-triangle edges.
void orientPieces(TriangleMesh& mesh, const std::vector<EdgeUse>& uses, const Pieces& pieces, MeshDefects& defects) {
  struct Link {
    int neighbour;
    bool against;  // the two pass their edge in the same direction
  };
  std::vector<std::vector<Link>> links(mesh.triangles.size());
  forEachEdge(uses, [&](const EdgeUse* first, const EdgeUse* last) {
    if (last - first != 2) return;
    const bool against = first[0].forward == first[1].forward;
    links[first[0].triangle].push_back({first[1].triangle, against});
    links[first[1].triangle].push_back({first[0].triangle, against});
  });
  std::vector<signed char> turned(mesh.triangles.size(), -1);
  std::int64_t conflicts = 0;
  for (const std::vector<int>& piece : pieces.triangles) {
    std::vector<int> queue = {piece.front()};
    turned[piece.front()] = 0;
    for (std::size_t at = 0; at < queue.size(); ++at) {
      for (const Link& link : links[queue[at]]) {
        const auto wanted = static_cast<signed char>(turned[queue[at]] ^ static_cast<int>(link.against));
        if (turned[link.neighbour] < 0) {
          turned[link.neighbour] = wanted;
          queue.push_back(link.neighbour);
        } else if (turned[link.neighbour] != wanted) {
          ++conflicts;  // seen from both sides: twice per edge
        }
      }
    }
    // The majority stays as it is; a tie keeps the first triangle.
    const auto minority = std::count_if(piece.begin(), piece.end(), [&](int t) { return turned[t] == 1; });
    const bool other = 2 * minority > static_cast<std::int64_t>(piece.size());
    for (const int t : piece) {
      if ((turned[t] == 1) == other) continue;
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      ++defects.flippedTriangles;
    }
  }
  defects.unorientableEdges = conflicts / 2;
}

std::vector<Triangle> trianglesOf(const TriangleMesh& mesh, const std::vector<int>& piece) {
  std::vector<Triangle> triangles;
  for (const int t : piece) triangles.push_back(mesh.triangles[t]);
  return triangles;
}

// Closed: the boundary as a chain is zero, so that the signed volume means something even at a pinched edge.
bool isClosed(const std::vector<Triangle>& triangles) {
  bool closed = true;
  forEachEdge(listEdgeUses(triangles), [&](const EdgeUse* first, const EdgeUse* last) {
    closed = closed && 2 * std::count_if(first, last, [](const EdgeUse& u) { return u.forward; }) == last - first;
  });
  return closed;
}

// The closed part of the largest volume, unless an open part has more than twice its area: then the open one is the
// body.
std::size_t chooseParts(const TriangleMesh& mesh, const Pieces& pieces) {
  std::size_t best = 0, widest = 0;
  double bestVolume = -1;
  for (std::size_t k = 0; k < pieces.triangles.size(); ++k) {
    if (pieces.areas[k] > pieces.areas[widest]) widest = k;
    if (!isClosed(trianglesOf(mesh, pieces.triangles[k]))) continue;
    const double volume = std::abs(volumeOf(mesh, pieces.triangles[k]));
    if (volume > bestVolume) {
      best = k;
      bestVolume = volume;
    }
  }
  return bestVolume < 0 || pieces.areas[widest] > 2 * pieces.areas[best] ? widest : best;
}

}  // namespace

RepairedMesh repairMesh(const RawMesh& raw) {
  RepairedMesh out;
  MeshDefects& defects = out.defects;
  TriangleMesh mesh = weldMesh(raw, defects);
  if (mesh.triangles.empty()) return out;

  // The whole mesh as it is.
  const EdgeCounts all = countEdges(mesh.triangles);
  defects.openEdges = all.open;
  defects.nonManifoldEdges = all.nonManifold;
  defects.euler =
      static_cast<std::int64_t>(mesh.vertices.size()) - all.edges + static_cast<std::int64_t>(mesh.triangles.size());

  dropFins(mesh, defects);
  const std::vector<EdgeUse> uses = listEdgeUses(mesh.triangles);
  const Pieces pieces = findPieces(mesh, uses);
  orientPieces(mesh, uses, pieces, defects);

  // One part stays.
  const std::size_t kept = chooseParts(mesh, pieces);
  defects.parts = static_cast<std::int64_t>(pieces.triangles.size());
  defects.droppedParts = defects.parts - 1;
  defects.droppedTriangles = static_cast<std::int64_t>(mesh.triangles.size() - pieces.triangles[kept].size());
  for (std::size_t k = 0; k < pieces.areas.size(); ++k) {
    if (k != kept) out.kept.droppedArea = std::max(out.kept.droppedArea, pieces.areas[k] / pieces.areas[kept]);
  }
  defects.insideOut = volumeOf(mesh, pieces.triangles[kept]) < 0;
  out.mesh.vertices = mesh.vertices;
  out.mesh.triangles = trianglesOf(mesh, pieces.triangles[kept]);
  if (defects.insideOut) {
    for (Triangle& triangle : out.mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  dropUnusedVertices(out.mesh);

  // What it is like.
  const EdgeCounts edges = countEdges(out.mesh.triangles);
  out.kept.closed = isClosed(out.mesh.triangles);
  out.kept.openEdges = edges.open;
  out.kept.nonManifoldEdges = edges.nonManifold;
  out.kept.euler = static_cast<std::int64_t>(out.mesh.vertices.size()) - edges.edges +
                   static_cast<std::int64_t>(out.mesh.triangles.size());
  if (out.kept.closed) out.kept.handles = (2 - out.kept.euler) / 2;
  return out;
}

}  // namespace granular
