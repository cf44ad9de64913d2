// What the narrow phase finds of one pair.
#pragma once

#include <cstdint>

#include "granular/core/math.h"

namespace granular {

/// One contact of two convex shapes, world axes.
struct Touch {
  Vec3 normal;     ///< unit, from A to B
  double overlap;  ///< m, > 0
  Vec3 onA, onB;   ///< deepest points on either surface; onA - onB = overlap * normal
  /// Of polyhedra: a vertex by the deepest point, where searches begin; -1: not known.
  std::int32_t nearVertexA = -1, nearVertexB = -1;
};

}  // namespace granular
