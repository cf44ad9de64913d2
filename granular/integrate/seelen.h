// The improved quaternion scheme (Seelen, Padding & Kuipers, Acta Mechanica 227, 3381, 2016), the default: second order
// in orientation and angular velocity with one torque per step, and no rotation matrices.
//   w_3/4 = w_{n+1/2} + dt/4 a_n,  W_3/4 = q_{n+1/2} w_3/4 q_{n+1/2}^-1,  q_{n+1}   = E(W_3/4 dt/2) q_{n+1/2}
//   w_1   = w_{n+1/2} + dt/2 a_n,  W_1   = q_{n+1} w_1 q_{n+1}^-1                     (q_{n+1}, W_1) go to the contact
//   law a_{n+1} = I^-1 (T_b - w_1 x I w_1),  w_{n+3/2} = w_{n+1/2} + dt a_{n+1},  q_{n+3/2} = E(W_1 dt) q_{n+1/2}
// w, a in body axes, W in world axes. It gains energy as d ln E/dt of about .02 |w| (|w| dt)^3: use it below |w| dt =
// .05.
#pragma once

#include "granular/integrate/integrator.h"
#include "granular/integrate/small_rotation.h"

namespace granular::seelen {

inline void startRotation(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Quat& q,
                          const Vec3& w, RotationMemory memory) {
  const Vec3 wBody = q.conjugate() * w;
  memory.alpha = accelerateRotation(inertia, inverseInertia, q.conjugate() * torque, wBody);
  memory.wHalf = wBody + 0.5 * dt * memory.alpha;
  memory.qHalf = rotateByStep(0.5 * dt * (q * Vec3(wBody + 0.25 * dt * memory.alpha))) * q;
}

inline void predictRotation(double dt, const Quat& qHalf, const Vec3& wHalf, const Vec3& alpha, Quat& q, Vec3& w) {
  q = rotateByStep(0.5 * dt * (qHalf * Vec3(wHalf + 0.25 * dt * alpha))) * qHalf;
  w = q * Vec3(wHalf + 0.5 * dt * alpha);
}

inline void advanceRotation(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque,
                            const Quat& q, const Vec3& w, RotationMemory memory) {
  const Vec3 wBody = memory.wHalf + 0.5 * dt * memory.alpha;
  memory.alpha = accelerateRotation(inertia, inverseInertia, q.conjugate() * torque, wBody);
  memory.wHalf += dt * memory.alpha;
  memory.qHalf = rotateByStep(dt * w) * memory.qHalf;
  keepUnit(memory.qHalf);
}

}  // namespace granular::seelen
