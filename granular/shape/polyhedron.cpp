// Convex polyhedra of any number of vertices: hull, body frame, support features.
#include "granular/shape/polyhedron.h"

#include <algorithm>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"
#include "granular/shape/hull.h"
#include "granular/shape/slab_points.h"

namespace granular {

namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// Collects the vertices no lower than floor along d. They are connected in the vertex graph: flood from the highest;
/// small polyhedra and slabs of very many vertices are scanned.
void collectSlab(const PolyhedronTables& tables, const Vec3& d, double floor, std::int32_t highest, SlabPoints& found) {
  constexpr int scanned = 20;
  if (tables.vertexCount() > scanned) {
    found.push(tables.vertices[at(highest)], d.dot(tables.vertices[at(highest)]), highest);
    for (int k = 0; k < found.size() && !found.isFull(); ++k) {
      const std::int32_t from = found[k].index;
      for (const PolyhedronTables::Spoke& spoke : tables.spokesOf(from)) {
        const Vec3& far = tables.vertices[at(spoke.vertex)];
        const double height = d.dot(far);
        if (height >= floor && !found.isFull() && !found.holds(spoke.vertex)) found.push(far, height, spoke.vertex);
      }
    }
    if (!found.isFull()) return;
    found.clear();
  }
  for (std::int32_t v = 0; v < tables.vertexCount(); ++v) {
    const double height = d.dot(tables.vertices[at(v)]);
    if (height >= floor) found.push(tables.vertices[at(v)], height, v);
  }
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
  const double inner = topology.leastOffset();
  setMeasures(solid.principal, bounding, inner, std::sqrt(diameter), distinctAxis(solid.principal.inertia, false));
}

Polyhedron::Polyhedron(const Polyhedron& source, double factor)
    : Shape(ShapeKind::polyhedron), topology(source.topology.scaled(factor)), octantVertex(source.octantVertex) {
  setScaledMeasures(source, factor);
}

void Polyhedron::findOctantVertices() {
  for (std::size_t k = 0; k < 8; ++k) {
    const Vec3 middle((k & 1) ? 1 : -1, (k & 2) ? 1 : -1, (k & 4) ? 1 : -1);
    octantVertex[k] = topology.supportVertex(middle);
  }
}

Vec3 Polyhedron::support(const Vec3& d) const { return topology.vertices[at(supportVertex(d))]; }

void Polyhedron::supportFeature(const Vec3& d, double slab, Feature& out) const {
  const std::int32_t highest = supportVertex(d);
  // rounding must not part the corners of one face: the slab is widened by a few units of the last place
  const double floor = d.dot(topology.vertices[at(highest)]) - slab - tolerance::onSurface * boundingRadius();
  SlabPoints found;
  collectSlab(topology, d, floor, highest, found);

  hullSeenAlong(d, found, out);
}

Vec3 Polyhedron::supportFace(const Vec3& d, double minCosine, Feature& out) const {
  out.clear();
  // the face turned most towards d (it need not touch the support vertex, so all are looked at)
  std::size_t best = 0;
  double cosine = -2;
  for (std::size_t f = 0; f < topology.faces.size(); ++f) {
    const double c = d.dot(topology.faces[f].normal);
    if (c > cosine) {
      cosine = c;
      best = f;
    }
  }
  if (cosine >= minCosine) {
    const auto corners = topology.cornersOf(static_cast<std::int32_t>(best));
    const std::size_t count = std::min<std::size_t>(corners.size(), Feature::capacity);
    for (std::size_t k = 0; k < count; ++k) out.push(topology.vertices[at(corners[k * corners.size() / count].vertex)]);
    return topology.faces[best].normal;
  }

  // the edge at the support vertex that lies flattest against the supporting plane
  const std::int32_t top = supportVertex(d);
  const Vec3& vertex = topology.vertices[at(top)];
  double flattest = std::sqrt(std::max(0.0, 1 - minCosine * minCosine));
  const PolyhedronTables::Spoke* other = nullptr;
  for (const PolyhedronTables::Spoke& spoke : topology.spokesOf(top)) {
    const Vec3 along = topology.vertices[at(spoke.vertex)] - vertex;
    const double slope = std::abs(along.dot(d)) / along.norm();
    if (slope <= flattest) {
      flattest = slope;
      other = &spoke;
    }
  }
  out.push(vertex);
  if (other) out.push(topology.vertices[at(other->vertex)]);
  return d;
}

bool Polyhedron::contains(const Vec3& p) const {
  const double slack = tolerance::onSurface * boundingRadius();
  for (std::size_t f = 0; f < topology.faces.size(); ++f) {
    if (!(topology.faces[f].normal.dot(p) <= topology.faces[f].offset + slack)) return false;
  }
  return true;
}

TriangleMesh Polyhedron::surface(int) const {
  TriangleMesh mesh;
  mesh.vertices.assign(topology.vertices.begin(), topology.vertices.end());
  for (std::int32_t f = 0; f < topology.faceCount(); ++f) {
    const auto corners = topology.cornersOf(f);
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      mesh.triangles.push_back({corners[0].vertex, corners[k].vertex, corners[k + 1].vertex});
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
    box.hi[k] = frame.x[k] + d.dot(topology.vertices[at(supportVertex(d))]);
    const Vec3 e = -d;
    box.lo[k] = frame.x[k] + d.dot(topology.vertices[at(supportVertex(e))]);
  }
  return box;
}

}  // namespace granular
