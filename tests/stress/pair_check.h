// What every answer of the narrow phase must keep, whatever the pair: the depth is the depth along the normal, nowhere
// does the exhaustive search find a shallower direction, what is called apart is separated by the direction given, and
// nothing was used without a certificate. What every contact-point rule must keep: finite numbers, a point that lies in
// both bodies but for the overlap, moments of a real area.
#pragma once

#include <cstdio>
#include <tuple>

#include "granular/core/tolerances.h"
#include "granular/narrow/bullet_manifold.h"
#include "granular/narrow/exhaustive.h"
#include "granular/point/contact_point.h"
#include "stress/pair_samples.h"

namespace granular::stress {

/// The largest product of edges that the search over all pairs of edges is asked for; beyond, the net of directions.
inline constexpr double mostEdgePairs = 3e5;

inline ExhaustiveDepth askOracle(const PairSample& pair, const Frame& frameA, const Frame& frameB) {
  const auto edges = [](const Shape& shape) {
    const bool flat = shape.kind() == ShapeKind::polyhedron || shape.kind() == ShapeKind::cuboid;
    return flat ? static_cast<double>(static_cast<const Polyhedron&>(shape).tables().edges.size()) : 0;
  };
  if (edges(*pair.a) * edges(*pair.b) <= mostEdgePairs) return searchExhaustively(*pair.a, frameA, *pair.b, frameB);
  return searchDirections(*pair.a, frameA, *pair.b, frameB, 2000);
}

/// How far off, relative to the smaller size; and what is wrong, empty if nothing is.
struct PairVerdict {
  std::string fault;
  bool touches = false;
  double excess = 0;  ///< of the answer over the oracle's, while not deep
};

/// Rounding of a depth, m: of supports and of centres far from the origin.
inline double roundOff(const PairSample& pair) {
  return 2e-14 * pair.reach() + 1e-15 * (pair.poseA.x.norm() + pair.poseB.x.norm());
}

inline std::string quote(const char* what, double value) {
  char text[160];
  std::snprintf(text, sizeof text, "%s %.3g", what, value);
  return text;
}

/// What a warm answer takes for granted, relative to the overlap: a stationary normal is the least within 10 degrees,
/// up to their cosine (narrow/global_proof.h).
inline constexpr double warmAllowance = 0.0152;

/// Judges one answer. withOracle: ask the exhaustive search too. warm: it may have been verified from the last one.
inline PairVerdict judge(const PairSample& pair, const Frame& frameA, const Frame& frameB, bool touches,
                         const Touch& touch, const WarmCache& cache, const NarrowCounts& counts, bool withOracle,
                         bool warm) {
  PairVerdict verdict;
  verdict.touches = touches;
  const Shape &a = *pair.a, &b = *pair.b;
  // A sphere's normal is the direction between two points as near to each other as its radius; the depth along it is
  // felt at the other body's extent.
  const bool ball = a.kind() == ShapeKind::sphere || b.kind() == ShapeKind::sphere;
  // Faces that are nearly one are told apart no better than a tie.
  const double size = pair.size();
  const double rounding = roundOff(pair) * (ball ? pair.reach() / size : 1) + tolerance::tie * size;
  if (counts.uncertified > 0) verdict.fault = "uncertified";
  if (!touches) {
    const bool swapped = a.kind() > b.kind();
    const Vec3 n = swapped ? Vec3(-frameB.rotate(cache.direction)) : frameA.rotate(cache.direction);
    if (!(std::abs(n.norm() - 1) < 1e-13))
      verdict.fault = quote("the separating direction is not unit: 1 +", n.norm() - 1);
    const double depth = depthAlong(a, frameA, b, frameB, n);
    if (!(depth <= rounding))
      verdict.fault = quote("called apart, but along its direction it overlaps by, over size,", depth / size);
    if (!(-cache.budget >= depth - rounding))
      verdict.fault = quote("the gap is too large by, over size,", (cache.budget + depth) / size);
    return verdict;
  }
  const double along = depthAlong(a, frameA, b, frameB, touch.normal);
  if (!(std::abs(touch.normal.norm() - 1) < 1e-13))
    verdict.fault = quote("the normal is not unit: 1 +", touch.normal.norm() - 1);
  if (!(std::abs(along - touch.overlap) <= rounding))
    verdict.fault = quote("the depth along the normal is off by, over size,", (along - touch.overlap) / size);
  const double between = (touch.onA - touch.onB - touch.overlap * touch.normal).norm();
  if (!(between <= 4 * rounding)) verdict.fault = quote("the deepest points lie off by, over size,", between / size);
  if (!withOracle) return verdict;
  const ExhaustiveDepth oracle = askOracle(pair, frameA, frameB);
  const double excess = (touch.overlap - oracle.depth) / size;
  if (touch.overlap <= tolerance::deepOverlap * size) verdict.excess = excess;
  // Nearly concentric: to the part of the overlap that the certificate leaves there.
  const bool deep = touch.overlap > tolerance::deepOverlap * size;
  const double part = deep ? tolerance::deepCertificate : warm ? warmAllowance : 0;
  const double allowed = std::max(tolerance::certificate * size, part * touch.overlap);
  if (!(touch.overlap <= oracle.depth + allowed + rounding))
    verdict.fault = quote("the oracle is shallower by, over size,", excess);
  return verdict;
}

/// How far p lies outside the shape, m, seen along 26 directions of the world and along n; negative: inside all.
inline double distanceOutside(const Shape& shape, const Frame& frame, const Vec3& p, const Vec3& n) {
  const auto beyond = [&](const Vec3& d) {
    return (p - frame.x).dot(d) - frame.rotate(shape.support(frame.unrotate(d))).dot(d);
  };
  double farthest = std::max(beyond(n), beyond(-n));
  for (int k = 0; k < 27; ++k) {
    const int row = k / 3 % 3, layer = k / 9;
    const Vec3 d(k % 3 - 1, row - 1, layer - 1);
    if (d.squaredNorm() > 0) farthest = std::max(farthest, beyond(d.normalized()));
  }
  return farthest;
}

/// The force of stiff_patch is the gradient of a potential, a pressure that pulls where the overlap is less than
/// p u/(p + 1) (point/stiff_patch.cpp): its line of action may pass beside the patch, by a part of the patch's radius
/// of gyration. Of two hundred thousand pairs the worst needed .085.
inline constexpr double besidePatch = .2;

/// Judges where one rule puts the contact; empty if nothing is wrong. beside: how far from the patch the point may lie,
/// over the patch's radius of gyration.
inline std::string judgePatch(const PairSample& pair, const Frame& frameA, const Frame& frameB, const Touch& touch,
                              const ContactPatch& patch, double beside) {
  // A contact no deeper than rounding may act anywhere that its normal's supports name: its force is nothing.
  if (!patch.point.allFinite() || !patch.centre.allFinite()) return "the point is not finite";
  if (touch.overlap < 100 * roundOff(pair)) return {};
  // Bodies around each other's centre: nothing but finite numbers is asked.
  if (touch.overlap > tolerance::deepOverlap * pair.size()) return {};

  // A point in the middle of the overlap lies in either body but for the overlap's width; a patch is cut from faces
  // that lie up to that far from each other. A search that names no piece leaves the normal off by some 1e-8 (a descent
  // stops where the depth is right to round-off), and the points by that times the bodies' extent.
  const double margin = touch.overlap + 3e-8 * pair.reach() + roundOff(pair);
  const auto excess = [&](const Shape& shape, const Frame& frame, const Vec3& p) {
    return (distanceOutside(shape, frame, p, touch.normal) - margin) / pair.size();
  };
  for (const auto& [shape, frame, name] :
       {std::tuple{pair.a.get(), &frameA, 'A'}, std::tuple{pair.b.get(), &frameB, 'B'}}) {
    const double point = excess(*shape, *frame, patch.point) - beside * std::sqrt(patch.uu + patch.vv) / pair.size();
    const double centre = excess(*shape, *frame, patch.centre);
    if (!(point <= 0)) return quote("off by, over size,", point) + ": the point lies outside " + name;
    if (!(centre <= 0)) return quote("off by, over size,", centre) + ": the centre lies outside " + name;
  }

  // What the area is is asked of contacts alone, not of bodies inside each other.
  if (touch.overlap > 0.1 * pair.size()) return {};
  const double width = std::min(pair.a->boundingRadius(), pair.b->boundingRadius());
  if (!(patch.area >= 0 && patch.area <= 4 * width * width)) return quote("the area is", patch.area);
  if (!(patch.uu >= 0 && patch.vv >= 0 && patch.uu + patch.vv <= 2 * width * width))
    return quote("the second moments are", patch.uu + patch.vv);
  if (!(patch.uv * patch.uv <= patch.uu * patch.vv + 1e-12 * std::pow(patch.uu + patch.vv, 2)))
    return "the second moments are those of no area";
  if (!(patch.depth >= 0 && patch.depth <= touch.overlap * (1 + 1e-9) + roundOff(pair)))
    return quote("depth over overlap is", patch.depth / touch.overlap);
  if (!(patch.squaredDepth >= 0 && std::isfinite(patch.squaredDepth)))
    return quote("the potential is", patch.squaredDepth);
  if (!(patch.share >= 0 && std::isfinite(patch.share))) return quote("the share is", patch.share);
  return {};
}

}  // namespace granular::stress
