// What a law did with energy, found from its answer instead of inside it: the force loop stays as it is, and the ledger
// pays for its own work.
//
// A step of the tangential spring is d_n = d' + slip - p: d' the old spring carried into the new contact plane, p what
// gave way to friction. The spring's energy is quadratic, so it changes by 1/2 (f' + f_n).(slip - p) exactly, f the
// spring force: friction heat of the step is 1/2 (f' + f_n).p.
#pragma once

#include "granular/law/hertz.h"
#include "granular/law/linear.h"
#include "granular/law/tensor.h"

namespace granular {

/// The springs of a contact before and after one step.
struct SpringStep {
  Vec3 carried = Vec3::Zero();                          ///< d', world axes, m
  Vec3 spring = Vec3::Zero();                           ///< d_n, m
  Vec3 gaveWay = Vec3::Zero();                          ///< p, m
  double overlapBefore = 0;                             ///< at t_{n-1}, by the motion of the contact point, m
  double twistBefore = 0, twist = 0, twistGaveWay = 0;  ///< rad
};

inline SpringStep followSpring(const LawConstants& c, const ContactMotion& m, const ContactHistory& before,
                               const ContactHistory& after) {
  SpringStep step;
  const Vec3& n = m.normal;
  step.overlapBefore = before.normal.isZero() ? 0 : std::max(m.overlap - n.dot(m.slip), 0.0);
  if (c.parameters.friction == 0) return step;

  // As the laws do it, so that p is zero to the last bit or two while the contact sticks.
  step.carried = carrySpring(before.spring, before.normal, n, n.dot(m.meanSpin) * m.dt);
  Vec3 trial = step.carried + m.slip;
  trial -= n.dot(trial) * n;
  step.spring = after.spring;
  step.gaveWay = trial - after.spring;
  if (m.area > 0) {
    step.twistBefore = before.twist;
    step.twist = after.twist;
    step.twistGaveWay = before.twist + n.dot(m.turn) - after.twist;
  }
  return step;
}

/// A patch's torsional spring.
inline void accountTwist(const ContactMotion& m, const SpringStep& step, double stiffness, ContactAccount& account) {
  const double torsion = stiffness * (m.area > 0 ? m.uu + m.vv : 0);
  account.tangentialSpring += 0.5 * torsion * step.twist * step.twist;
  account.elasticCouple -= torsion * step.twist * m.normal;
  account.slipHeat += 0.5 * torsion * (step.twistBefore + step.twist) * step.twistGaveWay;
}

using FindStiffness = ContactStiffness(const LawConstants&, const LawOptions&, const ContactBody&, const ContactBody&,
                                       const Vec3&);

/// Springs of the linear laws.
template <FindStiffness findStiffness>
void accountSprings(const LawConstants& c, const LawOptions& options, const ContactBody& a, const ContactBody& b,
                    const ContactMotion& m, const SpringStep& step, ContactAccount& account) {
  const ContactStiffness k = findStiffness(c, options, a, b, m.normal);
  const double normal = m.share * k.normal, tangential = m.share * k.tangential;
  account.normalSpring = 0.5 * normal * m.squaredDepth;
  account.tangentialSpring = 0.5 * tangential * step.spring.squaredNorm();
  account.elasticForce = -normal * m.overlap * m.normal - tangential * step.spring;
  account.slipHeat = 0.5 * tangential * (step.carried + step.spring).dot(step.gaveWay);
  accountTwist(m, step, tangential, account);
}

/// Springs of the tensor law: 1/2 d.K d, of which 1/2 k_n overlap^2 would be left without a tangential force.
inline void accountTensor(const LawConstants& c, const LawOptions& options, const ContactBody& a, const ContactBody& b,
                          const ContactMotion& m, const SpringStep& step, ContactAccount& account) {
  if (c.parameters.friction == 0) {
    accountSprings<findLocalStiffness>(c, options, a, b, m, step, account);
    return;
  }
  const TensorStiffness k = findTensorStiffness(c, options, a, b, m.normal);
  const Mat3 spring = m.share * (k.axes * k.spring * k.axes.transpose());
  const Vec3 d = m.overlap * m.normal + step.spring, force = spring * d;
  const double half = 0.5 * m.share * c.parameters.stiffness;
  account.normalSpring = half * m.squaredDepth;
  account.tangentialSpring = 0.5 * d.dot(force) - half * m.overlap * m.overlap;
  account.elasticForce = -force;
  const Vec3 forceBefore = spring * (step.overlapBefore * m.normal + step.carried);
  account.slipHeat = 0.5 * (forceBefore + force).dot(step.gaveWay);
  accountTwist(m, step, 0.5 * m.share * (k.spring(1, 1) + k.spring(2, 2)), account);
}

using FindHertz = ContactStiffness(const LawConstants&, const LawOptions&, const ContactBody&, const ContactBody&,
                                   const Vec3&, double, double);

/// Springs of Hertz's laws: the secant stiffness times the overlap is a force of energy 2/5 k overlap^2. What the
/// tangential spring gains or loses with the stiffness shows as work of the contact rule.
template <FindHertz findStiffness>
void accountHertz(const LawConstants& c, const LawOptions& options, const ContactBody& a, const ContactBody& b,
                  const ContactMotion& m, const SpringStep& step, ContactAccount& account) {
  const ContactStiffness k = findStiffness(c, options, a, b, m.normal, stiffDepth(m), m.radius);
  const double normal = m.share * k.normal, tangential = m.share * k.tangential;
  account.normalSpring = 0.4 * normal * m.squaredDepth;
  account.tangentialSpring = 0.5 * tangential * step.spring.squaredNorm();
  account.elasticForce = -normal * m.overlap * m.normal - tangential * step.spring;
  account.slipHeat = 0.5 * tangential * (step.carried + step.spring).dot(step.gaveWay);
  accountTwist(m, step, tangential, account);
}

/// What is not elastic: along the normal and in a patch's plane the normal dashpot, the rest tangential.
inline void splitForce(const ContactMotion& m, const SpringStep& step, const ContactForce& force,
                       ContactAccount& account) {
  const Vec3& n = m.normal;
  const Vec3 rest = force.force - account.elasticForce, couple = force.couple - account.elasticCouple;
  account.dampingForce = n.dot(rest) * n;
  account.viscousForce = rest - account.dampingForce;
  account.viscousCouple = n.dot(couple) * n;
  account.dampingCouple = couple - account.viscousCouple;
  account.slides = force.sliding;
  account.twists = step.twistGaveWay != 0;
}

}  // namespace granular
