#include "granular/analysis/filling_height.h"

#include <algorithm>

namespace granular {

namespace {

/// The fractions averaged over a window of the given number of discs, centred.
std::vector<double> smooth(const std::vector<double>& fraction, std::size_t window) {
  std::vector<double> sums(fraction.size() + 1, 0.0), mean(fraction.size());
  for (std::size_t j = 0; j < fraction.size(); ++j) sums[j + 1] = sums[j] + fraction[j];
  for (std::size_t j = 0; j < fraction.size(); ++j) {
    const std::size_t from = j > window / 2 ? j - window / 2 : 0, to = std::min(fraction.size(), j + window / 2 + 1);
    mean[j] = (sums[to] - sums[from]) / static_cast<double>(to - from);
  }
  return mean;
}

/// Mean with cos^2 weight between two heights, m above the first disc's lower side.
double averageTapered(const std::vector<double>& fraction, double step, double from, double to) {
  double sum = 0, weight = 0;
  for (std::size_t j = 0; j < fraction.size(); ++j) {
    const double t = ((static_cast<double>(j) + 0.5) * step - from) / (to - from);
    if (t <= 0 || t >= 1) continue;
    const double w = std::pow(std::sin(pi * t), 2);
    sum += w * fraction[j];
    weight += w;
  }
  return weight > 0 ? sum / weight : 0;
}

/// Height at which the fraction, seen from above, first reaches the level; linear between discs.
double findTop(const std::vector<double>& fraction, double step, double level) {
  for (std::size_t j = fraction.size(); j-- > 0;) {
    if (fraction[j] < level) continue;
    const double above = j + 1 < fraction.size() ? fraction[j + 1] : 0;
    return (static_cast<double>(j) + 0.5 + (fraction[j] - level) / (fraction[j] - above)) * step;
  }
  return 0;
}

/// Solid volume per area above a height, m.
double integrateAbove(const std::vector<double>& fraction, double step, double from) {
  double sum = 0;
  for (std::size_t j = 0; j < fraction.size(); ++j) {
    const double lo = static_cast<double>(j) * step;
    sum += fraction[j] * std::max(0.0, lo + step - std::max(lo, from));
  }
  return sum;
}

}  // namespace

FillingHeight measureFillingHeight(const RingSamples& samples, double length, double highestPoint) {
  std::vector<double> fraction(samples.discs);
  for (std::size_t j = 0; j < samples.discs; ++j) fraction[j] = samples.meanOfDisc(j);
  const double step = samples.discStep;
  const std::vector<double> mean = smooth(fraction, static_cast<std::size_t>(std::max(1.0, length / step)));

  // The bulk depends on the top and the top on the bulk: start from the densest layer and settle within a few rounds.
  FillingHeight filling;
  filling.highestPoint = highestPoint - samples.lo;
  double level = 0.5 * *std::max_element(mean.begin(), mean.end());
  for (int round = 0; round < 8; ++round) {
    filling.halfFraction = findTop(mean, step, level);
    const double margin = std::min(2 * length, 0.25 * filling.halfFraction);
    filling.bulkFrom = margin;
    filling.bulkTo = filling.halfFraction - margin;
    filling.bulkFraction = averageTapered(fraction, step, filling.bulkFrom, filling.bulkTo);
    level = 0.5 * filling.bulkFraction;
  }
  const double middle = 0.5 * (filling.bulkFrom + filling.bulkTo);
  filling.equivalent = middle;
  if (filling.bulkFraction > 0) filling.equivalent += integrateAbove(fraction, step, middle) / filling.bulkFraction;
  return filling;
}

}  // namespace granular
