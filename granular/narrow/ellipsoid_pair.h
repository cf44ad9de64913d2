// Two ellipsoids, as their contacts in batches (world/ellipsoid_contacts.cpp) share it with the kernel for one pair.
#pragma once

#include <algorithm>
#include <limits>

#include "granular/narrow/ellipsoid_newton.h"
#include "granular/narrow/kernels.h"

namespace granular {

/// Slopes of two such bodies' depth below this are 0, m: of numbers, or of many side by side.
template <class Real>
Real slopeRoundOff(const Real& boundingRadiusA, const Real& boundingRadiusB) {
  return 8 * std::numeric_limits<double>::epsilon() * (boundingRadiusA + boundingRadiusB);
}

/// How the normal turned from the last look to this one, which the cache of two ellipsoids remembers.
inline Triple<double> lastTurn(const WarmCache& cache) {
  const auto& turn = cache.proof.axis;
  return {turn[0], turn[1], turn[2]};
}
inline void rememberTurn(const Triple<double>& turn, WarmCache& cache) {
  cache.proof.floor = 0;
  cache.proof.axis = {static_cast<float>(turn.x), static_cast<float>(turn.y), static_cast<float>(turn.z)};
}
/// True where the last look found a touch by Newton's steps, so that both normal and turn are known.
inline bool isForeseen(const WarmCache& cache) {
  return cache.kind == WarmCache::smooth && cache.touched != 0 && cache.proof.floor == 0;
}

/// touchEllipsoids for one pair, in short.
bool findEllipsoidTouch(const PairView& view, WarmCache& cache, NarrowCounts& counts, SmoothTouch& touch);

}  // namespace granular
