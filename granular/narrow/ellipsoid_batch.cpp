#include "granular/narrow/ellipsoid_batch.h"

namespace granular {
namespace {

template <class Lanes>
void put(const Triple<double>& v, std::size_t k, Lanes& lanes) {
  lanes.x[k] = v.x;
  lanes.y[k] = v.y;
  lanes.z[k] = v.z;
}
template <class Lanes>
Triple<Wide> load(const Lanes& lanes, std::size_t k) {
  return {loadWide(&lanes.x[k]), loadWide(&lanes.y[k]), loadWide(&lanes.z[k])};
}
template <class Lanes>
void store(const Triple<Wide>& v, std::size_t k, Lanes& lanes) {
  storeWide(v.x, &lanes.x[k]);
  storeWide(v.y, &lanes.y[k]);
  storeWide(v.z, &lanes.z[k]);
}

}  // namespace

void EllipsoidBatch::add(const EllipsoidLook& look) {
  const EllipsoidPair<double>& pair = look.pair;
  put(pair.axesA, count, axesA);
  put(pair.axesB, count, axesB);
  put(pair.column0, count, column0);
  put(pair.column1, count, column1);
  put(pair.column2, count, column2);
  put(pair.x, count, x);
  put(look.start, count, start);
  ratio[count] = pair.ratio;
  roundOff[count] = pair.roundOff;
  looks[count++] = look;
}

void EllipsoidBatch::run() {
  if (count == 0) return;
  // Whole registers: the lanes beyond the last repeat it.
  const EllipsoidLook last = looks[count - 1];
  const std::size_t kept = count, end = (count + wideSize - 1) / wideSize * wideSize;
  while (count < end) add(last);
  count = kept;
  for (std::size_t k = 0; k < end; k += wideSize) {
    const EllipsoidPair<Wide> pair{load(axesA, k),   load(axesB, k), load(column0, k),    load(column1, k),
                                   load(column2, k), load(x, k),     loadWide(&ratio[k]), loadWide(&roundOff[k])};
    const NewtonAnswer<Wide> found = takeTwoSteps(pair, load(start, k));
    store(found.normal, k, normal);
    store(found.onA, k, onA);
    store(found.onB, k, onB);
    storeWide(found.depth, &depth[k]);
    storeWide(choose(found.converged, 1 + Wide{}, Wide{}), &converged[k]);
  }
}

}  // namespace granular
