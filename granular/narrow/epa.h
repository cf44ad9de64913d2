// Both bounds of an overlap from one polytope: the expanding polytope of van den Bergen 2001, read as a proof.
// A polytope inscribed in C = A - B that holds the origin bounds the overlap from below by its nearest facet; the depth
// h(n) along any unit n bounds it from above. The nearest facet is pushed out to C's surface until the two meet, so
// that the direction found is the global minimum, not just a local one. The origin need not lie inside at the start:
// facets that it sees from outside count as negative distances and are pushed out first.
#pragma once

#include "granular/narrow/difference.h"

namespace granular {

/// A's body axes, m.
struct DepthBounds {
  double upper = infinity;      ///< least depth h(n) met
  double lower = -infinity;     ///< no direction has a smaller one
  Vec3 normal = Vec3::UnitX();  ///< unit direction of the upper bound
  bool met = false;             ///< upper - lower <= the tolerance asked for
  /// The three points of C that span the supporting facet, when the upper bound is a facet's.
  std::array<SupportPoint, 3> facet;
  bool hasFacet = false;
  int supports = 0;  ///< support points spent
};

/// A cone around a local minimum of the depth that is taken for granted: with it the bounds only ask whether any
/// direction outside is shallower, which a coarse polytope answers. A ray outside the cone leaves a facet of normal m
/// and distance d no nearer than d / cos(angle - angle between m and the axis).
struct GrantedCone {
  Vec3 axis;            ///< unit, A's body axes
  double cosine, sine;  ///< of the angle
};

/// Bounds the overlap. start: a guess of the normal (unit, from A to B); known: its depth if it is known to be the
/// least so far, else infinity; tolerance: m. Stops early when a separating direction turns up (upper < 0).
DepthBounds boundOverlap(Difference& c, const Vec3& start, double known, double tolerance,
                         const GrantedCone* granted = nullptr);

/// The same with eight times as many corners, at some sixty times the cost, where those ran out.
DepthBounds boundOverlapFinely(Difference& c, const Vec3& start, double known, double tolerance);

}  // namespace granular
