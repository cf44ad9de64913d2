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
      for (std::int32_t j = tables.neighbourBegin[at(from)]; j < tables.neighbourBegin[at(from) + 1]; ++j) {
        const std::int32_t v = tables.neighbours[at(j)];
        const double height = d.dot(tables.vertices[at(v)]);
        if (height >= floor && !found.isFull() && !found.holds(v)) found.push(tables.vertices[at(v)], height, v);
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
  const double inner = *std::min_element(topology.faceOffsets.begin(), topology.faceOffsets.end());
  setMeasures(solid.principal, bounding, inner, std::sqrt(diameter), distinctAxis(solid.principal.inertia, false));
}

Polyhedron::Polyhedron(const Polyhedron& source, double factor)
    : Shape(ShapeKind::polyhedron), topology(source.topology), octantVertex(source.octantVertex) {
  for (Vec3& v : topology.vertices) v *= factor;
  for (double& offset : topology.faceOffsets) offset *= factor;
  setScaledMeasures(source, factor);
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
  SlabPoints found;
  collectSlab(topology, d, floor, highest, found);

  hullSeenAlong(d, found, out);
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
