// SPIRAL in leapfrog form (del Valle et al., Comput. Phys. Commun. 297, 109077, 2024): the angular velocity by Shu and
// Osher's third-order Runge-Kutta step with the torque frozen in body axes, the orientation by its exact rotation. More
// accurate for free tops than the default.
//   K1 = dt a(w), K2 = dt a(w + K1), K3 = dt a(w + (K1 + K2)/4), w += (K1 + K2 + 4 K3)/6, q = q E(w dt)
// qHalf stores q_n here: this scheme keeps orientations at whole steps, angular velocities at half steps.
#pragma once

#include "granular/integrate/small_rotation.h"
#include "granular/integrate/turn.h"

namespace granular {

struct Spiral {
  template <class Real>
  static HalfTurn<Real> startRotation(double dt, const Moments<Real>& moments, const Triple<Real>& torque,
                                      const Turn<Real>& now) {
    const Quadruple<Real> toBody = now.q.conjugate();
    const Triple<Real> torqueBody = toBody.rotate(torque);
    const Triple<Real> w = stepVelocity(0.5 * dt, moments, torqueBody, toBody.rotate(now.w));
    return {now.q, w, moments.accelerate(torqueBody, w)};
  }

  template <class Real>
  static Turn<Real> predictRotation(double dt, const HalfTurn<Real>& half) {
    const Quadruple<Real> q = half.q * rotateByStep(dt * half.w);
    return {q, q.rotate(half.w + 0.5 * dt * half.alpha)};
  }

  template <class Real>
  static void advanceRotation(double dt, const Moments<Real>& moments, const Triple<Real>& torque,
                              const Turn<Real>& now, HalfTurn<Real>& half) {
    const Triple<Real> torqueBody = now.q.conjugate().rotate(torque);
    half.w = stepVelocity(dt, moments, torqueBody, half.w);
    half.alpha = moments.accelerate(torqueBody, half.w);
    half.q = now.q;
    keepUnit(half.q);
  }

 private:
  /// The angular velocity after a step of h with a constant torque, all in body axes.
  template <class Real>
  static Triple<Real> stepVelocity(double h, const Moments<Real>& moments, const Triple<Real>& torque,
                                   const Triple<Real>& w) {
    const Triple<Real> k1 = h * moments.accelerate(torque, w);
    const Triple<Real> k2 = h * moments.accelerate(torque, w + k1);
    const Triple<Real> k3 = h * moments.accelerate(torque, w + 0.25 * (k1 + k2));
    return w + (k1 + k2 + 4.0 * k3) / 6;
  }
};

}  // namespace granular
