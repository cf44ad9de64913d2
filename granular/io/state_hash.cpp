#include "granular/io/state_hash.h"

#include "granular/io/digest.h"

namespace granular {

std::string hashState(const Bodies& bodies) {
  Digest digest;
  for (const std::int32_t slot : bodies.slotsById()) {
    const auto i = static_cast<std::size_t>(slot);
    digest.add(std::as_bytes(std::span(&bodies.id[i], 1)));
    digest.add(std::as_bytes(std::span<const double>(bodies.x(i).data(), 3)));
    digest.add(std::as_bytes(std::span<const double>(bodies.orientation(i).coeffs().data(), 4)));
    digest.add(std::as_bytes(std::span<const double>(bodies.v(i).data(), 3)));
    digest.add(std::as_bytes(std::span<const double>(bodies.w(i).data(), 3)));
  }
  return digest.finishHex();
}

}  // namespace granular
