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

/// x / n for a small whole number n. In lanes to the same bits without a division, which would take longer than all
/// else here: x times the rounded inverse is off by less than two units in the last place, what that leaves of x is
/// found exactly, and the sum rounds as the quotient does, because no quotient by a small number lies near the middle
/// of two numbers. (Where what is left is too small to be a number in full, both differ by less than 1e-300.)
template <int n>
double quotient(double x) {
  return x / n;
}
template <int n>
Wide quotient(const Wide& x) {
#if defined(__AVX512F__)
  constexpr double inverse = 1.0 / n;
  const Wide near = x * inverse;
  const Wide left = _mm512_fnmadd_pd(near, _mm512_set1_pd(n), x);
  return _mm512_fmadd_pd(left, _mm512_set1_pd(inverse), near);
#else
  return x / n;
#endif
}

/// As rotationFromVector, without square root or sine for |r| < 0.2 rad: there the first term left out is below 3e-17.
template <class Real>
Quadruple<Real> rotateByStep(const Triple<Real>& r) {
  const Real t = 0.25 * r.dot(r);
  const Real s = 0.5 * (1 - quotient<6>(t) * (1 - quotient<20>(t) * (1 - quotient<42>(t) * (1 - quotient<72>(t)))));
  const Real c = 1 - 0.5 * t * (1 - quotient<12>(t) * (1 - quotient<30>(t) * (1 - quotient<56>(t))));
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
