// Items taken in an order.
#pragma once

#include <cstdint>
#include <vector>

namespace granular {

/// items[order[0]], items[order[1]], ...: moved out of items, which must hold them all.
template <class Item>
std::vector<Item> pick(std::vector<Item>& items, const std::vector<std::int32_t>& order) {
  std::vector<Item> picked;
  picked.reserve(order.size());
  for (const std::int32_t k : order) picked.push_back(std::move(items[static_cast<std::size_t>(k)]));
  return picked;
}

}  // namespace granular
