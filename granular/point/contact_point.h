// Where a contact's force acts: the contact-point rules (S section 5.2 and beyond), one file each behind one signature.
#pragma once

#include <string_view>

#include "granular/narrow/narrow.h"

namespace granular {

enum class PointRule : unsigned char { witness, manifold, faceCentroid, pressureCentroid, patch };

/// A contact as the force law needs it, world axes. For point contacts area = 0 and centre = point.
struct ContactPatch {
  Vec3 point;          ///< where the elastic force acts: in the middle of the overlap
  Vec3 centre;         ///< where the normal dashpot's resultant acts for a translation: area centroid of the patch
  double area = 0;     ///< of the clipped polygon, m^2
  /// Second moments of area per area about centre along the in-plane unit axes u and v = normal x u, m^2.
  Vec3 u = Vec3::Zero();
  double uu = 0, vv = 0, uv = 0;
};

struct RuleOptions {
  PointRule rule = PointRule::patch;
  /// Thickness of the feature slab of faceCentroid, as a fraction of the overlap (1: every vertex that penetrates).
  double slab = 0.01;
};

/// Places the contact of two convex shapes for every rule but `manifold`, which keeps state of its own.
void placeContact(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                  const Touch& touch, ContactPatch& out);

/// Names as scene files spell them: "witness", "manifold", "face_centroid", "pressure_centroid", "patch".
/// Throws InputError for any other.
PointRule pointRuleFromName(std::string_view name);
std::string_view pointRuleName(PointRule rule);

}  // namespace granular
