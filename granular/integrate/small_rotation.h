// The rotation of one time step: E(r) = (cos |r|/2, sin(|r|/2) r/|r|), by its series while the angle is small.
#pragma once

#include "granular/core/math.h"

namespace granular {

/// As rotationFromVector, without square root or sine for |r| < 0.2 rad: there the first term left out is below 3e-17.
inline Quat rotateByStep(const Vec3& r) {
  const double square = 0.25 * r.squaredNorm();
  if (square > 0.01) return rotationFromVector(r);
  const double s = 0.5 * (1 - square / 6 * (1 - square / 20 * (1 - square / 42 * (1 - square / 72))));
  Quat q;
  q.w() = 1 - square / 2 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56)));
  q.vec() = s * r;
  return q;
}

/// Takes off the round-off that products of unit quaternions gather: one Newton step towards unit length.
inline void keepUnit(Quat& q) { q.coeffs() *= 1.5 - 0.5 * q.squaredNorm(); }

}  // namespace granular
