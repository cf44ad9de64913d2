// SPIRAL in leapfrog form (del Valle et al., Comput. Phys. Commun. 297, 109077, 2024): the angular velocity by Shu and
// Osher's third-order Runge-Kutta step with the torque frozen in body axes, the orientation by its exact rotation. More
// accurate for free tops than the default.
//   K1 = dt a(w), K2 = dt a(w + K1), K3 = dt a(w + (K1 + K2)/4), w += (K1 + K2 + 4 K3)/6, q = q E(w dt)
// qHalf stores q_n here: this scheme keeps orientations at whole steps, angular velocities at half steps.
#pragma once

#include "granular/integrate/integrator.h"
#include "granular/integrate/small_rotation.h"

namespace granular::spiral {

/// The angular velocity after a step of h with a constant torque, all in body axes.
inline Vec3 stepVelocity(double h, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Vec3& w) {
  const Vec3 k1 = h * accelerateRotation(inertia, inverseInertia, torque, w);
  const Vec3 k2 = h * accelerateRotation(inertia, inverseInertia, torque, w + k1);
  const Vec3 k3 = h * accelerateRotation(inertia, inverseInertia, torque, w + 0.25 * (k1 + k2));
  return w + (k1 + k2 + 4 * k3) / 6;
}

inline void startRotation(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Quat& q,
                          const Vec3& w, RotationMemory memory) {
  const Vec3 torqueBody = q.conjugate() * torque;
  memory.wHalf = stepVelocity(0.5 * dt, inertia, inverseInertia, torqueBody, q.conjugate() * w);
  memory.alpha = accelerateRotation(inertia, inverseInertia, torqueBody, memory.wHalf);
  memory.qHalf = q;
}

inline void predictRotation(double dt, const Quat& qHalf, const Vec3& wHalf, const Vec3& alpha, Quat& q, Vec3& w) {
  q = qHalf * rotateByStep(dt * wHalf);
  w = q * Vec3(wHalf + 0.5 * dt * alpha);
}

inline void advanceRotation(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque,
                            const Quat& q, const Vec3& /*w*/, RotationMemory memory) {
  const Vec3 torqueBody = q.conjugate() * torque;
  memory.wHalf = stepVelocity(dt, inertia, inverseInertia, torqueBody, memory.wHalf);
  memory.alpha = accelerateRotation(inertia, inverseInertia, torqueBody, memory.wHalf);
  memory.qHalf = q;
  keepUnit(memory.qHalf);
}

}  // namespace granular::spiral
