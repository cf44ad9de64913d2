#include "granular/point/overlap.h"

#include <algorithm>
#include <limits>
#include <span>

#include "granular/point/clip.h"
#include "granular/point/corner_overlap.h"
#include "granular/point/disk_overlap.h"

namespace granular {
namespace {

/// A face of A over a face of B, and the heights of both.
struct Cell {
  std::int32_t a, b;
  Linear heightA, heightB;
};

/// The cells of one overlap in the order they were found. More than the capacity (hundreds of small faces in one
/// overlap) are left out: those found last are the shallowest.
class Cells {
 public:
  bool holds(std::int32_t a, std::int32_t b) const {
    for (int k = 0; k < count; ++k) {
      const Cell& each = items[static_cast<std::size_t>(k)];
      if (each.a == a && each.b == b) return true;
    }
    return false;
  }
  void add(const Cell& cell) {
    if (count < capacity) items[static_cast<std::size_t>(count++)] = cell;
  }
  void clear() { count = 0; }
  int size() const { return count; }
  const Cell& operator[](int k) const { return items[static_cast<std::size_t>(k)]; }

 private:
  static constexpr int capacity = 128;
  std::array<Cell, capacity> items;
  int count = 0;
};

/// The middle of the overlap at x: between the lowest surface of A and the highest of B.
double findMiddle(const Cells& cells, const Vec2& x) {
  double top = infinity, bottom = -infinity;
  for (int k = 0; k < cells.size(); ++k) {
    top = std::min(top, cells[k].heightA.at(x));
    bottom = std::max(bottom, cells[k].heightB.at(x));
  }
  return 0.5 * (top + bottom);
}

/// Faces within this part of the overlap of the deepest place count as deepest, and the flattest of them is taken.
constexpr double startSlack = 1e-3;

/// Flat faces on both sides: all cells, from the deepest place outwards.
class FaceWalk {
 public:
  FaceWalk(const SurfaceSide& sideA, const SurfaceSide& sideB, const PowerChoice& choice, double narrowestStrip)
      : a(sideA), b(sideB), power(choice), narrowest(narrowestStrip) {}

  void measure(const TouchingFeature& feature, double overlap, OverlapArea& out) {
    const double slack = startSlack * overlap;
    const std::int32_t startA = feature.kind == TouchingFeature::faceOfA ? feature.a : a.findStartFace(slack);
    const std::int32_t startB = feature.kind == TouchingFeature::faceOfB ? feature.b : b.findStartFace(slack);
    if (startA >= 0 && startB >= 0) {
      cells.add({startA, startB, a.findHeight(startA), b.findHeight(startB)});
      walk(out);
    }
    if (!(out.moments.volume > 0)) {
      addAllAround();
      walk(out);
    }
    if (out.moments.volume > 0) out.height = findMiddle(cells, out.moments.centroidOfVolume());
  }

 private:
  /// Where a vertex lies over a vertex or an edge, the flattest faces may miss each other: start from all pairs.
  void addAllAround() {
    std::array<std::int32_t, Feature::capacity> facesA, facesB;
    const int countA = a.findFacesAround(facesA), countB = b.findFacesAround(facesB);
    cells.clear();
    for (int i = 0; i < countA * countB; ++i) {
      const std::int32_t faceA = facesA[static_cast<std::size_t>(i / countB)];
      const std::int32_t faceB = facesB[static_cast<std::size_t>(i % countB)];
      cells.add({faceA, faceB, a.findHeight(faceA), b.findHeight(faceB)});
    }
  }

  /// Integrates the cells and all that hang together with them.
  void walk(OverlapArea& out) {
    std::int32_t projected = -1;
    for (int k = 0; k < cells.size(); ++k) {
      const Cell& cell = cells[k];
      const Linear depth = cell.heightA - cell.heightB;

      // A's face where it lies above B's, over B's face.
      a.projectFace(cell.a, region);
      clipPolygon(depth, noEdge, region);
      if (region.count == 0) continue;
      if (!b.surelyHolds(region)) {
        if (projected != cell.b) b.projectFace(projected = cell.b, under);
        clipPolygon(under, region);
      }
      const AreaMoments moments = integrate(region, depth, power);
      out.moments += moments;
      if (k == 0) least = narrowest * moments.volume;
      for (int e = 0; e < region.count; ++e) cross(cell, depth, e);
    }
  }

  /// Adds the cell beyond an edge of the region where the overlap goes on there.
  void cross(const Cell& cell, const Linear& depth, int e) {
    const std::int32_t name = region.edge(e);
    if (name == noEdge) return;
    const Vec2 &from = region[e], &to = region[region.next(e)];
    const double deepest = std::max(depth.at(from), depth.at(to));
    const bool beyondA = name >= 0;
    const std::int32_t face = beyondA ? name : -2 - name;
    if (deepest <= 0 || !(beyondA ? a : b).isSeen(face)) return;
    Cell next = cell;
    if (beyondA) {
      next.a = face;
    } else {
      next.b = face;
    }
    if (cells.holds(next.a, next.b)) return;

    // What lies beyond falls off from `deepest` with the slope across the edge: at most a triangle's worth.
    (beyondA ? next.heightA : next.heightB) = (beyondA ? a : b).findHeight(face);
    const Vec2 edge = to - from;
    const double fall = granular::cross(edge, next.heightA.slope - next.heightB.slope);
    if (0.5 * edge.squaredNorm() * deepest * deepest < least * fall) return;
    cells.add(next);
  }

  const SurfaceSide &a, &b;
  const PowerChoice power;
  const double narrowest;
  Cells cells;
  Polygon region, under;
  double least = 0;
};

/// Of a strip's width.
constexpr double sidewaysSlack = 1e-6;

/// Keeps the part of a strip's middle line over one of several faces that meet at the deepest point, given by `which`.
/// Round-off must not decide about a line along an edge: between two of the faces the one whose depth is less has it,
/// and beyond the others' outline it may lie sideways by `sidewaysSlack`.
bool keepOverFace(const SurfaceSide& body, std::span<const std::int32_t> faces, std::span<const Linear> depths,
                  std::size_t which, double sign, double width, Segment& piece) {
  if (body.isRound()) return body.clipToDisk(piece);
  const Vec2 along = piece.to - piece.from;
  const Vec2 lateral = Vec2(-along.y(), along.x()) / std::max(along.norm(), std::numeric_limits<double>::min());
  Polygon face;
  body.projectFace(faces[which], face);
  for (int k = 0; k < face.count; ++k) {
    const std::int32_t name = face.edge(k), beyond = sign > 0 ? name : -2 - name;
    if (name != noEdge && std::find(faces.begin(), faces.end(), beyond) != faces.end()) continue;
    Linear side = findLeftSide(face[k], face[face.next(k)]);
    side.offset += sidewaysSlack * width * std::abs(side.slope.dot(lateral));
    if (!clipSegment(side, piece)) return false;
  }
  for (std::size_t other = 0; other < faces.size(); ++other) {
    if (other == which) continue;
    // Where two are equal all along, the first has it.
    const Linear more = depths[other] - depths[which];
    if (other < which && more.at(piece.from) <= 0 && more.at(piece.to) <= 0) return false;
    if (!clipSegment(more, piece)) return false;
  }
  return true;
}

/// A segment over flat faces, or beside another segment: the strip along it.
void measureStrip(const SurfaceSide& a, const SurfaceSide& b, double width, const PowerChoice& power,
                  OverlapArea& out) {
  const bool aIsSegment = a.dimension() == 2;
  const SurfaceSide& thin = aIsSegment ? a : b;
  const SurfaceSide& wide = aIsSegment ? b : a;
  std::array<std::int32_t, Feature::capacity> faces{};
  const int count = wide.dimension() == 3 ? wide.findFacesAround(faces) : 1;
  const auto number = static_cast<std::size_t>(count);

  std::array<Linear, Feature::capacity> depths;
  Cells cells;
  for (std::size_t k = 0; k < number; ++k) {
    cells.add({faces[k], faces[k], a.findHeight(faces[k]), b.findHeight(faces[k])});
    depths[k] = cells[static_cast<int>(k)].heightA - cells[static_cast<int>(k)].heightB;
  }
  for (std::size_t k = 0; k < number; ++k) {
    Segment piece = thin.segment();
    if (!clipSegment(depths[k], piece)) continue;
    if (wide.dimension() == 3) {
      if (!keepOverFace(wide, {faces.data(), number}, {depths.data(), number}, k, aIsSegment ? -1 : 1, width, piece))
        continue;
    } else if (!clipSegment(wide.segment(), width, piece)) {
      continue;
    }
    // Nothing is deeper than the overlap; beyond an outline a steep face's plane would be.
    const auto depthAt = [&](const Vec2& x) { return std::min(depths[k].at(x), width); };
    out.moments += integrate(piece, width, depthAt(piece.from), depthAt(piece.to), power);
  }
  if (out.moments.volume > 0) out.height = findMiddle(cells, out.moments.centroidOfVolume());
}

/// Strips beyond an edge that hold less than this part of the first cell are not looked at: they move the point by less
/// than a thousandth of the patch.
constexpr double narrowestStrip = 2e-3;

bool isCurved(const Shape& shape) { return shape.kind() == ShapeKind::sphere || shape.kind() == ShapeKind::ellipsoid; }

}  // namespace

bool measureOverlap(const ContactPlane& plane, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                    double overlap, const PowerChoice& power, OverlapArea& out) {
  if (isCurved(a) || isCurved(b)) return false;
  const SurfaceSide sideA(plane, a, frameA, 1), sideB(plane, b, frameB, -1);
  if (sideA.dimension() == 1 || sideB.dimension() == 1) return false;
  out = OverlapArea{};
  if (sideA.isRound() && sideB.isRound()) {
    measureDisks(sideA, sideB, power, out);
  } else if (sideA.dimension() == 3 && sideB.dimension() == 3) {
    if (measureCorner(plane.feature, sideA, sideB, overlap, startSlack * overlap, power, out)) return true;
    out = OverlapArea{};
    FaceWalk(sideA, sideB, power, narrowestStrip).measure(plane.feature, overlap, out);
  } else {
    measureStrip(sideA, sideB, overlap, power, out);
  }
  return out.moments.volume > 0 && out.moments.area > 0;
}

bool measureByWalk(const ContactPlane& plane, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                   double overlap, const PowerChoice& power, double narrowest, OverlapArea& out) {
  const SurfaceSide sideA(plane, a, frameA, 1), sideB(plane, b, frameB, -1);
  out = OverlapArea{};
  FaceWalk(sideA, sideB, power, narrowest).measure({}, overlap, out);
  return out.moments.volume > 0 && out.moments.area > 0;
}

}  // namespace granular
