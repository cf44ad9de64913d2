// Memory asked for before it is needed.
#pragma once

#include <cstddef>

namespace granular {

inline constexpr std::size_t cacheLine = 64;  ///< bytes

/// Starts to bring a thing of several lines into the cache.
template <class Thing>
void fetchWhole(const Thing& thing) {
  const auto* from = reinterpret_cast<const std::byte*>(&thing);
  for (std::size_t k = 0; k < sizeof(Thing); k += cacheLine) __builtin_prefetch(from + k);
}

/// Starts to bring all items of a vector into the cache, to be read or overwritten.
template <class Items>
void fetchAll(const Items& items) {
  const auto* from = reinterpret_cast<const std::byte*>(items.data());
  for (std::size_t k = 0; k < items.size() * sizeof(items[0]); k += cacheLine) __builtin_prefetch(from + k);
}

}  // namespace granular
