// What contact laws read of a body's motion, side by side: one row in two lines of the cache, in place of six arrays,
// and turned into lanes within registers (core/rows.h).
#pragma once

#include <vector>

#include "granular/body/bodies.h"

namespace granular {

/// As in Bodies.
struct alignas(64) MotionRow {
  Vec3 v, w;
  double inverseMass, radiusRatio;
  Vec3 vHalf, spinHalf;
  double unused[2];  // written with the rest: whole lines need not be read first

  MotionRow() = default;
  MotionRow(const Bodies& bodies, std::size_t i)
      : v(bodies.v[i]),
        w(bodies.w[i]),
        inverseMass(bodies.inverseMass[i]),
        radiusRatio(bodies.radiusRatio[i]),
        vHalf(bodies.vHalf[i]),
        spinHalf(bodies.spinHalf[i]),
        unused{} {}
  /// Its eight numbers up to radiusRatio, and the six after it.
  const double* atStep() const { return v.data(); }
  const double* atHalfStep() const { return vHalf.data(); }
};
static_assert(sizeof(MotionRow) == 128);

/// Where a ball is, in half a line of the cache.
struct alignas(32) BallRow {
  Vec3 x;
  double radius;
};
static_assert(sizeof(BallRow) == 4 * sizeof(double));  // a row of numbers

/// By slot; those of bodies that nobody meets hold nothing of use.
struct MotionRows {
  std::vector<MotionRow> motion;
  std::vector<BallRow> balls;  ///< empty unless balls meet
  /// Bodies::changes when they were last laid out; those of bodies that don't move hold until it grows.
  std::uint64_t changes = ~std::uint64_t{0};

  void resize(std::size_t bodies, bool anyBalls) {
    motion.resize(bodies);
    balls.resize(anyBalls ? bodies : 0);
  }
  void put(const Bodies& bodies, std::size_t i) {
    motion[i] = MotionRow(bodies, i);
    if (!balls.empty()) balls[i] = {bodies.x[i], bodies.boundingRadius[i]};
  }
};

}  // namespace granular
