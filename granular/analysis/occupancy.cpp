#include "granular/analysis/occupancy.h"

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {

namespace {

/// Half extents of the box around the shape along its body axes, about the body's origin, m.
Vec3 measureHalfExtent(const Shape& shape) {
  Vec3 half;
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = Vec3::Unit(k);
    half[k] = std::max(shape.support(axis)[k], -shape.support(-axis)[k]);
  }
  return half;
}

/// Cells beyond this many cost more memory than they save time.
constexpr double mostCells = 4e6;

}  // namespace

Occupancy::Occupancy(const Bed& bed) {
  require(bed.shapes.size() == bed.frames.size(), "bed: as many shapes as frames are needed");
  require(bed.size() > 0, "bed: no particles to analyse");
  if (bed.vessel.kind == Vessel::Kind::periodic) {
    periodic = bed.vessel.repeats();
    periodLo = bed.vessel.lo;
    period = bed.vessel.hi - bed.vessel.lo;
    for (int k = 0; k < 3; ++k)
      require(!periodic[k] || period[k] > 0, "bed: a periodic vessel needs lo < hi along its periodic axes");
  }
  place(bed);
  sizeCells(bed);
  fillCells(bed);
}

Vec3 Occupancy::wrap(const Vec3& p) const {
  Vec3 q = p;
  for (int k = 0; k < 3; ++k)
    if (periodic[k]) q[k] -= period[k] * std::floor((q[k] - periodLo[k]) / period[k]);
  return q;
}

void Occupancy::place(const Bed& bed) {
  for (std::size_t i = 0; i < bed.size(); ++i) {
    const Shape& shape = *bed.shapes[i];
    Frame home = bed.frames[i];
    home.x = wrap(home.x);
    const Aabb own = shape.bounds(home);
    box.include(own.lo);
    box.include(own.hi);

    // The images whose bounds reach into the period, the particle itself among them.
    std::array<int, 3> from{}, to{};
    for (int k = 0; k < 3; ++k) {
      if (!periodic[k]) continue;
      from[k] = -static_cast<int>(std::floor((own.hi[k] - periodLo[k]) / period[k]));
      to[k] = static_cast<int>(std::ceil((periodLo[k] + period[k] - own.lo[k]) / period[k])) - 1;
    }
    for (int a = from[0]; a <= to[0]; ++a)
      for (int b = from[1]; b <= to[1]; ++b)
        for (int c = from[2]; c <= to[2]; ++c) {
          Frame frame = home;
          frame.x += Vec3(a * period.x(), b * period.y(), c * period.z());
          const double outer = shape.boundingRadius(), inner = shape.innerRadius();
          placements.push_back({frame, outer * outer, inner * inner, &shape, static_cast<std::int32_t>(i)});
        }
  }
}

void Occupancy::sizeCells(const Bed& bed) {
  grid = box;
  for (int k = 0; k < 3; ++k) {
    if (!periodic[k]) continue;
    grid.lo[k] = periodLo[k];
    grid.hi[k] = periodLo[k] + period[k];
  }

  // Cells of half the median particle's radius hold two or three candidates in a dense bed.
  std::vector<double> sizes(bed.size());
  for (std::size_t i = 0; i < bed.size(); ++i) sizes[i] = bed.shapes[i]->size();
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const Vec3 extent = grid.hi - grid.lo;
  const double finest = std::cbrt(extent.x() * extent.y() * extent.z() / mostCells);
  const double edge = std::max(0.5 * *middle, finest);
  for (int k = 0; k < 3; ++k) {
    cells[k] = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(extent[k] / edge)));
    cell[k] = extent[k] / static_cast<double>(cells[k]);
    inverseCell[k] = 1 / cell[k];
  }
}

bool Occupancy::reaches(const Placement& placement, const Vec3& halfExtent, const Vec3& cellCentre) const {
  const Vec3 local = placement.frame.toBody(cellCentre).cwiseAbs();
  // A hair more than half the diagonal, so that rounding at a cell's corner loses nothing.
  const double ball = 0.5 * cell.norm() * (1 + 1e-12);
  if (local.squaredNorm() > std::pow(std::sqrt(placement.outerSquared) + ball, 2)) return false;
  return ((local - halfExtent).array() <= ball).all();
}

void Occupancy::fillCells(const Bed& bed) {
  std::vector<std::pair<std::int64_t, std::int32_t>> entries;
  for (std::size_t n = 0; n < placements.size(); ++n) {
    const Placement& placement = placements[n];
    const Shape& shape = *bed.shapes[static_cast<std::size_t>(placement.particle)];
    const Vec3 half = measureHalfExtent(shape);
    const Aabb own = shape.bounds(placement.frame);

    // The cells under its bounds, clamped to the grid, less those its box cannot reach.
    std::array<std::int64_t, 3> from, to;
    for (int k = 0; k < 3; ++k) {
      const double last = static_cast<double>(cells[k] - 1);
      from[k] = static_cast<std::int64_t>(std::clamp(std::floor((own.lo[k] - grid.lo[k]) * inverseCell[k]), 0.0, last));
      to[k] = static_cast<std::int64_t>(std::clamp(std::floor((own.hi[k] - grid.lo[k]) * inverseCell[k]), 0.0, last));
    }
    for (std::int64_t z = from[2]; z <= to[2]; ++z)
      for (std::int64_t y = from[1]; y <= to[1]; ++y)
        for (std::int64_t x = from[0]; x <= to[0]; ++x) {
          const Vec3 steps(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, static_cast<double>(z) + 0.5);
          if (reaches(placement, half, grid.lo + steps.cwiseProduct(cell)))
            entries.emplace_back((z * cells[1] + y) * cells[0] + x, static_cast<std::int32_t>(n));
        }
  }

  // Counting sort keeps the placements of a cell in order of index.
  cellBegin.assign(static_cast<std::size_t>(cells[0] * cells[1] * cells[2] + 1), 0);
  for (const auto& entry : entries) ++cellBegin[static_cast<std::size_t>(entry.first + 1)];
  for (std::size_t k = 1; k < cellBegin.size(); ++k) cellBegin[k] += cellBegin[k - 1];
  cellItems.resize(entries.size());
  std::vector<std::int64_t> next(cellBegin.begin(), cellBegin.end() - 1);
  for (const auto& [index, placement] : entries)
    cellItems[static_cast<std::size_t>(next[static_cast<std::size_t>(index)]++)] = placement;
}

std::int32_t Occupancy::find(const Vec3& point) const {
  const Vec3 p = wrap(point);
  std::array<std::int64_t, 3> at;
  for (int k = 0; k < 3; ++k) {
    if (!(p[k] >= grid.lo[k] && p[k] <= grid.hi[k])) return -1;
    at[k] = std::min(static_cast<std::int64_t>((p[k] - grid.lo[k]) * inverseCell[k]), cells[k] - 1);
  }
  const auto index = static_cast<std::size_t>((at[2] * cells[1] + at[1]) * cells[0] + at[0]);
  for (std::int64_t n = cellBegin[index]; n < cellBegin[index + 1]; ++n) {
    const Placement& placement = placements[static_cast<std::size_t>(cellItems[static_cast<std::size_t>(n)])];
    const Vec3 offset = p - placement.frame.x;
    const double distance = offset.squaredNorm();
    if (distance > placement.outerSquared) continue;
    if (distance <= placement.innerSquared || placement.shape->contains(placement.frame.unrotate(offset)))
      return placement.particle;
  }
  return -1;
}

}  // namespace granular
