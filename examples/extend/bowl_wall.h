// A wall of one's own: the inside of a sphere. A body touches it where it is furthest from the centre.
#pragma once

#include <fmt/format.h>

#include "granular/core/errors.h"
#include "granular/wall/wall.h"

namespace extend {

using namespace granular;

/// Bodies live inside. Right for spheres, for clumps, which come sphere by sphere, and for other bodies while one point
/// of them is deepest; a body that stands on several corners needs a spot for each, as in
/// granular/wall/vessel_wall.cpp.
class BowlWall final : public Wall {
 public:
  /// Both in m.
  BowlWall(const Vec3& centre, double radius) : centre(centre), radius(radius) {
    require(centre.allFinite() && std::isfinite(radius) && radius > 0,
            fmt::format("bowl: radius = {} m: it must be finite and > 0, and so must be the centre", radius));
  }

  void touch(const RuleOptions& /*rule*/, const Shape& shape, const Frame& frame,
             std::vector<WallTouch>& out) const override {
    if (clearance(frame.x, shape.boundingRadius()) > 0) return;
    // The support point towards itself: each round is no nearer to the wall than the one before.
    Vec3 deepest = frame.x;
    for (int round = 0; round < 50; ++round) {
      const Vec3 outwards = deepest - centre;
      const Vec3 next = frame.toWorld(shape.support(frame.unrotate(outwards)));
      const bool same = (next - deepest).norm() < 1e-12 * radius;
      deepest = next;
      if (same) break;
    }
    const double distance = (deepest - centre).norm(), overlap = distance - radius;
    if (!(overlap > 0)) return;

    WallTouch& found = out.emplace_back();
    found.normal = (deepest - centre) / distance;
    found.overlap = overlap;
    found.spot = 0;
    found.share = 1;
    // A point contact, halfway between the two surfaces.
    found.patch.point = found.patch.centre = deepest - 0.5 * overlap * found.normal;
    found.patch.u = perpendicular(found.normal);
    found.patch.depth = overlap;
    found.patch.squaredDepth = overlap * overlap;
  }

  double clearance(const Vec3& x, double bound) const override { return radius - (x - centre).norm() - bound; }
  bool admits(const Vec3& p) const override { return (p - centre).norm() < radius; }

  /// Hollow by 1/radius in both directions along the surface, which only Hertz's laws ask for.
  Mat3 curvatureAt(const Vec3& p) const override {
    const Vec3 n = (p - centre).normalized();
    return (n * n.transpose() - Mat3::Identity()) / radius;
  }
  bool isFlat() const override { return false; }

  std::string describe() const override { return fmt::format("inside of a sphere of radius {} m", radius); }

 private:
  Vec3 centre;
  double radius;
};

}  // namespace extend
