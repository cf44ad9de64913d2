// The three parts of a look at two ellipsoids, for one pair alone or for many whose middle part is done side by side.
#pragma once

#include "granular/narrow/ellipsoid_newton.h"
#include "granular/narrow/kernels.h"

namespace granular {

/// A direction below which C's boundary is tangent to round-off, or as near to it as some dozens of steps come; slope
/// receives how near.
LocalMinimum descendFar(const EllipsoidPair<double>& pair, const Triple<double>& start, double& slope);

struct EllipsoidLook {
  Triple<double> start;    ///< unit normal to begin with, A's axes
  double provenUpTo;       ///< a stationary depth up to this is the global minimum, m
  double ratio, roundOff;  ///< as in EllipsoidPair
  bool warm;

  /// What Newton's steps work on.
  EllipsoidPair<double> pairOf(const PairView& view) const;

  /// Prepares Newton's steps. False where the last direction still separates the two: then the look is over.
  bool begin(const PairView& view, WarmCache& cache, NarrowCounts& counts);
  /// Answers the look, given the steps' answer; goes further on its own where they did not converge.
  bool end(const NewtonAnswer<double>& answer, const PairView& view, WarmCache& cache, NarrowCounts& counts,
           Touch& touch) const;
};

inline bool EllipsoidLook::end(const NewtonAnswer<double>& answer, const PairView& view, WarmCache& cache,
                               NarrowCounts& counts, Touch& touch) const {
  LocalMinimum found{toVec3(answer.normal), answer.depth, toVec3(answer.onA), toVec3(answer.onB)};
  double slope = 0;
  if (!answer.converged) found = descendFar(pairOf(view), start, slope);
  constexpr double slack = 1e3;
  // Deep, or not converged: the general route.
  if (!(found.depth <= provenUpTo) || (found.depth > 0 && !(slope <= slack * roundOff)))
    return touchConvex(view, cache, counts, touch);

  ++(warm ? counts.warm : counts.cold);
  if (!(found.depth > 0)) return reportApart(found.normal, -found.depth, cache);
  const bool follows = warm && cache.touched != 0;
  const Vec3 turn = follows ? Vec3(found.normal - cache.direction) : Vec3(Vec3::Zero());
  cache.proof.floor = 0;
  for (int k = 0; k < 3; ++k) cache.proof.axis[static_cast<std::size_t>(k)] = static_cast<float>(turn[k]);
  const Vec3 middle = 0.5 * (found.onA + found.onB);
  found.onA = middle + 0.5 * found.depth * found.normal;
  found.onB = middle - 0.5 * found.depth * found.normal;
  return reportTouch(view, WarmCache::smooth, found, cache, counts, touch);
}

}  // namespace granular
