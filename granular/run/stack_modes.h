// The sway of a tower as an eigenvalue problem: rigid cuboids, each interface a rocking spring and a shear spring,
// gravity pulling down whatever leans. The tower stands by itself as long as its lowest eigenvalue is positive; an
// elastic column of the same stiffness buckles at N^3 = 7.837 k_theta/(m g s) (s: side).
#pragma once

#include "granular/run/stack_settings.h"

namespace granular {

struct SwayMode {
  double square = 0;         ///< omega^2, 1/s^2; negative: grows as exp(sqrt(-square) t)
  std::vector<double> tilt;  ///< of each cuboid, rad, for a top that is off by 1 m
  std::vector<double> way;   ///< horizontal way of each centre, m, likewise
};

/// The lowest mode in one vertical plane, of face contacts without lift-off, sliding or damping. Only the rules with a
/// finite rocking stiffness have it: pressure_centroid, patch, stiff_patch, foundation. Throws InputError for others.
SwayMode findLowestSway(const StackSettings& settings);

}  // namespace granular
