#include "granular/core/random.h"

#include <bit>

namespace granular {

Random::Random(std::uint64_t seed) {
  // splitmix64 spreads a small seed over the whole state.
  for (std::uint64_t& word : words) {
    seed += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = seed;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    word = z ^ (z >> 31);
  }
}

std::uint64_t Random::bits() {
  const std::uint64_t result = std::rotl(words[0] + words[3], 23) + words[0];
  const std::uint64_t t = words[1] << 17;
  words[2] ^= words[0];
  words[3] ^= words[1];
  words[1] ^= words[2];
  words[0] ^= words[3];
  words[2] ^= t;
  words[3] = std::rotl(words[3], 45);
  return result;
}

double Random::uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

std::uint64_t Random::below(std::uint64_t n) {
  // Values past the largest multiple of n are drawn again, so that every remainder is equally likely.
  const std::uint64_t excess = (UINT64_MAX % n + 1) % n;
  std::uint64_t value = bits();
  while (value > UINT64_MAX - excess) value = bits();
  return value % n;
}

double Random::normal() {
  // Box and Muller's transform; 1 - u lies in (0, 1].
  const double radius = std::sqrt(-2 * std::log(1 - uniform()));
  return radius * std::cos(2 * pi * uniform());
}

Vec3 Random::direction() {
  const double z = uniform(-1, 1);
  const double azimuth = uniform(0, 2 * pi);
  const double s = std::sqrt(1 - z * z);
  return {s * std::cos(azimuth), s * std::sin(azimuth), z};
}

Quat Random::rotation() {
  // Shoemake 1992: uniform on the 3-sphere.
  const double u = uniform();
  const double a = uniform(0, 2 * pi);
  const double b = uniform(0, 2 * pi);
  return {std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a),
          std::sqrt(u) * std::sin(b)};
}

}  // namespace granular
