// The local minimum of the depth h(n) nearest to a given direction, for any convex shapes. From a unit n with depth h a
// point p = (h + g) n lies outside C by at least g; the direction from C's nearest point to p is the next n. Its depth
// is (h + g) cos(angle) - g at most, so that the descent is monotone, and it stands still at the minima of h alone. On
// a flat face of C one step arrives; on a surface of curvature radius rho each step shrinks the error by (h + g)/(rho +
// g).
#pragma once

#include "granular/narrow/difference.h"

namespace granular {

/// A's body axes, m.
struct LocalMinimum {
  Vec3 normal;     ///< unit, from A to B
  double depth;    ///< h(normal); negative: the two are apart
  Vec3 onA, onB;   ///< deepest points: onA - onB = depth * normal
  double off = 0;  ///< of a search that ended beside the minimum: how far its points lay from opposite each other
};

/// Descends from the unit direction start.
LocalMinimum descend(Difference& c, const Vec3& start);

}  // namespace granular
