#include "granular/wall/plane_patch.h"

#include <algorithm>

#include "granular/point/clip.h"
#include "granular/point/rules.h"
#include "granular/point/witness.h"

namespace granular {

namespace {

/// More faces than this in one overlap are left out: those found last are the shallowest.
constexpr std::size_t mostPieces = 128;

ContactPlane viewOf(const Plane& plane, const Vec3& deepest) {
  return ContactPlane(
      Touch{-plane.normal, plane.depth(deepest), deepest, deepest + plane.depth(deepest) * plane.normal});
}

}  // namespace

void SunkenSurface::look(const RuleOptions& rule, const Plane& wall, const Vec3& deepest, const Shape& shape,
                         const Frame& frame) {
  plane = viewOf(wall, deepest);
  overlap = wall.depth(deepest);
  size = shape.size();
  power = powersFor(rule, overlap);
  pieces.clear();
  kind = 1;
  if (shape.kind() == ShapeKind::sphere || shape.kind() == ShapeKind::ellipsoid) return;

  // Heights are over the middle of the overlap, the wall lies half an overlap below.
  const SurfaceSide side(plane, shape, frame, 1);
  kind = side.dimension();
  if (kind == 3) {
    lookAtFaces(side);
    if (pieces.empty()) kind = 1;
  } else if (kind == 2) {
    line = side.segment();
    lineDepth = side.findHeight(0);
    lineDepth.offset += 0.5 * overlap;
    const Vec2 along = line.to - line.from;
    const double length = along.norm();
    lineFlat = length > 0 ? flatWeight(1 / std::hypot(1, lineDepth.slope.dot(along) / length)) : 0;
    if (!clipSegment(lineDepth, line)) kind = 1;
  }
}

void SunkenSurface::lookAtFaces(const SurfaceSide& side) {
  // From the deepest face over every edge that is still below the plane.
  std::array<std::int32_t, mostPieces> faces;
  std::size_t count = 0;
  const auto add = [&](std::int32_t face) {
    if (face == noEdge || count == faces.size()) return;
    if (std::find(faces.begin(), faces.begin() + count, face) == faces.begin() + count) faces[count++] = face;
  };
  add(side.findStartFace(1e-3 * overlap));
  for (std::size_t k = 0; k < count; ++k) {
    Piece& piece = pieces.emplace_back();
    piece.depth = side.findHeight(faces[k]);
    piece.depth.offset += 0.5 * overlap;
    piece.flat = flatWeight(1 / std::sqrt(1 + piece.depth.slope.squaredNorm()));
    side.projectFace(faces[k], piece.region);
    clipPolygon(piece.depth, noEdge, piece.region);
    for (int e = 0; e < piece.region.count; ++e)
      if (piece.depth.at(piece.region[e]) > 0 || piece.depth.at(piece.region[piece.region.next(e)]) > 0)
        if (piece.region.edge(e) != noEdge && side.isSeen(piece.region.edge(e))) add(piece.region.edge(e));
  }
}

void SunkenSurface::lookAtFeature(const Plane& wall, const Vec3& deepest, double slab, const Shape& shape,
                                  const Frame& frame) {
  plane = viewOf(wall, deepest);
  overlap = wall.depth(deepest);
  size = shape.size();
  power = PowerChoice{};
  pieces.clear();
  Feature feature;
  shape.supportFeature(frame.unrotate(plane.n), slab, feature);
  kind = std::min(feature.count, 3);
  if (kind == 2) {
    line = {plane.project(frame.toWorld(feature[0])), plane.project(frame.toWorld(feature[1]))};
    lineDepth = {1, Vec2::Zero()};
  } else if (kind == 3) {
    Piece& piece = pieces.emplace_back();
    piece.region.count = 0;
    piece.depth = {1, Vec2::Zero()};
    piece.flat = 1;
    for (int k = 0; k < feature.count; ++k) piece.region.push(plane.project(frame.toWorld(feature[k])), noEdge);
  }
}

AreaMoments SunkenSurface::integrateWhole() const {
  AreaMoments moments;
  for (const Piece& piece : pieces) moments += integrate(piece.region, piece.depth, power);
  if (kind == 2) moments += integrate(line, overlap, lineDepth.at(line.from), lineDepth.at(line.to), power);
  return moments;
}

void SunkenSurface::addStretch(const Segment& stretch, const Linear& depth, double flat, SunkenPart& part) const {
  part.add(integrate(stretch, overlap, depth.at(stretch.from), depth.at(stretch.to), power), flat);
  part.deepest = std::max({part.deepest, depth.at(stretch.from), depth.at(stretch.to)});
}

void SunkenSurface::addInside(const Polygon& polygon, SunkenPart& part) const {
  if (kind == 2) {
    Segment stretch = line;
    if (clipSegment(polygon, stretch)) addStretch(stretch, lineDepth, lineFlat, part);
    return;
  }
  thread_local Polygon region;
  for (const Piece& piece : pieces) {
    region.count = piece.region.count;
    std::copy_n(piece.region.points.begin(), region.count, region.points.begin());
    std::copy_n(piece.region.edges.begin(), region.count, region.edges.begin());
    clipPolygon(polygon, region);
    if (region.count < 3) continue;
    part.add(integrate(region, piece.depth, power), piece.flat);
    for (int k = 0; k < region.count; ++k) part.deepest = std::max(part.deepest, piece.depth.at(region[k]));
  }
}

void SunkenSurface::addAlong(const Segment& ridge, SunkenPart& part) const {
  if (kind == 2) {
    Segment stretch = line;
    if (clipSegment(ridge, overlap, stretch)) addStretch(stretch, lineDepth, lineFlat, part);
    return;
  }
  for (const Piece& piece : pieces) {
    Segment stretch = ridge;
    if (piece.region.count >= 3 && clipSegment(piece.region, stretch))
      addStretch(stretch, piece.depth, piece.flat, part);
  }
}

void SunkenSurface::place(const RuleOptions& options, const AreaMoments& m, double deepestPart,
                          ContactPatch& out) const {
  const PointRule rule = options.rule;
  const bool centred = rule != PointRule::witness && rule != PointRule::manifold;
  if (!centred || kind == 1 || !(m.volume > 0 && m.area > 0))
    return placePoint(plane.origin, plane.u, deepestPart, out);
  const Vec2 centre = m.centroidOfVolume();
  if (rule == PointRule::faceCentroid) return placePoint(plane.lift(centre, 0), plane.u, deepestPart, out);

  // In the middle of the overlap there: between the wall and the body's lowest surface.
  double depth = kind == 2 ? lineDepth.at(centre) : infinity;
  for (const Piece& piece : pieces) depth = std::min(depth, piece.depth.at(centre));
  placePressure(options, plane, m, overlap, 0.5 * (depth - overlap), size, out);
  if (hasOwnDepth(rule)) return;
  out.depth = deepestPart;
  out.squaredDepth = deepestPart * deepestPart;
}

void placeOnPlane(const RuleOptions& options, const Shape& shape, const Frame& frame, const Plane& plane,
                  const Vec3& deepest, SunkenSurface& surface, ContactPatch& out) {
  switch (options.rule) {
    case PointRule::witness:
    case PointRule::manifold:
      return placePoint(deepest + 0.5 * plane.depth(deepest) * plane.normal, perpendicular(plane.normal),
                        plane.depth(deepest), out);
    case PointRule::faceCentroid:
      surface.lookAtFeature(plane, deepest, options.slab * plane.depth(deepest), shape, frame);
      break;
    case PointRule::pressureCentroid:
    case PointRule::patch:
    case PointRule::stiffPatch:
    case PointRule::foundation:
      surface.look(options, plane, deepest, shape, frame);
  }
  surface.place(options, surface.integrateWhole(), plane.depth(deepest), out);
}

}  // namespace granular
