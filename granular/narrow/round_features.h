// Minima of the depth that pairs with a cylinder or a cone share with simpler bodies, and that need no descent: the
// deepest point of the other body above a flat face, and the side of a cylinder, which near its axis' common normal is
// the segment of its axis with a layer of its radius.
#pragma once

#include "granular/narrow/descent.h"

namespace granular {

/// A local minimum next to the last normal (unit, A's body axes), if it is one of those above.
struct RoundFeature {
  bool holds = false;
  LocalMinimum minimum;  ///< A's body axes
  double margin = 0;     ///< distance of the origin's foot from the rim of C's flat facet; 0 on curved ones
};

/// Looks for a flat face of either body across the last normal, then for cylinders lying along it.
RoundFeature findRoundFeature(Difference& c, const Vec3& last);

}  // namespace granular
