// A stiffness matrix in place of a normal and a tangential spring, so that a contact's whole motion is isochronous.
//
// A = sum over both bodies of (1/m 1 - [r]x I^-1 [r]x) is the inverse mass that the contact point feels: a force F on A
// changes the relative velocity u at the rate A F. Off the line of centres A is no multiple of 1, so that a normal
// force moves the point sideways too, and two springs (S 10, 11) part at different times: some of the tangential spring
// is left over. With d the displacement since first touch, overlap n + tangential spring, and
//   F = -K d - C u     K = w^2 X A^-1 X     C = w Y A^-1 Y     w^2 = k_n/m_n, 1/m_n = n.A n
//   X = n n + rho t t, rho^2 = (pi^2 + ln^2 e_t)/(pi^2 + ln^2 e_n) as in S 13
//   Y = sqrt(2 zeta_n) n n + sqrt(2 zeta_t) t t, 2 zeta_t = -2 ln e_t/sqrt(pi^2 + ln^2 e_n) as in S 16
// (t t: the projector on the contact plane) the motion u' = A F is that of one oscillator in every direction when e_n =
// e_t: overlap and spring vanish together. K and C are symmetric and positive, so the force is the gradient of
// 1/2 d.K d while arms and normal keep still, and no dashpot adds energy, which Newton's two restitutions would for
// some eccentric impacts: with e_n != e_t they are exact where the contact is central. For spheres the law is the
// linear one.
//
// Coulomb's limit. A slider in series with spring and dashpot takes the slip p, along the friction force:
//   F_t = F_t* - M_tt p,  F_n = F_n* - M_nt p,  p = rho F_t, rho >= 0,  M = K + C/dt,
// with the trial force F* of a contact that sticks, and rho such that |F_t| = mu_c |F_n|. F_t = (1 + rho M_tt)^-1 F_t*
// falls from the trial to 0, where F_n is the force of a contact without friction: its stiffness is k_n and its dashpot
// that of the local mass (K's and C's Schur complements). So there always is a root, and neither friction nor a jammed
// (Painleve) contact needs a case of its own.
#pragma once

#include "granular/law/linear.h"

namespace granular {

/// The matrices of one contact in its own axes: columns n, t1, t2 in world axes.
struct TensorStiffness {
  Mat3 axes;
  Mat3 spring;             ///< K, N/m
  Mat3 damping;            ///< C, kg/s
  double inverseMass = 0;  ///< n.A n, 1/kg
};

/// Adds one body's inverse mass at its arm, in contact axes.
inline void addInverseMass(const ContactBody& body, const Mat3& axes, Mat3& sum) {
  Mat3 lever;
  for (int k = 0; k < 3; ++k) lever.col(k) = body.arm.cross(axes.col(k));
  sum += lever.transpose() * (body.inverseInertia * lever);
  sum.diagonal().array() += body.inverseMass;
}

inline TensorStiffness findTensorStiffness(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                           const ContactBody& b, const Vec3& normal) {
  TensorStiffness k;
  k.axes.col(0) = normal;
  k.axes.col(1) = perpendicular(normal);
  k.axes.col(2) = normal.cross(k.axes.col(1));
  Mat3 inverse = Mat3::Zero();
  addInverseMass(a, k.axes, inverse);
  addInverseMass(b, k.axes, inverse);
  k.inverseMass = inverse(0, 0);
  assert(k.inverseMass > 0);

  // A^-1 by cofactors; kept symmetric.
  Mat3 mass;
  mass.row(0) = inverse.col(1).cross(inverse.col(2)).transpose();
  mass.row(1) = inverse.col(2).cross(inverse.col(0)).transpose();
  mass.row(2) = inverse.col(0).cross(inverse.col(1)).transpose();
  const double determinant = mass.row(0).dot(inverse.col(0).transpose());
  mass = (0.5 / determinant) * (mass + Mat3(mass.transpose()));

  const double square = c.parameters.stiffness * k.inverseMass, omega = std::sqrt(square);
  const double rho = std::sqrt(c.stiffnessRatio);
  const Vec3 x(1, rho, rho);
  const double dampingT = std::sqrt(c.dampingT);
  const Vec3 y(std::sqrt(c.dampingN[options.tension]), dampingT, dampingT);
  k.spring = square * (x.asDiagonal() * mass * x.asDiagonal());
  k.damping = omega * (y.asDiagonal() * mass * y.asDiagonal());
  return k;
}

inline ContactStiffness summariseTensorStiffness(const LawConstants& c, const LawOptions& options, const ContactBody& a,
                                                 const ContactBody& b, const Vec3& normal) {
  const TensorStiffness k = findTensorStiffness(c, options, a, b, normal);
  ContactStiffness summary;
  summary.normal = k.spring(0, 0);
  summary.tangential = 0.5 * (k.spring(1, 1) + k.spring(2, 2));
  summary.dampingNormal = k.damping(0, 0);
  summary.dampingTangential = 0.5 * (k.damping(1, 1) + k.damping(2, 2));
  summary.contactTime = c.timeFactor[options.tension] / std::sqrt(c.parameters.stiffness * k.inverseMass);
  return summary;
}

/// How a contact slides, in contact axes.
struct Slip {
  Vec2 friction;  ///< F_t as a force on B, N
  Vec2 way;       ///< p, m
};

/// Finds the slip that brings the trial force (normal, t1, t2; on B) to Coulomb's limit. give: M above, N/m.
/// The unknown is q = rho m/(1 + rho m) in [0, 1] with m the mean of M_tt: in q the excess over the limit is a straight
/// line where M_tt is a multiple of 1, and nearly straight elsewhere, so that the secant with a bracket (Illinois) ends
/// after a few steps.
inline Slip slideToLimit(const Vec3& trial, const Mat3& give, double friction, bool push) {
  const double mean = 0.5 * (give(1, 1) + give(2, 2)), inverse = 1 / mean;
  const double a = give(1, 1) * inverse - 1, b = give(1, 2) * inverse, d = give(2, 2) * inverse - 1;
  const Vec2 t = trial.tail<2>(), coupling = give.block<1, 2>(0, 1).transpose();
  const auto slipAt = [&](double q) {
    const double p11 = 1 + q * a, p12 = q * b, p22 = 1 + q * d;
    const double scale = 1 / (p11 * p22 - p12 * p12);
    const Vec2 part = scale * Vec2(p22 * t.x() - p12 * t.y(), p11 * t.y() - p12 * t.x());
    return Slip{(1 - q) * part, (q * inverse) * part};
  };
  const auto excess = [&](const Slip& slip) {
    const double normal = trial.x() - coupling.dot(slip.way);
    return slip.friction.norm() - friction * (push ? std::max(normal, 0.0) : std::abs(normal));
  };

  // Excess above 0 at q = 0 (the trial exceeds the limit) and not above it at q = 1 (no friction).
  double low = 0, high = 1;
  Slip slip = slipAt(0), none = slipAt(1);
  double above = excess(slip), below = excess(none);
  if (below >= 0) return none;
  const double enough = 4 * std::numeric_limits<double>::epsilon() * t.norm();
  int side = 0;
  for (int k = 0; k < 100; ++k) {
    const double q = (low * below - high * above) / (below - above);
    slip = slipAt(q);
    const double value = excess(slip);
    if (std::abs(value) <= enough || high - low <= std::numeric_limits<double>::epsilon()) break;
    if (value > 0) {
      low = q;
      above = value;
      if (side == 1) below *= 0.5;
      side = 1;
    } else {
      high = q;
      below = value;
      if (side == -1) above *= 0.5;
      side = -1;
    }
  }
  return slip;
}

/// Normal, t1 and t2 component of the force on B of a contact with friction, in contact axes; springs and sliding.
inline Vec3 rubWithTensor(const TensorStiffness& k, const LawConstants& c, const LawOptions& options,
                          const ContactMotion& m, const Vec3& u, ContactHistory& history, bool& sliding) {
  const Vec3& n = m.normal;
  const Mat3 spring = m.share * k.spring, damping = m.share * k.damping;
  const Vec3 carried = carrySpring(history.spring, history.normal, n, n.dot(m.meanSpin) * m.dt) + m.slip;
  Vec3 d = k.axes.transpose() * carried;
  d.x() = m.overlap;

  // Trial: the contact sticks. Beyond Coulomb's limit it slides.
  Vec3 force = spring * d + damping * u;
  const bool push = options.frictionOfPush || !options.tension;
  const double limit = c.parameters.friction * (push ? std::max(force.x(), 0.0) : std::abs(force.x()));
  sliding = force.tail<2>().squaredNorm() > limit * limit;
  if (sliding) {
    const Mat3 give = m.dt > 0 ? Mat3(spring + damping / m.dt) : spring;
    const Slip slip = slideToLimit(force, give, c.parameters.friction, push);
    force.x() -= give(0, 1) * slip.way.x() + give(0, 2) * slip.way.y();
    // The root is known to the trial's round-off, which may be large beside a small limit.
    const double held = c.parameters.friction * (push ? std::max(force.x(), 0.0) : std::abs(force.x()));
    const double square = slip.friction.squaredNorm();
    force.tail<2>() = square > held * held ? Vec2((held / std::sqrt(square)) * slip.friction) : slip.friction;
    d.tail<2>() -= slip.way;
  }
  history.spring = d.y() * k.axes.col(1) + d.z() * k.axes.col(2);
  history.normal = n;
  return force;
}

/// The law itself. History is updated in place; out is overwritten. Without friction it is the linear one with the
/// local mass. A patch spreads the normal dashpot over its polygon and resists twisting as with the linear law.
inline void applyTensorLaw(const LawConstants& c, const LawOptions& options, const ContactBody& a, const ContactBody& b,
                           const ContactMotion& m, ContactHistory& history, ContactForce& out) {
  if (c.parameters.friction == 0) {
    applyLinearLocalLaw(c, options, a, b, m, history, out);
    return;
  }
  const TensorStiffness k = findTensorStiffness(c, options, a, b, m.normal);

  // A patch's normal dashpot feels the velocity at its centre.
  Vec3 u = k.axes.transpose() * m.velocity;
  if (m.area > 0) u.x() += m.normal.dot(m.spin.cross(m.centreArm));
  Vec3 force = rubWithTensor(k, c, options, m, u, history, out.sliding);

  // The normal force, over a patch's polygon if there is one. What no longer pushes can't hold by friction either.
  double push = options.tension ? force.x() : std::max(force.x(), 0.0);
  out.couple.setZero();
  if (m.area > 0) {
    const double damping = m.share * k.damping(0, 0);
    push = pressPatch(m, force.x() - damping * u.x(), damping, options.tension, out.couple);
    if (push < force.x()) force.tail<2>() *= push / force.x();
  }
  out.normalForce = push;
  out.force = -push * m.normal - force.y() * k.axes.col(1) - force.z() * k.axes.col(2);

  // A patch's friction against twisting.
  const bool ofPush = options.frictionOfPush || !options.tension;
  const double limit = c.parameters.friction * (ofPush ? std::max(push, 0.0) : std::abs(push));
  twistPatch(m, 0.5 * m.share * (k.spring(1, 1) + k.spring(2, 2)), 0.5 * m.share * (k.damping(1, 1) + k.damping(2, 2)),
             limit, history, out);
}

}  // namespace granular
