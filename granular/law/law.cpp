#include "granular/law/law.h"

#include <array>
#include <cmath>
#include <string>

#include "granular/core/errors.h"
#include "granular/law/account.h"
#include "granular/law/linear.h"
#include "granular/law/tensor.h"

namespace granular {
namespace {

using StiffnessFinder = ContactStiffness (*)(const LawConstants&, const LawOptions&, const ContactBody&,
                                             const ContactBody&, const Vec3&);

using Accountant = void (*)(const LawConstants&, const LawOptions&, const ContactBody&, const ContactBody&,
                            const ContactMotion&, const SpringStep&, ContactAccount&);

struct LawRow {
  LawKind kind;
  std::string_view name;
  Law function;
  StiffnessFinder stiffness;
  Accountant account;
  bool readsInertia;
};

// The table of laws: one row per law, in the order of LawKind.
constexpr std::array<LawRow, 3> laws = {{
    {LawKind::linear, "linear", applyLinearLaw, findLinearStiffness, accountSprings<findLinearStiffness>, false},
    {LawKind::linearLocal, "linear_local", applyLinearLocalLaw, findLocalStiffness, accountSprings<findLocalStiffness>,
     true},
    {LawKind::tensor, "tensor", applyTensorLaw, summariseTensorStiffness, accountTensor, true},
}};

const LawRow& rowOf(LawKind kind) { return laws[static_cast<std::size_t>(kind)]; }

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

  // S 13-16, apart from masses.
  const double logN = std::log(p.restitution), logT = std::log(p.restitutionT);
  const double phase = pi * pi + logN * logN;
  LawConstants c;
  c.parameters = p;
  c.inverseStiffness = 1 / p.stiffness;
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

Law lawFunction(LawKind kind) { return rowOf(kind).function; }

std::string_view lawName(LawKind kind) { return rowOf(kind).name; }

bool lawReadsInertia(LawKind kind, const LawOptions& options) { return rowOf(kind).readsInertia || options.localMass; }

LawKind lawFromName(std::string_view name) {
  for (const LawRow& row : laws) {
    if (row.name == name) return row.kind;
  }
  std::string known;
  for (const LawRow& row : laws) known += " \"" + std::string(row.name) + "\"";
  throw InputError("unknown contact law \"" + std::string(name) + "\"; known:" + known);
}

ContactStiffness stiffnessOf(LawKind kind, const LawConstants& constants, const LawOptions& options,
                             const ContactBody& a, const ContactBody& b, const Vec3& normal) {
  return rowOf(kind).stiffness(constants, options, a, b, normal);
}

ContactAccount accountContact(LawKind kind, const LawConstants& constants, const LawOptions& options,
                              const ContactBody& a, const ContactBody& b, const ContactMotion& motion,
                              const ContactHistory& before, const ContactHistory& after, const ContactForce& force) {
  ContactAccount account;
  const SpringStep step = followSpring(constants, motion, before, after);
  rowOf(kind).account(constants, options, a, b, motion, step, account);
  splitForce(motion, step, force, account);
  return account;
}

}  // namespace granular
