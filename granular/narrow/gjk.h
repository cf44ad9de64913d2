// The point of C = A - B nearest to a given point: the algorithm of Gilbert, Johnson and Keerthi 1988, with the
// signed-volume sub-algorithm of Montanari, Petrinic and Barbieri 2017, in double precision. It ends by the duality
// gap, so that every answer carries its own proof: a direction whose supporting plane keeps the point out of C.
#pragma once

#include "granular/narrow/difference.h"

namespace granular {

/// A's body axes, m.
struct Nearest {
  bool inside = false;                          ///< the point lies in C, or so near that round-off hides it
  Vec3 offset = Vec3::Zero();                   ///< nearest point of C minus the given point
  double distance = 0;                          ///< |offset|
  Vec3 onA = Vec3::Zero(), onB = Vec3::Zero();  ///< makings of the nearest point: onA - onB = given point + offset
  /// Unit direction from C to the point, and the proven distance along it: n . point - h(n) = gap <= true distance.
  Vec3 direction = Vec3::UnitX();
  double gap = -infinity;
};

/// Nearest point of C to `point`. start: a guess (any length > 0) of the direction from C to the point; precision:
/// relative duality gap at which to stop (distance - gap <= precision * distance), no finer than round-off allows.
Nearest findNearest(Difference& c, const Vec3& point, const Vec3& start, double precision);

}  // namespace granular
