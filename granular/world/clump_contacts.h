// How the stages look at pairs with a clump.
#pragma once

#include "granular/world/world.h"

namespace granular {

/// Looks at a pair of bodies of which at least one is a clump; appends its contacts in the order of their children.
/// travel: of both bodies, m.
void lookAtClumpPair(World& world, std::int32_t index, double travel, World::Chunk& chunk);

/// The same for a clump near a wall. travel: of the body and the walls, m.
void lookAtClumpAtWall(World& world, std::int32_t index, double travel, World::Chunk& chunk);

/// Turns the chunk's wallTouches into contacts of this pair, index in the list. size: of the body, m.
void addWallContacts(const WallPair& pair, std::int32_t index, double size, World::Chunk& chunk);

}  // namespace granular
