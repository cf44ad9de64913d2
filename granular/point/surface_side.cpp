#include "granular/point/surface_side.h"

namespace granular {
namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// A round body's flat end and its side share the contacts of its rim: the flatter of the two takes them.
constexpr double flatterCosine = 0.70710678118654752;

/// The plane (normal, offset; plane axes) as a height over the contact plane.
Linear heightOf(const Vec3& normal, double offset) {
  const double inverse = 1 / normal.z();
  return {offset * inverse, Vec2(-normal.x() * inverse, -normal.y() * inverse)};
}

}  // namespace

SurfaceSide::SurfaceSide(const ContactPlane& plane, const Shape& shape, const Frame& frame, double side) : sign(side) {
  // Body axes to plane axes.
  Mat3 axes;
  axes.row(0) = plane.u.transpose();
  axes.row(1) = plane.v.transpose();
  axes.row(2) = plane.n.transpose();
  rotation = axes * frame.R;
  shift = axes * (frame.x - plane.origin);
  const Vec3 direction = sign * rotation.row(2).transpose();

  // Polyhedra: their own tables.
  if (shape.kind() == ShapeKind::cuboid || shape.kind() == ShapeKind::polyhedron) {
    tables = &static_cast<const Polyhedron&>(shape).tables();
    deepest = tables->supportVertex(direction);
    return;
  }

  // Others: the feature that supports.
  Feature feature;
  const Vec3 normal = rotation * shape.supportFace(direction, flatterCosine, feature);
  kind = std::min(feature.count, 3);
  if (kind == 2) {
    const Vec3 from = rotation * feature[0] + shift, to = rotation * feature[1] + shift;
    line = {from.head<2>(), to.head<2>()};
    const Vec2 along = line.to - line.from;
    const double square = along.squaredNorm();
    height.slope = square > 0 ? Vec2((to.z() - from.z()) / square * along) : Vec2::Zero();
    height.offset = from.z() - height.slope.dot(line.from);
  } else if (kind == 3) {
    // Seen from below, counter-clockwise runs backwards.
    for (int k = 0; k < feature.count; ++k) {
      const Vec3 p = rotation * feature[sign > 0 ? k : feature.count - 1 - k] + shift;
      polygon.push(p.head<2>(), noEdge);
    }
    height = heightOf(normal, normal.dot(rotation * feature[0] + shift));
  }
}

bool SurfaceSide::faces(std::int32_t face) const {
  return sign * rotation.row(2).dot(tables->faceNormals[at(face)]) >= steepestCosine;
}

int SurfaceSide::findFacesAround(std::array<std::int32_t, Feature::capacity>& out) const {
  int count = 0;
  if (!tables) {
    out[at(count++)] = 0;
    return count;
  }
  for (std::int32_t k = tables->vertexFaceBegin[at(deepest)]; k < tables->vertexFaceBegin[at(deepest) + 1]; ++k) {
    const std::int32_t face = tables->vertexFaces[at(k)];
    if (faces(face) && count < Feature::capacity) out[at(count++)] = face;
  }
  return count;
}

std::int32_t SurfaceSide::findStartFace() const {
  if (!tables) return 0;
  // The surface is the lowest of A's planes, the highest of B's.
  std::int32_t best = -1;
  double lowest = infinity;
  for (std::int32_t k = tables->vertexFaceBegin[at(deepest)]; k < tables->vertexFaceBegin[at(deepest) + 1]; ++k) {
    const std::int32_t face = tables->vertexFaces[at(k)];
    if (!faces(face)) continue;
    const double z = sign * findHeight(face).offset;
    if (z < lowest) {
      lowest = z;
      best = face;
    }
  }
  return best;
}

void SurfaceSide::projectFace(std::int32_t face, Polygon& out) const {
  if (!tables) {
    out.count = polygon.count;
    for (int k = 0; k < polygon.count; ++k) {
      out[k] = polygon[k];
      out.edges[at(k)] = noEdge;
    }
    return;
  }

  // Of very many corners, evenly spaced ones.
  out.count = 0;
  const std::int32_t begin = tables->faceBegin[at(face)], corners = tables->faceBegin[at(face) + 1] - begin;
  const std::int32_t count = std::min<std::int32_t>(corners, Feature::capacity);
  for (std::int32_t k = 0; k < count; ++k) {
    // Seen from below, counter-clockwise runs backwards, and the edge to the next corner is the one that ends here.
    const std::int32_t order = sign > 0 ? k : count - 1 - k;
    const std::int32_t corner = begin + order * corners / count;
    const std::int32_t edgeCorner = sign > 0 ? corner : (corner == begin ? begin + corners - 1 : corner - 1);
    const PolyhedronTables::Edge& edge = tables->edges[at(tables->cornerEdges[at(edgeCorner)])];
    const std::int32_t beyond = edge.faceLeft == face ? edge.faceRight : edge.faceLeft;
    const Vec3 p = rotation * tables->vertices[at(tables->faceCorners[at(corner)])] + shift;
    out.push(p.head<2>(), !faces(beyond) ? noEdge : sign > 0 ? beyond : -2 - beyond);
  }
}

Linear SurfaceSide::findHeight(std::int32_t face) const {
  if (!tables) return height;
  const Vec3 normal = rotation * tables->faceNormals[at(face)];
  return heightOf(normal, tables->faceOffsets[at(face)] + normal.dot(shift));
}

}  // namespace granular
