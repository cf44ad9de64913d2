// Rows of numbers, as vectors, quaternions and records of them lie in memory, turned into lanes (core/wide.h) and back:
// wideSize rows at once.
#pragma once

#include <algorithm>

#include "granular/core/wide.h"

namespace granular {

/// Rows of three numbers, one behind the other.
inline void loadRows(const double* rows, Triple<Wide>& v) {
#if defined(__AVX512F__)
  const Wide a = loadWide(rows), b = loadWide(rows + 8), c = loadWide(rows + 16);
  v.x = __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 3, 6, 9, 12, 15, 0, 0), c, 0, 1, 2, 3, 4, 5, 10, 13);
  v.y = __builtin_shufflevector(__builtin_shufflevector(a, b, 1, 4, 7, 10, 13, 0, 0, 0), c, 0, 1, 2, 3, 4, 8, 11, 14);
  v.z = __builtin_shufflevector(__builtin_shufflevector(a, b, 2, 5, 8, 11, 14, 0, 0, 0), c, 0, 1, 2, 3, 4, 9, 12, 15);
#else
  for (std::size_t k = 0; k < wideSize; ++k) {
    v.x[k] = rows[3 * k];
    v.y[k] = rows[3 * k + 1];
    v.z[k] = rows[3 * k + 2];
  }
#endif
}
inline void storeRows(const Triple<Wide>& v, double* rows) {
#if defined(__AVX512F__)
  const Wide a = __builtin_shufflevector(v.x, v.y, 0, 8, 0, 1, 9, 0, 2, 10);
  const Wide b = __builtin_shufflevector(v.x, v.y, 0, 3, 11, 0, 4, 12, 0, 5);
  const Wide c = __builtin_shufflevector(v.x, v.y, 13, 0, 6, 14, 0, 7, 15, 0);
  storeWide(__builtin_shufflevector(a, v.z, 0, 1, 8, 3, 4, 9, 6, 7), rows);
  storeWide(__builtin_shufflevector(b, v.z, 10, 1, 2, 11, 4, 5, 12, 7), rows + 8);
  storeWide(__builtin_shufflevector(c, v.z, 0, 13, 2, 3, 14, 5, 6, 15), rows + 16);
#else
  for (std::size_t k = 0; k < wideSize; ++k) {
    rows[3 * k] = v.x[k];
    rows[3 * k + 1] = v.y[k];
    rows[3 * k + 2] = v.z[k];
  }
#endif
}

#if defined(__AVX512F__)
/// Columns of eight rows of four numbers: rows 0 and 4, 1 and 5, 2 and 6, 3 and 7 one behind the other.
inline std::array<Wide, 4> turnFours(const Wide& r0, const Wide& r1, const Wide& r2, const Wide& r3) {
  const Wide xz01 = __builtin_shufflevector(r0, r1, 0, 8, 2, 10, 4, 12, 6, 14);
  const Wide yw01 = __builtin_shufflevector(r0, r1, 1, 9, 3, 11, 5, 13, 7, 15);
  const Wide xz23 = __builtin_shufflevector(r2, r3, 0, 8, 2, 10, 4, 12, 6, 14);
  const Wide yw23 = __builtin_shufflevector(r2, r3, 1, 9, 3, 11, 5, 13, 7, 15);
  return {__builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(yw01, yw23, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(yw01, yw23, 2, 3, 10, 11, 6, 7, 14, 15)};
}
/// Eight rows of four columns: rows 0 and 2, 1 and 3, 4 and 6, 5 and 7 one behind the other.
inline std::array<Wide, 4> turnBack(const Wide& x, const Wide& y, const Wide& z, const Wide& w) {
  const Wide xyEven = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
  const Wide xyOdd = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
  const Wide zwEven = __builtin_shufflevector(z, w, 0, 8, 2, 10, 4, 12, 6, 14);
  const Wide zwOdd = __builtin_shufflevector(z, w, 1, 9, 3, 11, 5, 13, 7, 15);
  return {__builtin_shufflevector(xyEven, zwEven, 0, 1, 8, 9, 2, 3, 10, 11),
          __builtin_shufflevector(xyOdd, zwOdd, 0, 1, 8, 9, 2, 3, 10, 11),
          __builtin_shufflevector(xyEven, zwEven, 4, 5, 12, 13, 6, 7, 14, 15),
          __builtin_shufflevector(xyOdd, zwOdd, 4, 5, 12, 13, 6, 7, 14, 15)};
}
inline Wide joinHalves(__m256d low, __m256d high) {
  return Wide(_mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1));
}
#endif

/// Four numbers of each row; rows begin `stride` numbers apart.
inline void loadRows(const double* rows, std::size_t stride, Quadruple<Wide>& q) {
#if defined(__AVX512F__)
  const auto pick = [&](std::size_t k) {
    return joinHalves(_mm256_loadu_pd(rows + k * stride), _mm256_loadu_pd(rows + (k + 4) * stride));
  };
  const std::array<Wide, 4> columns = turnFours(pick(0), pick(1), pick(2), pick(3));
  q.x = columns[0];
  q.y = columns[1];
  q.z = columns[2];
  q.w = columns[3];
#else
  for (std::size_t k = 0; k < wideSize; ++k) {
    q.x[k] = rows[stride * k];
    q.y[k] = rows[stride * k + 1];
    q.z[k] = rows[stride * k + 2];
    q.w[k] = rows[stride * k + 3];
  }
#endif
}
inline void storeRows(const Quadruple<Wide>& q, std::size_t stride, double* rows) {
#if defined(__AVX512F__)
  const std::array<Wide, 4> twos = turnBack(q.x, q.y, q.z, q.w);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t row = 4 * (k / 2) + k % 2;
    _mm256_storeu_pd(rows + row * stride, _mm512_castpd512_pd256(twos[k]));
    _mm256_storeu_pd(rows + (row + 2) * stride, _mm512_extractf64x4_pd(twos[k], 1));
  }
#else
  for (std::size_t k = 0; k < wideSize; ++k) {
    rows[stride * k] = q.x[k];
    rows[stride * k + 1] = q.y[k];
    rows[stride * k + 2] = q.z[k];
    rows[stride * k + 3] = q.w[k];
  }
#endif
}

#if defined(__AVX512F__)
/// Rows and columns of eight times eight numbers change places.
inline void transpose(std::array<Wide, 8>& m) {
  std::array<Wide, 8> t;
  for (std::size_t k = 0; k < 8; k += 2) {
    t[k] = __builtin_shufflevector(m[k], m[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    t[k + 1] = __builtin_shufflevector(m[k], m[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  std::array<Wide, 8> u;
  for (std::size_t k = 0; k < 8; k += 4) {
    for (std::size_t j = 0; j < 2; ++j) {
      u[k + j] = __builtin_shufflevector(t[k + j], t[k + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      u[k + j + 2] = __builtin_shufflevector(t[k + j], t[k + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    m[k] = __builtin_shufflevector(u[k], u[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    m[k + 4] = __builtin_shufflevector(u[k], u[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}
#endif

/// Up to eight numbers of each row, rows anywhere: number c of the rows to columns[c].
template <std::size_t width>
void loadRows(const std::array<const double*, wideSize>& rows, std::array<Wide, width>& columns) {
  static_assert(width <= 8);
#if defined(__AVX512F__)
#if defined(__AVX512VL__)
  if constexpr (width <= 4) {
    constexpr __mmask8 some = (1u << width) - 1;
    const auto pick = [&](std::size_t k) {
      return joinHalves(_mm256_maskz_loadu_pd(some, rows[k]), _mm256_maskz_loadu_pd(some, rows[k + 4]));
    };
    const std::array<Wide, 4> all = turnFours(pick(0), pick(1), pick(2), pick(3));
    std::copy_n(all.begin(), width, columns.begin());
    return;
  }
#endif
  std::array<Wide, 8> m;
  for (std::size_t k = 0; k < 8; ++k) m[k] = _mm512_maskz_loadu_pd((1u << width) - 1, rows[k]);
  transpose(m);
  std::copy_n(m.begin(), width, columns.begin());
#else
  for (std::size_t c = 0; c < width; ++c) {
    for (std::size_t k = 0; k < wideSize; ++k) columns[c][k] = rows[k][c];
  }
#endif
}
/// The first `count` rows.
template <std::size_t width>
void storeRows(const std::array<Wide, width>& columns, const std::array<double*, wideSize>& rows, std::size_t count) {
  static_assert(width <= 8);
#if defined(__AVX512F__)
#if defined(__AVX512VL__)
  if constexpr (width <= 4) {
    std::array<Wide, 4> m{};
    std::copy_n(columns.begin(), width, m.begin());
    constexpr __mmask8 some = (1u << width) - 1;
    const std::array<Wide, 4> pairs = turnBack(m[0], m[1], m[2], m[3]);
    for (std::size_t k = 0; k < count; ++k) {
      const __m512d two = pairs[2 * (k / 4) + k % 2];
      _mm256_mask_storeu_pd(rows[k], some, k % 4 < 2 ? _mm512_castpd512_pd256(two) : _mm512_extractf64x4_pd(two, 1));
    }
    return;
  }
#endif
  std::array<Wide, 8> m{};
  std::copy_n(columns.begin(), width, m.begin());
  transpose(m);
  for (std::size_t k = 0; k < count; ++k) _mm512_mask_storeu_pd(rows[k], (1u << width) - 1, m[k]);
#else
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t c = 0; c < width; ++c) rows[k][c] = columns[c][k];
  }
#endif
}

}  // namespace granular
