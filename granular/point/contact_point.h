// Where a contact's force acts: the contact-point rules (S section 5.2 and beyond), one file each behind one signature.
#pragma once

#include <string_view>

#include "granular/pair/contact_patch.h"
#include "granular/pair/touch.h"
#include "granular/shape/shape.h"

namespace granular {

enum class PointRule : unsigned char { witness, manifold, faceCentroid, pressureCentroid, patch };

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
