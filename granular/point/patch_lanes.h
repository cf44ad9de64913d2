// The contacts that a rule makes of the overlaps of as many pairs as a register holds.
#pragma once

#include "granular/narrow/lane_look.h"
#include "granular/point/contact_point.h"
#include "granular/point/overlap_lanes.h"

namespace granular {

/// True for the rules that can be placed in lanes.
inline bool placesInLanes(PointRule rule) {
  return rule == PointRule::patch || rule == PointRule::pressureCentroid || rule == PointRule::stiffPatch;
}
/// The exponent of the depth's powers that the rule needs, or 0.
inline int powerInLanes(const RuleOptions& rule) { return rule.rule == PointRule::stiffPatch ? rule.sharpness : 0; }

/// Writes the sums of a fan, and the powers of tips (powersOfTips).
void store(const Fan& fan, OverlapLanes& sums);
void storePowers(const Wide& area, const Wide& x, const Wide& y, int exponent, OverlapLanes& sums);
/// Both of a fan of nothing but tips; no powers if the exponent is 0.
void storeTips(const Fan& fan, int exponent, OverlapLanes& sums);

/// A ContactPatch per lane. Points from the seat's centre, world axes; second moments along the contact's x and y.
struct PatchLanes {
  Mask<Wide> good;  ///< false: no area, or integrals that have lost their digits
  Triple<Wide> point, centre;
  Wide area, xx, yy, xy;
  Wide depth, squaredDepth;
};

/// The centroids of overlaps.
struct PressLanes {
  Mask<Wide> good;
  Wide perArea;
  Place centre, press;  ///< of the area, of the volume
};
PressLanes findPress(const OverlapLanes& sums);
/// The patch of a look; height: of the overlap's middle over the contact plane at `press`, m.
PatchLanes placePress(const LaneLook<Wide>& look, const PressLanes& press, const Wide& height, const OverlapLanes& sums,
                      const RuleOptions& rule);

}  // namespace granular
