// What the stages of a step read of a body at once, side by side: rows of whole or half lines of the cache, which are
// turned into lanes within registers (core/rows.h).
#pragma once

#include "granular/core/math.h"

namespace granular {

/// The sphere about a body's centre of mass that holds it.
struct alignas(32) BoundingSphere {
  Vec3 x;         ///< the body's position at t_n, m
  double radius;  ///< m
};
static_assert(sizeof(BoundingSphere) == 4 * sizeof(double));  // a row of numbers

/// How a body moves, and what resists it. Velocities m/s, angular velocities rad/s, world axes.
struct alignas(64) MotionRow {
  Vec3 v, w;           ///< at t_n (predicted)
  double radiusRatio;  ///< <r^2>/<I> of S 13, 1/kg
  double unused = 0;
  Vec3 vHalf;          ///< at the half step
  double inverseMass;  ///< 1/kg; 0 for bodies that are frozen
  Vec3 spinHalf;       ///< at the half step
  double inertia;      ///< of a ball, about any axis, kg m^2

  /// Its two halves of eight numbers each.
  const double* now() const { return v.data(); }
  double* now() { return v.data(); }
  const double* half() const { return vHalf.data(); }
  double* half() { return vHalf.data(); }
};
static_assert(sizeof(MotionRow) == 16 * sizeof(double));

}  // namespace granular
