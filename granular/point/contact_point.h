// Where a contact's force acts: the contact-point rules (S section 5.2 and beyond), one file each behind one signature.
// A program may add one of its own (addPointRule; examples/extend/box_centre_rule.h).
#pragma once

#include <string_view>
#include <vector>

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
/// "stiff_patch", "foundation", and those of rules that were added. Throws InputError for any other.
PointRule pointRuleFromName(std::string_view name);
std::string_view pointRuleName(PointRule rule);
/// All of them, in the order of the table.
std::vector<std::string_view> pointRuleNames();

/// Writes every member of the patch for two convex shapes that touch. Thread-safe, depends on its arguments alone, and
/// places the same point whichever body is called A.
using PlaceContact = void (*)(const RuleOptions&, const Shape& a, const Frame& frameA, const Shape& b,
                              const Frame& frameB, const Touch&, ContactPatch& out);

/// One row of the table of rules.
struct PointRuleRow {
  std::string_view name;  ///< as scene files spell it; a literal
  PlaceContact place = nullptr;
  /// The library's rule that serves at walls, which place their contacts by themselves.
  PointRule atWalls = PointRule::pressureCentroid;
};

/// Adds a contact-point rule of the user's own: from then on scenes and WorldOptions may choose it. Call it once,
/// before anything else reads the table. Throws InputError where the name is empty or taken, place is missing, atWalls
/// is not a rule of the library, or the table is full.
PointRule addPointRule(const PointRuleRow& row);
/// True if the rule was added by a user.
constexpr bool isUsersRule(PointRule rule) { return rule > PointRule::foundation; }
/// The options as walls are to be given them: with a rule of the library.
RuleOptions ruleAtWalls(const RuleOptions& options);

}  // namespace granular
