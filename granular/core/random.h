// Random numbers that are the same on every machine and can be saved: xoshiro256++ (Blackman & Vigna 2019), and the few
// distributions the project needs, written out because the standard library's differ between implementations.
#pragma once

#include <array>
#include <cstdint>

#include "granular/core/math.h"

namespace granular {

class Random {
 public:
  explicit Random(std::uint64_t seed = 1);

  /// 64 random bits.
  std::uint64_t bits();
  /// Uniform in [0, 1).
  double uniform();
  /// Uniform in [lo, hi).
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Uniform in 0 ... n-1; n > 0.
  std::uint64_t below(std::uint64_t n);
  /// Standard normal; keeps no spare value, so that the state is the four words alone.
  double normal();
  /// Uniform on the unit sphere.
  Vec3 direction();
  /// Three numbers by draw(), the last component first. (Arguments of a constructor are drawn in an order that is the
  /// compiler's choice.)
  template <class Draw>
  static Vec3 drawComponents(const Draw& draw) {
    Vec3 v;
    for (int k = 2; k >= 0; --k) v[k] = draw();
    return v;
  }
  /// Uniform on the rotation group.
  Quat rotation();

  /// The whole state, for a checkpoint.
  const std::array<std::uint64_t, 4>& state() const { return words; }
  void setState(const std::array<std::uint64_t, 4>& saved) { words = saved; }

 private:
  std::array<std::uint64_t, 4> words;
};

}  // namespace granular
