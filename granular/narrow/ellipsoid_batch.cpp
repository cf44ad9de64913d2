#include "granular/narrow/ellipsoid_batch.h"

namespace granular {

void EllipsoidBatch::add(const EllipsoidLook& look) {
  const EllipsoidPair<double>& pair = look.pair;
  axesA.put(count, pair.axesA);
  axesB.put(count, pair.axesB);
  column0.put(count, pair.column0);
  column1.put(count, pair.column1);
  column2.put(count, pair.column2);
  x.put(count, pair.x);
  start.put(count, look.start);
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
    const EllipsoidPair<Wide> pair{axesA.load(k),   axesB.load(k), column0.load(k),     column1.load(k),
                                   column2.load(k), x.load(k),     loadWide(&ratio[k]), loadWide(&roundOff[k])};
    const NewtonAnswer<Wide> found = takeTwoSteps(pair, start.load(k));
    normal.store(k, found.normal);
    onA.store(k, found.onA);
    onB.store(k, found.onB);
    storeWide(found.depth, &depth[k]);
    storeWide(choose(found.converged, 1 + Wide{}, Wide{}), &converged[k]);
  }
}

}  // namespace granular
