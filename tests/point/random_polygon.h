// Random convex polygons and integrals over them by brute force.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "granular/core/random.h"
#include "granular/point/polygon.h"

namespace granular::test {

/// Corners at random angles on an ellipse somewhere: convex, counter-clockwise.
inline Polygon makeRandomPolygon(Random& random, int corners) {
  std::vector<double> angles;
  for (int k = 0; k < corners; ++k) angles.push_back(random.uniform(0, 2 * pi));
  std::sort(angles.begin(), angles.end());
  const Vec2 centre(random.uniform(-.5, .5), random.uniform(-.5, .5));
  const double a = random.uniform(.3, 1), b = random.uniform(.3, 1);
  Polygon polygon;
  for (int k = 0; k < corners; ++k) {
    polygon.push(centre + Vec2(a * std::cos(angles[k]), b * std::sin(angles[k])), k);
  }
  return polygon;
}

inline bool isInside(const Polygon& polygon, const Vec2& p) {
  for (int k = 0; k < polygon.count; ++k) {
    if (cross(polygon[polygon.next(k)] - polygon[k], p - polygon[k]) < 0) return false;
  }
  return polygon.count > 2;
}

/// The integral of f over [-2, 2]^2, by the midpoint rule on n x n cells.
inline double integrateByCells(int n, const std::function<double(const Vec2&)>& f) {
  double sum = 0;
  const double h = 4.0 / n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) sum += f({-2 + (i + .5) * h, -2 + (j + .5) * h});
  }
  return sum * h * h;
}

}  // namespace granular::test
