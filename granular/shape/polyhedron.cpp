// Convex polyhedra of any number of vertices: hull, body frame, support features.
#include "granular/shape/polyhedron.h"

#include <algorithm>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"
#include "granular/shape/hull.h"

namespace granular {

namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// A vertex in the slab: its height along d and its coordinates in the plane seen along d.
struct SlabVertex {
  double height, u, v;
  std::int32_t index;
};

/// The vertices within a slab, at most Feature::capacity, the deepest if there are more. No allocation.
class SlabVertices {
 public:
  bool holds(std::int32_t index) const {
    return std::any_of(begin(), end(), [index](const SlabVertex& s) { return s.index == index; });
  }
  bool isFull() const { return count == Feature::capacity; }
  void push(const SlabVertex& vertex) {
    if (!isFull()) {
      items[at(count++)] = vertex;
      return;
    }
    const auto lowest = std::min_element(items.begin(), items.end(),
                                         [](const SlabVertex& s, const SlabVertex& t) { return s.height < t.height; });
    if (vertex.height > lowest->height) *lowest = vertex;
  }
  const SlabVertex& operator[](int k) const { return items[at(k)]; }
  int size() const { return count; }
  void clear() { count = 0; }
  SlabVertex* begin() { return items.data(); }
  SlabVertex* end() { return items.data() + count; }
  const SlabVertex* begin() const { return items.data(); }
  const SlabVertex* end() const { return items.data() + count; }

 private:
  std::array<SlabVertex, Feature::capacity> items;
  int count = 0;
};

/// Collects the vertices no lower than floor along d. They are connected in the vertex graph: flood from the highest;
/// small polyhedra and slabs of very many vertices are scanned.
void collectSlab(const PolyhedronTables& tables, const Vec3& d, double floor, std::int32_t highest,
                 SlabVertices& found) {
  constexpr int scanned = 20;
  if (tables.vertexCount() > scanned) {
    found.push({d.dot(tables.vertices[at(highest)]), 0, 0, highest});
    for (int k = 0; k < found.size() && !found.isFull(); ++k) {
      const std::int32_t from = found[k].index;
      for (std::int32_t j = tables.neighbourBegin[at(from)]; j < tables.neighbourBegin[at(from) + 1]; ++j) {
        const std::int32_t v = tables.neighbours[at(j)];
        const double height = d.dot(tables.vertices[at(v)]);
        if (height >= floor && !found.isFull() && !found.holds(v)) found.push({height, 0, 0, v});
      }
    }
    if (!found.isFull()) return;
    found.clear();
  }
  for (std::int32_t v = 0; v < tables.vertexCount(); ++v) {
    const double height = d.dot(tables.vertices[at(v)]);
    if (height >= floor) found.push({height, 0, 0, v});
  }
}

double turn(const SlabVertex& o, const SlabVertex& a, const SlabVertex& b) {
  return (a.u - o.u) * (b.v - o.v) - (a.v - o.v) * (b.u - o.u);
}

/// The convex hull of the slab's vertices in the (u, v) plane (monotone chain), counter-clockwise, into out.
void hullInPlane(const PolyhedronTables& tables, SlabVertices& found, Feature& out) {
  // of points that coincide in the plane the highest comes first and stays
  std::sort(found.begin(), found.end(), [](const SlabVertex& s, const SlabVertex& t) {
    return std::tuple(s.u, s.v, -s.height) < std::tuple(t.u, t.v, -t.height);
  });
  const auto last = std::unique(found.begin(), found.end(),
                                [](const SlabVertex& s, const SlabVertex& t) { return s.u == t.u && s.v == t.v; });
  const int n = static_cast<int>(last - found.begin());

  out.clear();
  if (n <= 2) {
    for (int k = 0; k < n; ++k) out.push(tables.vertices[at(found[k].index)]);
    return;
  }
  std::array<int, 2 * Feature::capacity + 1> chain;
  int count = 0;
  const auto extend = [&](int k, int base) {
    while (count >= base + 2 && turn(found[chain[at(count - 2)]], found[chain[at(count - 1)]], found[k]) <= 0) --count;
    chain[at(count++)] = k;
  };
  for (int k = 0; k < n; ++k) extend(k, 0);
  const int lower = count - 1;
  for (int k = n - 2; k >= 0; --k) extend(k, lower);
  for (int k = 0; k + 1 < count; ++k) out.push(tables.vertices[at(found[chain[at(k)]].index)]);
}

}  // namespace

Polyhedron::Polyhedron(std::span<const Vec3> points, Frame* toBody) : Shape(ShapeKind::polyhedron) {
  const ConvexHull hull = convexHull(points);
  const SolidProperties solid = solidProperties(hull.vertices, fanTriangles(hull));
  const Frame frame = solid.frame();
  if (toBody) *toBody = frame;

  std::vector<Vec3> vertices;
  for (const Vec3& v : hull.vertices) vertices.push_back(frame.toBody(v));
  topology = makePolyhedronTables(std::move(vertices), hull.faces);
  findOctantVertices();

  double bounding = 0, diameter = 0;
  for (const Vec3& v : topology.vertices) {
    bounding = std::max(bounding, v.norm());
    for (const Vec3& w : topology.vertices) diameter = std::max(diameter, (v - w).squaredNorm());
  }
  const double inner = *std::min_element(topology.faceOffsets.begin(), topology.faceOffsets.end());
  setMeasures(solid.principal, bounding, inner, std::sqrt(diameter), distinctAxis(solid.principal.inertia, false));
}

void Polyhedron::findOctantVertices() {
  for (std::size_t k = 0; k < 8; ++k) {
    const Vec3 middle((k & 1) ? 1 : -1, (k & 2) ? 1 : -1, (k & 4) ? 1 : -1);
    octantVertex[k] = topology.supportVertex(middle);
  }
}

Vec3 Polyhedron::support(const Vec3& d) const {
  return topology.vertices[at(topology.supportVertex(d, climbStart(d)))];
}

void Polyhedron::supportFeature(const Vec3& d, double slab, Feature& out) const {
  const std::int32_t highest = topology.supportVertex(d, climbStart(d));
  // rounding must not part the corners of one face: the slab is widened by a few units of the last place
  const double floor = d.dot(topology.vertices[at(highest)]) - slab - tolerance::onSurface * boundingRadius();
  SlabVertices found;
  collectSlab(topology, d, floor, highest, found);

  const Vec3 u = perpendicular(d);
  const Vec3 v = d.cross(u);
  for (SlabVertex& s : found) {
    s.u = u.dot(topology.vertices[at(s.index)]);
    s.v = v.dot(topology.vertices[at(s.index)]);
  }
  hullInPlane(topology, found, out);
}

Vec3 Polyhedron::supportFace(const Vec3& d, double minCosine, Feature& out) const {
  out.clear();
  // the face turned most towards d (it need not touch the support vertex, so all are looked at)
  std::size_t best = 0;
  double cosine = -2;
  for (std::size_t f = 0; f < topology.faceNormals.size(); ++f) {
    const double c = d.dot(topology.faceNormals[f]);
    if (c > cosine) {
      cosine = c;
      best = f;
    }
  }
  if (cosine >= minCosine) {
    const std::int32_t begin = topology.faceBegin[best], n = topology.faceBegin[best + 1] - begin;
    const std::int32_t count = std::min<std::int32_t>(n, Feature::capacity);
    for (std::int32_t k = 0; k < count; ++k) {
      out.push(topology.vertices[at(topology.faceCorners[at(begin + k * n / count)])]);
    }
    return topology.faceNormals[best];
  }

  // the edge at the support vertex that lies flattest against the supporting plane
  const std::int32_t top = topology.supportVertex(d, climbStart(d));
  const Vec3& vertex = topology.vertices[at(top)];
  double flattest = std::sqrt(std::max(0.0, 1 - minCosine * minCosine));
  std::int32_t other = -1;
  for (std::int32_t k = topology.neighbourBegin[at(top)]; k < topology.neighbourBegin[at(top) + 1]; ++k) {
    const Vec3 along = topology.vertices[at(topology.neighbours[at(k)])] - vertex;
    const double slope = std::abs(along.dot(d)) / along.norm();
    if (slope <= flattest) {
      flattest = slope;
      other = topology.neighbours[at(k)];
    }
  }
  out.push(vertex);
  if (other >= 0) out.push(topology.vertices[at(other)]);
  return d;
}

bool Polyhedron::contains(const Vec3& p) const {
  const double slack = tolerance::onSurface * boundingRadius();
  for (std::size_t f = 0; f < topology.faceNormals.size(); ++f) {
    if (!(topology.faceNormals[f].dot(p) <= topology.faceOffsets[f] + slack)) return false;
  }
  return true;
}

TriangleMesh Polyhedron::surface(int) const {
  TriangleMesh mesh;
  mesh.vertices = topology.vertices;
  for (std::size_t f = 0; f < topology.faceNormals.size(); ++f) {
    const std::int32_t begin = topology.faceBegin[f], end = topology.faceBegin[f + 1];
    for (std::int32_t k = begin + 1; k + 1 < end; ++k) {
      mesh.triangles.push_back(
          {topology.faceCorners[at(begin)], topology.faceCorners[at(k)], topology.faceCorners[at(k + 1)]});
    }
  }
  return mesh;
}

std::string Polyhedron::describe() const {
  return "polyhedron of " + std::to_string(topology.vertexCount()) + " vertices, " +
         std::to_string(topology.faceCount()) + " faces, longest extent " + describeLength(longestExtent());
}

Aabb Polyhedron::bounds(const Frame& frame) const {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    const Vec3 d = frame.R.row(k).transpose();
    box.hi[k] = frame.x[k] + d.dot(topology.vertices[at(topology.supportVertex(d, climbStart(d)))]);
    const Vec3 e = -d;
    box.lo[k] = frame.x[k] + d.dot(topology.vertices[at(topology.supportVertex(e, climbStart(e)))]);
  }
  return box;
}

}  // namespace granular
