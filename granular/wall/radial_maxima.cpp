#include "granular/wall/radial_maxima.h"

namespace granular {

namespace {

/// g(t) of the header for A, B >= 0; `side` = -1 reflects t at the minor axis (t = pi - s, read as a function of s).
struct Slope {
  double a, b, d;
  double side;

  double at(double cosT, double sinT) const { return side * (b * cosT - d * sinT * cosT) - a * sinT; }
  double derivative(double cosT, double sinT) const {
    return -side * (b * sinT + d * (cosT * cosT - sinT * sinT)) - a * cosT;
  }
};

/// The root of a slope that is > 0 (rising = -1: < 0) near lo and changes sign once in [lo, hi]: Newton inside a
/// shrinking bracket.
double findRoot(const Slope& slope, double rising, double lo, double hi) {
  double t = 0.5 * (lo + hi);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double c = std::cos(t), s = std::sin(t);
    const double value = -rising * slope.at(c, s);
    (value > 0 ? lo : hi) = t;
    if (value == 0) return t;
    const double derivative = -rising * slope.derivative(c, s);
    double next = t - value / derivative;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    // A few ulp of the angle: the distance is known to the square of it.
    if (std::abs(next - t) <= 1e-15) return next;
    t = next;
  }
  return t;
}

}  // namespace

RadialMaxima findRadialMaxima(double c1, double c2, double s1, double s2) {
  const double sign1 = c1 < 0 ? -1 : 1, sign2 = c2 < 0 ? -1 : 1;
  const double a = std::abs(c1) * s1, b = std::abs(c2) * s2, d = (s1 - s2) * (s1 + s2);
  const auto distanceAt = [&](double cosT, double sinT) {
    return std::hypot(std::abs(c1) + s1 * cosT, std::abs(c2) + s2 * sinT);
  };

  RadialMaxima maxima;
  const auto push = [&](double cosT, double sinT) {
    maxima.angle[maxima.count] = Vec2(sign1 * cosT, sign2 * sinT);
    maxima.distance[maxima.count] = distanceAt(cosT, sinT);
    ++maxima.count;
  };

  // The furthest point lies in the quadrant of the centre.
  const double t = findRoot({a, b, d, 1}, -1, 0, 0.5 * pi);
  push(std::cos(t), std::sin(t));

  // The second maximum and the minimum between the two, inside the evolute.
  const auto power = [](double x) { return std::cbrt(x) * std::cbrt(x); };
  if (power(a) + power(b) < power(d)) {
    const double turn = std::atan2(std::cbrt(b), std::cbrt(a));
    const Slope reflected{a, b, d, -1};
    const double s = findRoot(reflected, 1, 0, turn);
    push(-std::cos(s), std::sin(s));
    const double low = findRoot(reflected, -1, turn, 0.5 * pi);
    maxima.between = distanceAt(-std::cos(low), std::sin(low));
  }
  return maxima;
}

}  // namespace granular
