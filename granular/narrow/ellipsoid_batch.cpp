#include "granular/narrow/ellipsoid_batch.h"

#include "granular/shape/ellipsoid.h"

namespace granular {
namespace {

/// Those of a register.
template <class Thing, std::size_t capacity>
std::array<const Thing*, wideSize> registerAt(const std::array<const Thing*, capacity>& all, std::size_t k) {
  std::array<const Thing*, wideSize> some;
  std::copy_n(all.begin() + k, wideSize, some.begin());
  return some;
}

}  // namespace

void EllipsoidBatch::add(const EllipsoidLook& look, const PairView& view) {
  frameA[count] = &view.frameA;
  frameB[count] = &view.frameB;
  axesA[count] = &static_cast<const Ellipsoid&>(view.a).semiAxes();
  axesB[count] = &static_cast<const Ellipsoid&>(view.b).semiAxes();
  start.put(count, look.start);
  ratio[count] = look.ratio;
  roundOff[count] = look.roundOff;
  looks[count++] = look;
}

void EllipsoidBatch::run() {
  if (count == 0) return;
  // Whole registers: the lanes beyond the last repeat it.
  const std::size_t end = (count + wideSize - 1) / wideSize * wideSize;
  for (std::size_t k = count; k < end; ++k) {
    frameA[k] = frameA[count - 1];
    frameB[k] = frameB[count - 1];
    axesA[k] = axesA[count - 1];
    axesB[k] = axesB[count - 1];
    start.put(k, start.at(count - 1));
    ratio[k] = ratio[count - 1];
    roundOff[k] = roundOff[count - 1];
  }
  for (std::size_t k = 0; k < end; k += wideSize) {
    const EllipsoidPair<Wide> pair(loadVectors(registerAt(axesA, k)), loadAxes(registerAt(frameA, k)),
                                   loadVectors(registerAt(axesB, k)), loadAxes(registerAt(frameB, k)),
                                   loadWide(&ratio[k]), loadWide(&roundOff[k]));
    const NewtonAnswer<Wide> found = takeTwoSteps(pair, start.load(k));
    normal.store(k, found.normal);
    onA.store(k, found.onA);
    onB.store(k, found.onB);
    storeWide(found.depth, &depth[k]);
    storeWide(choose(found.converged, 1 + Wide{}, Wide{}), &converged[k]);
  }
}

}  // namespace granular
