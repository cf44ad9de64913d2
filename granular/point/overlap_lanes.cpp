#include "granular/point/overlap_lanes.h"

namespace granular {

void PowerTriangles::add(const Triangle& triangle, const OverlapLane& whose) {
  makeRoom(1);
  px[count] = triangle.px;
  py[count] = triangle.py;
  qx[count] = triangle.qx;
  qy[count] = triangle.qy;
  depthP[count] = triangle.depthP;
  depthQ[count] = triangle.depthQ;
  area[count] = 0.5 * triangle.twice;
  target[count++] = whose;
}

// The recurrence of depth_powers.h for three corners, the first of them the origin with a depth of 1: what belongs to
// it alone is 1 in every step, and it has no part in the first moments.
void PowerTriangles::integrate() {
  if (count == 0) return;
  const std::size_t end = (count + wideSize - 1) / wideSize * wideSize;
  for (Lane* lane : {&px, &py, &qx, &qy, &depthP, &depthQ, &area}) {
    for (std::size_t k = count; k < end; ++k) (*lane)[k] = (*lane)[count - 1];
  }
  const auto mean = [](double n) { return 2 / ((n + 1) * (n + 2)); };
  for (std::size_t k = 0; k < end; k += wideSize) {
    const Wide p = loadWide(depthP + k), q = loadWide(depthQ + k);
    Wide firstTwo = 1 + Wide{}, whole = firstTwo, twiceP = firstTwo, twiceQ = firstTwo;
    const auto raise = [&] {
      firstTwo = p * firstTwo + 1;
      whole = q * whole + firstTwo;
      twiceP = p * twiceP + whole;
      twiceQ = q * twiceQ + whole;
    };
    const Wide a = loadWide(area + k);
    const Place atP{loadWide(px + k), loadWide(py + k)}, atQ{loadWide(qx + k), loadWide(qy + k)};
    const auto first = [&](double n) { return Wide(mean(n) / (n + 3) * a) * (twiceP * atP + twiceQ * atQ); };
    for (int n = 1; n < power; ++n) raise();
    const Wide below = mean(power - 1) * a * whole;
    const Place firstBelow = first(power - 1);
    raise();
    const Wide at = mean(power) * a * whole;
    const Place firstAt = first(power);
    raise();
    const Wide above = mean(power + 1) * a * whole;
    const std::array<Wide, OverlapLanes::powers> found = {below,        at,        above,    firstBelow.x,
                                                          firstBelow.y, firstAt.x, firstAt.y};
    const std::size_t last = count - k < wideSize ? count - k : wideSize;
    for (std::size_t i = 0; i < last; ++i) {
      const OverlapLane& to = target[k + i];
      for (std::size_t f = 0; f < found.size(); ++f) to.sums->power[f][to.lane] += found[f][i];
    }
  }
  count = 0;
}

}  // namespace granular
