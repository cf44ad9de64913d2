// The narrow phase: do two placed convex shapes touch, how deep, along which normal? (S sections 4 and 5.1)
// The overlap of a pair is the least depth over all directions: min over unit n of h(n) = s_A(n).n - s_B(-n).n.
#pragma once

#include <cstdint>

#include "granular/pair/touch.h"
#include "granular/pair/warm_cache.h"
#include "granular/shape/shape.h"

namespace granular {

/// What the run's contact certificate counts. Summed over pairs and steps.
struct NarrowCounts {
  std::uint64_t cold = 0;         ///< searches from nothing (Bullet's GJK/EPA or a closed form)
  std::uint64_t searches = 0;     ///< full searches of any cause
  std::uint64_t warm = 0;         ///< answers verified from the cache
  std::uint64_t uncertified = 0;  ///< answers used although upper and lower bound differ
  std::uint64_t coarse = 0;       ///< answers of a search whose bounds met within the second tier alone (tolerances.h)
  std::uint64_t fallbacks = 0;    ///< answers of Bullet's that failed their certificate; the second route answered
  std::uint64_t missed = 0;       ///< pairs Bullet called separate that overlap
  std::uint64_t normalFlips = 0;  ///< normals that turned by more than 30 degrees from one step to the next

  NarrowCounts& operator+=(const NarrowCounts& other);
};

/// Do two convex shapes touch, by the pair's kernel, warm start included. B's frame must already hold the periodic
/// image next to A. searchAlways: skip nothing, run the full search every time (the oracle of the switches). Returns
/// true and fills touch when overlap > 0. Deterministic: depends on the arguments alone.
bool findTouch(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, bool searchAlways,
               WarmCache& cache, NarrowCounts& counts, Touch& touch);

/// True if the two placed shapes, clumps included, overlap (for insertion and checks: no cache). overlap receives the
/// depth when given, the deepest of all children.
bool overlaps(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, double* overlap = nullptr);

/// The depth along the unit direction n (world): an upper bound of the overlap, negative if n separates the two.
double depthAlong(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, const Vec3& n);

}  // namespace granular
