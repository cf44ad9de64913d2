// Where and over what area a contact acts.
#pragma once

#include "granular/core/math.h"

namespace granular {

/// A contact as the force law needs it, world axes. For point contacts area = 0 and centre = point.
struct ContactPatch {
  Vec3 point;       ///< where the elastic force acts: in the middle of the overlap
  Vec3 centre;      ///< where the normal dashpot's resultant acts for a translation: area centroid of the patch
  double area = 0;  ///< of the clipped polygon, m^2
  /// Second moments of area per area about centre along the in-plane unit axes u and v = normal x u, m^2.
  Vec3 u = Vec3::Zero();
  double uu = 0, vv = 0, uv = 0;
  /// The elastic force is k_n times this, m: the overlap, or what a rule with a potential of its own makes of it.
  double depth = 0;
  /// The elastic energy is k_n/2 times this, m^2: the square of the overlap, or the rule's own potential.
  double squaredDepth = 0;
  double share = 1;  ///< factor on every stiffness and dashpot of this contact
};

}  // namespace granular
