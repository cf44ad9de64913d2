// What the warm looks at pairs of flat-faced bodies have in common, for as many pairs as a register holds.
#pragma once

#include "granular/core/wide.h"

namespace granular {

/// What a look at a feature finds. Of each pair one body is the seat. Contact axes: z is the normal out of the seat, x
/// and y lie in the contact plane.
template <class Real>
struct LaneLook {
  Mask<Real> holds;      ///< the feature is a minimum of the depth; of cuboids, without ties
  Mask<Real> proven;     ///< and the global one
  Real depth;            ///< m; not above 0: apart by as much
  Triple<Real> x, y, z;  ///< contact axes, world
  Triple<Real> middle;   ///< from the seat's centre to the middle between the deepest points, world, m
};

/// Squared sine between two edges below which the axis across them loses too many digits for lanes.
inline constexpr double leastLaneSine2 = 1e-8;

}  // namespace granular
