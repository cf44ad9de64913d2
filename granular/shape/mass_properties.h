// Volume, inertia and surface measures of a solid of unit density.
#pragma once

#include "granular/core/math.h"

namespace granular {

/// In body axes: origin at the centre of mass, axes along the principal axes. Density 1 kg/m^3: a body of density rho has
/// mass rho * volume and principal inertia rho * inertia.
struct MassProperties {
  double volume = 0;              ///< m^3
  double area = 0;                ///< m^2
  Vec3 inertia = Vec3::Zero();    ///< principal moments per density, m^5
  double meanSquareRadius = 0;    ///< <r^2>: mean over the surface of the squared distance from the centre of mass, m^2 (S 13)
};

}  // namespace granular
