#include "granular/io/state_hash.h"

#include <algorithm>
#include <numeric>

#include "granular/io/digest.h"

namespace granular {

std::string hashState(const Bodies& bodies) {
  std::vector<std::size_t> slots(bodies.size());
  std::iota(slots.begin(), slots.end(), std::size_t{0});
  std::sort(slots.begin(), slots.end(), [&](std::size_t i, std::size_t j) { return bodies.id[i] < bodies.id[j]; });
  Digest digest;
  for (const std::size_t i : slots) {
    digest.add(std::as_bytes(std::span(&bodies.id[i], 1)));
    digest.add(std::as_bytes(std::span<const double>(bodies.x[i].data(), 3)));
    digest.add(std::as_bytes(std::span<const double>(bodies.q[i].coeffs().data(), 4)));
    digest.add(std::as_bytes(std::span<const double>(bodies.v[i].data(), 3)));
    digest.add(std::as_bytes(std::span<const double>(bodies.w[i].data(), 3)));
  }
  return digest.finishHex();
}

}  // namespace granular
