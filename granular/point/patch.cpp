// Beyond the paper: the elastic force at the pressure centroid, and the area and second moments of the overlap, over
// which the law spreads its dashpot.
#include "granular/point/rules.h"

namespace granular {

Pressure pressPatch(const AreaMoments& moments, double overlap) {
  return {moments.centroidOfVolume(), overlap, overlap * overlap};
}

}  // namespace granular
