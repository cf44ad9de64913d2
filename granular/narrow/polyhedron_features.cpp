#include "granular/narrow/polyhedron_features.h"

#include <algorithm>

namespace granular {
namespace {

const Vec3& vertexOf(const PolyhedronTables& t, std::int32_t v) { return t.vertices[static_cast<std::size_t>(v)]; }

/// Sines of angles between edges below which their cross product has lost too many digits to be a normal. Edges that
/// close to parallel span a facet of C too narrow to hold a minimum that a neighbouring face does not also hold.
constexpr double leastSine = 1e-7;

/// A convex polygon of tied vertices while it is clipped; corners beyond the capacity cannot arise from its inputs'
/// sizes.
using Polygon = std::vector<Vec3>;

/// The vertices within `tie` of the deepest below the face, projected onto its plane, in order around it.
Polygon collectTied(const PolyhedronTables& other, const Frame& frame, const Vec3& n, double tie) {
  double lowest = infinity;
  for (const Vec3& v : other.vertices) lowest = std::min(lowest, n.dot(frame.toWorld(v)));
  Polygon tied;
  Vec3 centre = Vec3::Zero();
  for (const Vec3& v : other.vertices) {
    const Vec3 p = frame.toWorld(v);
    if (n.dot(p) > lowest + tie) continue;
    tied.push_back(p);
    centre += p;
  }
  centre /= static_cast<double>(tied.size());
  const Vec3 u = perpendicular(n), w = n.cross(u);
  std::sort(tied.begin(), tied.end(), [&](const Vec3& p, const Vec3& q) {
    return std::atan2(w.dot(p - centre), u.dot(p - centre)) < std::atan2(w.dot(q - centre), u.dot(q - centre));
  });
  return tied;
}

/// Keeps the part of the polygon on the inner side of the line through `from` along `edge` (Sutherland and Hodgman
/// 1974).
Polygon clipToInside(const Polygon& polygon, const Vec3& from, const Vec3& inward, double tie) {
  Polygon kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3& p = polygon[k];
    const Vec3& q = polygon[(k + 1) % polygon.size()];
    const double dp = inward.dot(p - from), dq = inward.dot(q - from);
    if (dp >= -tie) kept.push_back(p);
    if ((dp >= -tie) != (dq >= -tie)) kept.push_back(p + (q - p) * (dp / (dp - dq)));
  }
  return kept;
}

}  // namespace

double faceMargin(const PolyhedronTables& tables, std::int32_t face, const Vec3& p) {
  const Vec3& n = tables.faces[static_cast<std::size_t>(face)].normal;
  const auto corners = tables.cornersOf(face);
  // Signed squares of the distances from the edges: one root at the end.
  double least = infinity;
  Vec3 from = vertexOf(tables, corners.back().vertex);
  for (const PolyhedronTables::Corner& corner : corners) {
    const Vec3& to = vertexOf(tables, corner.vertex);
    const Vec3 edge = to - from;
    const double area = n.dot(edge.cross(p - from));
    least = std::min(least, area * std::abs(area) / edge.squaredNorm());
    from = to;
  }
  return least < 0 ? -std::sqrt(-least) : std::sqrt(least);
}

FeatureCheck checkFace(const PolyhedronTables& reference, std::int32_t face, const PolyhedronTables& other,
                       const Frame& frame, double tie, std::int32_t& vertex) {
  const Vec3 n = reference.faces[static_cast<std::size_t>(face)].normal;
  vertex = other.climb(-frame.unrotate(n), vertex);
  const Vec3 p = frame.toWorld(vertexOf(other, vertex));

  FeatureCheck out;
  out.minimum.normal = n;
  out.minimum.depth = reference.faces[static_cast<std::size_t>(face)].offset - n.dot(p);
  out.minimum.onB = p;
  out.minimum.onA = p + out.minimum.depth * n;

  const double margin = faceMargin(reference, face, p);
  out.holds = margin >= -tie;
  out.margin = std::max(0.0, margin);
  return out;
}

FeatureCheck checkTiedFace(const PolyhedronTables& reference, std::int32_t face, const PolyhedronTables& other,
                           const Frame& frame, double tie) {
  const Vec3 n = reference.faces[static_cast<std::size_t>(face)].normal;
  FeatureCheck out;
  Polygon polygon = collectTied(other, frame, n, tie);
  const double depth = reference.faces[static_cast<std::size_t>(face)].offset - n.dot(polygon.front());
  const auto corners = reference.cornersOf(face);
  for (std::size_t k = 0; k < corners.size() && !polygon.empty(); ++k) {
    const Vec3& from = vertexOf(reference, corners[k].vertex);
    const Vec3& to = vertexOf(reference, corners[k + 1 < corners.size() ? k + 1 : 0].vertex);
    polygon = clipToInside(polygon, from, n.cross(to - from).normalized(), tie);
  }
  if (polygon.empty()) return out;

  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : polygon) middle += p;
  middle /= static_cast<double>(polygon.size());
  out.holds = true;
  out.minimum = {n, depth, middle + depth * n, middle};
  return out;
}

FeatureCheck checkEdges(const PolyhedronTables& a, std::int32_t edgeA, const PolyhedronTables& b, std::int32_t edgeB,
                        const Frame& frame, double tie) {
  const PolyhedronTables::Edge& ea = a.edges[static_cast<std::size_t>(edgeA)];
  const PolyhedronTables::Edge& eb = b.edges[static_cast<std::size_t>(edgeB)];
  const Vec3& startA = vertexOf(a, ea.a);
  const Vec3 startB = frame.toWorld(vertexOf(b, eb.a));
  const Vec3 u = vertexOf(a, ea.b) - startA;
  const Vec3 v = frame.rotate(vertexOf(b, eb.b) - vertexOf(b, eb.a));

  FeatureCheck out;
  const Vec3 cross = u.cross(v);
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), cc = cross.squaredNorm();
  if (!(cc > leastSine * leastSine * uu * vv)) return out;

  // The common normal, outward for A.
  const Vec3& leftA = a.faces[static_cast<std::size_t>(ea.faceLeft)].normal;
  const Vec3& rightA = a.faces[static_cast<std::size_t>(ea.faceRight)].normal;
  const double area = std::sqrt(cc);
  const double side = cross.dot(leftA + rightA) < 0 ? -1 : 1;
  const Vec3 n = cross * (side / area);

  // Both edges support: n lies between the normals of A's two faces, and -n between those of B's. Asked of the slope
  // across each face from the edge on, which keeps its digits where the two faces are nearly one.
  constexpr double angular = 1e-14;
  const auto supports = [](const PolyhedronTables& t, const PolyhedronTables::Edge& e, const Vec3& edge, double length,
                           const Vec3& m) {
    const Vec3& left = t.faces[static_cast<std::size_t>(e.faceLeft)].normal;
    const Vec3& right = t.faces[static_cast<std::size_t>(e.faceRight)].normal;
    return m.dot(left.cross(edge)) <= angular * length && m.dot(edge.cross(right)) <= angular * length &&
           m.dot(left) + m.dot(right) > 0;
  };
  const double lengthA = std::sqrt(uu), lengthB = std::sqrt(vv);
  if (!supports(a, ea, u, lengthA, n)) return out;
  if (!supports(b, eb, vertexOf(b, eb.b) - vertexOf(b, eb.a), lengthB, -frame.unrotate(n))) return out;

  // The closest points of the two lines, as fractions of the edges.
  const Vec3 w = startA - startB;
  const double s = -side * w.cross(v).dot(n) / area, t = -side * w.cross(u).dot(n) / area;
  const double insideA = std::min(s, 1 - s), insideB = std::min(t, 1 - t);
  out.holds = insideA * lengthA >= -tie && insideB * lengthB >= -tie;
  out.margin = std::max(0.0, area * std::min(insideA / lengthB, insideB / lengthA));
  out.minimum.normal = n;
  out.minimum.depth = n.dot(w);
  const Vec3 middle = 0.5 * (startA + s * u + startB + t * v);
  out.minimum.onA = middle + 0.5 * out.minimum.depth * n;
  out.minimum.onB = middle - 0.5 * out.minimum.depth * n;
  return out;
}

}  // namespace granular
