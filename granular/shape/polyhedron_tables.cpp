// From faces to the tables that kernels walk, and the support search on the vertex graph. On a convex polyhedron a
// vertex none of whose neighbours is further along d is the furthest of all, so climbing needs no backtracking.
#include <algorithm>
#include <utility>

#include "granular/shape/hull.h"
#include "granular/shape/polyhedron.h"

namespace granular {

namespace {

using Edge = PolyhedronTables::Edge;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// Lists of one item kind per owner, flattened: (owner, item) pairs sorted by owner, order of items kept.
void flatten(std::vector<std::pair<std::int32_t, std::int32_t>> pairs, std::size_t owners,
             std::vector<std::int32_t>& begin, std::vector<std::int32_t>& items) {
  std::stable_sort(pairs.begin(), pairs.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
  begin.assign(owners + 1, 0);
  items.clear();
  for (const auto& [owner, item] : pairs) {
    ++begin[at(owner) + 1];
    items.push_back(item);
  }
  for (std::size_t k = 0; k < owners; ++k) begin[k + 1] += begin[k];
}

/// Normals and offsets of all faces.
void placePlanes(PolyhedronTables& tables) {
  for (std::size_t f = 0; f + 1 < tables.faceBegin.size(); ++f) {
    const std::span corners(tables.faceCorners.data() + tables.faceBegin[f],
                            at(tables.faceBegin[f + 1] - tables.faceBegin[f]));
    const Vec3 normal = polygonNormal(tables.vertices, corners);
    double offset = -infinity;
    for (std::int32_t c : corners) offset = std::max(offset, normal.dot(tables.vertices[at(c)]));
    tables.faceNormals.push_back(normal);
    tables.faceOffsets.push_back(offset);
  }
}

/// Edges in ascending order of their ends. Seen from outside, faceLeft lies left of the way from a to b (there the
/// face's corners run from a to b), faceRight right.
void linkEdges(PolyhedronTables& tables) {
  struct Side {
    std::int32_t a, b, face, corner;
    bool forward;
  };
  std::vector<Side> sides;
  for (std::int32_t f = 0; f < tables.faceCount(); ++f) {
    const std::int32_t begin = tables.faceBegin[at(f)], end = tables.faceBegin[at(f) + 1];
    for (std::int32_t k = begin; k < end; ++k) {
      const std::int32_t p = tables.faceCorners[at(k)];
      const std::int32_t q = tables.faceCorners[at(k + 1 < end ? k + 1 : begin)];
      sides.push_back({std::min(p, q), std::max(p, q), f, k, p < q});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return std::tuple(s.a, s.b, !s.forward) < std::tuple(t.a, t.b, !t.forward);
  });
  assert(sides.size() % 2 == 0);
  tables.cornerEdges.assign(tables.faceCorners.size(), -1);
  for (std::size_t k = 0; k + 1 < sides.size(); k += 2) {
    const Side &left = sides[k], &right = sides[k + 1];
    assert(left.a == right.a && left.b == right.b && left.forward && !right.forward);
    tables.cornerEdges[at(left.corner)] = static_cast<std::int32_t>(tables.edges.size());
    tables.cornerEdges[at(right.corner)] = static_cast<std::int32_t>(tables.edges.size());
    tables.edges.push_back({left.a, left.b, left.face, right.face});
  }
}

}  // namespace

PolyhedronTables makePolyhedronTables(std::vector<Vec3> vertices, std::span<const std::vector<std::int32_t>> faces) {
  PolyhedronTables tables;
  tables.vertices = std::move(vertices);
  tables.faceBegin.push_back(0);
  for (const auto& face : faces) {
    tables.faceCorners.insert(tables.faceCorners.end(), face.begin(), face.end());
    tables.faceBegin.push_back(static_cast<std::int32_t>(tables.faceCorners.size()));
  }
  placePlanes(tables);
  linkEdges(tables);

  std::vector<std::pair<std::int32_t, std::int32_t>> links;
  for (const Edge& e : tables.edges) {
    links.emplace_back(e.a, e.b);
    links.emplace_back(e.b, e.a);
  }
  flatten(std::move(links), tables.vertices.size(), tables.neighbourBegin, tables.neighbours);
  std::vector<std::pair<std::int32_t, std::int32_t>> around;
  for (std::int32_t f = 0; f < tables.faceCount(); ++f) {
    for (std::int32_t k = tables.faceBegin[at(f)]; k < tables.faceBegin[at(f) + 1]; ++k) {
      around.emplace_back(tables.faceCorners[at(k)], f);
    }
  }
  flatten(std::move(around), tables.vertices.size(), tables.vertexFaceBegin, tables.vertexFaces);
  return tables;
}

std::int32_t PolyhedronTables::supportVertex(const Vec3& d, std::int32_t start) const {
  constexpr std::size_t scanned = 20;
  if (vertices.size() <= scanned) {
    std::int32_t best = 0;
    double furthest = d.dot(vertices[0]);
    for (std::size_t v = 1; v < vertices.size(); ++v) {
      const double along = d.dot(vertices[v]);
      if (along > furthest) {
        furthest = along;
        best = static_cast<std::int32_t>(v);
      }
    }
    return best;
  }

  // climb to the furthest neighbour until none is further
  std::int32_t best = start;
  double furthest = d.dot(vertices[at(start)]);
  for (std::int32_t from = -1; from != best;) {
    from = best;
    for (std::int32_t k = neighbourBegin[at(from)]; k < neighbourBegin[at(from) + 1]; ++k) {
      const std::int32_t v = neighbours[at(k)];
      const double along = d.dot(vertices[at(v)]);
      if (along > furthest) {
        furthest = along;
        best = v;
      }
    }
  }
  return best;
}

}  // namespace granular
