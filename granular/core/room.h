// Vectors with little more room than they use: twice as much, as they make it by themselves, is too much where there
// are many.
#pragma once

#include <cstddef>
#include <vector>

namespace granular {

/// Makes room for a sixteenth more than so many items, if there is none for these.
template <class Item>
void reserveClosely(std::vector<Item>& items, std::size_t count) {
  if (count > items.capacity()) items.reserve(count + count / 16);
}
template <class Item>
void resizeClosely(std::vector<Item>& items, std::size_t count) {
  reserveClosely(items, count);
  items.resize(count);
}

/// Gives back the room that is left over if it is much.
template <class Item>
void trim(std::vector<Item>& items) {
  constexpr std::size_t few = 16;
  if (items.capacity() > items.size() + items.size() / 4 + few) items.shrink_to_fit();
}

/// Forgets all items and gives back their room, which `items = {}` keeps.
template <class Item>
void discard(std::vector<Item>& items) {
  std::vector<Item>().swap(items);
}

}  // namespace granular
