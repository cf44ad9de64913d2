// How the spots of one wall share its stiffness. A flat face of a particle meets a concave wall at several spots; each
// is a contact of its own, but together they must be as stiff as k_n. (design 1.4)
#pragma once

#include <span>

#include "granular/wall/wall.h"

namespace granular {

/// Turns weights into shares: share_s = w_s / sum_t w_t max(0, n_s . n_t). On entry `share` holds the weight (>= 0) of
/// each touch: its overlap (m), possibly faded where a spot appears or goes. A lone spot gets 1, two equal parallel
/// ones 1/2 each, spots on opposite sides nothing of each other; a spot of weight 0 changes nothing, so that forces are
/// continuous.
void shareStiffness(std::span<WallTouch> touches);

}  // namespace granular
