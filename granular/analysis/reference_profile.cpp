#include "granular/analysis/reference_profile.h"

#include "granular/core/math.h"

namespace granular {

double evaluateDeKlerk(double z, double corePorosity) {
  if (z <= 0.637) return (2.14 * z - 2.53) * z + 1;
  return corePorosity + 0.29 * std::exp(-0.6 * z) * std::cos(2.3 * pi * (z - 0.16)) + 0.15 * std::exp(-0.9 * z);
}

double evaluateMeanPorosity(double tubeOverSphere) {
  const double shifted = tubeOverSphere + 1.14;
  return 0.390 + 1.740 / (shifted * shifted);
}

}  // namespace granular
