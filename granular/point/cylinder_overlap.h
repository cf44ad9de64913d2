// The overlaps of two cylinders of which at least one shows its side, for as many pairs as a register holds: a strip
// along that side, as overlap.cpp measures it one by one.
#pragma once

#include "granular/narrow/cylinder_lanes.h"
#include "granular/point/patch_lanes.h"

namespace granular {

/// Integrates the overlaps of the lanes chosen; the sums of others, and of two caps, are 0. seatIsA: the strip runs
/// along A's side where both show theirs. Returns the height of the overlap's middle over the contact plane at the
/// centroid of its volume, m.
Wide integrateStrip(const CylinderPair<Wide>& pairs, const LaneLook<Wide>& look, const Mask<Wide>& seatIsA,
                    const Mask<Wide>& chosen, OverlapLanes& sums);

}  // namespace granular
