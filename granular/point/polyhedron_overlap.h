// The two commonest overlaps of polyhedra and the contact that a rule makes of them, for as many pairs as a register
// holds: corner_overlap.h in lanes.
#pragma once

#include "granular/narrow/polyhedron_lanes.h"
#include "granular/point/patch_lanes.h"

namespace granular {

/// Integrates the overlaps of the lanes chosen in which each triangle about the deepest place lies in one face of A and
/// one of B; the sums of others are 0. exponent: powerInLanes.
void integrateOverlap(const CrossingLook<Wide>& look, const Mask<Wide>& chosen, int exponent, OverlapLanes& sums);
void integrateOverlap(const TipLook<Wide>& look, const Mask<Wide>& chosen, int exponent, OverlapLanes& sums);

/// The contacts; not good where nothing was integrated.
PatchLanes endOverlap(const CrossingLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule);
PatchLanes endOverlap(const TipLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule);

}  // namespace granular
