// As many numbers side by side as the registers of the machine compiled for hold, and code that is written once for
// them and for one number alone: kernels over many contacts, whose answers are the same bits either way. g++ and clang
// know arithmetic, comparisons and ?: of such vectors; what else is needed stands here.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#ifdef __AVX__
#include <immintrin.h>
#endif

#include "granular/core/math.h"

namespace granular {

#if defined(__AVX512F__)
inline constexpr std::size_t wideSize = 8;
#elif defined(__AVX__)
inline constexpr std::size_t wideSize = 4;
#else
inline constexpr std::size_t wideSize = 2;
#endif
typedef double Wide __attribute__((vector_size(wideSize * sizeof(double))));

inline Wide loadWide(const double* from) {
  Wide wide;
  std::memcpy(&wide, from, sizeof wide);
  return wide;
}
inline void storeWide(const Wide& wide, double* to) { std::memcpy(to, &wide, sizeof wide); }
/// The same number in every lane.
inline Wide spread(double x) { return x - Wide{}; }

inline double squareRoot(double x) { return std::sqrt(x); }
inline Wide squareRoot(const Wide& x) {
#if defined(__AVX512F__)
  return _mm512_maskz_sqrt_pd(0xff, x);  // of all eight: g++ 12 warns of its own _mm512_sqrt_pd
#elif defined(__AVX__)
  return _mm256_sqrt_pd(x);
#else
  Wide root;
  for (std::size_t k = 0; k < wideSize; ++k) root[k] = std::sqrt(x[k]);
  return root;
#endif
}

/// What a comparison of Reals is: bool, or a vector of them.
template <class Real>
using Mask = decltype(Real{} < Real{});

inline double choose(bool first, double a, double b) { return first ? a : b; }
inline Wide choose(const Mask<Wide>& first, const Wide& a, const Wide& b) { return first ? a : b; }

/// std::min and std::max, to the bit.
template <class Real>
Real smaller(const Real& a, const Real& b) {
  return choose(b < a, b, a);
}
template <class Real>
Real larger(const Real& a, const Real& b) {
  return choose(a < b, b, a);
}
template <class Real>
Real bounded(const Real& x, const Real& low, const Real& high) {
  return smaller(larger(x, low), high);
}
/// std::copysign, and std::abs.
inline Wide copySign(const Wide& size, const Wide& sign) {
  const Mask<Wide> signBit = Mask<Wide>{} + std::numeric_limits<std::int64_t>::min();
  return (Wide)(((Mask<Wide>)size & ~signBit) | ((Mask<Wide>)sign & signBit));
}
inline double magnitude(double x) { return std::abs(x); }
inline Wide magnitude(const Wide& x) { return copySign(x, Wide{}); }
/// 1, or -1 below 0.
template <class Real>
Real signOf(const Real& x) {
  return choose(x < 0, Real(Real{} - 1), Real(Real{} + 1));
}

inline bool both(bool a, bool b) { return a && b; }
inline bool either(bool a, bool b) { return a || b; }
inline Mask<Wide> both(const Mask<Wide>& a, const Mask<Wide>& b) { return a & b; }
inline Mask<Wide> either(const Mask<Wide>& a, const Mask<Wide>& b) { return a | b; }

/// True if it holds in any lane, in all lanes.
inline bool any(bool mask) { return mask; }
inline bool all(bool mask) { return mask; }
inline bool any(const Mask<Wide>& mask) {
#if defined(__AVX512F__)
  return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
#else
  std::int64_t found = 0;
  for (std::size_t k = 0; k < wideSize; ++k) found |= mask[k];
  return found != 0;
#endif
}
inline bool all(const Mask<Wide>& mask) { return !any(~mask); }

/// A vector in space of such numbers.
template <class Real>
struct Triple {
  Real x, y, z;

  Triple operator+(const Triple& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Triple operator-(const Triple& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Triple operator/(double o) const { return {x / o, y / o, z / o}; }
  Triple cross(const Triple& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
  Real dot(const Triple& o) const { return x * o.x + y * o.y + z * o.z; }
  /// Coefficient by coefficient.
  Triple times(const Triple& o) const { return {x * o.x, y * o.y, z * o.z}; }
  Real norm() const { return squareRoot(dot(*this)); }
};

/// Scalar: Real, or a number that all lanes share.
template <class Scalar, class Real>
Triple<Real> operator*(const Scalar& s, const Triple<Real>& v) {
  return {s * v.x, s * v.y, s * v.z};
}
template <class Real>
Triple<Real> unit(const Triple<Real>& v) {
  return Real(1 / v.norm()) * v;
}
template <class Real>
Triple<Real> choose(const Mask<Real>& first, const Triple<Real>& a, const Triple<Real>& b) {
  return {choose(first, a.x, b.x), choose(first, a.y, b.y), choose(first, a.z, b.z)};
}

/// A quaternion of such numbers, with Eigen's order of operations: of one number alone it gives the bits of Quat.
template <class Real>
struct Quadruple {
  Real x, y, z, w;

  Triple<Real> vec() const { return {x, y, z}; }
  Quadruple conjugate() const { return {-x, -y, -z, w}; }
  Quadruple operator*(const Quadruple& o) const {
    return {(w * o.x + y * o.z) - (z * o.y - x * o.w), (w * o.y + y * o.w) + (z * o.x - x * o.z),
            (w * o.z - y * o.x) + (z * o.w + x * o.y), (w * o.w - y * o.y) - (z * o.z + x * o.x)};
  }
  /// Of a unit quaternion.
  Triple<Real> rotate(const Triple<Real>& v) const {
    const Triple<Real> half = vec().cross(v), whole = half + half;
    return v + w * whole + vec().cross(whole);
  }
  Real squaredNorm() const { return (x * x + z * z) + (y * y + w * w); }
  /// The columns of the matrix of a unit quaternion.
  std::array<Triple<Real>, 3> columns() const {
    const Real tx = 2 * x, ty = 2 * y, tz = 2 * z;
    const Real wx = tx * w, wy = ty * w, wz = tz * w, xx = tx * x, xy = ty * x, xz = tz * x;
    const Real yy = ty * y, yz = tz * y, zz = tz * z;
    return {{{1 - (yy + zz), xy + wz, xz - wy}, {xy - wz, 1 - (xx + zz), yz + wx}, {xz + wy, yz - wx, 1 - (xx + yy)}}};
  }
};

/// Quantities of several pairs or contacts in memory, side by side.
template <std::size_t size>
struct TripleLanes {
  alignas(64) double x[size], y[size], z[size];

  void put(std::size_t k, const Vec3& v) { put(k, Triple<double>{v.x(), v.y(), v.z()}); }
  void put(std::size_t k, const Triple<double>& v) {
    x[k] = v.x;
    y[k] = v.y;
    z[k] = v.z;
  }
  Triple<double> at(std::size_t k) const { return {x[k], y[k], z[k]}; }
  Vec3 take(std::size_t k) const { return {x[k], y[k], z[k]}; }
  Triple<Wide> load(std::size_t k) const { return {loadWide(x + k), loadWide(y + k), loadWide(z + k)}; }
  void store(std::size_t k, const Triple<Wide>& v) {
    storeWide(v.x, x + k);
    storeWide(v.y, y + k);
    storeWide(v.z, z + k);
  }
};

inline Triple<double> toTriple(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 toVec3(const Triple<double>& v) { return {v.x, v.y, v.z}; }
inline Quadruple<double> toQuadruple(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline Quat toQuat(const Quadruple<double>& q) { return {q.w, q.x, q.y, q.z}; }

}  // namespace granular
