#include "granular/law/law.h"

#include <array>
#include <cmath>
#include <string>

#include "granular/core/errors.h"
#include "granular/core/open_table.h"
#include "granular/law/account.h"
#include "granular/law/hertz.h"
#include "granular/law/hertz_lanes.h"
#include "granular/law/linear.h"
#include "granular/law/linear_lanes.h"
#include "granular/law/tensor.h"

namespace granular {
namespace {

/// A law whose stiffness is the same at every overlap.
template <FindStiffness find>
ContactStiffness findAnywhere(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                              const ContactBody& b, const Vec3& normal, double, double) {
  return find(c, options, a, b, normal);
}

/// Hertz's: the force goes with overlap^{3/2}, so that its slope is 3/2 of the secant.
template <FindHertz find>
ContactStiffness findSlope(const LawConstants& c, const LawOptions& options, const ContactBody& a, const ContactBody& b,
                           const Vec3& normal, double overlap, double radius) {
  ContactStiffness k = find(c, options, a, b, normal, overlap, radius);
  k.normal *= 1.5;
  return k;
}

// The table of laws: one row per law, in the order of LawKind.
constexpr std::array<LawRow, 5> ownLaws = {{
    {"linear", applyLinearLaw, findAnywhere<findLinearStiffness>, accountSprings<findLinearStiffness>, false, false,
     nullptr, applyLinearLawInLanes},
    {"linear_local", applyLinearLocalLaw, findAnywhere<findLocalStiffness>, accountSprings<findLocalStiffness>, true},
    {"tensor", applyTensorLaw, findAnywhere<summariseTensorStiffness>, accountTensor, true},
    {"hertz", applyHertzLaw, findSlope<findHertzStiffness>, accountHertz<findHertzStiffness>, false, true, nullptr,
     applyHertzLawInLanes},
    {"hertz_mindlin", applyHertzMindlinLaw, findSlope<findMindlinStiffness>, accountHertz<findMindlinStiffness>, false,
     true, shortenGrownSpring, applyHertzMindlinLawInLanes},
}};
constinit OpenTable<LawRow, LawKind> laws("contact law", ownLaws);

void requireParameter(bool condition, const char* name, double value, const char* limit) {
  if (!condition)
    throw InputError(std::string("contact parameter ") + name + " = " + std::to_string(value) + ": " + limit);
}

void requireRestitution(const char* name, double e) {
  requireParameter(e != 0, name, e, "must be > 0 (no finite dashpot stops a contact dead)");
  requireParameter(e > 0 && e <= 1, name, e, "must lie in (0, 1]");
}

/// acos(z)/sqrt(1 - z^2), continued through z = 1 to acosh(z)/sqrt(z^2 - 1).
double arcRatio(double z) {
  const double gap = 1 - z;
  if (std::abs(gap) < 1e-4) return 1 + gap / 3 + 2 * gap * gap / 15;
  return gap > 0 ? std::acos(z) / std::sqrt(1 - z * z) : std::acosh(z) / std::sqrt(z * z - 1);
}

}  // namespace

void setElasticity(const Elasticity& a, const Elasticity& b, ContactParameters& parameters) {
  for (const Elasticity& solid : {a, b}) {
    requireParameter(solid.young > 0, "young_modulus", solid.young, "must be > 0 Pa");
    requireParameter(solid.poisson > -1 && solid.poisson <= 0.5, "poisson_ratio", solid.poisson,
                     "must lie in (-1, 0.5]");
  }
  require(std::isfinite(a.young) || std::isfinite(b.young),
          "contact of two rigid solids (young_modulus = infinity): one of them must give way");
  const auto normalCompliance = [](const Elasticity& s) { return (1 - s.poisson * s.poisson) / s.young; };
  const auto shearCompliance = [](const Elasticity& s) { return 2 * (1 + s.poisson) * (2 - s.poisson) / s.young; };
  parameters.modulus = 1 / (normalCompliance(a) + normalCompliance(b));
  parameters.shearModulus = 1 / (shearCompliance(a) + shearCompliance(b));
}

double dampingRatioFor(double restitution, bool tension) {
  const double logE = std::log(restitution);
  if (tension) return -logE / std::sqrt(pi * pi + logE * logE);

  // Cut at 0: -ln e = 2 z acos(z)/sqrt(1 - z^2) grows with z, and for large z as 2 ln(2 z): bisect.
  double low = 0, high = 1 + 1 / std::sqrt(restitution);
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (2 * middle * arcRatio(middle) < -logE ? low : high) = middle;
  }
  return restitution == 1 ? 0 : 0.5 * (low + high);
}

LawConstants prepareLaw(const ContactParameters& p) {
  requireParameter(std::isfinite(p.stiffness) && p.stiffness > 0, "stiffness", p.stiffness,
                   "must be finite and > 0 N/m");
  requireRestitution("restitution", p.restitution);
  requireRestitution("restitution_t", p.restitutionT);
  requireParameter(std::isfinite(p.friction) && p.friction >= 0, "friction", p.friction, "must be finite and >= 0");
  for (const auto& [name, value] : {std::pair{"E*", p.modulus},
                                    {"G*", p.shearModulus},
                                    {"damping_normal", p.dampingRateN},
                                    {"damping_tangential", p.dampingRateT}})
    requireParameter(std::isfinite(value) && value >= 0, name, value, "must be finite and >= 0");
  for (const double value : p.own) requireParameter(std::isfinite(value), "own", value, "must be finite");

  // S 13-16, apart from masses.
  const double logN = std::log(p.restitution), logT = std::log(p.restitutionT);
  const double phase = pi * pi + logN * logN;
  LawConstants c;
  c.parameters = p;
  c.inverseStiffness = 1 / p.stiffness;
  c.hertz = 4.0 / 3 * p.modulus;
  c.mindlin = 8 * p.shearModulus;
  c.dampingT = p.restitutionT == 1 ? 0 : -2 * logT / std::sqrt(phase);
  c.stiffnessRatio = (pi * pi + logT * logT) / phase;
  c.dampingN[1] = p.restitution == 1 ? 0 : 2 * dampingRatioFor(p.restitution, true);
  c.timeFactor[1] = std::sqrt(phase);

  // Cut at 0: the contact ends when the force does, 2 acos(zeta)/(w0 sqrt(1 - zeta^2)) after it began.
  const double cut = dampingRatioFor(p.restitution, false);
  c.dampingN[0] = 2 * cut;
  c.timeFactor[0] = 2 * arcRatio(cut);
  return c;
}

Law lawFunction(LawKind kind) { return laws[kind].apply; }

std::string_view lawName(LawKind kind) { return laws[kind].name; }

std::vector<std::string_view> lawNames() { return laws.names(); }

bool lawReadsInertia(LawKind kind, const LawOptions& options) { return laws[kind].readsInertia || options.localMass; }

LawInLanes lawInLanes(LawKind kind, const LawOptions& options) {
  return lawReadsInertia(kind, options) ? nullptr : laws[kind].inLanes;
}

bool lawReadsCurvature(LawKind kind) { return laws[kind].readsCurvature; }

bool lawSetsStiffness(LawKind kind) { return laws[kind].readsCurvature || laws.isUsers(kind); }

bool lawKeepsAccount(LawKind kind) { return laws[kind].account != nullptr; }

LawKind lawFromName(std::string_view name) { return laws.find(name); }

LawKind addLaw(const LawRow& row) {
  require(row.apply && row.stiffness,
          "contact law \"" + std::string(row.name) + "\": its row needs the functions apply and stiffness");
  return laws.add(row);
}

ContactStiffness stiffnessOf(LawKind kind, const LawConstants& constants, const LawOptions& options,
                             const ContactBody& a, const ContactBody& b, const Vec3& normal, double overlap,
                             double radius) {
  return laws[kind].stiffness(constants, options, a, b, normal, overlap, radius);
}

ContactAccount accountContact(LawKind kind, const LawConstants& constants, const LawOptions& options,
                              const ContactBody& a, const ContactBody& b, const ContactMotion& motion,
                              const ContactHistory& before, const ContactHistory& after, const ContactForce& force) {
  ContactAccount account;
  ContactHistory prepared = before;
  if (laws[kind].prepare) laws[kind].prepare(motion, prepared);
  const SpringStep step = followSpring(constants, motion, prepared, after);
  laws[kind].account(constants, options, a, b, motion, step, account);
  splitForce(motion, step, force, account);
  return account;
}

}  // namespace granular
