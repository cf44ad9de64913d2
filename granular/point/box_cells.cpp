#include "granular/point/box_cells.h"

#include <algorithm>
#include <cstring>

namespace granular {
namespace {

/// A piece of a convex outline with the depths at its ends. Pieces that were clipped away have both at the origin.
struct Piece {
  Place from, to;
  Wide depthFrom, depthTo;
};

/// Outlines of cells: four edges of the parallelogram, then one for each line that clips it.
class Outline {
 public:
  Outline(const BoxCell& cell) {
    const Place p1 = cell.corner + cell.along, p2 = p1 + cell.across, p3 = cell.corner + cell.across;
    const auto depthAt = [&](const Place& p) -> Wide { return cell.depth + cell.slope.x * p.x + cell.slope.y * p.y; };
    const Wide d0 = depthAt(cell.corner), d1 = depthAt(p1), d2 = depthAt(p2), d3 = depthAt(p3);
    pieces[0] = {cell.corner, p1, d0, d1};
    pieces[1] = {p1, p2, d1, d2};
    pieces[2] = {p2, p3, d2, d3};
    pieces[3] = {p3, cell.corner, d3, d0};
  }

  /// Keeps what lies where side(piece end) >= 0. side: linear; of a place and the depth there.
  template <class Side>
  void clip(Side&& side) {
    std::array<Wide, 8> valueFrom, valueTo;
    Mask<Wide> beyond = Wide{} < 0;
    for (std::size_t k = 0; k < count; ++k) {
      valueFrom[k] = side(pieces[k].from, pieces[k].depthFrom);
      valueTo[k] = side(pieces[k].to, pieces[k].depthTo);
      beyond = either(beyond, valueFrom[k] < 0);
    }
    if (!any(beyond)) return;

    Piece closing{};
    for (std::size_t k = 0; k < count; ++k) {
      Piece& piece = pieces[k];
      const Mask<Wide> before = valueFrom[k] < 0, after = valueTo[k] < 0;
      const Mask<Wide> comes = before & ~after, goes = after & ~before, none = before & after;
      const Wide part = valueFrom[k] / choose(comes | goes, valueFrom[k] - valueTo[k], 1 + Wide{});
      const Place cut = piece.from + part * (piece.to - piece.from);
      const Wide depth = piece.depthFrom + part * (piece.depthTo - piece.depthFrom);
      closing.from = choose(goes, cut, closing.from);
      closing.to = choose(comes, cut, closing.to);
      closing.depthFrom = choose(goes, depth, closing.depthFrom);
      closing.depthTo = choose(comes, depth, closing.depthTo);
      piece.from = choose(none, Place{}, choose(comes, cut, piece.from));
      piece.to = choose(none, Place{}, choose(goes, cut, piece.to));
      piece.depthFrom = choose(comes, depth, piece.depthFrom);
      piece.depthTo = choose(goes, depth, piece.depthTo);
    }
    pieces[count++] = closing;
  }

  /// Depths below 0 are round-off.
  void levelRoundOff() {
    for (std::size_t k = 0; k < count; ++k) {
      pieces[k].depthFrom = larger(pieces[k].depthFrom, Wide{});
      pieces[k].depthTo = larger(pieces[k].depthTo, Wide{});
    }
  }

  std::size_t size() const { return count; }
  const Piece& operator[](std::size_t k) const { return pieces[k]; }

 private:
  std::array<Piece, 9> pieces;
  std::size_t count = 4;
};

/// The triangles of the first `cells` lanes, cell by cell.
void addTriangles(const Outline& outline, const Wide& depth, std::size_t cells, const OverlapLane (&targets)[wideSize],
                  PowerTriangles& triangles) {
  const Wide perDepth = 1 / depth;
  std::array<Wide, 9> twice, from, to;
  for (std::size_t n = 0; n < outline.size(); ++n) {
    twice[n] = magnitude(cross(outline[n].from, outline[n].to));
    from[n] = perDepth * outline[n].depthFrom;
    to[n] = perDepth * outline[n].depthTo;
  }
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t n = 0; n < outline.size(); ++n) {
      if (!(twice[n][i] > 0)) continue;
      const Piece& piece = outline[n];
      triangles.add({piece.from.x[i], piece.from.y[i], piece.to.x[i], piece.to.y[i], from[n][i], to[n][i], twice[n][i]},
                    targets[i]);
    }
  }
}

}  // namespace

void BoxCells::add(const BoxCell& cell, const Mask<Wide>& chosen, OverlapLanes& sums) {
  double lanes[fields][wideSize];
  std::memcpy(lanes, &cell, sizeof lanes);
  for (std::size_t k = 0; k < wideSize; ++k) {
    if (!chosen[k]) continue;
    for (std::size_t f = 0; f < fields; ++f) field[f][count] = lanes[f][k];
    target[count++] = {&sums, k};
  }
}

void BoxCells::integrate(PowerTriangles& triangles) {
  if (count == 0) return;
  // Whole registers: the lanes beyond the last cell repeat it.
  const std::size_t end = (count + wideSize - 1) / wideSize * wideSize;
  for (auto& lane : field) {
    for (std::size_t k = count; k < end; ++k) lane[k] = lane[count - 1];
  }
  for (std::size_t k = 0; k < end; k += wideSize) {
    BoxCell cell;
    static_assert(sizeof cell == fields * sizeof(Wide));
    double lanes[fields][wideSize];
    for (std::size_t f = 0; f < fields; ++f) std::copy_n(field[f] + k, wideSize, lanes[f]);
    std::memcpy(&cell, lanes, sizeof cell);

    Outline outline(cell);
    outline.clip([](const Place&, const Wide& depth) { return depth; });
    outline.clip([&](const Place& p, const Wide&) -> Wide { return p.x - cell.lowX; });
    outline.clip([&](const Place& p, const Wide&) -> Wide { return cell.highX - p.x; });
    outline.clip([&](const Place& p, const Wide&) -> Wide { return p.y - cell.lowY; });
    outline.clip([&](const Place& p, const Wide&) -> Wide { return cell.highY - p.y; });
    outline.levelRoundOff();

    const std::size_t last = std::min(count - k, wideSize);
    Mask<Wide> used = Wide{} < 1;
    OverlapLane targets[wideSize];
    for (std::size_t i = 0; i < wideSize; ++i) {
      if (i >= last) used[i] = 0;
      targets[i] = target[std::min(k + i, count - 1)];
    }
    Fan fan;
    for (std::size_t n = 0; n < outline.size(); ++n) {
      const Piece& piece = outline[n];
      fan.add(piece.from, piece.to, cell.depth, piece.depthFrom, piece.depthTo, used);
    }
    if (triangles.isWanted()) addTriangles(outline, cell.depth, last, targets, triangles);

    // Each to its contact.
    const auto found = fan.sums();
    for (std::size_t i = 0; i < last; ++i) {
      const OverlapLane& to = targets[i];
      for (std::size_t n = 0; n < found.size(); ++n) to.sums->moment[n][to.lane] += found[n][i];
    }
  }
  count = 0;
}

}  // namespace granular
