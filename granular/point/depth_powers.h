// Integrals of powers of a linear depth h >= 0 over polygons and segments, in closed form. On a simplex of dimension d
// with the values a_i at its corners and the barycentric coordinates l_i,
//   mean of h^n     = d! n!/(n + d)!     H_n(a_0 .. a_d)
//   mean of l_i h^n = d! n!/(n + d + 1)! H_n(a_0 .. a_d, a_i)
// where H_n is the complete homogeneous symmetric polynomial (Dirichlet's integral). H_n obeys
// H_n(a .. b) = b H_{n-1}(a .. b) + H_n(a ..): sums of positive terms, exact to round-off whatever the values.
#pragma once

#include <cmath>

#include "granular/point/polygon.h"

namespace granular {

/// Which powers are asked for: none with exponent 0. Depths are divided by scale (m, > 0), the largest of them.
struct PowerChoice {
  int exponent = 0;
  double scale = 1;
};

/// Integrals over an area of (h/scale)^n with n = exponent - 1, exponent, exponent + 1 (m^2), and of x times the first
/// two of them (m^3).
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

/// Adds the integrals over a simplex (2 corners: a strip along a segment, 3: a triangle) of the given area, m^2. value:
/// depth over scale at the corners; round-off below 0 counts as 0.
template <std::size_t corners>
void addSimplex(const std::array<Vec2, corners>& x, std::array<double, corners> value, double area, int exponent,
                DepthPowers& out) {
  for (double& each : value) each = std::max(each, 0.0);

  // H_n of all corners, and of all corners with one of them twice, for n from 0 up.
  double whole = 1;
  std::array<double, corners> twice;
  twice.fill(1);
  std::array<double, corners> partial;  // H_n of the first k + 1 corners
  partial.fill(1);
  constexpr double dimension = static_cast<double>(corners) - 1;
  double weight = 1;  // d! n!/(n + d)!
  for (int n = 0;; ++n) {
    if (n > 0) {
      partial[0] *= value[0];
      for (std::size_t k = 1; k < corners; ++k) partial[k] = value[k] * partial[k] + partial[k - 1];
      whole = partial[corners - 1];
      for (std::size_t k = 0; k < corners; ++k) twice[k] = value[k] * twice[k] + whole;
      weight *= n / (n + dimension);
    }
    if (n < exponent - 1) continue;
    const double mean = weight * whole;
    if (n == exponent + 1) {
      out.above += area * mean;
      return;
    }
    Vec2 first = Vec2::Zero();
    for (std::size_t k = 0; k < corners; ++k) first += (area * weight / (n + dimension + 1) * twice[k]) * x[k];
    (n == exponent ? out.at : out.below) += area * mean;
    (n == exponent ? out.firstAt : out.firstBelow) += first;
  }
}

/// Over a convex polygon of three corners or more.
inline DepthPowers integratePowers(const Polygon& polygon, const Linear& depth, const PowerChoice& power) {
  DepthPowers out;
  const double inverse = 1 / power.scale;
  const Vec2 p = polygon[0];
  for (int k = 2; k < polygon.count; ++k) {
    const Vec2& a = polygon[k - 1];
    const Vec2& b = polygon[k];
    const double area = 0.5 * cross(a - p, b - p);
    addSimplex<3>({p, a, b}, {depth.at(p) * inverse, depth.at(a) * inverse, depth.at(b) * inverse}, area,
                  power.exponent, out);
  }
  return out;
}

/// Over a strip of the given width (m) along a segment; the depth is linear along it and constant across.
inline DepthPowers integratePowers(const Segment& segment, double width, double depthFrom, double depthTo,
                                   const PowerChoice& power) {
  DepthPowers out;
  addSimplex<2>({segment.from, segment.to}, {depthFrom / power.scale, depthTo / power.scale},
                width * (segment.to - segment.from).norm(), power.exponent, out);
  return out;
}

}  // namespace granular
