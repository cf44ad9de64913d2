// What contact laws read of a body's motion, side by side: one row in two lines of the cache, in place of six arrays,
// and turned into lanes within registers (core/rows.h).
#pragma once

#include "granular/body/bodies.h"

namespace granular {

/// As in Bodies.
struct alignas(64) MotionRow {
  Vec3 v, w;
  double inverseMass, radiusRatio;
  Vec3 vHalf, spinHalf;

  MotionRow() = default;
  MotionRow(const Bodies& bodies, std::size_t i)
      : v(bodies.v[i]),
        w(bodies.w[i]),
        inverseMass(bodies.inverseMass[i]),
        radiusRatio(bodies.radiusRatio[i]),
        vHalf(bodies.vHalf[i]),
        spinHalf(bodies.spinHalf[i]) {}
  /// Its eight numbers up to radiusRatio, and the six after it.
  const double* atStep() const { return v.data(); }
  const double* atHalfStep() const { return vHalf.data(); }
};
static_assert(sizeof(MotionRow) == 128);

}  // namespace granular
