// From faces to the tables that kernels walk, and the support search on the vertex graph. On a convex polyhedron a
// vertex none of whose neighbours is further along d is the furthest of all, so climbing needs no backtracking.
#include <algorithm>
#include <memory>
#include <utility>

#include "granular/shape/hull.h"
#include "granular/shape/polyhedron.h"

namespace granular {

namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

}  // namespace

/// The tables while they are made.
struct PolyhedronTables::Parts {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<Spoke> spokes;
  std::vector<Corner> corners;
  std::vector<std::int32_t> spokeBegin, cornerBegin;

  std::int32_t faceCount() const { return static_cast<std::int32_t>(cornerBegin.size()) - 1; }
  std::span<const Corner> cornersOf(std::int32_t face) const { return slice<Corner>(corners, cornerBegin, face); }
  /// So many corners of the face after this one (an index in all corners), at least -1.
  std::int32_t vertexBeside(std::int32_t face, std::int32_t corner, std::int32_t after) const {
    const auto around = cornersOf(face);
    const std::size_t here = at(corner - cornerBegin[at(face)]);
    return around[(here + around.size() + at(after + 1) - 1) % around.size()].vertex;
  }
  void placePlanes();
  void linkEdges();
  void layOutSpokes();
};

/// Normals and offsets of all faces.
void PolyhedronTables::Parts::placePlanes() {
  std::vector<std::int32_t> around;
  for (std::int32_t f = 0; f < faceCount(); ++f) {
    around.clear();
    for (const Corner& c : cornersOf(f)) around.push_back(c.vertex);
    const Vec3 normal = polygonNormal(vertices, around);
    double offset = -infinity;
    for (std::int32_t c : around) offset = std::max(offset, normal.dot(vertices[at(c)]));
    faces.push_back({normal, offset});
  }
}

/// Edges in ascending order of their ends. Seen from outside, faceLeft lies left of the way from a to b (there the
/// face's corners run from a to b), faceRight right.
void PolyhedronTables::Parts::linkEdges() {
  struct Side {
    std::int32_t a, b, face, corner;
    bool forward;
  };
  std::vector<Side> sides;
  for (std::int32_t f = 0; f < faceCount(); ++f) {
    const std::int32_t begin = cornerBegin[at(f)], end = cornerBegin[at(f) + 1];
    for (std::int32_t k = begin; k < end; ++k) {
      const std::int32_t p = corners[at(k)].vertex, q = corners[at(k + 1 < end ? k + 1 : begin)].vertex;
      sides.push_back({std::min(p, q), std::max(p, q), f, k, p < q});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return std::tuple(s.a, s.b, !s.forward) < std::tuple(t.a, t.b, !t.forward);
  });
  assert(sides.size() % 2 == 0);
  for (std::size_t k = 0; k + 1 < sides.size(); k += 2) {
    const Side &left = sides[k], &right = sides[k + 1];
    assert(left.a == right.a && left.b == right.b && left.forward && !right.forward);
    const auto edge = static_cast<std::int32_t>(edges.size());
    Corner &ofLeft = corners[at(left.corner)], &ofRight = corners[at(right.corner)];
    ofLeft.edge = ofRight.edge = edge;
    ofLeft.beyond = right.face;
    ofRight.beyond = left.face;
    edges.push_back({left.a,
                     left.b,
                     left.face,
                     right.face,
                     {vertexBeside(left.face, left.corner, -1), vertexBeside(left.face, left.corner, 2),
                      vertexBeside(right.face, right.corner, -1), vertexBeside(right.face, right.corner, 2)}});
  }
}

/// Around each vertex from face to face: the edge that ends a face here begins the next spoke.
void PolyhedronTables::Parts::layOutSpokes() {
  /// One per corner: the spoke out of it along its face's own edge, found from vertex and face.
  struct Way {
    std::int32_t vertex, face, to, before;  // before: the corner ahead of it in the face
  };
  std::vector<Way> ways;
  for (std::int32_t f = 0; f < faceCount(); ++f) {
    const auto around = cornersOf(f);
    for (std::size_t k = 0; k < around.size(); ++k) {
      ways.push_back({around[k].vertex, f, around[(k + 1) % around.size()].vertex,
                      around[(k + around.size() - 1) % around.size()].vertex});
    }
  }
  std::sort(ways.begin(), ways.end(),
            [](const Way& p, const Way& q) { return std::pair(p.vertex, p.face) < std::pair(q.vertex, q.face); });

  for (std::size_t begin = 0; begin < ways.size();) {
    const std::size_t from = begin;
    while (begin < ways.size() && ways[begin].vertex == ways[from].vertex) ++begin;
    spokeBegin.push_back(static_cast<std::int32_t>(spokes.size()));
    for (std::size_t here = from, count = from; count < begin; ++count) {
      const Way& way = ways[here];
      spokes.push_back({way.to, way.face});
      here = from;
      while (here + 1 < begin && ways[here].to != way.before) ++here;
    }
  }
  spokeBegin.push_back(static_cast<std::int32_t>(spokes.size()));
  assert(spokeBegin.size() == vertices.size() + 1);
}

/// Lays the parts out one after the other, those that a contact reads first.
PolyhedronTables::PolyhedronTables(const Parts& parts) {
  const auto visit = [&](auto&& each) {
    each(parts.vertices, vertices);
    each(parts.faces, faces);
    each(parts.spokeBegin, spokeBegin);
    each(parts.spokes, spokes);
    each(parts.cornerBegin, cornerBegin);
    each(parts.corners, corners);
    each(parts.edges, edges);
  };
  /// Of a table, in doubles.
  const auto room = [](const auto& part) {
    return (part.size() * sizeof(part[0]) + sizeof(double) - 1) / sizeof(double);
  };
  visit([&](const auto& part, auto&) { blockSize += room(part); });
  auto memory = std::make_shared<double[]>(blockSize);
  double* next = memory.get();
  visit([&]<class T>(const std::vector<T>& part, std::span<const T>& table) {
    static_assert(alignof(T) <= alignof(double));
    T* begin = reinterpret_cast<T*>(next);
    std::uninitialized_copy(part.begin(), part.end(), begin);
    table = {begin, part.size()};
    next += room(part);
  });
  block = std::move(memory);
}

PolyhedronTables makePolyhedronTables(std::vector<Vec3> vertices, std::span<const std::vector<std::int32_t>> corners) {
  PolyhedronTables::Parts parts;
  parts.vertices = std::move(vertices);
  parts.cornerBegin.push_back(0);
  for (const auto& face : corners) {
    for (const std::int32_t v : face) parts.corners.push_back({v, -1, -1});
    parts.cornerBegin.push_back(static_cast<std::int32_t>(parts.corners.size()));
  }
  parts.placePlanes();
  parts.linkEdges();
  parts.layOutSpokes();
  return PolyhedronTables(parts);
}

PolyhedronTables PolyhedronTables::scaled(double factor) const {
  const auto copy = [](const auto& table) { return std::vector(table.begin(), table.end()); };
  Parts parts{copy(vertices), copy(faces),      copy(edges),      copy(spokes),
              copy(corners),  copy(spokeBegin), copy(cornerBegin)};
  for (Vec3& v : parts.vertices) v *= factor;
  for (Face& face : parts.faces) face.offset *= factor;
  return PolyhedronTables(parts);
}

double PolyhedronTables::leastOffset() const {
  double least = infinity;
  for (const Face& face : faces) least = std::min(least, face.offset);
  return least;
}

std::int32_t PolyhedronTables::supportVertex(const Vec3& d, std::int32_t start) const {
  constexpr std::size_t scanned = 20;
  if (vertices.size() > scanned) return climb(d, start);
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

std::int32_t PolyhedronTables::climb(const Vec3& d, std::int32_t start) const {
  std::int32_t best = start;
  double furthest = d.dot(vertices[at(start)]);
  for (std::int32_t from = -1; from != best;) {
    from = best;
    for (const Spoke& spoke : spokesOf(from)) {
      const double along = d.dot(vertices[at(spoke.vertex)]);
      if (along > furthest) {
        furthest = along;
        best = spoke.vertex;
      }
    }
  }
  return best;
}

}  // namespace granular
