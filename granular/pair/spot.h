// Which contact of a pair that may have several: with walls, between clumps, under the `manifold` rule.
#pragma once

#include <cstdint>

namespace granular {

/// Names a contact within its pair by the geometry of the bodies, never by order of discovery.
struct Spot {
  std::int32_t number = 0;                ///< with a wall: of the spot; `manifold` rule: of the point, by its birth
  std::int32_t childA = -1, childB = -1;  ///< of clumps; -1 for a body that is none, and for walls
  bool ofClump() const { return childA >= 0 || childB >= 0; }
  bool operator==(const Spot&) const = default;
};

}  // namespace granular
