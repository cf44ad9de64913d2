// What the schemes of rotation read and write, of one body or of several side by side (core/wide.h).
#pragma once

#include "granular/core/wide.h"

namespace granular {

/// Orientation (body to world) and angular velocity (world axes, rad/s) at t_n.
template <class Real>
struct Turn {
  Quadruple<Real> q;
  Triple<Real> w;
};

/// What a scheme remembers of the rotation from one step to the next.
template <class Real>
struct HalfTurn {
  Quadruple<Real> q;   ///< orientation at the scheme's stored time, body to world
  Triple<Real> w;      ///< angular velocity at the half step, body axes, rad/s
  Triple<Real> alpha;  ///< angular acceleration of the last step, body axes, rad/s^2
};

/// Principal moments, kg m^2; inverseInertia 0 holds the axis.
template <class Real>
struct Moments {
  Triple<Real> inertia, inverseInertia;

  /// Euler's equation in body axes: a = I^-1 (T - w x I w).
  Triple<Real> accelerate(const Triple<Real>& torque, const Triple<Real>& w) const {
    return inverseInertia.times(torque - w.cross(inertia.times(w)));
  }
};

}  // namespace granular
