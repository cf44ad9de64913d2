#include "granular/analysis/ring_samples.h"

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {

namespace {

/// The part of a cell [index, index + 1] * step that lies between two limits, as a share of the cell.
double overlapShare(std::size_t index, double step, double from, double to) {
  const double lo = static_cast<double>(index) * step;
  return std::max(0.0, std::min(lo + step, to) - std::max(lo, from)) / step;
}

/// One curve at one height.
struct Curve {
  const Occupancy& occupancy;
  const CrossSection& section;
  double distance, height;

  bool solidAt(double fraction) const {
    const Vec2 p = section.curvePoint(distance, fraction - std::floor(fraction));
    return occupancy.contains(Vec3(p.x(), p.y(), height));
  }
  /// Where between a and b the curve enters or leaves a particle: solid at a differs from solid at b.
  double bisect(double a, double b, bool solidAtA) const {
    for (int k = 0; k < 10; ++k) {
      const double middle = 0.5 * (a + b);
      (solidAt(middle) == solidAtA ? a : b) = middle;
    }
    return 0.5 * (a + b);
  }
};

/// Solid share of a curve sampled at count points, the first at phase (in spacings).
double measureShare(const Curve& curve, int count, double phase, ArcRule rule) {
  const double spacing = 1.0 / count;
  const auto place = [&](int k) { return (k + phase) * spacing; };
  double length = 0;
  const bool first = curve.solidAt(place(0));
  bool here = first;
  for (int k = 0; k < count; ++k) {
    const bool next = k + 1 < count ? curve.solidAt(place(k + 1)) : first;
    switch (rule) {
      case ArcRule::spacing:
        if (here) length += spacing;
        break;
      case ArcRule::paper:
        if (here && next) length += spacing;
        break;
      case ArcRule::refined: {
        if (here == next) {
          if (here) length += spacing;
          break;
        }
        const double edge = curve.bisect(place(k), place(k + 1), here);
        length += here ? edge - place(k) : place(k + 1) - edge;
        break;
      }
    }
    here = next;
  }
  return std::clamp(length, 0.0, 1.0);
}

/// Whole number of steps that fill a length, at least one.
std::size_t countSteps(double length, double step) {
  return static_cast<std::size_t>(std::max(1.0, std::round(length / step)));
}

}  // namespace

double RingSamples::meanOfDisc(std::size_t disc) const {
  double solid = 0, area = 0;
  for (std::size_t k = 0; k < rings; ++k) {
    solid += at(disc, k) * ringArea[k];
    area += ringArea[k];
  }
  return solid / area;
}

double RingSamples::meanOfRing(std::size_t ring, double from, double to) const {
  double solid = 0, weight = 0;
  for (std::size_t j = 0; j < discs; ++j) {
    const double part = overlapShare(j, discStep, from - lo, to - lo);
    solid += part * at(j, ring);
    weight += part;
  }
  return solid / weight;
}

double RingSamples::mean(double from, double to, double nearest, double furthest) const {
  double solid = 0, area = 0;
  for (std::size_t k = 0; k < rings; ++k) {
    const double part = overlapShare(k, ringStep, nearest, furthest) * ringArea[k];
    if (part <= 0) continue;
    solid += part * meanOfRing(k, from, to);
    area += part;
  }
  return solid / area;
}

RingSamples sampleRings(const Occupancy& occupancy, const CrossSection& section, const RingGrid& grid, ArcRule rule) {
  require(grid.hi > grid.lo && grid.discStep > 0 && grid.ringStep > 0 && grid.arcStep > 0,
          "porosity sampling: heights and steps must be positive");
  RingSamples samples;
  samples.lo = grid.lo;
  samples.discs = countSteps(grid.hi - grid.lo, grid.discStep);
  samples.discStep = (grid.hi - grid.lo) / static_cast<double>(samples.discs);
  samples.rings = countSteps(section.depth(), grid.ringStep);
  samples.ringStep = section.depth() / static_cast<double>(samples.rings);
  samples.share.resize(samples.discs * samples.rings);

  // The curve's length is linear in the distance, so that length times step is the ring's exact area.
  std::vector<int> count(samples.rings);
  for (std::size_t k = 0; k < samples.rings; ++k) {
    const double length = section.curveLength(samples.distance(k));
    samples.ringArea.push_back(length * samples.ringStep);
    count[k] = std::max(8, static_cast<int>(std::ceil(length / grid.arcStep)));
    samples.points += samples.discs * static_cast<std::size_t>(count[k]);
  }

  // Every curve starts at another phase (multiples of the golden ratio), so that no lattice falls into step with the
  // points.
  const auto total = static_cast<std::int64_t>(samples.share.size());
#pragma omp parallel for schedule(dynamic, 64)
  for (std::int64_t n = 0; n < total; ++n) {
    const auto disc = static_cast<std::size_t>(n) / samples.rings, ring = static_cast<std::size_t>(n) % samples.rings;
    const double turn = 0.6180339887498949 * static_cast<double>(n);
    const Curve curve{occupancy, section, samples.distance(ring), samples.height(disc)};
    samples.share[static_cast<std::size_t>(n)] = measureShare(curve, count[ring], turn - std::floor(turn), rule);
  }
  return samples;
}

}  // namespace granular
