// Where a contact's force acts: the contact-point rules (S section 5.2 and beyond), one file each behind one signature.
#pragma once

#include <string_view>

#include "granular/pair/contact_patch.h"
#include "granular/pair/touch.h"
#include "granular/shape/shape.h"

namespace granular {

enum class PointRule : unsigned char {
  witness,
  manifold,
  faceCentroid,
  pressureCentroid,
  patch,
  stiffPatch,
  foundation
};

struct RuleOptions {
  PointRule rule = PointRule::stiffPatch;
  /// Thickness of the feature slab of faceCentroid, as a fraction of the overlap (1: every vertex that penetrates).
  double slab = 0.01;
  /// Of stiffPatch, 1 or more: a face's rocking stiffness is 2 sharpness times that of an elastic foundation.
  int sharpness = 24;
};

/// A face contact's rocking stiffness over k_n times the second moment of its area per area.
double rockingStiffness(const RuleOptions& options);
/// Its rocking dashpot over eta_n times the same.
double rockingDamping(const RuleOptions& options);

/// Places the contact of two convex shapes for every rule but `manifold`, which keeps state of its own.
void placeContact(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                  const Touch& touch, ContactPatch& out);

/// Names as scene files spell them: "witness", "manifold", "face_centroid", "pressure_centroid", "patch",
/// "stiff_patch", "foundation".
/// Throws InputError for any other.
PointRule pointRuleFromName(std::string_view name);
std::string_view pointRuleName(PointRule rule);

}  // namespace granular
