// The deepest point, halfway between the two surfaces: what most DEM codes take.
#pragma once

#include "granular/point/contact_point.h"

namespace granular {

/// A point contact at x, pushed apart by k_n times the overlap.
inline void placePoint(const Vec3& x, const Vec3& u, double overlap, ContactPatch& out) {
  out.point = out.centre = x;
  out.u = u;
  out.area = out.uu = out.vv = out.uv = 0;
  out.depth = overlap;
  out.squaredDepth = overlap * overlap;
  out.share = 1;
}

inline void placeWitness(const Touch& touch, ContactPatch& out) {
  placePoint(0.5 * (touch.onA + touch.onB), perpendicular(touch.normal), touch.overlap, out);
}

}  // namespace granular
