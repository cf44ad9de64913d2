// Rotations known exactly: the torque-free asymmetric top (Jacobi's elliptic functions) and the heavy symmetric top in
// steady precession.
#pragma once

#include <array>

#include "granular/core/math.h"

namespace granular {

/// Jacobi's sn, cn, dn by descending Landen transformations (AGM), m = k^2 in (0, 1).
inline std::array<double, 3> findJacobi(double u, double m) {
  std::array<double, 16> a{}, c{};
  a[0] = 1;
  c[0] = std::sqrt(m);
  double b = std::sqrt(1 - m);
  int n = 0;
  while (c[n] > 1e-17 && n < 15) {
    a[n + 1] = 0.5 * (a[n] + b);
    c[n + 1] = 0.5 * (a[n] - b);
    b = std::sqrt(a[n] * b);
    ++n;
  }
  double phi = std::ldexp(a[n] * u, n);
  for (; n > 0; --n) phi = 0.5 * (phi + std::asin(c[n] / a[n] * std::sin(phi)));
  const double sn = std::sin(phi);
  return {sn, std::cos(phi), std::sqrt(1 - m * sn * sn)};
}

/// The torque-free asymmetric top with I1 < I2 < I3 and L^2 > 2 E I2: w3 never vanishes.
/// L points along world z; orientation by the angles phi (about z), theta, psi of the zxz convention.
struct FreeTop {
  Vec3 inertia{1.0, 2.0, 3.0};
  Vec3 amplitude;
  double rate = 0, m = 0, momentum = 0;

  FreeTop(double w1, double w3) {
    const double i1 = inertia.x(), i2 = inertia.y(), i3 = inertia.z();
    // At t = 0: w = (w1, 0, w3).
    const double energy2 = i1 * w1 * w1 + i3 * w3 * w3, square = i1 * i1 * w1 * w1 + i3 * i3 * w3 * w3;
    momentum = std::sqrt(square);
    rate = std::sqrt((i3 - i2) * (square - energy2 * i1) / (i1 * i2 * i3));
    m = (i2 - i1) * (energy2 * i3 - square) / ((i3 - i2) * (square - energy2 * i1));
    amplitude = Vec3(w1, std::sqrt((energy2 * i3 - square) / (i2 * (i3 - i2))), w3);
  }
  Vec3 velocityBody(double t) const {
    const auto [sn, cn, dn] = findJacobi(rate * t, m);
    // w1 ~ cn, w2 ~ sn, w3 ~ dn; Euler: I2 w2' = (I3 - I1) w3 w1 > 0 at t = 0.
    return {amplitude.x() * cn, amplitude.y() * sn, amplitude.z() * dn};
  }
  double precession(double t) const {
    const Vec3 l = inertia.cwiseProduct(velocityBody(t)), w = velocityBody(t);
    return momentum * (l.x() * w.x() + l.y() * w.y()) / (l.x() * l.x() + l.y() * l.y());
  }
  Quat orientation(double t) const {
    // phi by Gauss-Legendre with three points on many intervals: exact to round-off for this smooth function.
    const int intervals = 4000;
    const double h = t / intervals;
    double phi = 0;
    for (int i = 0; i < intervals; ++i) {
      const double middle = (i + 0.5) * h, off = 0.5 * h * std::sqrt(0.6);
      phi += h / 18 * (5 * precession(middle - off) + 8 * precession(middle) + 5 * precession(middle + off));
    }
    const Vec3 l = inertia.cwiseProduct(velocityBody(t));
    const double theta = std::acos(l.z() / momentum), psi = std::atan2(l.x(), l.y());
    return Quat(Eigen::AngleAxisd(phi, Vec3::UnitZ()) * Eigen::AngleAxisd(theta, Vec3::UnitX()) *
                Eigen::AngleAxisd(psi, Vec3::UnitZ()));
  }
};

/// A symmetric top in steady precession at tilt theta: I3 w3 W - I1 W^2 cos(theta) = m g l; phi = W t, psi = (w3 - W
/// cos(theta)) t.
struct HeavyTop {
  Vec3 inertia{1.5, 1.5, 0.7};
  double theta = 0.6, precession = 0.9, w3 = 6;

  double weight() const {
    return inertia.z() * w3 * precession - inertia.x() * precession * precession * std::cos(theta);
  }
  Quat orientation(double t) const {
    return Quat(Eigen::AngleAxisd(precession * t, Vec3::UnitZ()) * Eigen::AngleAxisd(theta, Vec3::UnitX()) *
                Eigen::AngleAxisd((w3 - precession * std::cos(theta)) * t, Vec3::UnitZ()));
  }
  /// World axes.
  Vec3 velocity(double t) const {
    return precession * Vec3::UnitZ() + (w3 - precession * std::cos(theta)) * (orientation(t) * Vec3::UnitZ());
  }
  /// World axes.
  Vec3 torque(const Quat& q) const { return (q * Vec3::UnitZ()).cross(-weight() * Vec3::UnitZ()); }
};

}  // namespace granular
