#include "granular/insert/size_distribution.h"

#include <fmt/format.h>

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {
namespace {

constexpr int cellCount = 256;
// Beyond six deviations lie 2e-9 of a Gaussian: no bed has as many particles.
constexpr double deviationsKept = 6;

double inverseCubeOf(double s) { return 1 / (s * s * s); }

const char* weightName(SizeWeight weight) { return weight == SizeWeight::mass ? "by mass" : "by number"; }

}  // namespace

SizeDistribution::SizeDistribution(const SizeOptions& options) : given(options) {
  switch (given.kind) {
    case SizeKind::fixed:
      setFixed(given.value);
      break;
    case SizeKind::uniform:
      setUniform();
      break;
    case SizeKind::normal:
      setNormal();
      break;
    case SizeKind::logNormal:
      setLogNormal();
      break;
    case SizeKind::sieve:
      setSieve();
      break;
  }
}

void SizeDistribution::setFixed(double size) {
  require(size > 0 && std::isfinite(size), fmt::format("size: {} is not positive", size));
  lo = hi = size;
}

void SizeDistribution::setUniform() {
  require(given.min > 0 && std::isfinite(given.min), fmt::format("size: the lower end {} is not positive", given.min));
  require(given.max >= given.min && std::isfinite(given.max),
          fmt::format("size: the upper end {} is below the lower end {}, or not finite", given.max, given.min));
  lo = given.min;
  hi = given.max;
}

void SizeDistribution::cutOff(double from, double to) {
  lo = std::max(given.min, from);
  hi = std::min(given.max, to);
  require(lo > 0, fmt::format("size: reaches down to {}; give a lower cut-off above 0", lo));
  require(lo < hi, fmt::format("size: nothing lies between the cut-offs {} and {} (mean {}, deviation {})", given.min,
                               given.max, given.mean, given.deviation));
}

void SizeDistribution::setNormal() {
  require(given.mean > 0 && std::isfinite(given.mean), fmt::format("size: the mean {} is not positive", given.mean));
  require(given.deviation >= 0 && std::isfinite(given.deviation),
          fmt::format("size: the deviation {} is negative or not finite", given.deviation));
  if (given.deviation == 0) return setFixed(given.mean);

  middle = given.mean;
  width = given.deviation;
  cutOff(middle - deviationsKept * width, middle + deviationsKept * width);
  inverseCube = given.weight == SizeWeight::mass;
  makeCells(lo, hi);
}

void SizeDistribution::setLogNormal() {
  require(given.mean > 0 && std::isfinite(given.mean), fmt::format("size: the mean {} is not positive", given.mean));
  require(given.deviation >= 0 && std::isfinite(given.deviation),
          fmt::format("size: the deviation {} is negative or not finite", given.deviation));
  if (given.deviation == 0) return setFixed(given.mean);

  // Mean and variance of the logarithm, from those of the size.
  const double ratio = given.deviation / given.mean;
  const double variance = std::log1p(ratio * ratio);
  width = std::sqrt(variance);
  const double middleGiven = std::log(given.mean) - variance / 2;
  // s^-3 times a log-normal is one again, of the same width, shifted by three variances (Hatch & Choate 1929).
  middle = given.weight == SizeWeight::mass ? middleGiven - 3 * variance : middleGiven;
  cutOff(std::exp(middle - deviationsKept * width), std::exp(middleGiven + deviationsKept * width));
  makeCells(std::log(lo), std::log(hi));
}

void SizeDistribution::setSieve() {
  const std::vector<double>& sizes = given.sizes;
  const std::vector<double>& passing = given.passing;
  require(sizes.size() >= 2 && sizes.size() == passing.size(),
          fmt::format("sieve curve: {} openings and {} fractions; both need as many, at least 2", sizes.size(),
                      passing.size()));
  require(passing.front() == 0 && passing.back() == 1,
          fmt::format("sieve curve: runs from {} to {}; it must run from 0 to 1", passing.front(), passing.back()));

  double total = 0;
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k) {
    const double from = sizes[k], to = sizes[k + 1], share = passing[k + 1] - passing[k];
    require(from > 0 && to > from && std::isfinite(to),
            fmt::format("sieve curve: the opening {} follows {}; openings must be positive and ascend", to, from));
    require(share >= 0,
            fmt::format("sieve curve: falls from {} to {} at the opening {}", passing[k], passing[k + 1], to));
    if (share == 0) continue;
    // Mass spread evenly over the sizes of a class: integral of s^-3 over it, divided by its width.
    const double byNumber =
        given.weight == SizeWeight::number ? share : share * (from + to) / (2 * from * from * to * to);
    total += byNumber;
    classes.push_back({total, from, to});
  }
  for (Class& each : classes) each.cumulated /= total;
  lo = classes.front().lo;
  hi = classes.back().hi;
}

double SizeDistribution::density(double t) const {
  const double z = (t - middle) / width;
  const double gauss = std::exp(-z * z / 2);
  return inverseCube ? gauss * inverseCubeOf(t / lo) : gauss;
}

void SizeDistribution::makeCells(double from, double to) {
  // Cells of equal ratio follow s^-3 down evenly; a Gaussian alone wants cells of equal width.
  const auto edge = [&](int k) {
    const double f = double(k) / cellCount;
    return inverseCube ? from * std::pow(to / from, f) : from + (to - from) * f;
  };
  double total = 0;
  for (int k = 0; k < cellCount; ++k) {
    const double a = edge(k);
    const double b = k + 1 == cellCount ? to : edge(k + 1);
    // The Gaussian is largest at the point nearest its middle, s^-3 at the lower end.
    const double z = (std::clamp(middle, a, b) - middle) / width;
    const double bound = std::exp(-z * z / 2) * (inverseCube ? inverseCubeOf(a / lo) : 1);
    total += bound * (b - a);
    cells.push_back({total, a, b, bound});
  }
  for (Cell& each : cells) each.cumulated /= total;
}

double SizeDistribution::drawFromCells(Random& random) const {
  for (;;) {
    const double u = random.uniform();
    const auto cell = std::upper_bound(cells.begin(), cells.end() - 1, u,
                                       [](double value, const Cell& each) { return value < each.cumulated; });
    const double t = random.uniform(cell->lo, cell->hi);
    if (random.uniform() * cell->bound < density(t)) return t;
  }
}

double SizeDistribution::drawBetween(double from, double to, Random& random) const {
  const double u = random.uniform();
  if (given.weight == SizeWeight::number) return from + (to - from) * u;
  // The inverse of the cumulated s^-3 on [from, to].
  const double ratio = from / to;
  return std::min(to, from / std::sqrt(1 - u * (1 - ratio * ratio)));
}

double SizeDistribution::draw(Random& random) const {
  if (lo == hi) return lo;
  if (given.kind == SizeKind::uniform) return drawBetween(lo, hi, random);
  if (given.kind == SizeKind::normal) return drawFromCells(random);
  if (given.kind == SizeKind::logNormal) return std::clamp(std::exp(drawFromCells(random)), lo, hi);
  const double u = random.uniform();
  const auto found = std::upper_bound(classes.begin(), classes.end() - 1, u,
                                      [](double value, const Class& each) { return value < each.cumulated; });
  return drawBetween(found->lo, found->hi, random);
}

std::string SizeDistribution::describe() const {
  const char* weight = weightName(given.weight);
  switch (given.kind) {
    case SizeKind::fixed:
      return fmt::format("fixed {}", given.value);
    case SizeKind::uniform:
      return fmt::format("uniform {} to {} {}", lo, hi, weight);
    case SizeKind::normal:
      return fmt::format("normal, mean {}, deviation {}, within {} to {}, {}", given.mean, given.deviation, lo, hi,
                         weight);
    case SizeKind::logNormal:
      return fmt::format("log-normal, mean {}, deviation {}, within {} to {}, {}", given.mean, given.deviation, lo, hi,
                         weight);
    case SizeKind::sieve:
      return fmt::format("sieve curve of {} openings, {} to {}, {}", given.sizes.size(), lo, hi, weight);
  }
  return {};
}

}  // namespace granular
