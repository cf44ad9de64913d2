// One trial: a sample looked at cold, then warm after small motions, and where every contact-point rule puts it.
#pragma once

#include <array>
#include <ctime>

#include "stress/pair_check.h"

namespace granular::stress {

inline constexpr std::array<PointRule, 6> overlapRules = {PointRule::witness,          PointRule::faceCentroid,
                                                          PointRule::pressureCentroid, PointRule::patch,
                                                          PointRule::stiffPatch,       PointRule::foundation};

struct TrialOutcome {
  bool touches = false;
  double coldExcess = 0, warmExcess = 0;  ///< worst over the oracle's depth, over the smaller size
  double slowest = 0;                     ///< longest single look, s
  NarrowCounts counts;
  std::string fault;                      ///< of the narrow phase; empty: none
  std::array<std::string, 7> ruleFaults;  ///< by PointRule
};

/// Of the processor, s: what else the machine does is not counted.
inline double threadTime() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A look with its time.
inline bool lookTimed(const PairSample& pair, const Frame& frameA, const Frame& frameB, WarmCache& cache,
                      TrialOutcome& out, Touch& touch) {
  NarrowCounts counts;
  const double began = threadTime();
  const bool touches = findTouch(*pair.a, frameA, *pair.b, frameB, false, cache, counts, touch);
  out.slowest = std::max(out.slowest, threadTime() - began);
  out.counts += counts;
  return touches;
}

inline void tryRules(const PairSample& pair, const Frame& frameA, const Frame& frameB, const Touch& touch,
                     TrialOutcome& out) {
  for (const PointRule rule : overlapRules) {
    ContactPatch patch;
    placeContact({rule}, *pair.a, frameA, *pair.b, frameB, touch, patch);
    std::string& fault = out.ruleFaults[static_cast<std::size_t>(rule)];
    if (fault.empty())
      fault = judgePatch(pair, frameA, frameB, touch, patch, rule == PointRule::stiffPatch ? besidePatch : 0);
  }
  // Bullet's manifold: every point a contact that penetrates, the shares making up one.
  Manifold manifold;
  std::array<ManifoldContact, 4> points;
  const int count = refreshManifold(*pair.a, frameA, *pair.b, frameB, touch, manifold, points);
  double shares = 0;
  std::string& fault = out.ruleFaults[static_cast<std::size_t>(PointRule::manifold)];
  for (int k = 0; k < count; ++k) {
    const ManifoldContact& p = points[static_cast<std::size_t>(k)];
    shares += p.share;
    if (!p.touch.onA.allFinite() || !p.touch.onB.allFinite()) fault = "a point is not finite";
    if (!(p.touch.overlap > 0)) fault = quote("a point's overlap is", p.touch.overlap);
  }
  if (!(std::abs(shares - 1) < 1e-12) && touch.overlap > 100 * roundOff(pair))
    fault = quote("the shares sum to", shares);
}

/// oracle: ask the exhaustive search of the first and of the last look.
inline TrialOutcome tryPair(PairSample pair, std::uint64_t seed, std::uint64_t k, bool oracle) {
  TrialOutcome out;
  Random random((seed + 1) * 0x9e3779b97f4a7c15ull + k);
  WarmCache cache;
  Touch touch;
  constexpr int looks = 4;
  const double motion = pair.size() * std::pow(10.0, random.uniform(-8, -2));
  for (int look = 0; look < looks; ++look) {
    if (look > 0) {
      pair.poseB.x += motion * random.direction();
      pair.poseB.q = rotationFromVector(motion / pair.b->boundingRadius() * random.direction()) * pair.poseB.q;
      pair.poseB.q.normalize();
    }
    const Frame frameA(pair.poseA), frameB(pair.poseB);
    const std::uint64_t before = out.counts.uncertified;
    const bool touches = lookTimed(pair, frameA, frameB, cache, out, touch);
    out.touches |= touches;
    NarrowCounts fresh;
    fresh.uncertified = out.counts.uncertified - before;
    const bool ends = look == 0 || look == looks - 1;
    const PairVerdict verdict = judge(pair, frameA, frameB, touches, touch, cache, fresh, oracle && ends, look > 0);
    double& worst = look > 0 ? out.warmExcess : out.coldExcess;
    worst = std::max(worst, verdict.excess);
    if (out.fault.empty() && !verdict.fault.empty()) out.fault = "look " + std::to_string(look) + ": " + verdict.fault;
    if (touches && ends) tryRules(pair, frameA, frameB, touch, out);
  }
  return out;
}

}  // namespace granular::stress
