// Where the bed ends. The published fractions depend on it and S does not define it, so three definitions are reported.
//
// The one used (`equivalent`) is the height of the flat-topped bed of equal solid volume: H = z0 + (1/phi) int_z0^inf
// phi(z) dz, with phi the mean solid fraction of the bulk. Voids between the uppermost particles and particles above
// their neighbours cancel, whatever the roughness of the top, so that all particle volume / vessel volume up to H (S
// appendix A) has no bias from the top. z0 is the middle of the bulk; phi is averaged there with a cos^2 weight, which
// suppresses layers.
#pragma once

#include "granular/analysis/ring_samples.h"

namespace granular {

struct FillingHeight {
  double equivalent = 0;  ///< as above, m above the floor
  double halfFraction =
      0;  ///< where the solid fraction, averaged over a length, falls below half of the bulk's, m above the floor
  double highestPoint = 0;          ///< of all particles, m above the floor
  double bulkFraction = 0;          ///< phi
  double bulkFrom = 0, bulkTo = 0;  ///< heights of the bulk, m above the floor
};

/// Measures the bed's height from samples that reach from the floor to above its highest point. length: the longest
/// extent of the particles, m. The bulk leaves out two lengths at floor and top, at most a quarter of the height each.
FillingHeight measureFillingHeight(const RingSamples& samples, double length, double highestPoint);

}  // namespace granular
