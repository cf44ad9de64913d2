// Hertz's contact of smooth elastic bodies, in two rows of the table. R: effective radius of the two surfaces
// (shape/curvature.h), delta: overlap, a = sqrt(R delta): radius of the contact circle. Every stiffness grows with a.
//
// hertz, Markauskas et al. 2010, eqs 19-25, for two solids of any kind (theirs are equal, E* = E/(2 (1 - nu^2)), G* =
// G/(2 (2 - nu)), and their normal points the other way):
//   F_n = 4/3 E* sqrt(R) delta^{3/2} + eta_n mu u_n        eta_n, eta_t: given, 1/s; mu: reduced mass
//   F_t = 16/3 G* a delta_t + eta_t mu u_t, or Coulomb's limit                 (two thirds of Mindlin's stiffness)
// The spring is secant: the whole of delta_t is stretched with the stiffness of now.
//
// hertz_mindlin:
//   F_n = 4/3 E* sqrt(R) delta^{3/2} + sqrt(5) zeta sqrt(k m) u_n              k = F_elastic/delta = 4/3 E* a
//   dF_t = 8 G* a d(delta_t) while the contact grows or holds (Mindlin 1949, no slip); when it shrinks, the force
//        shrinks with the stiffness, so that no energy is won from unloading    (+ 2 sqrt(5/6) beta sqrt(8 G* a mu)
//        u_t)
// The dashpot goes with delta^{1/4} (Tsuji et al. 1992). Then v dv/dd = -d^{3/2} - alpha d^{1/4} v (scaled) becomes, in
// y = d^{5/4}, the linear oscillator v dv/dy = -4/5 (y + alpha v), of damping ratio alpha/sqrt(5): the restitution does
// not depend on the speed and is that of the linear law with the same zeta, kept attractive or cut at 0 alike (Antypov
// and Elliott 2011 for the former; beta = zeta then). The tangential dashpot has the same beta.
#pragma once

#include "granular/law/linear.h"

namespace granular {

/// The inverse mass behind the normal dashpot, 1/kg.
inline double inverseMassAlong(const LawOptions& options, const ContactBody& a, const ContactBody& b, const Vec3& n) {
  return options.localMass ? localInverseMass(a, n) + localInverseMass(b, n) : a.inverseMass + b.inverseMass;
}

/// Time from touch to parting of an elastic impact that ends at the overlap with the secant stiffness k: 2.94327
/// delta/v, v^2 = 4/5 k delta^2/m.
inline double elasticContactTime(double k, double inverseMass) { return 3.2906798 / std::sqrt(k * inverseMass); }

/// Coefficients of M's row; normal: secant.
inline ContactStiffness findHertzStiffness(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                           const ContactBody& b, const Vec3& normal, double overlap, double radius) {
  const double circle = std::sqrt(radius * overlap);
  const double inverse = a.inverseMass + b.inverseMass;
  assert(inverse > 0);
  ContactStiffness k;
  k.normal = c.hertz * circle;
  k.tangential = (2.0 / 3) * c.mindlin * circle;
  k.dampingNormal = c.parameters.dampingRateN / inverseMassAlong(options, a, b, normal);
  k.dampingTangential = c.parameters.dampingRateT / inverse;
  k.contactTime = elasticContactTime(k.normal, inverse);
  return k;
}

/// Coefficients of hertz_mindlin; normal: secant.
inline ContactStiffness findMindlinStiffness(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                             const ContactBody& b, const Vec3& normal, double overlap, double radius) {
  constexpr double halfRootFive = 1.1180339887498949, rootFiveSixths = 0.91287092917527690;
  const double circle = std::sqrt(radius * overlap);
  const double inverse = a.inverseMass + b.inverseMass;
  assert(inverse > 0);
  ContactStiffness k;
  k.normal = c.hertz * circle;
  k.tangential = c.mindlin * circle;
  k.dampingNormal =
      halfRootFive * c.dampingN[options.tension] * std::sqrt(k.normal / inverseMassAlong(options, a, b, normal));
  k.dampingTangential = rootFiveSixths * c.dampingN[1] * std::sqrt(k.tangential / inverse);
  k.contactTime = elasticContactTime(k.normal, inverse);
  return k;
}

/// The depth whose stiffness a contact has: the overlap, or what a rule with a potential of its own makes of it. With
/// the linear potential k_n/2 u^2 of a rule, force k_n u du, Hertz's is 2/5 K u^{5/2}, of force K sqrt(u) u du: the
/// stiffness at u times the rule's depth u du.
inline double stiffDepth(const ContactMotion& m) { return std::sqrt(m.squaredDepth); }

/// A contact that grew keeps its tangential force, not its spring's length: the spring becomes shorter as it becomes
/// stiffer. The overlap a step ago is that of the motion since; R counts as it is.
inline void shortenGrownSpring(const ContactMotion& m, ContactHistory& history) {
  const double grown = m.normal.dot(m.slip);
  if (!(grown > 0) || history.normal.isZero()) return;
  const double depth = stiffDepth(m);
  const double ratio = depth > grown ? std::sqrt((depth - grown) / depth) : 0;
  history.spring *= ratio;
  history.twist *= ratio;
}

inline void applyHertzLaw(const LawConstants& c, const LawOptions& options, const ContactBody& a, const ContactBody& b,
                          const ContactMotion& m, ContactHistory& history, ContactForce& out) {
  pressAndRub(findHertzStiffness(c, options, a, b, m.normal, stiffDepth(m), m.radius), c, options, m, history, out);
}

inline void applyHertzMindlinLaw(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                 const ContactBody& b, const ContactMotion& m, ContactHistory& history,
                                 ContactForce& out) {
  shortenGrownSpring(m, history);
  pressAndRub(findMindlinStiffness(c, options, a, b, m.normal, stiffDepth(m), m.radius), c, options, m, history, out);
}

}  // namespace granular
