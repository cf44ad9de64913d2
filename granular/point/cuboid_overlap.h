// The overlap of two cuboids and the contact that `pressure_centroid` and `patch` make of it, for as many pairs as a
// register holds: the integrals of measureByWalk with no strip left out, to round-off. What lies in one face of the
// seat has a closed form as in corner_overlap.h; the rest goes by cells (box_cells.h).
#pragma once

#include "granular/narrow/cuboid_lanes.h"
#include "granular/point/box_cells.h"

namespace granular {

/// Begins the integrals of the lanes chosen: writes `sums`, which `cells` adds to when it integrates.
void beginOverlap(const FaceLook<Wide>& look, const Mask<Wide>& chosen, BoxCells& cells, MomentLanes& sums);
void beginOverlap(const EdgeLook<Wide>& look, const Mask<Wide>& chosen, BoxCells& cells, MomentLanes& sums);
/// The most calls of BoxCells::add that one of them makes.
inline constexpr std::size_t mostBoxCells = 4;

/// What of ContactPatch depends on the integrals. Points from the seat's centre, world axes; second moments along the
/// contact's x and y.
struct PatchLanes {
  Mask<Wide> good;  ///< false: slivers whose integrals have lost their digits
  Triple<Wide> point, centre;
  Wide area, xx, yy, xy;
};
PatchLanes endOverlap(const FaceLook<Wide>& look, const MomentLanes& sums);
PatchLanes endOverlap(const EdgeLook<Wide>& look, const MomentLanes& sums);

}  // namespace granular
