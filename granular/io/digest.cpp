#include "granular/io/digest.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace granular {
namespace {

// Fractional parts of the cube roots of the first 64 primes.
constexpr std::uint32_t constants[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

}  // namespace

void Digest::compress(const std::byte* block) {
  // The message schedule.
  std::uint32_t w[64];
  for (int t = 0; t < 16; ++t) {
    w[t] = 0;
    for (int k = 0; k < 4; ++k) w[t] = (w[t] << 8) | std::to_integer<std::uint32_t>(block[4 * t + k]);
  }
  for (int t = 16; t < 64; ++t) {
    const std::uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ (w[t - 15] >> 3);
    const std::uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ (w[t - 2] >> 10);
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }

  // Sixty-four rounds on the eight working variables.
  std::array<std::uint32_t, 8> v = state;
  for (int t = 0; t < 64; ++t) {
    const std::uint32_t s1 = std::rotr(v[4], 6) ^ std::rotr(v[4], 11) ^ std::rotr(v[4], 25);
    const std::uint32_t choice = (v[4] & v[5]) ^ (~v[4] & v[6]);
    const std::uint32_t t1 = v[7] + s1 + choice + constants[t] + w[t];
    const std::uint32_t s0 = std::rotr(v[0], 2) ^ std::rotr(v[0], 13) ^ std::rotr(v[0], 22);
    const std::uint32_t majority = (v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]);
    for (std::size_t k = 7; k > 0; --k) v[k] = v[k - 1];
    v[4] += t1;
    v[0] = t1 + s0 + majority;
  }
  for (std::size_t k = 0; k < 8; ++k) state[k] += v[k];
}

void Digest::add(std::span<const std::byte> bytes) {
  total += bytes.size();
  if (pendingCount > 0) {
    const std::size_t taken = std::min(bytes.size(), pending.size() - pendingCount);
    std::copy_n(bytes.begin(), taken, pending.begin() + static_cast<std::ptrdiff_t>(pendingCount));
    pendingCount += taken;
    bytes = bytes.subspan(taken);
    if (pendingCount < pending.size()) return;
    compress(pending.data());
    pendingCount = 0;
  }
  for (; bytes.size() >= pending.size(); bytes = bytes.subspan(pending.size())) compress(bytes.data());
  std::copy(bytes.begin(), bytes.end(), pending.begin());
  pendingCount = bytes.size();
}

std::array<std::uint8_t, 32> Digest::finish() {
  // A one bit, zeros up to the last eight bytes of a block, the length in bits.
  const std::uint64_t bits = total * 8;
  const std::byte one{0x80}, zero{0};
  add({&one, 1});
  while (pendingCount != 56) add({&zero, 1});
  for (int shift = 56; shift >= 0; shift -= 8) {
    const std::byte byte{static_cast<std::uint8_t>(bits >> shift)};
    add({&byte, 1});
  }
  std::array<std::uint8_t, 32> result;
  for (std::size_t k = 0; k < 32; ++k) result[k] = static_cast<std::uint8_t>(state[k / 4] >> (24 - 8 * (k % 4)));
  return result;
}

std::string Digest::finishHex() {
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : finish()) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

}  // namespace granular
