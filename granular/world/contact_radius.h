// How round the two surfaces of a contact are together, for the laws that read it.
#pragma once

#include "granular/world/world.h"

namespace granular {

/// Effective radius of a contact (shape/curvature.h), m.
double contactRadius(const World& world, const Contact& contact);

bool isBetweenEllipsoids(const World& world, const Contact& contact);
/// The same for as many contacts between ellipsoids as a register has lanes, to the same bits.
void findEllipsoidRadii(const World& world, Contact* const* contacts, double* radii);

}  // namespace granular
