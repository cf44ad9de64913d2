#include "granular/point/contact_point.h"

#include <array>
#include <cassert>
#include <cmath>
#include <string>

#include "granular/core/errors.h"
#include "granular/core/open_table.h"
#include "granular/point/rules.h"
#include "granular/point/witness.h"

namespace granular {
namespace {

void placeDeepest(const RuleOptions&, const Shape&, const Frame&, const Shape&, const Frame&, const Touch& touch,
                  ContactPatch& out) {
  placeWitness(touch, out);
}

// The table of rules, in the order of PointRule. A manifold is placed where its state is kept.
constexpr std::array<PointRuleRow, 7> ownRules = {{
    {"witness", placeDeepest},
    {"manifold", placeDeepest},
    {"face_centroid", placeFaceCentroid},
    {"pressure_centroid", placeOnOverlap},
    {"patch", placeOnOverlap},
    {"stiff_patch", placeOnOverlap},
    {"foundation", placeOnOverlap},
}};
constinit OpenTable<PointRuleRow, PointRule> rules("contact-point rule", ownRules);

}  // namespace

void placeContact(const RuleOptions& options, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                  const Touch& touch, ContactPatch& out) {
  assert(options.rule != PointRule::manifold);
  rules[options.rule].place(options, a, frameA, b, frameB, touch, out);
}

double rockingStiffness(const RuleOptions& options) {
  return options.rule == PointRule::stiffPatch ? 2.0 * options.sharpness : 1;
}

double rockingDamping(const RuleOptions& options) {
  // As the normal dashpot damps two equal cubes that part, this one damps their rocking: there the reduced moment of
  // inertia is twice the reduced mass times the second moment of a face.
  return options.rule == PointRule::stiffPatch ? std::sqrt(4.0 * options.sharpness) : 1;
}

PointRule pointRuleFromName(std::string_view name) { return rules.find(name); }

std::string_view pointRuleName(PointRule rule) { return rules[rule].name; }

std::vector<std::string_view> pointRuleNames() { return rules.names(); }

PointRule addPointRule(const PointRuleRow& row) {
  const std::string name(row.name);
  require(row.place != nullptr, "contact-point rule \"" + name + "\": its row needs the function place");
  require(!isUsersRule(row.atWalls),
          "contact-point rule \"" + name + "\": atWalls must be a rule of the library, such as pressureCentroid");
  return rules.add(row);
}

RuleOptions ruleAtWalls(const RuleOptions& options) {
  RuleOptions chosen = options;
  if (isUsersRule(options.rule)) chosen.rule = rules[options.rule].atWalls;
  return chosen;
}

}  // namespace granular
