// How round the two surfaces of a contact are together, for the laws that read it.
#pragma once

#include "granular/world/world.h"

namespace granular {

/// Effective radius of a contact (shape/curvature.h), m.
double contactRadius(const World& world, const Contact& contact);

/// The same between the ellipsoids in two slots; n: unit normal of the contact, world axes.
double ellipsoidRadius(const Bodies& bodies, std::int32_t a, std::int32_t b, const Vec3& n);

}  // namespace granular
