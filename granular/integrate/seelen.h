// The improved quaternion scheme (Seelen, Padding & Kuipers, Acta Mechanica 227, 3381, 2016), the default: second order
// in orientation and angular velocity with one torque per step, and no rotation matrices.
//   w_3/4 = w_{n+1/2} + dt/4 a_n,  W_3/4 = q_{n+1/2} w_3/4 q_{n+1/2}^-1,  q_{n+1}   = E(W_3/4 dt/2) q_{n+1/2}
//   w_1   = w_{n+1/2} + dt/2 a_n,  W_1   = q_{n+1} w_1 q_{n+1}^-1                     (q_{n+1}, W_1) go to the contact
//   law a_{n+1} = I^-1 (T_b - w_1 x I w_1),  w_{n+3/2} = w_{n+1/2} + dt a_{n+1},  q_{n+3/2} = E(W_1 dt) q_{n+1/2}
// w, a in body axes, W in world axes. It gains energy as d ln E/dt of about .02 |w| (|w| dt)^3: use it below |w| dt =
// .05.
#pragma once

#include "granular/integrate/small_rotation.h"
#include "granular/integrate/turn.h"

namespace granular {

struct Seelen {
  template <class Real>
  static HalfTurn<Real> startRotation(double dt, const Moments<Real>& moments, const Triple<Real>& torque,
                                      const Turn<Real>& now) {
    const Quadruple<Real> toBody = now.q.conjugate();
    const Triple<Real> w = toBody.rotate(now.w);
    const Triple<Real> alpha = moments.accelerate(toBody.rotate(torque), w);
    const Triple<Real> quarter = now.q.rotate(w + 0.25 * dt * alpha);
    return {rotateByStep(0.5 * dt * quarter) * now.q, w + 0.5 * dt * alpha, alpha};
  }

  template <class Real>
  static Turn<Real> predictRotation(double dt, const HalfTurn<Real>& half) {
    const Triple<Real> threeQuarters = half.q.rotate(half.w + 0.25 * dt * half.alpha);
    const Quadruple<Real> q = rotateByStep(0.5 * dt * threeQuarters) * half.q;
    return {q, q.rotate(half.w + 0.5 * dt * half.alpha)};
  }

  template <class Real>
  static void advanceRotation(double dt, const Moments<Real>& moments, const Triple<Real>& torque,
                              const Turn<Real>& now, HalfTurn<Real>& half) {
    const Triple<Real> w = half.w + 0.5 * dt * half.alpha;
    half.alpha = moments.accelerate(now.q.conjugate().rotate(torque), w);
    half.w = half.w + dt * half.alpha;
    half.q = rotateByStep(dt * now.w) * half.q;
    keepUnit(half.q);
  }
};

}  // namespace granular
