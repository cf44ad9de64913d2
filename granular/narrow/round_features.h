// Minima of the depth that pairs with a cylinder or a cone share with simpler bodies, and that need no descent: the
// deepest point of the other body above a flat face, and the side of a cylinder, which near its axis' common normal is
// the segment of its axis with a layer of its radius.
#pragma once

#include "granular/narrow/newton.h"

namespace granular {

/// A local minimum next to the last normal (unit, A's body axes), if it is one of those above; its pieces are not
/// named. Looks for a flat face of either body across the last normal, then for cylinders lying along it.
PieceMinimum findRoundFeature(Difference& c, const Vec3& last);

}  // namespace granular
