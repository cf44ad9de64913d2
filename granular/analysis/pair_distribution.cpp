#include "granular/analysis/pair_distribution.h"

#include <algorithm>
#include <array>

namespace granular {

namespace {

/// The convex region D: an upright cylinder or a box, unbounded along periodic axes.
struct Domain {
  bool round = false;
  Vec2 axis = Vec2::Zero();
  double radius = 0;
  Vec3 lo = Vec3::Constant(-infinity), hi = Vec3::Constant(infinity);
  Vec3 period = Vec3::Zero();  ///< 0: not periodic
  double volume = 0;

  bool contains(const Vec3& p) const {
    if (round && (p.head<2>() - axis).squaredNorm() > radius * radius) return false;
    return (p.array() >= lo.array()).all() && (p.array() <= hi.array()).all();
  }
  /// Distance along the unit direction d from a point inside to the boundary, m.
  double exitDistance(const Vec3& p, const Vec3& d) const {
    double exit = infinity;
    for (int k = 0; k < 3; ++k) {
      if (d[k] > 0) exit = std::min(exit, (hi[k] - p[k]) / d[k]);
      if (d[k] < 0) exit = std::min(exit, (lo[k] - p[k]) / d[k]);
    }
    const double a = d.head<2>().squaredNorm();
    if (!round || a < 1e-24) return exit;
    const Vec2 arm = p.head<2>() - axis;
    const double b = arm.dot(d.head<2>()), c = arm.squaredNorm() - radius * radius;
    return std::min(exit, (-b + std::sqrt(std::max(0.0, b * b - a * c))) / a);
  }
  Vec3 nearest(Vec3 offset) const {
    for (int k = 0; k < 3; ++k)
      if (period[k] > 0) offset[k] -= period[k] * std::round(offset[k] / period[k]);
    return offset;
  }
};

Domain makeDomain(const Bed& bed, double filling) {
  double inner = 0;
  for (const Shape* shape : bed.shapes) inner += shape->innerRadius() / static_cast<double>(bed.size());
  const Vessel& vessel = bed.vessel;
  Domain domain;

  // Sides.
  switch (vessel.kind) {
    case Vessel::Kind::cylinder:
      domain.round = true;
      domain.axis = vessel.axis;
      domain.radius = std::max(0.0, vessel.radius - inner);
      break;
    case Vessel::Kind::box:
      domain.lo = vessel.lo.array() + inner;
      domain.hi = vessel.hi.array() - inner;
      break;
    case Vessel::Kind::periodic:
      for (int k = 0; k < 3; ++k) {
        if (vessel.repeats()[static_cast<std::size_t>(k)]) {
          domain.period[k] = vessel.hi[k] - vessel.lo[k];
        } else {
          domain.lo[k] = vessel.lo[k] + inner;
          domain.hi[k] = vessel.hi[k] - inner;
        }
      }
      break;
    case Vessel::Kind::none: {
      Aabb centres;
      for (const Frame& frame : bed.frames) centres.include(frame.x);
      domain.lo = centres.lo;
      domain.hi = centres.hi;
      break;
    }
  }
  if (vessel.kind != Vessel::Kind::none && !(domain.period.z() > 0)) {
    domain.lo.z() = vessel.floor + inner;
    domain.hi.z() = vessel.floor + filling - inner;
  }

  Vec3 extent;
  for (int k = 0; k < 3; ++k)
    extent[k] = std::max(0.0, domain.period[k] > 0 ? domain.period[k] : domain.hi[k] - domain.lo[k]);
  domain.volume = domain.round ? pi * domain.radius * domain.radius * extent.z() : extent.prod();
  return domain;
}

/// Adds the volumes of the shells about p that lie inside the domain, by rays in directions spread evenly on the
/// sphere.
void addShellVolumes(const Domain& domain, const Vec3& p, std::size_t index, double bin, std::vector<double>& volumes) {
  constexpr int rays = 256;
  const double golden = pi * (3 - std::sqrt(5.0)), solidAngle = 4 * pi / rays;
  const double reach = bin * static_cast<double>(volumes.size());
  for (int k = 0; k < rays; ++k) {
    const double z = 1 - (2.0 * k + 1) / rays, s = std::sqrt(1 - z * z);
    const double azimuth = golden * (k + 0.37 * static_cast<double>(index));
    const double exit = std::min(reach, domain.exitDistance(p, {s * std::cos(azimuth), s * std::sin(azimuth), z}));
    for (std::size_t b = 0; b < volumes.size(); ++b) {
      const double from = bin * static_cast<double>(b), to = std::min(from + bin, exit);
      if (to <= from) break;
      volumes[b] += solidAngle * (to * to * to - from * from * from) / 3;
    }
  }
}

/// Volumes of all shells, added in a fixed order: blocks of particles, then the blocks.
std::vector<double> sumShellVolumes(const Domain& domain, const std::vector<Vec3>& centres, double bin,
                                    std::size_t bins) {
  constexpr std::size_t block = 64;
  const std::size_t blocks = (centres.size() + block - 1) / block;
  std::vector<std::vector<double>> partial(blocks, std::vector<double>(bins, 0.0));
#pragma omp parallel for schedule(dynamic)
  for (std::int64_t n = 0; n < static_cast<std::int64_t>(blocks); ++n) {
    const auto first = static_cast<std::size_t>(n) * block;
    for (std::size_t i = first; i < std::min(first + block, centres.size()); ++i)
      addShellVolumes(domain, centres[i], i, bin, partial[static_cast<std::size_t>(n)]);
  }
  std::vector<double> sum(bins, 0.0);
  for (const std::vector<double>& part : partial)
    for (std::size_t b = 0; b < bins; ++b) sum[b] += part[b];
  return sum;
}

/// Ordered pairs by distance. The centres come sorted by height.
std::vector<std::int64_t> countPairs(const Domain& domain, const std::vector<Vec3>& centres, double bin,
                                     std::size_t bins) {
  std::vector<std::int64_t> counts(bins, 0);
  const double reach = bin * static_cast<double>(bins);
  const bool sorted = !(domain.period.z() > 0);
#pragma omp parallel
  {
    std::vector<std::int64_t> own(bins, 0);
#pragma omp for schedule(dynamic, 16)
    for (std::int64_t n = 0; n < static_cast<std::int64_t>(centres.size()); ++n) {
      const auto i = static_cast<std::size_t>(n);
      for (std::size_t j = i + 1; j < centres.size(); ++j) {
        if (sorted && centres[j].z() - centres[i].z() >= reach) break;
        const double r = domain.nearest(centres[j] - centres[i]).norm();
        if (r < reach) own[std::min(bins - 1, static_cast<std::size_t>(r / bin))] += 2;
      }
    }
    // Whole numbers: the order of the threads does not matter.
#pragma omp critical
    for (std::size_t b = 0; b < bins; ++b) counts[b] += own[b];
  }
  return counts;
}

}  // namespace

PairDistribution measurePairDistribution(const Bed& bed, double filling, double unit, double reach, double bin) {
  PairDistribution result;
  result.table = {
      "pair_distribution",
      "Pair distribution of the centres of mass over those in the domain D (vessel up to the filling height, moved "
      "inward by the mean inner radius; periodic axes unbounded; no vessel: bounds of the centres): pairs per "
      "shell / ((N - 1)/|D| times the shell volumes inside D). neighbours: mean number within the upper end of "
      "the bin, edges accounted for.",
      {"r_m", "r_unit_lengths", "g", "neighbours"},
      {}};
  const Domain domain = makeDomain(bed, filling);
  std::vector<Vec3> centres;
  for (const Frame& frame : bed.frames)
    if (domain.contains(frame.x)) centres.push_back(frame.x);
  result.centres = centres.size();
  if (centres.size() < 2 || !(domain.volume > 0)) return result;
  std::stable_sort(centres.begin(), centres.end(), [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
  result.density = static_cast<double>(centres.size() - 1) / domain.volume;

  for (int k = 0; k < 3; ++k)
    if (domain.period[k] > 0) reach = std::min(reach, 0.5 * domain.period[k]);
  const auto bins = static_cast<std::size_t>(reach / bin);
  if (bins == 0) return result;
  const std::vector<double> volumes = sumShellVolumes(domain, centres, bin, bins);
  const std::vector<std::int64_t> counts = countPairs(domain, centres, bin, bins);
  double neighbours = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    const double from = bin * static_cast<double>(b), to = from + bin;
    const double g = volumes[b] > 0 ? static_cast<double>(counts[b]) / (result.density * volumes[b])
                                    : std::numeric_limits<double>::quiet_NaN();
    if (volumes[b] > 0) neighbours += result.density * g * 4 * pi / 3 * (to * to * to - from * from * from);
    const double middle = 0.5 * (from + to);
    result.table.rows.push_back({middle, middle / unit, g, neighbours});
  }
  return result;
}

}  // namespace granular
