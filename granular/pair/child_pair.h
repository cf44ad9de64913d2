// Two children near each other, one of each body of a pair: the list of them is to a pair of clumps what the pair list
// is to the bodies.
#pragma once

#include <cstdint>
#include <vector>

#include "granular/core/math.h"

namespace granular {

/// Sorted by (childA, childB).
struct ChildPair {
  std::int32_t childA = -1, childB = -1;  ///< -1 for a body that is no clump, and for walls
  /// The two cannot touch before the bodies' travel reaches this, m.
  double quietUntil = -infinity;
};

/// The children of a pair that may touch before the bodies' travel reaches validUntil, m.
struct ChildList {
  std::vector<ChildPair> near;
  double validUntil = -infinity;
};

}  // namespace granular
