// How round the two surfaces of a contact are together, for the laws that read it.
#pragma once

#include "granular/world/world.h"

namespace granular {

/// Effective radius of a contact (shape/curvature.h), m.
double contactRadius(const World& world, const Contact& contact);

}  // namespace granular
