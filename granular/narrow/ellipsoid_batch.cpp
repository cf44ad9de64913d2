#include "granular/narrow/ellipsoid_batch.h"

#include "granular/core/rows.h"
#include "granular/shape/ellipsoid.h"

namespace granular {
namespace {

std::array<const double*, wideSize> registerAt(const double* const* rows, std::size_t offset) {
  std::array<const double*, wideSize> from;
  for (std::size_t k = 0; k < wideSize; ++k) from[k] = rows[k] + offset;
  return from;
}

/// Frames, each twelve numbers.
PlacedAxes<Wide> loadFrames(const double* const* frames) {
  static_assert(sizeof(Frame) == 12 * sizeof(double));
  std::array<Wide, 8> first;
  std::array<Wide, 4> last;
  loadRows(registerAt(frames, 0), first);
  loadRows(registerAt(frames, 8), last);
  return {{first[0], first[1], first[2]},
          {first[3], first[4], first[5]},
          {first[6], first[7], last[0]},
          {last[1], last[2], last[3]}};
}

Triple<Wide> loadVectors(const double* const* vectors) {
  std::array<Wide, 3> v;
  loadRows(registerAt(vectors, 0), v);
  return {v[0], v[1], v[2]};
}

}  // namespace

void EllipsoidBatch::add(const EllipsoidLook& look, const PairView& view) {
  frameA[count] = view.frameA.R.data();
  frameB[count] = view.frameB.R.data();
  axesA[count] = static_cast<const Ellipsoid&>(view.a).semiAxes().data();
  axesB[count] = static_cast<const Ellipsoid&>(view.b).semiAxes().data();
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
    const EllipsoidPair<Wide> pair(loadVectors(&axesA[k]), loadFrames(&frameA[k]), loadVectors(&axesB[k]),
                                   loadFrames(&frameB[k]), loadWide(&ratio[k]), loadWide(&roundOff[k]));
    const NewtonAnswer<Wide> found = takeTwoSteps(pair, start.load(k));
    normal.store(k, found.normal);
    onA.store(k, found.onA);
    onB.store(k, found.onB);
    storeWide(found.depth, &depth[k]);
    storeWide(choose(found.converged, 1 + Wide{}, Wide{}), &converged[k]);
  }
}

}  // namespace granular
