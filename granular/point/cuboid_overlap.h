// The overlap of two cuboids and the contact that a rule makes of it, for as many pairs as a register holds: the
// integrals of measureByWalk with no strip left out, to round-off. What lies in one face of the seat has a closed form
// as in corner_overlap.h; the rest goes by cells (box_cells.h).
#pragma once

#include "granular/narrow/cuboid_lanes.h"
#include "granular/point/box_cells.h"
#include "granular/point/patch_lanes.h"

namespace granular {

/// Overlaps on their way: their integrals are complete after finish(), until which what they add up in must stay.
struct OverlapsInLanes {
  explicit OverlapsInLanes(const RuleOptions& rule) : triangles(powerInLanes(rule)) {}
  void finish() {
    cells.integrate(triangles);
    triangles.integrate();
  }

  BoxCells cells;
  PowerTriangles triangles;
};

/// Begins the integrals of the lanes chosen.
void beginOverlap(const FaceLook<Wide>& look, const Mask<Wide>& chosen, OverlapsInLanes& overlaps, OverlapLanes& sums);
void beginOverlap(const EdgeLook<Wide>& look, const Mask<Wide>& chosen, OverlapsInLanes& overlaps, OverlapLanes& sums);

/// The most calls of BoxCells::add that one of them makes.
inline constexpr std::size_t mostBoxCells = 4;

/// The contacts, once they are complete.
PatchLanes endOverlap(const FaceLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule);
PatchLanes endOverlap(const EdgeLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule);

}  // namespace granular
