#include "granular/analysis/solid_fraction.h"

#include <algorithm>
#include <sstream>

namespace granular {

namespace {

/// Share of a placed shape's volume below a height, by a grid of points over its bounds.
double measureShareBelow(const Shape& shape, const Frame& frame, double height) {
  const Aabb box = shape.bounds(frame);
  if (box.hi.z() <= height) return 1;
  if (box.lo.z() >= height) return 0;
  constexpr int n = 24;
  const Vec3 step = (box.hi - box.lo) / n;
  double below = 0, all = 0;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c) {
        const Vec3 p = box.lo + step.cwiseProduct(Vec3(a + 0.5, b + 0.5, c + 0.5));
        if (!shape.contains(frame.toBody(p))) continue;
        // The layer that the height cuts counts by its part below.
        all += 1;
        below += std::clamp((height - p.z()) / step.z() + 0.5, 0.0, 1.0);
      }
  return all > 0 ? below / all : (frame.x.z() < height ? 1 : 0);
}

std::string describeLengths(double length, double unit) {
  std::ostringstream text;
  text.precision(3);
  text << length / unit;
  return text.str();
}

}  // namespace

Regions layOutRegions(const CrossSection& section, double height, double unit, double length, double coreLengths,
                      double nearWallLengths) {
  Regions regions;
  regions.unit = unit;
  regions.length = length;
  regions.walled = section.walled();
  regions.nearWall = std::min(nearWallLengths * length, section.depth());

  // Heights: without the ends when the bed is high enough.
  const bool high = height >= 8 * length;
  const double margin = coreLengths * length;
  regions.from = high ? margin : 0;
  regions.to = high ? height - margin : height;
  if (!high)
    regions.notes.push_back(
        "The bed is " + describeLengths(height, length) +
        " longest lengths high, less than 8: no core, and the near-wall region spans the whole height.");

  // Width: a core of at least a quarter of a length is asked for.
  const bool wide = !section.walled() || section.depth() >= margin + 0.25 * length;
  regions.core = section.walled() ? margin : 0;
  regions.hasCore = high && wide;
  if (!wide)
    regions.notes.push_back("The vessel is " + describeLengths(section.depth(), length) +
                            " longest lengths from wall to middle, less than " +
                            describeLengths(margin + 0.25 * length, length) + ": no core.");
  if (!section.walled())
    regions.notes.push_back("The vessel is not walled all around: no near-wall region and no radial profile.");
  return regions;
}

double measureVolumeBelow(const Bed& bed, double height) {
  std::vector<double> volume(bed.size());
#pragma omp parallel for schedule(dynamic, 16)
  for (std::int64_t n = 0; n < static_cast<std::int64_t>(bed.size()); ++n) {
    const auto i = static_cast<std::size_t>(n);
    volume[i] = bed.shapes[i]->massProperties().volume * measureShareBelow(*bed.shapes[i], bed.frames[i], height);
  }
  double sum = 0;
  for (const double v : volume) sum += v;
  return sum;
}

SolidFractions measureSolidFractions(const Bed& bed, const CrossSection& section, const RingSamples& samples,
                                     const FillingHeight& filling, const Regions& regions) {
  SolidFractions solid;
  const double height = filling.equivalent, vessel = section.area() * height;
  if (!(vessel > 0)) return solid;
  double volume = 0;
  for (const Shape* shape : bed.shapes) volume += shape->massProperties().volume;
  solid.overall = volume / vessel;
  solid.below = measureVolumeBelow(bed, samples.lo + height) / vessel;
  solid.sampled = samples.mean(samples.lo, samples.lo + height, 0, section.depth());

  const double from = samples.lo + regions.from, to = samples.lo + regions.to;
  if (regions.walled) solid.nearWall = samples.mean(from, to, 0, regions.nearWall);
  if (regions.hasCore) solid.core = samples.mean(from, to, regions.core, section.depth());
  return solid;
}

}  // namespace granular
