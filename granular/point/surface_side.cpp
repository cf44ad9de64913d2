#include "granular/point/surface_side.h"

namespace granular {
namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// Squared radius of the circle within the polygon of faceSamples corners, less round-off, over that about it.
const double within2 = std::pow((1 - 1e-12) * std::cos(pi / faceSamples), 2);

}  // namespace

SurfaceSide::SurfaceSide(const ContactPlane& plane, const Shape& shape, const Frame& frame, double side)
    : origin(frame.toBody(plane.origin)),
      u(frame.unrotate(plane.u)),
      v(frame.unrotate(plane.v)),
      normal(frame.unrotate(plane.n)),
      sign(side) {
  tables = tablesOf(shape);
  if (tables) {
    deepest = plane.feature.kind == TouchingFeature::unknown
                  ? static_cast<const Polyhedron&>(shape).supportVertex(sign * normal)
                  : vertexOf(plane.feature);
  } else {
    showFeature(shape);
  }
}

std::int32_t SurfaceSide::vertexOf(const TouchingFeature& feature) const {
  const std::int32_t index = sign > 0 ? feature.a : feature.b;
  if (feature.kind == TouchingFeature::edges) return tables->edges[at(index)].a;
  const bool ownFace = feature.kind == (sign > 0 ? TouchingFeature::faceOfA : TouchingFeature::faceOfB);
  return ownFace ? tables->cornersOf(index).front().vertex : index;
}

void SurfaceSide::showFeature(const Shape& shape) {
  if (shape.supportDisk(sign * normal, flatterCosine, disk)) {
    round = &shape;
    kind = 3;
    height = findPlaneHeight(disk.normal, disk.normal.dot(disk.centre));
    return;
  }
  Feature feature;
  const Vec3 faceNormal = shape.supportFace(sign * normal, flatterCosine, feature);
  kind = std::min(feature.count, 3);
  if (kind == 2) {
    line = {projectPoint(feature[0]), projectPoint(feature[1])};
    const Vec2 along = line.to - line.from;
    const double square = along.squaredNorm(), rise = normal.dot(feature[1] - feature[0]);
    height.slope = square > 0 ? Vec2(rise / square * along) : Vec2::Zero();
    height.offset = normal.dot(feature[0] - origin) - height.slope.dot(line.from);
  } else if (kind == 3) {
    showPolygon(feature);
    height = findPlaneHeight(faceNormal, faceNormal.dot(feature[0]));
  }
}

void SurfaceSide::showPolygon(const Feature& feature) const {
  // Seen from below, counter-clockwise runs backwards.
  for (int k = 0; k < feature.count; ++k) {
    polygon.push(projectPoint(feature[sign > 0 ? k : feature.count - 1 - k]), noEdge);
  }
}

Oval SurfaceSide::oval() const {
  const double across = std::sqrt(normal.x() * normal.x() + normal.y() * normal.y());
  const Vec3 first = across > 0 ? Vec3(sign / across * Vec3(normal.x(), normal.y(), 0)) : Vec3(Vec3::UnitX());
  const Vec3 second = sign * disk.normal.cross(first);
  const auto turn = [&](const Vec3& d) -> Vec2 { return disk.radius * Vec2(u.dot(d), v.dot(d)); };
  return {projectPoint(disk.centre), turn(first), turn(second)};
}

bool SurfaceSide::surelyHolds(const Vec2& x) const {
  if (!round) return false;
  return findInDisk(x).squaredNorm() <= within2 * disk.radius * disk.radius;
}

bool SurfaceSide::clipToDisk(Segment& segment) const {
  // |from + t along|^2 = radius^2
  const Vec3 from = findInDisk(segment.from), along = findInDisk(segment.to) - from;
  const double square = along.squaredNorm(), half = from.dot(along);
  const double rest = from.squaredNorm() - disk.radius * disk.radius;
  if (!(square > 0)) return rest <= 0;
  const double under = half * half - square * rest;
  if (under < 0) return false;
  const double root = std::sqrt(under), first = (-half - root) / square, last = (-half + root) / square;
  if (last < 0 || first > 1) return false;
  const Segment whole = segment;
  if (first > 0) segment.from = whole.from + first * (whole.to - whole.from);
  if (last < 1) segment.to = whole.from + last * (whole.to - whole.from);
  return true;
}

int SurfaceSide::findFacesAround(std::array<std::int32_t, Feature::capacity>& out) const {
  int count = 0;
  if (!tables) {
    out[at(count++)] = 0;
    return count;
  }
  for (const PolyhedronTables::Spoke& spoke : tables->spokesOf(deepest)) {
    if (isSeen(spoke.face) && count < Feature::capacity) out[at(count++)] = spoke.face;
  }
  return count;
}

std::int32_t SurfaceSide::findStartFace(double slack) const {
  if (!tables) return 0;
  // The surface is the lowest of A's planes, the highest of B's. At a vertex all its faces are; the flattest has the
  // largest cell.
  std::int32_t best = -1;
  double lowest = infinity, flattest = 0;
  for (const PolyhedronTables::Spoke& spoke : tables->spokesOf(deepest)) {
    const PolyhedronTables::Face& plane = tables->faces[at(spoke.face)];
    const double cosine = sign * normal.dot(plane.normal);
    if (cosine < steepestCosine) continue;
    const double z = (plane.offset - plane.normal.dot(origin)) / cosine;
    if (z < lowest - slack || (z < lowest + slack && cosine > flattest)) {
      lowest = std::min(z, lowest);
      flattest = cosine;
      best = spoke.face;
    }
  }
  return best;
}

void SurfaceSide::projectFace(std::int32_t face, Polygon& out) const {
  if (!tables) {
    if (round && polygon.count == 0) {
      Feature feature;
      round->supportFace(sign * normal, flatterCosine, feature);
      showPolygon(feature);
    }
    out.count = 0;
    for (int k = 0; k < polygon.count; ++k) out.push(polygon[k], noEdge);
    return;
  }

  // Of very many corners, evenly spaced ones.
  out.count = 0;
  const auto corners = tables->cornersOf(face);
  const std::size_t count = std::min<std::size_t>(corners.size(), Feature::capacity);
  for (std::size_t k = 0; k < count; ++k) {
    // Seen from below, counter-clockwise runs backwards, and the edge to the next corner is the one that ends here.
    const std::size_t order = sign > 0 ? k : count - 1 - k;
    const std::size_t here = corners.size() == count ? order : order * corners.size() / count;
    const Vec2 x = projectPoint(tables->vertices[at(corners[here].vertex)]);
    if (sign > 0) {
      out.push(x, corners[here].beyond);
    } else {
      out.push(x, -2 - corners[here > 0 ? here - 1 : corners.size() - 1].beyond);
    }
  }
}

Linear SurfaceSide::findHeight(std::int32_t face) const {
  if (!tables) return height;
  return findPlaneHeight(tables->faces[at(face)].normal, tables->faces[at(face)].offset);
}

}  // namespace granular
