// The pairs whose bounds are near: light entries in key order, and the heavier memory of each pair in stable slots, so
// that a new search moves only the entries.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "granular/core/pick.h"
#include "granular/core/room.h"
#include "granular/pair/child_pair.h"
#include "granular/pair/contact.h"
#include "granular/pair/history.h"
#include "granular/pair/manifold.h"
#include "granular/pair/warm_cache.h"

namespace granular {

/// How many periods B's image is away from its stored position.
using Image = std::array<std::int32_t, 3>;

/// Two bodies whose grown bounds overlap; a has the lower id. Sorted by (a, b, image).
struct Pair {
  std::int32_t a, b;  ///< slots in Bodies
  std::int32_t slot;  ///< in PairMemory
  Image image;
  /// The pair cannot touch before travel[a] + travel[b] reaches this, m.
  double quietUntil;
};

/// The order of the pair list.
inline bool comesBefore(const Pair& p, const Pair& q) {
  if (p.a != q.a) return p.a < q.a;
  if (p.b != q.b) return p.b < q.b;
  return p.image < q.image;
}

/// History of one contact among several of a pair: walls, clumps and the `manifold` rule.
struct SpotHistory {
  Spot spot;
  ContactHistory history;
  SpringEnergy energy;
};

/// A body near a wall. Sorted by (body, wall).
struct WallPair {
  std::int32_t body, wall;
  double quietUntil;               ///< as for Pair, with the wall's travel
  std::vector<SpotHistory> spots;  ///< of the contacts of the last step, by spot
  std::vector<Contact> held;       ///< the contacts of a body at rest
  ChildList children;              ///< of a clump near the wall
};

/// What the `manifold` rule remembers of a pair.
struct ManifoldMemory {
  Manifold manifold;
  std::vector<SpotHistory> spots;  ///< of the contacts of the last step, by spot
};

/// What is remembered of a pair with a clump.
struct ClumpMemory {
  ChildList children;
  std::vector<WarmCache> caches;   ///< one per entry of children.near; empty where balls meet balls
  std::vector<SpotHistory> spots;  ///< of the contacts of the last step, by spot
  std::vector<Contact> held;       ///< the contacts of a pair at rest
};

/// Memory of pairs, one slot each; freed slots are used again.
struct PairMemory {
  std::size_t slots = 0;                ///< how many there are
  std::vector<ContactHistory> history;  ///< empty where chunks of spheres keep theirs (fileHistories)
  std::vector<WarmCache> cache;         ///< empty, or too short for all, where batches of balls keep none
  std::vector<Contact> held;            ///< the last contact of a pair at rest (a < 0: none); empty unless bodies sleep
  std::vector<ManifoldMemory> manifolds;  ///< empty unless the rule is `manifold`
  std::vector<ClumpMemory> clumps;        ///< empty unless there are clumps
  std::vector<SpringEnergy> energy;       ///< of the springs; empty unless an energy ledger is kept
  std::vector<std::int32_t> free;

  std::size_t size() const { return slots; }
  /// Makes room for the histories of all slots.
  void makeHistories() { resizeClosely(history, slots); }
  std::int32_t take() {
    if (free.empty()) return static_cast<std::int32_t>(slots++);
    const std::int32_t slot = free.back();
    free.pop_back();
    const auto k = static_cast<std::size_t>(slot);
    if (k < history.size()) history[k] = ContactHistory{};
    if (k < cache.size()) cache[k] = WarmCache{};
    if (k < manifolds.size()) manifolds[k] = ManifoldMemory{};
    if (k < clumps.size()) clumps[k] = ClumpMemory{};
    if (k < energy.size()) energy[k] = SpringEnergy{};
    if (k < held.size()) held[k].a = -1;
    return slot;
  }
  void give(std::int32_t slot) { free.push_back(slot); }

  /// The memory in slot order[k] moves to slot k; what order does not name is forgotten.
  void rearrange(const std::vector<std::int32_t>& order) {
    const auto lay = [&](auto& column) {
      if (column.empty()) return;
      column.resize(size());
      column = pick(column, order);
    };
    lay(held);
    lay(cache);
    lay(manifolds);
    lay(clumps);
    lay(energy);
    lay(history);
    slots = order.size();
    free.clear();
  }

  /// Calls visit(contact) for every held contact of a pair.
  template <class Visitor>
  void visitHeld(const Pair& pair, Visitor&& visit) {
    const auto slot = static_cast<std::size_t>(pair.slot);
    if (slot < held.size() && held[slot].a >= 0) visit(held[slot]);
    if (slot >= clumps.size()) return;
    for (Contact& contact : clumps[slot].held) visit(contact);
  }
  template <class Visitor>
  void visitHeld(const Pair& pair, Visitor&& visit) const {
    const_cast<PairMemory*>(this)->visitHeld(pair, [&](const Contact& contact) { visit(contact); });
  }
};

struct PairList {
  std::vector<Pair> pairs;
  PairMemory memory;
  std::vector<WallPair> wallPairs;
};

}  // namespace granular
