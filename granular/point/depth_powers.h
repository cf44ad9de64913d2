// Integrals of powers of a linear depth h >= 0 over polygons and segments, in
// closed form. On a simplex of dimension d with the values a_i at its corners
// and the barycentric coordinates l_i,
//   mean of h^n     = d! n!/(n + d)!     H_n(a_0 .. a_d)
//   mean of l_i h^n = d! n!/(n + d + 1)! H_n(a_0 .. a_d, a_i)
// where H_n is the complete homogeneous symmetric polynomial (Dirichlet's
// integral). H_n obeys H_n(a .. b) = b H_{n-1}(a .. b) + H_n(a ..): sums of
// positive terms, exact to round-off whatever the values.
#pragma once

#include <cmath>

#include "granular/point/polygon.h"

namespace granular {

/// Which powers are asked for: none with exponent 0. Depths are divided by
/// scale (m, > 0), the largest of them.
struct PowerChoice {
  int exponent = 0;
  double scale = 1;
};

/// Integrals over an area of (h/scale)^n with n = exponent - 1, exponent,
/// exponent + 1 (m^2), and of x times the first two of them (m^3).
struct DepthPowers {
  double below = 0, at = 0, above = 0;
  Vec2 firstBelow = Vec2::Zero(), firstAt = Vec2::Zero();

  DepthPowers& operator+=(const DepthPowers& other) {
    below += other.below;
    at += other.at;
    above += other.above;
    firstBelow += other.firstBelow;
    firstAt += other.firstAt;
    return *this;
  }
};

/// Integrals over a few simplices side by side (2 corners: strips along
/// segments, 3: triangles), so that the compiler works on all of them at once:
/// the recurrence of one waits for itself at every step.
template <std::size_t corners, std::size_t lanes>
struct SimplexRow {
  std::array<std::array<Vec2, corners>, lanes> x;
  /// Depth over scale at the corners. Lanes that are not used have none, and an
  /// area of 0.
  double value[corners][lanes] = {};
  std::array<double, lanes> area{};  ///< m^2

  /// Round-off below 0 counts as 0.
  void set(std::size_t lane, const std::array<Vec2, corners>& at, const std::array<double, corners>& depths,
           double simplexArea) {
    x[lane] = at;
    for (std::size_t k = 0; k < corners; ++k) value[k][lane] = std::max(depths[k], 0.0);
    area[lane] = simplexArea;
  }

  /// Adds the integrals of the first `count` lanes, in their order.
  void add(std::size_t count, int exponent, DepthPowers& out) const {
    // H_n of all corners, and of all corners with one of them twice, for n from
    // 0 up; those of the first k + 1 corners on the way.
    double twice[corners][lanes], partial[corners][lanes];
    for (std::size_t k = 0; k < corners; ++k) {
      for (std::size_t l = 0; l < lanes; ++l) twice[k][l] = partial[k][l] = 1;
    }
    const auto& whole = partial[corners - 1];
    for (int n = 1; n < exponent; ++n) raise(partial, twice);
    for (std::size_t l = 0; l < count; ++l) {
      out.below += area[l] * meanWeight(exponent - 1) * whole[l];
      out.firstBelow += findFirst(l, exponent - 1, twice);
    }
    raise(partial, twice);
    for (std::size_t l = 0; l < count; ++l) {
      out.at += area[l] * meanWeight(exponent) * whole[l];
      out.firstAt += findFirst(l, exponent, twice);
    }
    raise(partial, twice);
    for (std::size_t l = 0; l < count; ++l) out.above += area[l] * meanWeight(exponent + 1) * whole[l];
  }

 private:
  /// d! n!/(n + d)!
  static double meanWeight(int n) { return corners == 3 ? 2 / ((n + 1.0) * (n + 2.0)) : 1 / (n + 1.0); }

  Vec2 findFirst(std::size_t l, int n, const double (&twice)[corners][lanes]) const {
    const double weight = area[l] * meanWeight(n) / (n + static_cast<double>(corners));
    Vec2 first = Vec2::Zero();
    for (std::size_t k = 0; k < corners; ++k) first += (weight * twice[k][l]) * x[l][k];
    return first;
  }

  void raise(double (&partial)[corners][lanes], double (&twice)[corners][lanes]) const {
    for (std::size_t l = 0; l < lanes; ++l) partial[0][l] *= value[0][l];
    for (std::size_t k = 1; k < corners; ++k) {
      for (std::size_t l = 0; l < lanes; ++l) partial[k][l] = value[k][l] * partial[k][l] + partial[k - 1][l];
    }
    for (std::size_t k = 0; k < corners; ++k) {
      for (std::size_t l = 0; l < lanes; ++l) twice[k][l] = value[k][l] * twice[k][l] + partial[corners - 1][l];
    }
  }
};

/// Adds the integrals over a triangle of the given area (m^2) whose depth falls from `value` (over the scale) at x[0]
/// to 0 at the other corners: there H_n is a power.
inline void addTip(const std::array<Vec2, 3>& x, double value, double area, int exponent, DepthPowers& out) {
  double power = 1;  // value^(exponent - 1), by squaring
  for (int bit = 1 << 16; bit > 0; bit >>= 1) {
    power *= power;
    if ((exponent - 1) & bit) power *= value;
  }
  const auto mean = [&](int n) { return 2 * area * power / ((n + 1.0) * (n + 2.0)); };
  const auto first = [&](int n) -> Vec2 { return mean(n) / (n + 3.0) * ((n + 1.0) * x[0] + x[1] + x[2]); };
  out.below += mean(exponent - 1);
  out.firstBelow += first(exponent - 1);
  power *= value;
  out.at += mean(exponent);
  out.firstAt += first(exponent);
  power *= value;
  out.above += mean(exponent + 1);
}

/// Over a convex polygon of three corners or more: a fan of triangles about the
/// first.
inline DepthPowers integratePowers(const Polygon& polygon, const Linear& depth, const PowerChoice& power) {
  constexpr std::size_t lanes = 4;
  DepthPowers out;
  const double inverse = 1 / power.scale;
  const Vec2 p = polygon[0];
  const double atP = depth.at(p) * inverse;
  for (int k = 2; k < polygon.count;) {
    SimplexRow<3, lanes> row;
    std::size_t count = 0;
    for (; count < lanes && k < polygon.count; ++k, ++count) {
      const Vec2& a = polygon[k - 1];
      const Vec2& b = polygon[k];
      row.set(count, {p, a, b}, {atP, depth.at(a) * inverse, depth.at(b) * inverse}, 0.5 * cross(a - p, b - p));
    }
    row.add(count, power.exponent, out);
  }
  return out;
}

/// Over a strip of the given width (m) along a segment; the depth is linear
/// along it and constant across.
inline DepthPowers integratePowers(const Segment& segment, double width, double depthFrom, double depthTo,
                                   const PowerChoice& power) {
  DepthPowers out;
  SimplexRow<2, 1> row;
  row.set(0, {segment.from, segment.to}, {depthFrom / power.scale, depthTo / power.scale},
          width * (segment.to - segment.from).norm());
  row.add(1, power.exponent, out);
  return out;
}

}  // namespace granular
