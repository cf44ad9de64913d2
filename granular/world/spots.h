// The histories of pairs that may have several contacts.
#pragma once

#include <vector>

#include "granular/pair/pair_list.h"

namespace granular {

/// Keeps the history of the spots that still touch, in the order of the pair's contacts; new spots start at zero.
/// nameOf(k): the Spot of contact k of `count`.
template <class NameOf>
void matchSpots(std::vector<SpotHistory>& spots, std::size_t count, NameOf&& nameOf) {
  bool same = spots.size() == count;
  for (std::size_t k = 0; k < count && same; ++k) same = spots[k].spot == nameOf(k);
  if (same) return;
  std::vector<SpotHistory> matched(count);
  for (std::size_t k = 0; k < count; ++k) {
    matched[k].spot = nameOf(k);
    for (const SpotHistory& old : spots) {
      if (old.spot == matched[k].spot) matched[k] = old;
    }
  }
  spots.swap(matched);
}

}  // namespace granular
