// The order of bodies in memory. A step reads both bodies of a pair, so neighbours should lie near each other; bodies
// come in the order in which they were poured, and a flow mixes them.
#pragma once

#include "granular/world/world.h"

namespace granular {

/// True if neighbours lie much further apart than in an order of space.
bool isScattered(const World& world);

/// All slots along a space-filling curve (Morton's) through cells as wide as the largest body.
std::vector<std::int32_t> orderInSpace(const World& world);

/// Lays scattered bodies in the order of space. Nothing if the options keep slots, for a bed that a core's caches hold,
/// and for pairs whose order was looked at.
void layInOrder(World& world);

}  // namespace granular
