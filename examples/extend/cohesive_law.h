// A law of one's own: the library's linear law, and a constant pull for as long as two bodies touch.
//   F_n = k_n delta - F_c + eta_n u_n
// F_c is the force that pulls the contact apart: its own[0], N. The pull is that of an energy -F_c delta, which is 0
// where contacts begin and end: without dashpots every impact gives back what it took. Friction is held within
// Coulomb's limit of the force without the pull.
#pragma once

#include "granular/law/account.h"

namespace extend {

using namespace granular;

/// F_c of a contact; share keeps the spots of one face as strong as one contact.
inline double pullOf(const LawConstants& c, const ContactMotion& m) { return m.share * c.parameters.own[0]; }

/// The force on A; the normal points from A to B, so that a pull has its direction.
inline void applyCohesiveLaw(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                             const ContactBody& b, const ContactMotion& m, ContactHistory& history, ContactForce& out) {
  applyLinearLaw(c, options, a, b, m, history, out);
  out.force += pullOf(c, m) * m.normal;
  out.normalForce -= pullOf(c, m);
}

/// What the bound on the time step is made from: a constant force makes nothing stiffer.
inline ContactStiffness findCohesiveStiffness(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                              const ContactBody& b, const Vec3& normal, double /*overlap*/,
                                              double /*radius*/) {
  return findLinearStiffness(c, options, a, b, normal);
}

/// For the energy ledger.
inline void accountCohesion(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                            const ContactBody& b, const ContactMotion& m, const SpringStep& step,
                            ContactAccount& account) {
  accountSprings<findLinearStiffness>(c, options, a, b, m, step, account);
  account.normalSpring -= pullOf(c, m) * m.overlap;
  account.elasticForce += pullOf(c, m) * m.normal;
}

/// Adds the law under the name "cohesive": once, at the start of the program.
inline LawKind addCohesiveLaw() {
  return addLaw({"cohesive", applyCohesiveLaw, findCohesiveStiffness, accountCohesion});
}

}  // namespace extend
