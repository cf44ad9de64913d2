// Any two convex shapes, by their support functions alone. Warm: the last separating direction, or a descent from the
// last normal. Cold: GJK for the separated, Bullet's GJK/EPA for the touching, both bounds for whatever it says, and a
// second route where it fails.
#include "granular/core/tolerances.h"
#include "granular/narrow/epa.h"
#include "granular/narrow/gjk.h"
#include "granular/narrow/kernels.h"

namespace granular {
namespace {

/// How far Bullet's depth may lie from the depth along its own normal, relative to the pair's size. On smooth shapes
/// its polytope ends with an error of this order, which the descent then removes; its false answers are off by far
/// more.
constexpr double proposalError = 1e-3;

/// Polishes the proposal if it is consistent with itself; otherwise there is none.
bool takeProposal(Difference& c, const PenetrationAnswer& proposal, LocalMinimum& best, double& proposed) {
  proposed = infinity;
  if (!proposal.penetrating) return false;
  // Either sign of the normal is taken: the depth tells them apart.
  const double along = c.depth(proposal.normal), against = c.depth(-proposal.normal);
  proposed = std::min(along, against);
  if (std::abs(proposed - proposal.overlap) > proposalError * c.size()) return false;
  best = descend(c, along <= against ? proposal.normal : -proposal.normal);
  return true;
}

}  // namespace

SearchResult searchConvex(Difference& c, const Vec3& guess, const PenetrationAnswer* proposal, NarrowCounts& counts) {
  ++counts.searches;
  SearchResult out;
  const double tolerance = tolerance::certificate * c.size();

  // First route: the proposal, if any. Second: the descent from the guess.
  double proposed = infinity;
  const bool proposalStands = proposal && takeProposal(c, *proposal, out.minimum, proposed);
  if (!proposalStands) out.minimum = descend(c, guess);

  // Both bounds. A better direction than the one at hand is polished, and the bounds are drawn again around it.
  bool certified = false;
  bool replaced = false;
  for (int round = 0; round < 4 && !certified && out.minimum.depth > 0; ++round) {
    const DepthBounds bounds = boundOverlap(c, out.minimum.normal, out.minimum.depth, tolerance);
    certified = bounds.met;
    if (!(bounds.upper < out.minimum.depth)) break;
    const LocalMinimum polished = descend(c, bounds.normal);
    if (!(polished.depth < out.minimum.depth)) break;
    replaced = replaced || polished.depth < out.minimum.depth - tolerance;
    out.minimum = polished;
  }
  out.apart = !(out.minimum.depth > 0);
  if (out.apart) return out;

  if (!certified) ++counts.uncertified;
  if (proposal && !proposal->penetrating) ++counts.missed;
  if (proposal && proposal->penetrating && (!proposalStands || replaced)) ++counts.fallbacks;
  return out;
}

bool touchConvex(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  Difference c(pair.a, pair.frameA, pair.b, pair.frameB);

  // Warm and apart: does the last direction still separate?
  if (cache.kind == WarmCache::apart && !pair.searchAlways) {
    const double depth = c.depth(cache.direction);
    if (depth < 0) {
      ++counts.warm;
      return reportApart(cache.direction, -depth, cache);
    }
  }

  // Warm and touching: the minimum next to the last normal, while the overlap is small.
  if (cache.touched && !pair.searchAlways) {
    const LocalMinimum local = descend(c, cache.direction);
    if (!(local.depth > 0)) {
      ++counts.warm;
      return reportApart(local.normal, -local.depth, cache);
    }
    if (local.depth <= shallowOverlap * c.size()) {
      ++counts.warm;
      return reportTouch(pair, WarmCache::smooth, local, cache, counts, touch);
    }
  }

  // Cold: a separating direction ends it.
  if (cache.kind == WarmCache::cold) ++counts.cold;
  const Vec3 guess = guessNormal(c, cache);
  const Nearest nearest = findNearest(c, Vec3::Zero(), guess, separationPrecision);
  if (nearest.gap > 0) return reportApart(nearest.direction, nearest.gap, cache);

  // A contact is born with Bullet's answer; a running one is searched from its own normal.
  PenetrationAnswer proposal;
  if (!cache.touched) proposal = askBullet(c, guess);
  const SearchResult found = searchConvex(c, guess, cache.touched ? nullptr : &proposal, counts);
  if (found.apart) return reportApart(found.minimum.normal, -found.minimum.depth, cache);
  return reportTouch(pair, WarmCache::smooth, found.minimum, cache, counts, touch);
}

}  // namespace granular
