// A world as the analysis sees it.
#pragma once

#include "granular/analysis/bed.h"
#include "granular/world/world.h"

namespace granular {

/// Shapes, frames (inside the domain where it repeats) and contacts. Contacts between frozen bodies, which a run does
/// not look at, are looked for here; their force is not known and given as zero.
Bed makeBed(const World& world, const Vessel& vessel);

}  // namespace granular
