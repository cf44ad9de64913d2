// Beyond the paper: a contact with a potential, k_n for every feature, and a rocking stiffness to choose.
//
// The elastic energy is k_n u^2/2 with a mean of the depth h over the overlap that favours the deepest places,
// Lehmer's:
//   u = I_{p+1}/I_p,   I_n = int h^n dA.
// Depths that are the same everywhere give u = h; the limit p -> infinity gives the deepest point's, the law of S.
// Force and moment are the gradient, a pressure with the density k_n u w(x), w = ((p + 1) h^p - p u h^{p-1})/I_p:
//   F = k_n u W,  W = int w dA = (p + 1) - p I_{p+1} I_{p-1}/I_p^2,  at  x = int w x dA/W.
// * Full face, tilted by g: u = h + p g.M g/h + ..., so the rocking stiffness is 2 p k_n M (M: second moments per
// area).
//   An elastic foundation has k_n M: a column of n equal bodies buckles where n^3 exceeds a multiple of it.
// * Edge: W u = (p + 1)^2/(p + 2)^2 h. Corner: (p + 1)^2/(p + 3)^2 h. Never softer than 1/4, .86 of k_n for p = 24.
// * Where the far edge lifts off, the force arrives at the near one, and stays. Nothing jumps: I_{p-1} is continuous.
#include <limits>

#include "granular/point/rules.h"

namespace granular {

Pressure pressStiffPatch(const AreaMoments& m, int sharpness, double overlap) {
  const DepthPowers& I = m.powers;
  const double p = sharpness;
  Pressure out;
  // Faces that touch within round-off have depths of nothing beside the overlap, or of many times that, whose powers
  // are lost: they press with nothing. Between these bounds the quotients keep all their digits.
  constexpr double least = std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();
  const double u = I.above / I.at;  // over the overlap
  const double weight = (p + 1) * I.at - p * u * I.below;
  if (!(I.at > least * m.area && I.at < m.area / least && weight > 0 && weight < infinity)) {
    out.centre = m.centroidOfVolume();
    out.depth = out.squaredDepth = 0;
    return out;
  }
  out.centre = ((p + 1) * I.firstAt - p * u * I.firstBelow) / weight;
  out.depth = overlap * u * weight / I.at;
  out.squaredDepth = overlap * u * overlap * u;
  return out;
}

}  // namespace granular
