// What the narrow phase finds of one pair.
#pragma once

#include <cstdint>

#include "granular/core/math.h"

namespace granular {

/// What of two polyhedra touches, as far as the narrow phase has named it: indices in their tables.
struct TouchingFeature {
  enum Kind : std::int32_t { unknown, faceOfA, faceOfB, edges };
  Kind kind = unknown;
  /// faceOfA: a face of A, the deepest vertex of B; faceOfB: a vertex, a face; edges: an edge of each.
  std::int32_t a = -1, b = -1;

  TouchingFeature turnedRound() const { return {kind == faceOfA ? faceOfB : kind == faceOfB ? faceOfA : kind, b, a}; }
};

/// What two smooth bodies that touch have in common, world axes.
struct SmoothTouch {
  Vec3 normal;     ///< unit, from A to B
  double overlap;  ///< m, > 0
  Vec3 middle;     ///< halfway between the deepest points, m
};
static_assert(sizeof(SmoothTouch) == 7 * sizeof(double));  // a row of numbers

/// One contact of two convex shapes, world axes.
struct Touch {
  Vec3 normal;     ///< unit, from A to B
  double overlap;  ///< m, > 0
  Vec3 onA, onB;   ///< deepest points on either surface; onA - onB = overlap * normal
  TouchingFeature feature = {};

  /// The deepest points, half an overlap off the middle between them.
  void placeAbout(const Vec3& middle) {
    onA = middle + 0.5 * overlap * normal;
    onB = middle - 0.5 * overlap * normal;
  }
  void take(const SmoothTouch& smooth) {
    normal = smooth.normal;
    overlap = smooth.overlap;
    placeAbout(smooth.middle);
    feature = {};
  }
};

}  // namespace granular
