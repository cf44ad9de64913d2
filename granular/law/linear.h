// The linear spring-dashpot with tangential history (Seelen et al. 2018, section 6, with its typing errors corrected).
// n: unit normal from i to j; delta: overlap; u: velocity of i's contact point minus j's; F: force on i.
//   1/mu  = 1/m_i + 1/m_j          1/m_t = 1/mu + R_i + R_j,  R = <r^2>/<I>
//   k_t   = k_n (m_t/mu) (pi^2 + ln^2 e_t)/(pi^2 + ln^2 e_n)                     (S 13; the source lost the 1/mu)
//   t_c   = sqrt(mu (pi^2 + ln^2 e_n)/k_n)                                      (S 14)
//   eta_n = -2 mu ln(e_n)/t_c      eta_t = -2 m_t ln(e_t)/t_c                    (S 15, 16)
//   F_n   = -k_n delta n - eta_n u_n                                            (S 10)
//   F_t   = -k_t delta_t - eta_t u_t, or Coulomb's limit mu_c |F_n|              (S 11)
//   delta_t is rotated with the contact, grows by the slip, and is reset while sliding so that spring plus dashpot is
//   the Coulomb force                                                           (S 12; the source's sign contradicts S
//   11)
// A patch spreads the normal dashpot over its polygon and gets a torsional spring (below).
// The kernel is inline: no virtual call, no allocation, no logarithm.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>

#include "granular/law/law.h"

namespace granular {

/// 1/(n . A n) of one body: the inverse of the mass that a contact at its arm feels along n, 1/kg.
inline double localInverseMass(const ContactBody& body, const Vec3& n) {
  const Vec3 lever = body.arm.cross(n);
  return body.inverseMass + lever.dot(body.inverseInertia * lever);
}

/// Trace of -[r]x I^-1 [r]x of one body: the sum of its lever terms over three perpendicular directions, 1/kg.
inline double leverTrace(const ContactBody& body) {
  return body.inverseInertia.trace() * body.arm.squaredNorm() - body.arm.dot(body.inverseInertia * body.arm);
}

/// The coefficients of one contact (S 13-16). localMass changes eta_n and t_c alone: k_t and eta_t stay those of S.
inline ContactStiffness findLinearStiffness(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                            const ContactBody& b, const Vec3& normal) {
  const double inverseMu = a.inverseMass + b.inverseMass;
  const double inverseMt = inverseMu + a.radiusRatio + b.radiusRatio;
  assert(inverseMu > 0);
  const double product = 1 / (inverseMu * inverseMt);
  const double mu = inverseMt * product;
  const double root = std::sqrt(c.parameters.stiffness * mu);

  // m_t/mu scales both tangential coefficients; sqrt(k_n/mu) = root/mu.
  ContactStiffness k;
  k.normal = c.parameters.stiffness;
  k.tangential = k.normal * c.stiffnessRatio * inverseMu * inverseMu * product;
  k.dampingTangential = c.dampingT * root * inverseMu * inverseMu * product;

  // sqrt(k_n m) gives the normal dashpot and the contact's duration.
  const double rootN =
      options.localMass ? std::sqrt(k.normal / (localInverseMass(a, normal) + localInverseMass(b, normal))) : root;
  k.dampingNormal = c.dampingN[options.tension] * rootN;
  k.contactTime = c.timeFactor[options.tension] * rootN * c.inverseStiffness;
  return k;
}

/// The coefficients of the same law with the contact's own masses in place of S's averages: 1/m_n = n.A n for mu, and
/// the mean of A over the tangential directions for 1/m_t, A being the inverse mass that the contact point feels. For
/// spheres they are those of S.
inline ContactStiffness findLocalStiffness(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                           const ContactBody& b, const Vec3& normal) {
  const double inverseMn = localInverseMass(a, normal) + localInverseMass(b, normal);
  const double trace = 3 * (a.inverseMass + b.inverseMass) + leverTrace(a) + leverTrace(b);
  const double inverseMt = 0.5 * (trace - inverseMn);
  assert(inverseMn > 0 && inverseMt > 0);
  const double ratio = inverseMn / inverseMt;  // m_t/m_n
  const double root = std::sqrt(c.parameters.stiffness / inverseMn);

  ContactStiffness k;
  k.normal = c.parameters.stiffness;
  k.tangential = k.normal * c.stiffnessRatio * ratio;
  k.dampingNormal = c.dampingN[options.tension] * root;
  k.dampingTangential = c.dampingT * root * ratio;
  k.contactTime = c.timeFactor[options.tension] * root * c.inverseStiffness;
  return k;
}

/// The tangential spring carried to the new contact plane: the smallest rotation that takes the old normal to the new
/// one, then the mean spin about the normal during the step. Both keep its length. `old` must be zero or a unit vector.
inline Vec3 carrySpring(const Vec3& spring, const Vec3& old, const Vec3& normal, double angle) {
  // For d perpendicular to n0: d - (n1.d)/(1 + n0.n1) (n0 + n1). Opposite normals are not the same contact: start anew.
  const double cosine = old.dot(normal);
  if (cosine <= -0.999) return Vec3::Zero();
  const double t = 0.5 * angle;
  const double inverse = 1 / ((1 + cosine) * (1 + t * t));
  const Vec3 tilted = spring - (normal.dot(spring) * (1 + t * t) * inverse) * (old + normal);
  // Cayley's rotation by 2 atan(angle/2): exact length, angle right to its cube over 12.
  const double scale = (1 + cosine) * inverse;
  return ((1 - t * t) * scale) * tilted + (2 * t * scale) * normal.cross(tilted);
}

/// Holds a spring-dashpot pair within Coulomb's limit in one dimension: returns the force, resets the spring while
/// sliding. stiffness > 0.
inline double slideTwist(double limit, double stiffness, double damping, double rate, double& spring) {
  const double trial = stiffness * spring + damping * rate;
  if (std::abs(trial) <= limit) return -trial;
  const double bounded = std::copysign(limit, trial);
  spring = std::abs(damping * rate) >= limit ? 0 : (bounded - damping * rate) / stiffness;
  return -bounded;
}

/// A patch's normal force: the elastic force k_n delta at the contact point, and the dashpot spread evenly over the
/// polygon, its moments times `rocking`.
///
/// The dashpot's pressure (eta_n/area) u_n(x) is linear in x; with rho from the patch centre, u_n = u_c + g.rho and
/// g = n x spin, its resultant eta_n u_c acts at the centre and its first moment is eta_n M g (M: second moments per
/// area). "Pressures below 0 don't count": resultants of pressures >= 0 on the polygon lie in a cone over it. We hold N
/// and the first moment S about the centre in the cone S.M^-1 S <= 2 N^2: the ellipse of radius sqrt(2) sigma lies
/// inside every convex polygon (the triangle's touches its sides), so the centre of pressure cannot leave the patch. A
/// linear elastic pressure >= 0 satisfies S.M^-1 S <= N^2/2 and lies within; a stiff patch may press at the very rim,
/// and then the cone is as wide as that: r N with r^2 = max(2, S_e.M^-1 S_e/N_e^2), at most 8 (a triangle's corner). A
/// trial outside is projected on the cone in the dashpot's metric, N^2 + S.M^-1 S/rocking: closed form, continuous, and
/// never adding energy, because the dashpot's share F - F_e of a projection on a convex set that holds F_e obeys
/// (F - F_e).velocity >= |F - F_e|^2/eta. With tension, N is S 10 unchanged: the pull acts at the centre, and S is held
/// within r max(N, k_n delta). Returns N; writes the couple about the contact point.
inline double pressPatch(const ContactMotion& m, double elastic, double damping, bool tension, Vec3& couple) {
  const Vec3& n = m.normal;
  const Vec3 v = n.cross(m.u);
  const Vec3 g = n.cross(m.spin);
  const double gu = g.dot(m.u), gv = g.dot(v);
  const double cu = m.centreArm.dot(m.u), cv = m.centreArm.dot(v);

  // Trial: elastic force at the contact point, dashpot about the centre.
  const double approach = n.dot(m.velocity) + cu * gu + cv * gv;
  double push = elastic + damping * approach;
  const double mgu = m.rocking * (m.uu * gu + m.uv * gv), mgv = m.rocking * (m.uv * gu + m.vv * gv);
  double su = damping * mgu - elastic * cu, sv = damping * mgv - elastic * cv;

  // S.M^-1 S/rocking without inverting M where it isn't needed; c.M^-1 c <= 8 also bounds the round-off of slivers.
  const double det = m.uu * m.vv - m.uv * m.uv;
  const double quadratic = m.vv * cu * cu - 2 * m.uv * cu * cv + m.uu * cv * cv;
  const double offset = quadratic < 8 * det ? std::max(quadratic / det, 0.0) : 8;
  const double square = damping * damping * (gu * mgu + gv * mgv) - 2 * damping * elastic * (gu * cu + gv * cv) +
                        elastic * elastic * offset / m.rocking;

  // Project.
  const double held = tension ? std::max(push, elastic) : std::max(push, 0.0);
  const double slope = std::max(2.0, offset) / m.rocking;  // r^2
  if (square > slope * held * held) {
    const double s = std::sqrt(square), r = std::sqrt(slope);
    double bound = r * held;
    if (!tension) {
      push = std::max(push + r * s, 0.0) / (1 + slope);
      bound = r * push;
    }
    su *= bound / s;
    sv *= bound / s;
  } else if (!tension) {
    push = held;
  }

  // From the centre to the contact point; couple on A = moment x (-n), with u x n = -v and v x n = u.
  su += cu * push;
  sv += cv * push;
  couple = su * v - sv * m.u;
  return push;
}

/// The tangential force, with its spring carried, stretched and held within Coulomb's limit.
inline Vec3 rubTangentially(const ContactStiffness& k, const LawOptions& options, double limit, const ContactMotion& m,
                            ContactHistory& history, bool& sliding) {
  // Carry the spring into the new plane and add what the contact point slipped during the step.
  const Vec3& n = m.normal;
  Vec3 spring = carrySpring(history.spring, history.normal, n, n.dot(m.meanSpin) * m.dt) + m.slip;
  spring -= n.dot(spring) * n;
  const Vec3 slide = m.velocity - n.dot(m.velocity) * n;
  const double stiffness = k.tangential * m.share, damping = k.dampingTangential * m.share;

  // Stick?
  const Vec3 trial = stiffness * spring + damping * slide;
  const double square = trial.squaredNorm();
  history.normal = n;
  sliding = square > limit * limit;
  if (!sliding) {
    history.spring = spring;
    return -trial;
  }

  // Slide: the spring and dashpot together are Coulomb's force; a dashpot that exceeds it alone leaves no spring.
  const double slideSquare = slide.squaredNorm();
  const bool alongVelocity = options.slideAlongVelocity && slideSquare > 0;
  const Vec3 force =
      alongVelocity ? Vec3((limit / std::sqrt(slideSquare)) * slide) : Vec3((limit / std::sqrt(square)) * trial);
  if (damping * damping * slideSquare >= limit * limit) {
    history.spring.setZero();
  } else {
    history.spring = (force - damping * slide) * (1 / stiffness);
  }
  return -force;
}

/// A patch also turns about the normal against a torsional spring k_t (uu + vv), a dashpot eta_t (uu + vv) and
/// Coulomb's limit mu_c |F_n| (2/3) sqrt(area/pi): the torque of even pressure on a disc of equal area that slips
/// everywhere. Limits of sliding and twisting are held apart. limit: mu_c |F_n|, N.
inline void twistPatch(const ContactMotion& m, double stiffness, double damping, double limit, ContactHistory& history,
                       ContactForce& out) {
  const double polar = m.area > 0 ? m.uu + m.vv : 0;
  if (polar <= 0) {
    history.twist = 0;
    return;
  }
  constexpr double meanRadius = 0.37612638903183754;  // 2/3 / sqrt(pi)
  history.twist += m.normal.dot(m.turn);
  out.couple += slideTwist(limit * meanRadius * std::sqrt(m.area), stiffness * polar, damping * polar,
                           m.normal.dot(m.spin), history.twist) *
                m.normal;
}

/// The law with given coefficients. History is updated in place; out is overwritten.
inline void pressAndRub(const ContactStiffness& k, const LawConstants& c, const LawOptions& options,
                        const ContactMotion& m, ContactHistory& history, ContactForce& out) {
  const double elastic = m.share * k.normal * m.overlap, damping = m.share * k.dampingNormal;

  // Normal force, signed: > 0 pushes apart.
  double push;
  if (m.area > 0) {
    push = pressPatch(m, elastic, damping, options.tension, out.couple);
  } else {
    push = elastic + damping * m.normal.dot(m.velocity);
    if (!options.tension) push = std::max(push, 0.0);
    out.couple.setZero();
  }
  out.normalForce = push;
  out.force = -push * m.normal;

  // No friction, no history.
  if (c.parameters.friction == 0) {
    history = ContactHistory{};
    out.sliding = false;
    return;
  }

  // Friction, and a patch's friction against twisting.
  const double limit = c.parameters.friction * (options.frictionOfPush ? std::max(push, 0.0) : std::abs(push));
  out.force += rubTangentially(k, options, limit, m, history, out.sliding);
  twistPatch(m, m.share * k.tangential, m.share * k.dampingTangential, limit, history, out);
}

/// The law as S has it: k_t and eta_t from averaged masses.
inline void applyLinearLaw(const LawConstants& c, const LawOptions& options, const ContactBody& a, const ContactBody& b,
                           const ContactMotion& m, ContactHistory& history, ContactForce& out) {
  pressAndRub(findLinearStiffness(c, options, a, b, m.normal), c, options, m, history, out);
}

/// The law with the contact's own masses.
inline void applyLinearLocalLaw(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                const ContactBody& b, const ContactMotion& m, ContactHistory& history,
                                ContactForce& out) {
  pressAndRub(findLocalStiffness(c, options, a, b, m.normal), c, options, m, history, out);
}

}  // namespace granular
