// Volume, inertia and surface measures of a union of spheres: what overlaps counts once.
#pragma once

#include <span>
#include <vector>

#include "granular/shape/mass_properties.h"

namespace granular {

/// One sphere of a clump: centre and radius, m.
struct ChildSphere {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
};

/// Mass properties of the union of at least one sphere, radii > 0. Relative error about 1e-11 or less: the integrals
/// along the latitude are refined until they agree to that (sphere_union.cpp).
SolidProperties unionProperties(std::span<const ChildSphere> spheres);

/// The spheres that are not inside another one; of equal ones the first. Their union is the same.
std::vector<ChildSphere> withoutHidden(std::span<const ChildSphere> spheres);

/// How many separate parts the union has; spheres that touch in one point are joined.
int countParts(std::span<const ChildSphere> spheres);

}  // namespace granular
