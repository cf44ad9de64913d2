// Beyond the paper: the centroid of the overlap weighted by its local depth. It moves continuously, from the centre of
// a face without tilt over its third point, where the far edge lifts off, to the edge.
#include "granular/point/rules.h"

namespace granular {

Pressure pressCentroid(const AreaMoments& moments, double overlap) {
  return {moments.centroidOfVolume(), overlap, overlap * overlap, 1, false};
}

}  // namespace granular
