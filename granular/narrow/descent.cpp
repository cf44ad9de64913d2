#include "granular/narrow/descent.h"

#include "granular/narrow/gjk.h"

namespace granular {
namespace {

constexpr int maxSteps = 40;

/// Distance of the outside point from C, relative to the pair's size: the direction is then good to the machine
/// precision over it, and smooth surfaces converge by about this factor per step.
constexpr double stepGap = 1e-2;

}  // namespace

LocalMinimum descend(Difference& c, const Vec3& start) {
  const double g = stepGap * c.size();
  LocalMinimum out;
  const SupportPoint first = c.support(start);
  out.normal = start;
  out.depth = first.w.dot(start);
  out.onA = first.a;
  out.onB = first.b;

  for (int step = 0; step < maxSteps; ++step) {
    const Vec3 p = (out.depth + g) * out.normal;
    const Nearest nearest = findNearest(c, p, out.normal, 1e-15);
    if (nearest.inside || !(nearest.gap > 0)) break;
    const Vec3 n = nearest.direction;
    const double depth = n.dot(p) - nearest.gap;
    const double turn = (n - out.normal).norm();
    if (!(depth <= out.depth)) {
      // No progress beyond round-off: the direction stays, its witness points are the better ones of the search.
      if (turn < 1e-6) {
        out.onA = nearest.onA;
        out.onB = nearest.onB;
      }
      break;
    }
    out = {n, depth, nearest.onA, nearest.onB};
    if (turn < 1e-14) break;
  }

  // Hold the two points to the overlap exactly.
  const Vec3 middle = 0.5 * (out.onA + out.onB);
  out.onA = middle + 0.5 * out.depth * out.normal;
  out.onB = middle - 0.5 * out.depth * out.normal;
  return out;
}

}  // namespace granular
