// The overlap of two cuboids and the contact that a rule makes of it, for as many pairs as a register holds: the
// integrals of measureByWalk with no strip left out, to round-off. What lies in one face of the seat has a closed form
// as in corner_overlap.h; the rest goes by cells (box_cells.h).
#pragma once

#include "granular/narrow/cuboid_lanes.h"
#include "granular/point/box_cells.h"
#include "granular/point/contact_point.h"

namespace granular {

/// True for the rules that can be placed here.
inline bool placesInLanes(PointRule rule) {
  return rule == PointRule::patch || rule == PointRule::pressureCentroid || rule == PointRule::stiffPatch;
}

/// Overlaps on their way: their integrals are complete after finish(), until which what they add up in must stay.
struct OverlapsInLanes {
  explicit OverlapsInLanes(const RuleOptions& rule)
      : triangles(rule.rule == PointRule::stiffPatch ? rule.sharpness : 0) {}
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

/// A ContactPatch per lane. Points from the seat's centre, world axes; second moments along the contact's x and y.
struct PatchLanes {
  Mask<Wide> good;  ///< false: no area, or integrals that have lost their digits
  Triple<Wide> point, centre;
  Wide area, xx, yy, xy;
  Wide depth, squaredDepth;
};
PatchLanes endOverlap(const FaceLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule);
PatchLanes endOverlap(const EdgeLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule);

}  // namespace granular
