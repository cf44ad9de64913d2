// Two balls: the one closed form that spheres and the children of clumps share, so that a clump of one sphere moves as
// the sphere does, bit for bit.
#pragma once

#include "granular/pair/touch.h"

namespace granular {

struct BallLook {
  Vec3 normal;     ///< unit, from A to B; x for concentric balls
  double overlap;  ///< m; negative: minus the gap
};

inline BallLook lookAtBalls(const Vec3& a, double radiusA, const Vec3& b, double radiusB) {
  const Vec3 d = b - a;
  const double distance = d.norm();
  return {distance > 0 ? Vec3((1 / distance) * d) : Vec3(Vec3::UnitX()), radiusA + radiusB - distance};
}

/// The touch of two overlapping balls; a: centre of A, m.
inline void fillBallTouch(const BallLook& look, const Vec3& a, double radiusA, Touch& touch) {
  touch.take({look.normal, look.overlap, a + (radiusA - 0.5 * look.overlap) * look.normal});
}

}  // namespace granular
