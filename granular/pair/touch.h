// What the narrow phase finds of one pair.
#pragma once

#include "granular/core/math.h"

namespace granular {

/// One contact of two convex shapes, world axes.
struct Touch {
  Vec3 normal;     ///< unit, from A to B
  double overlap;  ///< m, > 0
  Vec3 onA, onB;   ///< deepest points on either surface; onA - onB = overlap * normal
};

}  // namespace granular
