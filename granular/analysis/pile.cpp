#include "granular/analysis/pile.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "granular/shape/chords.h"

namespace granular {

double defaultSpacing(const Bed& bed) {
  double sum = 0;
  for (const Shape* shape : bed.shapes) sum += shape->size();
  return 0.05 * sum / static_cast<double>(std::max<std::size_t>(1, bed.size()));
}

std::vector<SurfacePoint> sampleSide(const Bed& bed, double spacing) {
  double reach = 0;
  for (std::size_t i = 0; i < bed.size(); ++i) reach = std::max(reach, bed.shapes[i]->bounds(bed.frames[i]).hi.x());
  const auto count = static_cast<std::size_t>(std::ceil(reach / spacing));
  std::vector<SurfacePoint> surface(count);
  for (std::size_t k = 0; k < count; ++k) surface[k] = {(static_cast<double>(k) + 0.5) * spacing, 0};

  // Each particle above the places it covers.
  ChordFinder finder;
  std::vector<Chord> chords;
  for (std::size_t i = 0; i < bed.size(); ++i) {
    const Aabb box = bed.shapes[i]->bounds(bed.frames[i]);
    const auto first = static_cast<std::int64_t>(std::floor(box.lo.x() / spacing));
    for (std::int64_t k = std::max<std::int64_t>(0, first); k < static_cast<std::int64_t>(count); ++k) {
      SurfacePoint& place = surface[static_cast<std::size_t>(k)];
      if (place.distance > box.hi.x()) break;
      if (box.hi.z() <= place.height) continue;
      finder.find(*bed.shapes[i], bed.frames[i], place.distance, 0, chords);
      if (!chords.empty()) place.height = std::max(place.height, chords.back().high);
    }
  }
  return surface;
}

std::vector<SurfacePoint> sampleCone(const Bed& bed, double spacing, int sectors) {
  double reach = 0;
  for (std::size_t i = 0; i < bed.size(); ++i)
    reach = std::max(reach, bed.frames[i].x.head<2>().norm() + bed.shapes[i]->boundingRadius());
  const auto rings = static_cast<std::size_t>(std::ceil(reach / spacing));
  std::vector<double> heights(rings * static_cast<std::size_t>(sectors), 0);

  ChordFinder finder;
  std::vector<Chord> chords;
  for (std::size_t i = 0; i < bed.size(); ++i) {
    const Frame& frame = bed.frames[i];
    const double away = frame.x.head<2>().norm(), radius = bed.shapes[i]->boundingRadius();
    const auto first = static_cast<std::int64_t>(std::floor((away - radius) / spacing));
    for (auto k = static_cast<std::size_t>(std::max<std::int64_t>(0, first)); k < rings; ++k) {
      const double r = (static_cast<double>(k) + 0.5) * spacing;
      if (r > away + radius) break;
      for (int s = 0; s < sectors; ++s) {
        const double azimuth = 2 * pi * (s + 0.5) / sectors;
        const double x = r * std::cos(azimuth), y = r * std::sin(azimuth);
        double& height = heights[k * static_cast<std::size_t>(sectors) + static_cast<std::size_t>(s)];
        if (frame.x.z() + radius <= height || (frame.x.head<2>() - Vec2(x, y)).squaredNorm() > radius * radius)
          continue;
        finder.find(*bed.shapes[i], frame, x, y, chords);
        if (!chords.empty()) height = std::max(height, chords.back().high);
      }
    }
  }
  std::vector<SurfacePoint> surface;
  for (std::size_t k = 0; k < rings; ++k) {
    double sum = 0;
    for (int s = 0; s < sectors; ++s)
      sum += heights[k * static_cast<std::size_t>(sectors) + static_cast<std::size_t>(s)];
    surface.push_back({(static_cast<double>(k) + 0.5) * spacing, sum / sectors});
  }
  return surface;
}

namespace {

/// Half-open range of the surface's places.
using Stretch = std::pair<std::size_t, std::size_t>;

/// From the last place above the upper height to the first below the lower one.
Stretch middleOfHeight(const std::vector<SurfacePoint>& surface, const PileOptions& options, double height) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < surface.size(); ++k)
    if (surface[k].height >= options.high * height) first = k + 1;
  std::size_t last = first;
  while (last < surface.size() && surface[last].height >= options.low * height) ++last;
  return {first, last};
}

Stretch middleOfBase(const std::vector<SurfacePoint>& surface, const PileOptions& options) {
  const auto foot = std::find_if(surface.begin(), surface.end(), [](const SurfacePoint& p) { return !(p.height > 0); });
  const auto base = static_cast<double>(foot - surface.begin());
  return {static_cast<std::size_t>((1 - options.high) * base), static_cast<std::size_t>((1 - options.low) * base)};
}

}  // namespace

std::optional<SlopeLine> fitSlope(const std::vector<SurfacePoint>& surface, const PileOptions& options, double grain) {
  SlopeLine line;
  for (const SurfacePoint& p : surface) line.height = std::max(line.height, p.height);

  const auto [first, last] =
      options.ofBase ? middleOfBase(surface, options) : middleOfHeight(surface, options, line.height);
  const auto n = static_cast<double>(last - first);
  if (n < 3) return std::nullopt;

  double meanX = 0, meanZ = 0, xx = 0, xz = 0, squares = 0;
  for (std::size_t k = first; k < last; ++k) {
    meanX += surface[k].distance / n;
    meanZ += surface[k].height / n;
  }
  for (std::size_t k = first; k < last; ++k) {
    xx += std::pow(surface[k].distance - meanX, 2);
    xz += (surface[k].distance - meanX) * (surface[k].height - meanZ);
  }
  const double slope = -xz / xx;
  line.top = meanZ + slope * meanX;
  for (std::size_t k = first; k < last; ++k)
    squares += std::pow(surface[k].height - line.top + slope * surface[k].distance, 2);
  line.from = surface[first].distance;
  line.to = surface[last - 1].distance;
  line.deviation = std::sqrt(squares / n);
  line.angle = std::atan(slope) * 180 / pi;

  // Places on one particle are not independent: as many count as grains fit into the middle.
  const double spacing = (line.to - line.from) / (n - 1), independent = std::max(1.0, n * spacing / grain);
  line.standardError = line.deviation / std::sqrt(xx / n * independent) / (1 + slope * slope) * 180 / pi;
  return line;
}

PlanePorosity measurePorosity(const Bed& bed, const std::vector<SurfacePoint>& surface) {
  PlanePorosity result;
  if (surface.empty()) return result;
  const double spacing = 2 * surface[0].distance;
  for (const SurfacePoint& p : surface) result.pileArea += p.height * spacing;
  ChordFinder finder;
  for (std::size_t i = 0; i < bed.size(); ++i)
    result.sectionArea += finder.sectionArea(*bed.shapes[i], bed.frames[i], 0);
  result.porosity = 1 - result.sectionArea / result.pileArea;
  return result;
}

}  // namespace granular
