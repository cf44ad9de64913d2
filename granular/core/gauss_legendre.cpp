#include "granular/core/gauss_legendre.h"

#include "granular/core/math.h"

namespace granular {

// Newton's method on the Legendre polynomial.
std::pair<double, double> gaussLegendreNode(int n, int k) {
  double x = std::cos(pi * (k + 0.75) / (n + 0.5));
  double slope = 1;
  for (int iteration = 0; iteration < 8; ++iteration) {
    double p0 = 1, p1 = x;
    for (int j = 2; j <= n; ++j) {
      const double p2 = ((2 * j - 1) * x * p1 - (j - 1) * p0) / j;
      p0 = p1;
      p1 = p2;
    }
    slope = n * (x * p1 - p0) / (x * x - 1);
    const double correction = p1 / slope;
    x -= correction;
    if (std::abs(correction) < 1e-15) break;
  }
  return {x, 2 / ((1 - x * x) * slope * slope)};
}

}  // namespace granular
