// What every shape shares: measures, and the bounds that any support function gives.
#include "granular/shape/shape.h"

#include <algorithm>
#include <cstdio>

namespace granular {

void Shape::setMeasures(const MassProperties& properties, double bounding, double inner, double longestLength,
                        const Vec3& directorAxis) {
  mass = properties;
  outerRadius = bounding;
  insideRadius = inner;
  equalVolumeRadius = std::cbrt(3 * properties.volume / (4 * pi));
  longest = longestLength;
  axis = directorAxis;
}

void Shape::setScaledMeasures(const Shape& source, double factor) {
  const double square = factor * factor;
  MassProperties scaled = source.mass;
  scaled.volume *= square * factor;
  scaled.area *= square;
  scaled.inertia *= square * square * factor;
  scaled.meanSquareRadius *= square;
  setMeasures(scaled, source.outerRadius * factor, source.insideRadius * factor, source.longest * factor, source.axis);
}

Aabb Shape::bounds(const Frame& frame) const {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    // world axis k seen from the body
    const Vec3 d = frame.R.row(k).transpose();
    box.hi[k] = frame.x[k] + d.dot(support(d));
    box.lo[k] = frame.x[k] + d.dot(support(-d));
  }
  return box;
}

Vec3 distinctAxis(const Vec3& measures, bool preferLargest) {
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return measures[i] < measures[j]; });
  const double near = 1e-9 * measures[order[2]];
  const double below = measures[order[1]] - measures[order[0]];
  const double above = measures[order[2]] - measures[order[1]];
  if (below <= near && above <= near) return Vec3::UnitZ();
  const bool largest = std::abs(above - below) <= near ? preferLargest : above > below;
  return Vec3::Unit(largest ? order[2] : order[0]);
}

namespace {

struct Unit {
  double metres;
  const char* name;
};

/// The unit in which the largest of the lengths reads well.
Unit readableUnit(double largest) {
  if (largest >= 1) return {1, "m"};
  return largest >= 1e-4 ? Unit{1e-3, "mm"} : Unit{1e-6, "um"};
}

}  // namespace

std::string describeLengths(std::initializer_list<double> metres) {
  const Unit unit = readableUnit(std::max(metres));
  std::string text;
  for (double length : metres) {
    char number[32];
    std::snprintf(number, sizeof number, "%.4g", length / unit.metres);
    text += (text.empty() ? "" : " x ") + std::string(number);
  }
  return text + " " + unit.name;
}

std::string describeLength(double metres) { return describeLengths({metres}); }

}  // namespace granular
