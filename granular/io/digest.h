// SHA-256 (FIPS 180-4): tells a damaged checkpoint from a whole one, and one state of a run from another.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace granular {

class Digest {
 public:
  void add(std::span<const std::byte> bytes);
  /// Ends the message; nothing may be added afterwards.
  std::array<std::uint8_t, 32> finish();
  /// finish() as 64 hexadecimal digits.
  std::string finishHex();

 private:
  void compress(const std::byte* block);

  std::array<std::uint32_t, 8> state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::byte, 64> pending{};
  std::size_t pendingCount = 0;
  std::uint64_t total = 0;  ///< bytes
};

}  // namespace granular
