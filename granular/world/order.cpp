#include "granular/world/order.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "granular/world/stages.h"

namespace granular {
namespace {

/// Mean distance of the slots of neighbours, in units of what layers of n bodies have, n^(2/3), from which on they are
/// scattered. Along the curve it is about 1, at random n^(1/3)/3.
constexpr double scatteredFrom = 4;

constexpr int bitsPerAxis = 21;

/// The lowest 21 bits of k, two zeros after each.
std::uint64_t spreadBits(std::uint64_t k) {
  k &= (std::uint64_t{1} << bitsPerAxis) - 1;
  k = (k | k << 32) & 0x001f00000000ffff;
  k = (k | k << 16) & 0x001f0000ff0000ff;
  k = (k | k << 8) & 0x100f00f00f00f00f;
  k = (k | k << 4) & 0x10c30c30c30c30c3;
  k = (k | k << 2) & 0x1249249249249249;
  return k;
}

/// A place within the first period of each direction that has some.
Vec3 wrap(const Periods& periods, Vec3 x) {
  for (int k = 0; k < 3; ++k) {
    const double period = periods.length[k];
    if (period > 0) x[k] -= std::floor((x[k] - periods.origin[k]) / period) * period;
  }
  return x;
}

}  // namespace

bool isScattered(const World& world) {
  const std::size_t n = world.bodies.size();
  double sum = 0;
  for (const Pair& pair : world.pairs.pairs) sum += std::abs(pair.a - pair.b);
  return sum >
         scatteredFrom * std::pow(static_cast<double>(n), 2.0 / 3) * static_cast<double>(world.pairs.pairs.size());
}

std::vector<std::int32_t> orderInSpace(const World& world) {
  const Bodies& bodies = world.bodies;
  const std::size_t n = bodies.size();
  Aabb box;
  double width = 0;
  std::vector<Vec3> places(n);
  for (std::size_t i = 0; i < n; ++i) {
    places[i] = wrap(world.options.periods, bodies.x(i));
    box.include(places[i]);
    width = std::max(width, 2 * bodies.boundingRadius(i));
  }
  std::vector<std::uint64_t> code(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto cell = [&](int axis) {
      const double most = static_cast<double>((1 << bitsPerAxis) - 1);
      return static_cast<std::uint64_t>(std::min((places[i][axis] - box.lo[axis]) / width, most));
    };
    code[i] = spreadBits(cell(0)) | spreadBits(cell(1)) << 1 | spreadBits(cell(2)) << 2;
  }
  std::vector<std::int32_t> order = bodies.slotsById();
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) {
    return code[static_cast<std::size_t>(i)] < code[static_cast<std::size_t>(j)];
  });
  return order;
}

void layInOrder(World& world) {
  if (world.options.keepSlots || world.bodies.size() < bodiesBeyondCaches) return;
  if (world.orderLookedAt == world.search.refreshes) return;
  world.orderLookedAt = world.search.refreshes;
  if (!isScattered(world)) return;
  const std::vector<std::int32_t> order = orderInSpace(world);
  if (!std::is_sorted(order.begin(), order.end())) world.rearrange(order);
}

}  // namespace granular
