// The memory of one pair: enough to verify the last answer instead of searching again.
#pragma once

#include <array>
#include <cstdint>

#include "granular/core/math.h"

namespace granular {

/// A proof about a touching pair that outlasts its step (narrow/global_proof.h): as B lay at `turn` and `place` in A's
/// body axes, no direction further than 8 degrees from `axis` had a smaller depth than `floor`. Single precision, for
/// the memory of many pairs; its error is allowed for.
struct KeptProof {
  std::array<float, 9> turn{};   ///< rotation of B's axes into A's, by columns
  std::array<float, 3> place{};  ///< B's centre, m
  std::array<float, 3> axis{};   ///< unit
  float floor = 0;               ///< m; 0: no proof
};

/// What is remembered of a pair from one step to the next, in order to verify the last answer instead of searching
/// again. Plain data, saved in checkpoints.
struct WarmCache {
  enum Kind : std::int32_t { cold, apart, faceOfA, faceOfB, edgePair, smooth };
  std::int32_t kind = cold;
  std::int32_t featureA = 0;  ///< face, edge or vertex index of A, by kind; apart: vertices;
                              ///< smooth: code of a piece (encode), or 0
  std::int32_t featureB = 0;
  std::int32_t touched = 0;  ///< 1 if the last look found an overlap
  /// apart: unit separating direction from A to B in A's body axes; touching: the last normal in A's body axes.
  Vec3 direction = Vec3::Zero();
  /// How far the two surfaces may move relative to each other (sum of both bodies' motion, m) before the pair needs
  /// another look (apart) or another full search (touching).
  double budget = 0;
  /// smooth; two ellipsoids: floor 0, and in axis how the normal turned from the last look to this one.
  KeptProof proof;
};

}  // namespace granular
