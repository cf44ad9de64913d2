#include "granular/point/box_cells.h"

#include <cstring>

namespace granular {
namespace {

// The integrals over the part of a parallelogram that lies in a rectangle are those along a closed way: every point of
// the parallelogram's outline is moved to the nearest place of the rectangle in x, then in y. Where the outline is
// outside, the way runs along the rectangle's sides, back and forth where there is nothing between: such spikes cancel
// to round-off. There is no case to decide, so that lanes do not part.

constexpr double third = 1.0 / 3, sixth = 1.0 / 6, twelfth = 1.0 / 12;

Wide share(const Wide& value) { return bounded(value, Wide{}, 1 + Wide{}); }

struct Sums {
  Wide area{}, x{}, y{}, xx{}, xy{}, yy{};
};
struct Box {
  Wide lowX, highX, lowY, highY;
};
struct Point {
  Wide x, y;
};
struct Way {
  Point from, to;
};

/// A piece of the way at a constant height y.
inline void addLevel(const Wide& x0, const Wide& x1, const Wide& y, Sums& sum) {
  const Wide first = y * (x1 - x0), moment = first * (x0 + x1);
  sum.area -= first;
  sum.x -= 0.5 * moment;
  sum.y -= 0.5 * y * first;
  sum.xx -= third * first * (x0 * x0 + x0 * x1 + x1 * x1);
  sum.xy -= 0.25 * y * moment;
  sum.yy -= third * first * y * y;
}

/// A straight piece.
inline void addSlant(const Wide& x0, const Wide& y0, const Wide& x1, const Wide& y1, Sums& sum) {
  const Wide d = x1 - x0, s = y0 + y1;
  const Wide y00 = y0 * y0, y01 = y0 * y1, y11 = y1 * y1;
  sum.area -= 0.5 * d * s;
  sum.x -= sixth * d * (x0 * (s + y0) + x1 * (s + y1));
  sum.y -= sixth * d * (y00 + y01 + y11);
  sum.xx -= twelfth * d * (x0 * x0 * (s + 2 * y0) + 2 * x0 * x1 * s + x1 * x1 * (s + 2 * y1));
  sum.xy -= (0.5 * twelfth) * d * (x0 * (3 * y00 + 2 * y01 + y11) + x1 * (y00 + 2 * y01 + 3 * y11));
  sum.yy -= twelfth * d * s * (y00 + y11);
}

/// The straight way, moved into the box.
[[gnu::always_inline]] inline void addWay(const Box& box, const Way& way, Sums& sum) {
  // Between the sides x = const.
  const Point &p = way.from, &q = way.to;
  const Wide dx = q.x - p.x, dy = q.y - p.y;
  const Wide inverseX = 1 / choose(dx != 0, dx, 1 + Wide{});
  const Wide from = share((choose(dx > 0, box.lowX, box.highX) - p.x) * inverseX);
  const Wide to = share((choose(dx > 0, box.highX, box.lowX) - p.x) * inverseX);
  const Wide x0 = bounded(p.x, box.lowX, box.highX), x1 = bounded(q.x, box.lowX, box.highX);
  const Wide y0 = p.y + from * dy, y1 = q.y - (1 - to) * dy;

  // On one side y = const, between them, on the other.
  const Wide rise = y1 - y0, run = x1 - x0;
  const Wide inverseY = 1 / choose(rise != 0, rise, 1 + Wide{});
  const Wide enter = share((choose(rise > 0, box.lowY, box.highY) - y0) * inverseY);
  const Wide leave = share((choose(rise > 0, box.highY, box.lowY) - y0) * inverseY);
  const Wide first = bounded(y0, box.lowY, box.highY), last = bounded(y1, box.lowY, box.highY);
  const Wide xEnter = x0 + enter * run, xLeave = x1 - (1 - leave) * run;
  addLevel(x0, xEnter, first, sum);
  addSlant(xEnter, first, xLeave, last, sum);
  addLevel(xLeave, x1, last, sum);
}

/// The part of the edge from p to q that has depth, from its depths at both ends; where there is none, a way from the
/// origin to itself, which lies in the overlap or at its rim. in and out receive where the depth begins or ends.
inline Way findWay(const Point& p, const Wide& depthP, const Point& q, const Wide& depthQ, Point& in, Point& out) {
  const auto before = depthP < 0, after = depthQ < 0;
  const auto comes = before & ~after, goes = after & ~before, none = before & after;
  const Wide part = depthP / choose(comes | goes, depthP - depthQ, 1 + Wide{});
  const Wide x = p.x + part * (q.x - p.x), y = p.y + part * (q.y - p.y);
  in = {choose(comes, x, in.x), choose(comes, y, in.y)};
  out = {choose(goes, x, out.x), choose(goes, y, out.y)};
  const Wide zero{};
  return {{choose(none, zero, choose(comes, x, p.x)), choose(none, zero, choose(comes, y, p.y))},
          {choose(none, zero, choose(goes, x, q.x)), choose(none, zero, choose(goes, y, q.y))}};
}

/// Shrinks the box to what of it the ways go round, so that no spike is longer than that.
inline void bound(const std::array<Way, 4>& ways, Box& box) {
  Wide lowX = smaller(ways[0].from.x, ways[0].to.x), highX = larger(ways[0].from.x, ways[0].to.x);
  Wide lowY = smaller(ways[0].from.y, ways[0].to.y), highY = larger(ways[0].from.y, ways[0].to.y);
  for (std::size_t k = 1; k < 4; ++k) {
    lowX = smaller(lowX, smaller(ways[k].from.x, ways[k].to.x));
    highX = larger(highX, larger(ways[k].from.x, ways[k].to.x));
    lowY = smaller(lowY, smaller(ways[k].from.y, ways[k].to.y));
    highY = larger(highY, larger(ways[k].from.y, ways[k].to.y));
  }
  box.lowX = larger(box.lowX, lowX);
  box.highX = larger(smaller(box.highX, highX), box.lowX);
  box.lowY = larger(box.lowY, lowY);
  box.highY = larger(smaller(box.highY, highY), box.lowY);
}

}  // namespace

void BoxCells::add(const BoxCell& cell, const Mask<Wide>& chosen, MomentLanes& sums) {
  double lanes[fields][wideSize];
  std::memcpy(lanes, &cell, sizeof lanes);
  for (std::size_t k = 0; k < wideSize; ++k) {
    if (!chosen[k]) continue;
    for (std::size_t f = 0; f < fields; ++f) field[f][count] = lanes[f][k];
    target[count] = &sums;
    targetLane[count++] = static_cast<std::uint8_t>(k);
  }
}

void BoxCells::integrate() {
  if (count == 0) return;
  // Whole registers: the lanes beyond the last cell repeat it.
  const std::size_t end = (count + wideSize - 1) / wideSize * wideSize;
  for (Lane& lane : field) {
    for (std::size_t k = count; k < end; ++k) lane[k] = lane[count - 1];
  }
  for (std::size_t k = 0; k < end; k += wideSize) {
    BoxCell cell;
    Wide* wide = &cell.lowX;
    for (std::size_t f = 0; f < fields; ++f) wide[f] = loadWide(field[f] + k);

    // Corners counter-clockwise.
    const auto turned = cell.alongX * cell.acrossY - cell.alongY * cell.acrossX < 0;
    const Wide ex = choose(turned, cell.acrossX, cell.alongX), ey = choose(turned, cell.acrossY, cell.alongY);
    const Wide fx = choose(turned, cell.alongX, cell.acrossX), fy = choose(turned, cell.alongY, cell.acrossY);
    const Point p0{cell.cornerX, cell.cornerY}, p1{p0.x + ex, p0.y + ey}, p2{p1.x + fx, p1.y + fy};
    const Point p3{p0.x + fx, p0.y + fy};
    const auto depthAt = [&](const Point& p) -> Wide { return cell.depth + cell.slopeX * p.x + cell.slopeY * p.y; };
    const Wide d0 = depthAt(p0), d1 = depthAt(p1), d2 = depthAt(p2), d3 = depthAt(p3);

    // Round what has depth, within the rectangle.
    Point in{}, out{};
    const std::array<Way, 4> ways = {findWay(p0, d0, p1, d1, in, out), findWay(p1, d1, p2, d2, in, out),
                                     findWay(p2, d2, p3, d3, in, out), findWay(p3, d3, p0, d0, in, out)};
    Box box{cell.lowX, cell.highX, cell.lowY, cell.highY};
    bound(ways, box);
    Sums sum;
    for (const Way& way : ways) addWay(box, way, sum);
    addWay(box, {out, in}, sum);

    MomentLanes found;
    const Wide volume = cell.depth * sum.area + cell.slopeX * sum.x + cell.slopeY * sum.y;
    storeWide(sum.area, found.area);
    storeWide(sum.x, found.x);
    storeWide(sum.y, found.y);
    storeWide(sum.xx, found.xx);
    storeWide(sum.xy, found.xy);
    storeWide(sum.yy, found.yy);
    storeWide(volume, found.volume);
    storeWide(cell.depth * sum.x + cell.slopeX * sum.xx + cell.slopeY * sum.xy, found.volumeX);
    storeWide(cell.depth * sum.y + cell.slopeX * sum.xy + cell.slopeY * sum.yy, found.volumeY);
    const Wide reach = larger(Wide(box.lowX * box.lowX), Wide(box.highX * box.highX)) +
                       larger(Wide(box.lowY * box.lowY), Wide(box.highY * box.highY));
    storeWide((box.highX - box.lowX) * (box.highY - box.lowY) * reach, found.spikes);

    // Each to its contact; a cell of no volume is round-off.
    const std::size_t last = count - k < wideSize ? count - k : wideSize;
    for (std::size_t i = 0; i < last; ++i) {
      if (!(found.volume[i] > 0)) continue;
      MomentLanes& m = *target[k + i];
      const std::size_t to = targetLane[k + i];
      m.area[to] += found.area[i];
      m.x[to] += found.x[i];
      m.y[to] += found.y[i];
      m.xx[to] += found.xx[i];
      m.xy[to] += found.xy[i];
      m.yy[to] += found.yy[i];
      m.volume[to] += found.volume[i];
      m.volumeX[to] += found.volumeX[i];
      m.volumeY[to] += found.volumeY[i];
      m.spikes[to] += found.spikes[i];
    }
  }
  count = 0;
}

}  // namespace granular
