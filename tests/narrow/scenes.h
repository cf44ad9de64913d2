// Poses and pairs that the narrow phase's tests share.
#pragma once

#include <memory>
#include <vector>

#include "granular/core/random.h"
#include "granular/narrow/exhaustive.h"
#include "granular/narrow/narrow.h"
#include "granular/shape/polyhedron.h"

namespace granular::testing {

/// The hull of random points on an ellipsoid.
inline std::unique_ptr<Polyhedron> makeRock(Random& random, int points, double radius, const Vec3& stretch) {
  std::vector<Vec3> cloud;
  for (int k = 0; k < points; ++k) cloud.push_back((radius * random.direction()).cwiseProduct(stretch));
  return std::make_unique<Polyhedron>(cloud);
}

inline Frame randomFrame(Random& random, double spread) {
  return Frame(Pose{spread * random.direction() * random.uniform(), random.rotation()});
}

/// Moves B along the direction d until the pair's exhaustive depth is the one wanted (m), by secant steps on B's
/// distance: the depth along the minimal normal falls by n.d per metre.
inline void setDepth(const Shape& a, const Frame& frameA, const Shape& b, const Vec3& d, double wanted, Frame& frameB) {
  for (int k = 0; k < 60; ++k) {
    const ExhaustiveDepth now = searchExhaustively(a, frameA, b, frameB, 500);
    const double off = now.depth - wanted;
    if (std::abs(off) < 1e-3 * std::abs(wanted)) return;
    const double slope = now.normal.dot(d);
    frameB.x += (std::abs(slope) > 0.1 ? off / slope : off) * d;
  }
}

}  // namespace granular::testing
