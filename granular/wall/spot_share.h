// How the spots of one wall share its stiffness. A flat face of a particle meets a concave wall at several spots; each
// is a contact of its own, but together they must be as stiff as k_n.
#pragma once

#include <span>

#include "granular/wall/wall.h"

namespace granular {

/// A contact's claim on the stiffness, m.
struct Claim {
  double weight;  ///< its overlap (or its part of one, where an area is shared out), faded where a spot appears or goes
  double full;    ///< the same before fading
};

/// share_s = weight_s / max(full_s, sum_t weight_t max(0, n_s . n_t)): a lone spot gets 1, two equal parallel ones 1/2
/// each, spots on opposite sides nothing of each other; what fades goes to 0 whatever else there is, so that forces are
/// continuous. One claim per touch.
void shareStiffness(std::span<const Claim> claims, std::span<WallTouch> touches);

/// Under the rule `foundation` a spot's stiffness is that of its own area, and there is nothing to share; what fades
/// still does: share_s = weight_s / full_s.
void fadeStiffness(std::span<const Claim> claims, std::span<WallTouch> touches);

}  // namespace granular
