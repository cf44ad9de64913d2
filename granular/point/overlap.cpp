#include "granular/point/overlap.h"

#include "granular/point/clip.h"

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
  void add(std::int32_t a, std::int32_t b) {
    for (int k = 0; k < count; ++k) {
      if (items[static_cast<std::size_t>(k)].a == a && items[static_cast<std::size_t>(k)].b == b) return;
    }
    if (count == capacity) return;
    items[static_cast<std::size_t>(count)].a = a;
    items[static_cast<std::size_t>(count++)].b = b;
  }
  int size() const { return count; }
  Cell& operator[](int k) { return items[static_cast<std::size_t>(k)]; }

 private:
  static constexpr int capacity = 128;
  std::array<Cell, capacity> items;
  int count = 0;
};

/// The middle of the overlap at x: between the lowest surface of A and the highest of B.
double findMiddle(Cells& cells, const Vec2& x) {
  double top = infinity, bottom = -infinity;
  for (int k = 0; k < cells.size(); ++k) {
    top = std::min(top, cells[k].heightA.at(x));
    bottom = std::max(bottom, cells[k].heightB.at(x));
  }
  return 0.5 * (top + bottom);
}

/// Flat faces on both sides: all cells, from the deepest place outwards.
void measureFaces(const SurfaceSide& a, const SurfaceSide& b, OverlapArea& out) {
  Cells cells;
  const std::int32_t startA = a.findStartFace(), startB = b.findStartFace();
  if (startA >= 0 && startB >= 0) cells.add(startA, startB);
  Polygon region, other;
  std::int32_t projected = -1;
  for (int k = 0; k < cells.size(); ++k) {
    Cell& cell = cells[k];
    cell.heightA = a.findHeight(cell.a);
    cell.heightB = b.findHeight(cell.b);
    const Linear depth = cell.heightA - cell.heightB;

    // A's face where it lies above B's, over B's face.
    a.projectFace(cell.a, region);
    clipPolygon(depth, noEdge, region);
    if (projected != cell.b) b.projectFace(projected = cell.b, other);
    clipPolygon(other, region);
    out.moments += integrate(region, depth);

    // Beyond every edge that is not where the overlap ends.
    for (int e = 0; e < region.count; ++e) {
      const std::int32_t name = region.edge(e);
      if (name == noEdge) continue;
      if (depth.at(region[e]) <= 0 && depth.at(region[region.next(e)]) <= 0) continue;
      if (name >= 0) {
        cells.add(name, cell.b);
      } else {
        cells.add(cell.a, -2 - name);
      }
    }
  }
  if (out.moments.volume > 0) out.height = findMiddle(cells, out.moments.centroidOfVolume());
}

/// A segment over flat faces, or beside another segment: the strip along it.
void measureStrip(const SurfaceSide& a, const SurfaceSide& b, double width, OverlapArea& out) {
  const bool aIsSegment = a.dimension() == 2;
  const SurfaceSide& thin = aIsSegment ? a : b;
  const SurfaceSide& wide = aIsSegment ? b : a;
  std::array<std::int32_t, Feature::capacity> faces{};
  const int count = wide.dimension() == 3 ? wide.findFacesAround(faces) : 1;

  Polygon face;
  Cells cells;
  for (int k = 0; k < count; ++k) {
    const std::int32_t name = faces[static_cast<std::size_t>(k)];
    cells.add(name, name);
    Cell& cell = cells[k];
    cell.heightA = a.findHeight(name);
    cell.heightB = b.findHeight(name);
    const Linear depth = cell.heightA - cell.heightB;
    Segment piece = thin.segment();
    if (!clipSegment(depth, piece)) continue;
    if (wide.dimension() == 3) {
      wide.projectFace(name, face);
      if (!clipSegment(face, piece)) continue;
    } else if (!clipSegment(wide.segment(), width, piece)) {
      continue;
    }
    out.moments += integrate(piece, width, depth.at(piece.from), depth.at(piece.to));
  }
  if (out.moments.volume > 0) out.height = findMiddle(cells, out.moments.centroidOfVolume());
}

bool isCurved(const Shape& shape) { return shape.kind() == ShapeKind::sphere || shape.kind() == ShapeKind::ellipsoid; }

}  // namespace

bool measureOverlap(const ContactPlane& plane, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                    double overlap, OverlapArea& out) {
  if (isCurved(a) || isCurved(b)) return false;
  const SurfaceSide sideA(plane, a, frameA, 1), sideB(plane, b, frameB, -1);
  if (sideA.dimension() == 1 || sideB.dimension() == 1) return false;
  out = OverlapArea{};
  if (sideA.dimension() == 3 && sideB.dimension() == 3) {
    measureFaces(sideA, sideB, out);
  } else {
    measureStrip(sideA, sideB, overlap, out);
  }
  return out.moments.volume > 0 && out.moments.area > 0;
}

}  // namespace granular
