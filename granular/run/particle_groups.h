// From the particle groups of a scene to shapes: which shape a particle gets, of what material.
#pragma once

#include "granular/insert/inserter.h"
#include "granular/io/scene.h"

namespace granular {

/// One pour group per group of the scene, with counts resolved from shares. Throws InputError naming the group and the
/// scene's line for a mesh or a shape that can't be used.
std::vector<PourGroup> makePourGroups(const Scene& scene);

}  // namespace granular
