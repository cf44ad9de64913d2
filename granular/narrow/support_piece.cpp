#include "granular/narrow/support_piece.h"

#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"

namespace granular {
namespace {

Piece makeCylinderPiece(const Cylinder& cylinder, const PieceName& name) {
  Piece out;
  out.name = name;
  const double half = cylinder.halfHeight();
  out.first = {{0, 0, name.index ? -half : half}, cylinder.radius()};
  if (name.kind == PieceName::side) {
    out.bound = true;
    out.first.middle.z() = half;
    out.second = {{0, 0, -half}, cylinder.radius()};
  }
  return out;
}

Piece makeConePiece(const Cone& cone, const PieceName& name) {
  Piece out;
  out.name = name;
  const Piece::End apex{{0, 0, cone.apexZ()}, 0}, base{{0, 0, cone.baseZ()}, cone.radius()};
  out.first = name.kind == PieceName::rim ? base : apex;
  if (name.kind == PieceName::slope) {
    out.bound = true;
    out.level = cone.radius() / std::sqrt(cone.radius() * cone.radius() + cone.height() * cone.height());
    out.second = base;
  }
  return out;
}

Piece makePolyhedronPiece(const PolyhedronTables& t, const PieceName& name) {
  Piece out;
  out.name = name;
  const auto index = static_cast<std::size_t>(name.index);
  if (name.kind == PieceName::point) {
    out.first.middle = t.vertices[index];
  } else {
    const PolyhedronTables::Edge& edge = t.edges[index];
    out.bound = true;
    out.first.middle = t.vertices[static_cast<std::size_t>(edge.a)];
    out.second.middle = t.vertices[static_cast<std::size_t>(edge.b)];
    out.axis = (out.second.middle - out.first.middle).normalized();
  }
  return out;
}

/// Of the faces, then the edges, around the support vertex the one across n, else the vertex.
PieceName namePolyhedronPiece(const PolyhedronTables& t, const Vec3& n, double nearness) {
  const std::int32_t vertex = t.climb(n, 0);
  PieceName out{PieceName::point, vertex};
  double nearest = nearness * nearness;
  for (const PolyhedronTables::Spoke& spoke : t.spokesOf(vertex)) {
    const double off = (t.faces[static_cast<std::size_t>(spoke.face)].normal - n).squaredNorm();
    if (off >= nearest) continue;
    nearest = off;
    out = {PieceName::face, spoke.face};
  }
  if (out.kind == PieceName::face) return out;

  double flattest = nearness;
  for (std::size_t e = 0; e < t.edges.size(); ++e) {
    const PolyhedronTables::Edge& edge = t.edges[e];
    if (edge.a != vertex && edge.b != vertex) continue;
    const Vec3 along = t.vertices[static_cast<std::size_t>(edge.b)] - t.vertices[static_cast<std::size_t>(edge.a)];
    const double slope = std::abs(along.dot(n)) / along.norm();
    if (slope >= flattest) continue;
    flattest = slope;
    out = {PieceName::edge, static_cast<std::int32_t>(e)};
  }
  return out;
}

}  // namespace

PieceView::PieceView(const Piece& piece, const Vec3& n) {
  if (piece.name.kind == PieceName::quadric) {
    const Vec3 stretched = piece.semiAxes.cwiseProduct(n);
    height = stretched.norm();
    point = piece.semiAxes.cwiseProduct(stretched) / height;
    return;
  }
  // Circles about z; on the axis itself any azimuth will do, and the bend is without bound.
  point = piece.first.middle;
  azimuthX = azimuthY = bend = height = 0;
  const double radius = std::max(piece.first.radius, piece.second.radius);
  if (!(radius > 0)) return;
  const double across = std::sqrt(n.x() * n.x() + n.y() * n.y());
  azimuthX = across > 0 ? n.x() / across : 1;
  azimuthY = across > 0 ? n.y() / across : 0;
  bend = piece.first.radius / across;
  point.x() += piece.first.radius * azimuthX;
  point.y() += piece.first.radius * azimuthY;
}

double PieceView::second(const Piece& piece, const Vec3& p, const Vec3& q) const {
  if (piece.name.kind == PieceName::quadric) {
    const Vec3& d = piece.semiAxes;
    return (d.cwiseProduct(p).dot(d.cwiseProduct(q)) - point.dot(p) * point.dot(q)) / height;
  }
  if (!(piece.first.radius > 0)) return 0;
  return bend * (azimuthX * p.y() - azimuthY * p.x()) * (azimuthX * q.y() - azimuthY * q.x());
}

Vec3 secondEnd(const Piece& piece, const PieceView& view) {
  const double r = piece.second.radius;
  return piece.second.middle + Vec3(r * view.azimuthX, r * view.azimuthY, 0);
}

Piece makePiece(const Shape& shape, const PieceName& name) {
  if (name.kind == PieceName::unknown || name.kind == PieceName::face) return {};
  switch (shape.kind()) {
    case ShapeKind::ellipsoid: {
      Piece out;
      out.name = name;
      out.semiAxes = static_cast<const Ellipsoid&>(shape).semiAxes();
      return out;
    }
    case ShapeKind::cylinder:
      return makeCylinderPiece(static_cast<const Cylinder&>(shape), name);
    case ShapeKind::cone:
      return makeConePiece(static_cast<const Cone&>(shape), name);
    case ShapeKind::cuboid:
    case ShapeKind::polyhedron:
      return makePolyhedronPiece(*tablesOf(shape), name);
    default:
      return {};
  }
}

PieceName joinPieces(const Shape& shape, const PieceName& present, std::int32_t vertex) {
  switch (shape.kind()) {
    case ShapeKind::cylinder:
      return present.kind == PieceName::rim ? PieceName{PieceName::side, 0} : PieceName{};
    case ShapeKind::cone:
      return present.kind != PieceName::slope ? PieceName{PieceName::slope, 0} : PieceName{};
    case ShapeKind::cuboid:
    case ShapeKind::polyhedron: {
      if (present.kind != PieceName::point) return {};
      const auto& edges = tablesOf(shape)->edges;
      const std::int32_t low = std::min(present.index, vertex), high = std::max(present.index, vertex);
      for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].a == low && edges[e].b == high) return {PieceName::edge, static_cast<std::int32_t>(e)};
      }
      return {};
    }
    default:
      return {};
  }
}

PieceName endOf(const Shape& shape, const PieceName& line, bool second) {
  switch (line.kind) {
    case PieceName::side:
      return {PieceName::rim, second};
    case PieceName::slope:
      return second ? PieceName{PieceName::rim, 1} : PieceName{PieceName::point, 0};
    case PieceName::edge: {
      const PolyhedronTables::Edge& edge = tablesOf(shape)->edges[static_cast<std::size_t>(line.index)];
      return {PieceName::point, second ? edge.b : edge.a};
    }
    default:
      return {};
  }
}

PieceName rimOf(const Shape& shape, const PieceName& face, std::int32_t k) {
  if (face.kind != PieceName::face) return {};
  if (shape.kind() == ShapeKind::cylinder || shape.kind() == ShapeKind::cone)
    return k == 0 ? PieceName{PieceName::rim, face.index} : PieceName{};
  const auto corners = tablesOf(shape)->cornersOf(face.index);
  if (static_cast<std::size_t>(k) >= corners.size()) return {};
  return {PieceName::edge, corners[static_cast<std::size_t>(k)].edge};
}

std::int32_t vertexOf(const Shape& shape, const PieceName& name) {
  if (shape.kind() != ShapeKind::cuboid && shape.kind() != ShapeKind::polyhedron) return -1;
  const PolyhedronTables& t = *tablesOf(shape);
  const auto index = static_cast<std::size_t>(name.index);
  if (name.kind == PieceName::edge) return t.edges[index].a;
  if (name.kind == PieceName::face) return t.cornersOf(name.index).front().vertex;
  return name.index;
}

PieceName namePiece(const Shape& shape, const Vec3& n, double nearness) {
  const double across = std::sqrt(n.x() * n.x() + n.y() * n.y());
  switch (shape.kind()) {
    case ShapeKind::ellipsoid:
      return {PieceName::quadric, 0};
    case ShapeKind::cylinder:
      if (across <= nearness) return {PieceName::face, n.z() < 0};
      if (std::abs(n.z()) <= nearness) return {PieceName::side, 0};
      return {PieceName::rim, n.z() < 0};
    case ShapeKind::cone: {
      const Cone& cone = static_cast<const Cone&>(shape);
      if (n.z() < 0 && across <= nearness) return {PieceName::face, 1};
      const double slant = std::sqrt(cone.radius() * cone.radius() + cone.height() * cone.height());
      const double off = (cone.height() * n.z() - cone.radius() * across) / slant;  // sine of the angle above the slope
      if (std::abs(off) <= nearness) return {PieceName::slope, 0};
      return off > 0 ? PieceName{PieceName::point, 0} : PieceName{PieceName::rim, 1};
    }
    case ShapeKind::cuboid:
    case ShapeKind::polyhedron:
      return namePolyhedronPiece(*tablesOf(shape), n, nearness);
    default:
      return {};
  }
}

}  // namespace granular
