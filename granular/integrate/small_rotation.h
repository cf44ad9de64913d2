// The rotation of one time step: E(r) = (cos |r|/2, sin(|r|/2) r/|r|), by its series while the angle is small.
#pragma once

#include "granular/core/wide.h"

namespace granular {

/// Puts rotationFromVector(r) where r isn't near 0.
inline void rotateFar(const Triple<double>& r, bool /*near*/, Quadruple<double>& q) {
  q = toQuadruple(rotationFromVector(toVec3(r)));
}
[[gnu::noinline]] inline void rotateFar(const Triple<Wide>& r, const Mask<Wide>& near, Quadruple<Wide>& q) {
  for (std::size_t k = 0; k < wideSize; ++k) {
    if (near[k]) continue;
    const Quat one = rotationFromVector({r.x[k], r.y[k], r.z[k]});
    q.x[k] = one.x();
    q.y[k] = one.y();
    q.z[k] = one.z();
    q.w[k] = one.w();
  }
}

/// As rotationFromVector, without square root or sine for |r| < 0.2 rad: there the first term left out is below 3e-17.
template <class Real>
Quadruple<Real> rotateByStep(const Triple<Real>& r) {
  const Real t = 0.25 * r.dot(r);
  const auto of = [&](double n) -> Real { return (1 / n) * t; };  // no division at run time
  const Real s = 0.5 * (1 - of(6) * (1 - of(20) * (1 - of(42) * (1 - of(72)))));
  const Real c = 1 - 0.5 * t * (1 - of(12) * (1 - of(30) * (1 - of(56))));
  Quadruple<Real> q{s * r.x, s * r.y, s * r.z, c};
  const Mask<Real> near = t <= 0.01 + Real{};
  if (!all(near)) rotateFar(r, near, q);
  return q;
}
inline Quat rotateByStep(const Vec3& r) { return toQuat(rotateByStep(toTriple(r))); }

/// Takes off the round-off that products of unit quaternions gather: one Newton step towards unit length.
template <class Real>
void keepUnit(Quadruple<Real>& q) {
  const Real factor = 1.5 - 0.5 * q.squaredNorm();
  q = {q.x * factor, q.y * factor, q.z * factor, q.w * factor};
}
inline void keepUnit(Quat& q) { q.coeffs() *= 1.5 - 0.5 * q.squaredNorm(); }

}  // namespace granular
