#include "granular/wall/spot_share.h"

namespace granular {

void shareStiffness(std::span<WallTouch> touches) {
  if (touches.size() == 1) {
    touches[0].share = 1;
    return;
  }
  // Weights are read by every spot: keep them until all shares are known.
  thread_local std::vector<double> weights;
  weights.clear();
  for (const WallTouch& touch : touches) weights.push_back(touch.share);
  for (std::size_t s = 0; s < touches.size(); ++s) {
    double sum = 0;
    for (std::size_t t = 0; t < touches.size(); ++t)
      sum += weights[t] * (s == t ? 1.0 : std::max(0.0, touches[s].normal.dot(touches[t].normal)));
    touches[s].share = sum > 0 ? weights[s] / sum : 0;
  }
}

}  // namespace granular
