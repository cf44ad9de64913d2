// The contact-point rules, one file each. contact_point.cpp holds their table.
//
// Rules that integrate over the overlap say where the elastic force acts and how strong it is, given the integrals; the
// contacts of bodies with each other and with walls share them.
#pragma once

#include "granular/point/contact_point.h"
#include "granular/point/moments.h"
#include "granular/point/surface_side.h"

namespace granular {

void placeFaceCentroid(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b,
                       const Frame& frameB, const Touch& touch, ContactPatch& out);

/// Any rule that integrates over the overlap, for two bodies; the deepest point where there is no area.
void placeOnOverlap(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b,
                    const Frame& frameB, const Touch& touch, ContactPatch& out);

/// What a rule makes of an overlap's integrals.
struct Pressure {
  Vec2 centre;          ///< where the elastic force acts, in the contact plane
  double depth;         ///< as in ContactPatch, m
  double squaredDepth;  ///< as in ContactPatch, m^2
  double share = 1;     ///< as in ContactPatch
  bool isPatch = true;  ///< spread the dashpot over the area
};
Pressure pressCentroid(const AreaMoments& moments, double overlap);
Pressure pressPatch(const AreaMoments& moments, double overlap);
Pressure pressStiffPatch(const AreaMoments& moments, int sharpness, double overlap);
Pressure pressFoundation(const AreaMoments& moments, double referenceArea);

/// True if the rule has a potential of its own, and takes its depth from the integrals alone.
inline bool hasOwnDepth(PointRule rule) { return rule == PointRule::stiffPatch || rule == PointRule::foundation; }
/// Which powers of the depth the rule needs.
PowerChoice powersFor(const RuleOptions& options, double overlap);
/// The area over which the foundation of a pair spreads k_n, m^2: the face of the cube of equal volume, of the smaller
/// body. size: the smaller radius of equal volume, m.
double referenceArea(double size);
/// Places the contact of an overlap with area > 0 and volume > 0, given its integrals by one of these rules. height: of
/// the middle of the overlap over the contact plane, m; size: the smaller radius of equal volume, m.
void placePressure(const RuleOptions& options, const ContactPlane& plane, const AreaMoments& moments, double overlap,
                   double height, double size, ContactPatch& out);

}  // namespace granular
