// Whether a proof kept from an earlier step (global_proof.h) still holds, for one pair or for as many as a register
// holds.
#pragma once

#include "granular/core/rows.h"
#include "granular/pair/warm_cache.h"

namespace granular {

/// B in A's axes: its own, and its centre, m.
template <class Real>
struct RelativePlace {
  Triple<Real> column0, column1, column2, x;
};

/// A KeptProof in double precision.
template <class Real>
struct LoadedProof {
  RelativePlace<Real> then;
  Triple<Real> axis;
  Real floor;
};

static_assert(sizeof(KeptProof) == 16 * sizeof(float));  // a row of numbers

/// From the sixteen numbers of a KeptProof, each one or a register full.
template <class Real>
LoadedProof<Real> namedNumbers(const std::array<Real, 16>& p) {
  return {
      {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}, {p[9], p[10], p[11]}}, {p[12], p[13], p[14]}, p[15]};
}
inline std::array<double, 16> numbersOf(const KeptProof& proof) {
  std::array<float, 16> single;
  std::memcpy(single.data(), &proof, sizeof proof);
  std::array<double, 16> numbers;
  std::copy(single.begin(), single.end(), numbers.begin());
  return numbers;
}
inline LoadedProof<double> loadProof(const KeptProof& proof) { return namedNumbers(numbersOf(proof)); }
inline LoadedProof<Wide> loadProofs(const std::array<const KeptProof*, wideSize>& proofs) {
  std::array<std::array<double, 16>, wideSize> rows;
  std::array<const double*, wideSize> begin, middle;
  for (std::size_t k = 0; k < wideSize; ++k) {
    rows[k] = numbersOf(*proofs[k]);
    begin[k] = rows[k].data();
    middle[k] = begin[k] + 8;
  }
  std::array<Wide, 8> first, last;
  loadRows(begin, first);
  loadRows(middle, last);
  std::array<Wide, 16> numbers;
  std::copy(first.begin(), first.end(), numbers.begin());
  std::copy(last.begin(), last.end(), numbers.begin() + 8);
  return namedNumbers(numbers);
}

/// A kept proof leaves out a cone of 8 degrees and serves normals within 2 degrees of its axis: nothing further than 10
/// degrees from a minimum is taken for granted.
inline constexpr double driftCosine = 0.99939082701909576;

/// What the single precision of a kept proof is good for, relative to the largest length.
inline constexpr double keptPrecision = 1e-6;

/// True if it proves that a minimum with this normal (A's axes) and depth (m) is the global one. boundingRadius: B's,
/// m; extent: the largest length that enters a support point, m.
template <class Real>
Mask<Real> keptProofHolds(const LoadedProof<Real>& proof, const RelativePlace<Real>& now, const Triple<Real>& normal,
                          const Real& depth, const Real& boundingRadius, const Real& extent) {
  // How far any point of B may have moved in A's axes. The spectral norm of the difference of two rotations is its
  // Frobenius norm over sqrt 2.
  const RelativePlace<Real>& then = proof.then;
  const Triple<Real> off0 = now.column0 - then.column0, off1 = now.column1 - then.column1;
  const Triple<Real> off2 = now.column2 - then.column2;
  const Real turned = 0.70710678118654752 * squareRoot(Real(off0.dot(off0) + off1.dot(off1) + off2.dot(off2)));
  const Real moved = (now.x - then.x).norm() + turned * boundingRadius + keptPrecision * extent;
  return both(both(proof.floor > depth, proof.axis.dot(normal) >= driftCosine), depth + moved <= proof.floor);
}

}  // namespace granular
