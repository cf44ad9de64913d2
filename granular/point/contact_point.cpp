#include "granular/point/contact_point.h"

#include <array>
#include <cassert>
#include <cmath>
#include <string>

#include "granular/core/errors.h"
#include "granular/point/rules.h"
#include "granular/point/witness.h"

namespace granular {
namespace {

// The table of rules, in the order of PointRule.
constexpr std::array<std::string_view, 7> names = {"witness", "manifold",    "face_centroid", "pressure_centroid",
                                                   "patch",   "stiff_patch", "foundation"};

}  // namespace

void placeContact(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                  const Touch& touch, ContactPatch& out) {
  switch (options.rule) {
    case PointRule::manifold:
      assert(false && "the manifold rule keeps state of its own and is placed where that is kept");
      [[fallthrough]];
    case PointRule::witness:
      return placeWitness(touch, out);
    case PointRule::faceCentroid:
      return placeFaceCentroid(options, a, frameA, b, frameB, touch, out);
    case PointRule::pressureCentroid:
    case PointRule::patch:
    case PointRule::stiffPatch:
    case PointRule::foundation:
      return placeOnOverlap(options, a, frameA, b, frameB, touch, out);
  }
}

double rockingStiffness(const RuleOptions& options) {
  return options.rule == PointRule::stiffPatch ? 2.0 * options.sharpness : 1;
}

double rockingDamping(const RuleOptions& options) {
  // As the normal dashpot damps two equal cubes that part, this one damps their rocking: there the reduced moment of
  // inertia is twice the reduced mass times the second moment of a face.
  return options.rule == PointRule::stiffPatch ? std::sqrt(4.0 * options.sharpness) : 1;
}

PointRule pointRuleFromName(std::string_view name) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == name) return static_cast<PointRule>(k);
  }
  std::string known;
  for (const std::string_view each : names) known += " \"" + std::string(each) + "\"";
  throw InputError("unknown contact-point rule \"" + std::string(name) + "\"; known:" + known);
}

std::string_view pointRuleName(PointRule rule) { return names[static_cast<std::size_t>(rule)]; }

}  // namespace granular
