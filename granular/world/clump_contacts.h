// How the stages look at pairs with a clump.
#pragma once

#include <algorithm>

#include "granular/narrow/clump_pair.h"
#include "granular/world/world.h"

namespace granular {

/// Lists the children near each other anew if the bodies have travelled as far as the last list reached; warm caches of
/// those that stay are kept. travel: of both bodies, m.
void refreshChildren(const World& world, const ClumpPairView& view, double travel, ClumpMemory& memory);

/// Calls look(k) for every listed pair of children whose gap may be used up. It returns their overlap, or 0 or minus
/// the gap of those that don't touch. Returns the travel before which nobody who did not touch can, m.
template <class Look>
double visitNearChildren(const World& world, double travel, ChildList& list, Look&& look) {
  const bool skips = world.options.skips.separation;
  double quiet = list.validUntil;
  for (std::size_t k = 0; k < list.near.size(); ++k) {
    ChildPair& children = list.near[k];
    if (!skips || travel >= children.quietUntil) {
      const double overlap = look(k);
      if (overlap > 0) continue;
      children.quietUntil = travel - overlap;
    }
    quiet = std::min(quiet, children.quietUntil);
  }
  return quiet;
}

/// Looks at a pair of bodies of which at least one is a clump; appends its contacts in the order of their children.
/// travel: of both bodies, m.
void lookAtClumpPair(World& world, std::int32_t index, double travel, World::Chunk& chunk);

/// The same for a clump near a wall. travel: of the body and the walls, m.
void lookAtClumpAtWall(World& world, std::int32_t index, double travel, World::Chunk& chunk);

/// Turns the chunk's wallTouches into contacts of this pair, index in the list. size: of the body, m.
void addWallContacts(const WallPair& pair, std::int32_t index, double size, World::Chunk& chunk);

}  // namespace granular
