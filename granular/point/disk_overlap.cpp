#include "granular/point/disk_overlap.h"

#include "granular/core/wide.h"
#include "granular/point/clip.h"
#include "granular/shape/revolution.h"

namespace granular {
namespace {

constexpr std::size_t samples = faceSamples;
static_assert(samples % wideSize == 0 && samples <= 32);

/// The corners of a face's polygon, counter-clockwise in the contact plane.
struct Corners {
  alignas(64) double x[samples], y[samples];
  explicit Corners(const Oval& oval) {
    const RimAngles& circle = rimAngles();
    for (std::size_t k = 0; k < samples; k += wideSize) {
      const Wide c = loadWide(circle.cosine + k), s = loadWide(circle.sine + k);
      storeWide(oval.centre.x() + c * oval.first.x() + s * oval.second.x(), x + k);
      storeWide(oval.centre.y() + c * oval.first.y() + s * oval.second.y(), y + k);
    }
  }
  Vec2 operator[](std::size_t k) const { return {x[k], y[k]}; }
};

/// Which of a register's numbers are below 0, as bits.
std::uint32_t bitsBelow(const Wide& values) {
#if defined(__AVX512F__)
  return _mm512_cmp_pd_mask(values, _mm512_setzero_pd(), _CMP_LT_OQ);
#else
  std::array<double, wideSize> each;  // g++ 12 with its sanitizers takes the first for all otherwise
  storeWide(values, each.data());
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < wideSize; ++k) bits |= static_cast<std::uint32_t>(each[k] < 0) << k;
  return bits;
#endif
}

/// The part of the polygon where the depth is not below 0.
void keepDeep(const Corners& corners, const Linear& depth, Polygon& region) {
  alignas(64) std::array<double, samples> depths;
  std::uint32_t above = 0;
  for (std::size_t k = 0; k < samples; k += wideSize) {
    const Wide each =
        depth.offset + depth.slope.x() * loadWide(corners.x + k) + depth.slope.y() * loadWide(corners.y + k);
    storeWide(each, &depths[k]);
    above |= bitsBelow(each) << k;
  }
  region.count = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    const std::size_t next = (k + 1) % samples;
    const bool here = (above >> k & 1) == 0, there = (above >> next & 1) == 0;
    if (here) region.push(corners[k], noEdge);
    if (here == there) continue;
    const double part = depths[k] / (depths[k] - depths[next]);
    region.push(corners[k] + part * (corners[next] - corners[k]), noEdge);
  }
}

/// The part of the region inside the polygon.
void keepInside(const Corners& corners, Polygon& region) {
  // To the left of each edge, as findLeftSide has it.
  alignas(64) std::array<double, samples> offset, slopeX, slopeY;
  for (std::size_t k = 0; k < samples; ++k) {
    const Linear side = findLeftSide(corners[k], corners[(k + 1) % samples]);
    offset[k] = side.offset;
    slopeX[k] = side.slope.x();
    slopeY[k] = side.slope.y();
  }
  std::uint32_t cutting = 0;
  for (int corner = 0; corner < region.count; ++corner) {
    const Vec2& p = region[corner];
    for (std::size_t k = 0; k < samples; k += wideSize) {
      cutting |= bitsBelow(loadWide(&offset[k]) + loadWide(&slopeX[k]) * p.x() + loadWide(&slopeY[k]) * p.y()) << k;
    }
  }
  for (std::size_t k = 0; cutting != 0 && region.count > 0; ++k, cutting >>= 1) {
    if (cutting & 1) clipPolygon({offset[k], {slopeX[k], slopeY[k]}}, noEdge, region);
  }
}

}  // namespace

void measureDisks(const SurfaceSide& a, const SurfaceSide& b, const PowerChoice& power, OverlapArea& out) {
  const Linear heightA = a.findHeight(0), heightB = b.findHeight(0), depth = heightA - heightB;
  Polygon region;
  keepDeep(Corners(a.oval()), depth, region);
  if (region.count == 0) return;
  if (!b.surelyHolds(region)) keepInside(Corners(b.oval()), region);
  out.moments = integrate(region, depth, power);
  if (!(out.moments.volume > 0)) return;
  const Vec2 centre = out.moments.centroidOfVolume();
  out.height = 0.5 * (heightA.at(centre) + heightB.at(centre));
}

}  // namespace granular
