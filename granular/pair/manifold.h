// The memory of a persistent contact manifold, as plain data.
#pragma once

#include <array>
#include <cstdint>

#include "granular/core/math.h"

namespace granular {

struct ManifoldPoint {
  Vec3 onA = Vec3::Zero(), onB = Vec3::Zero();  ///< in the body axes of either, m
  Vec3 normal = Vec3::UnitX();                  ///< world, unit, from A to B, as when the point was last found
  double overlap = 0;                           ///< m; negative: the point has opened but is still kept
  std::int32_t spot = 0;                        ///< its number for as long as it lives; never used again for the pair
  std::int32_t age = 0;                         ///< steps since it was found
};

/// What is remembered of a touching pair. Plain data, saved in checkpoints; reset to {} when the pair parts.
struct Manifold {
  std::array<ManifoldPoint, 4> points;
  std::int32_t count = 0;
  std::int32_t nextSpot = 0;
};

}  // namespace granular
