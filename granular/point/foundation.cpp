// Beyond the paper: a bed of independent springs, F = (k_n/A) int h dA at the centre of pressure with A fixed for the
// pair (Winkler's foundation). Its potential is (k_n/2A) int h^2 dA, and so it conserves energy; but corners and edges
// are soft, because their area shrinks with the depth.
#include <algorithm>

#include "granular/point/rules.h"

namespace granular {

Pressure pressFoundation(const AreaMoments& m, double referenceArea) {
  return {m.centroidOfVolume(), m.volume / m.area, std::max(0.0, m.square / m.area), m.area / referenceArea};
}

double referenceArea(double size) {
  constexpr double faceOverRadius = 1.6119919540164696;  // (4 pi/3)^(1/3)
  const double side = faceOverRadius * size;
  return side * side;
}

}  // namespace granular
