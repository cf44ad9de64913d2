#include "granular/narrow/descent.h"

#include "granular/narrow/gjk.h"

namespace granular {
namespace {

constexpr int maxSteps = 40;

/// Distance of the outside point from C, relative to the pair's size: the direction is then good to the machine
/// precision over it, and smooth surfaces converge by about this factor per step.
constexpr double stepGap = 1e-2;

/// How far the two points lie from being opposite each other along the normal, squared, m^2.
double offset2(const Vec3& onA, const Vec3& onB, const Vec3& normal) {
  const Vec3 w = onA - onB;
  return (w - w.dot(normal) * normal).squaredNorm();
}

/// Moves the two points along the normal so that they are the overlap apart, exactly.
void holdApart(LocalMinimum& m) {
  m.off = std::sqrt(offset2(m.onA, m.onB, m.normal));
  const Vec3 middle = 0.5 * (m.onA + m.onB);
  m.onA = middle + 0.5 * m.depth * m.normal;
  m.onB = middle - 0.5 * m.depth * m.normal;
}

}  // namespace

LocalMinimum descend(Difference& c, const Vec3& start) {
  const double g = stepGap * c.size();
  const double roundOff = 4 * std::numeric_limits<double>::epsilon() * c.extent();
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
      // No progress beyond round-off: the direction stays. Where it supports a line or a face, any point of which may
      // be the support point, those of the search lie opposite each other.
      if (offset2(nearest.onA, nearest.onB, out.normal) < offset2(out.onA, out.onB, out.normal)) {
        out.onA = nearest.onA;
        out.onB = nearest.onB;
      }
      break;
    }
    const bool settled = out.depth - depth <= roundOff || turn < 1e-14;
    out = {n, depth, nearest.onA, nearest.onB};
    if (settled) break;
  }

  holdApart(out);
  return out;
}

}  // namespace granular
