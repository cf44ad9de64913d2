// A rotation scheme of one's own: a leapfrog whose spin takes one explicit midpoint step with the torque held in body
// axes,
//   w_{n+1/2} = w_{n-1/2} + dt a(w_{n-1/2} + dt/2 a(w_{n-1/2})),  q_{n+1} = q_n E(dt w_{n+1/2}),
// a from Euler's equation. Of second order, with two evaluations of a in a step. qHalf stores q_n.
#pragma once

#include "granular/integrate/integrator.h"
#include "granular/integrate/small_rotation.h"

namespace extend {

using namespace granular;

/// The spin after a step of h, all in body axes.
inline Vec3 stepSpin(double h, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Vec3& w) {
  const Vec3 middle = w + 0.5 * h * accelerateRotation(inertia, inverseInertia, torque, w);
  return w + h * accelerateRotation(inertia, inverseInertia, torque, middle);
}

/// The half step without which every staggered scheme falls to first order.
inline void startMidpoint(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Quat& q,
                          const Vec3& w, RotationMemory memory) {
  const Vec3 torqueBody = q.conjugate() * torque;
  memory.wHalf = stepSpin(0.5 * dt, inertia, inverseInertia, torqueBody, q.conjugate() * w);
  memory.alpha = accelerateRotation(inertia, inverseInertia, torqueBody, memory.wHalf);
  memory.qHalf = q;
}

/// Orientation and spin (world axes) at t_{n+1}, which the contact law reads.
inline void predictMidpoint(double dt, const Quat& qHalf, const Vec3& wHalf, const Vec3& alpha, Quat& q, Vec3& w) {
  q = qHalf * rotateByStep(dt * wHalf);
  w = q * Vec3(wHalf + 0.5 * dt * alpha);
}

inline void advanceMidpoint(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque,
                            const Quat& q, const Vec3& /*w*/, RotationMemory memory) {
  const Vec3 torqueBody = q.conjugate() * torque;
  memory.wHalf = stepSpin(dt, inertia, inverseInertia, torqueBody, memory.wHalf);
  memory.alpha = accelerateRotation(inertia, inverseInertia, torqueBody, memory.wHalf);
  memory.qHalf = q;
  keepUnit(memory.qHalf);
}

/// Adds the scheme under the name "midpoint": once, at the start of the program.
inline SchemeKind addMidpointScheme() {
  return addScheme({"midpoint", startMidpoint, predictMidpoint, advanceMidpoint});
}

}  // namespace extend
