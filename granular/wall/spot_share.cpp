#include "granular/wall/spot_share.h"

#include <algorithm>
#include <cassert>

namespace granular {

void shareStiffness(std::span<const Claim> claims, std::span<WallTouch> touches) {
  assert(claims.size() == touches.size());
  for (std::size_t s = 0; s < touches.size(); ++s) {
    double sum = claims[s].weight;
    for (std::size_t t = 0; t < touches.size(); ++t)
      if (t != s) sum += claims[t].weight * std::max(0.0, touches[s].normal.dot(touches[t].normal));
    touches[s].share = claims[s].weight / std::max(claims[s].full, sum);
  }
}

void fadeStiffness(std::span<const Claim> claims, std::span<WallTouch> touches) {
  assert(claims.size() == touches.size());
  for (std::size_t s = 0; s < touches.size(); ++s) touches[s].share = claims[s].weight / claims[s].full;
}

}  // namespace granular
