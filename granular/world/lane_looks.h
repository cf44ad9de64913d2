// Looks at the pairs of a chunk in batches: what cuboids, polyhedra and cylinders share. In a bed nearly all pairs
// touch as they did in the last step: along the same face, or across the same edges. They are looked at side by side,
// and placed while their geometry is at hand. Whatever is not proven there, a tie, another feature, a sliver, a birth,
// goes the general way. A pair's answer does not depend on who shares its batch. Chunks of several kinds are looked at
// one by one.
#pragma once

#include <tuple>

#include "granular/narrow/kernels.h"
#include "granular/point/patch_lanes.h"
#include "granular/world/lane_groups.h"
#include "granular/world/looks.h"

namespace granular {

/// Kind, which is derived from this, says what differs:
///   bool add(contact, cache)           the pair's group takes it by its last feature, or false: it can't
///   void begin(group)                  looks at a group, the last of which may be part full, and begins the
///                                      integrals of touchingLanes() if places()
///   void finishOverlaps()              completes all integrals begun
///   TouchingFeature nameFeature(contact, cache)
///   void fetchWhere(pair)              starts to bring what a look will read, in two steps; default: its
///   void fetchWhat(pair)               cache
///   void nameApart(pair, cache)        before a touching pair is remembered as apart
///   PatchLanes placeGroup(group)       ends the integrals; default: endOverlap(look, sums, rule)
/// Group...: one for each kind of look.
template <class Kind, class... Group>
class LaneLooks {
 public:
  /// Finds the contacts of chunk c.
  void takeChunk(std::size_t c) {
    std::array<std::size_t, World::chunkSize> due;
    std::array<std::uint16_t, World::chunkSize> dueOf;  // the one that a contact belongs to
    const std::size_t dueCount = listDue(world, c, due.data());
    const auto pairAt = [&](std::size_t k) -> const Pair& {
      return world.pairs.pairs[static_cast<std::size_t>(world.activePairs[due[k]])];
    };
    constexpr std::size_t farAhead = 8, nextAhead = 4;
    for (std::size_t k = 0; k < dueCount; ++k) {
      if (k + farAhead < dueCount) kind().fetchWhere(pairAt(k + farAhead));
      if (k + nextAhead < dueCount) kind().fetchWhat(pairAt(k + nextAhead));
      const std::size_t before = chunk.contacts.size();
      take(world.activePairs[due[k]]);
      if (chunk.contacts.size() > before) {
        dueOf[before] = static_cast<std::uint16_t>(k);
      } else {
        chunk.due.apart.set(k);
      }
    }
    (finish(groups<Group>()), ...);
    keepTouching(dueOf.data(), world, chunk);
  }

  template <class One>
  PatchLanes placeGroup(const One& group) const {
    return endOverlap(group.look, group.sums, world.options.rule);
  }
  void fetchWhere(const Pair&) const {}
  void fetchWhat(const Pair& pair) const { __builtin_prefetch(&cacheOf(pair)); }

 protected:
  /// placesThese: the rule is one that places in lanes.
  LaneLooks(World& chosen, World::Chunk& into, bool placesThese) : world(chosen), chunk(into), placing(placesThese) {}
  LaneLooks(World& chosen, World::Chunk& into) : LaneLooks(chosen, into, placesInLanes(chosen.options.rule.rule)) {}

  bool places() const { return placing; }
  /// The contact being added.
  std::size_t last() const { return chunk.contacts.size() - 1; }

  /// Groups of one kind; those closed wait for their integrals.
  template <class One>
  struct Groups {
    static constexpr std::size_t most = 2;  // their lanes and integrals stay in the first cache
    std::array<One, most> all;
    std::size_t closed = 0;
    One& open() { return all[closed]; }
  };
  template <class One>
  Groups<One>& groups() {
    return std::get<Groups<One>>(ofKinds);
  }
  template <class One>
  void closeIfFull(Groups<One>& some) {
    if (some.open().count == wideSize) close(some);
  }

  World& world;
  World::Chunk& chunk;

 private:
  Kind& kind() { return static_cast<Kind&>(*this); }
  WarmCache& cacheOf(const Pair& pair) const { return world.pairs.memory.cache[static_cast<std::size_t>(pair.slot)]; }

  /// Looks at a pair that is due; its contact, if there is one, is the chunk's next.
  void take(std::int32_t index) {
    const Pair& pair = world.pairs.pairs[static_cast<std::size_t>(index)];
    std::vector<Contact>& held = world.pairs.memory.held;
    const auto slot = static_cast<std::size_t>(pair.slot);
    if (slot < held.size()) held[slot].a = -1;
    const WarmCache& cache = cacheOf(pair);
    if (cache.touched == 0) {
      Look look;
      if (!beginLook(world, index, look)) return;
      Touch touch;
      const bool touching = takeLook(world, look, chunk, touch);
      return endLook(world, look, touching, touch, chunk);
    }
    Contact& contact = chunk.contacts.emplace_back();
    contact.pair = index;
    contact.a = pair.a;
    contact.b = pair.b;
    contact.shift = world.options.periods.shift(pair.image);
    if (!kind().add(contact, cache)) takeAlone({last(), index, true});
  }

  /// Takes the looks of the open group; ends all when there is no room for another.
  template <class One>
  void close(Groups<One>& some) {
    kind().begin(some.open());
    if (++some.closed == Groups<One>::most) endAll(some);
  }

  /// Ends the looks of all groups, the open one of which may be part full, and empties them.
  template <class One>
  void finish(Groups<One>& some) {
    if (some.open().count > 0) close(some);
    if (some.closed > 0) endAll(some);
  }
  template <class One>
  void endAll(Groups<One>& some) {
    kind().finishOverlaps();
    for (std::size_t g = 0; g < some.closed; ++g) end(some.all[g]);
    some.closed = 0;
  }

  template <class One>
  void end(One& group) {
    const auto& look = group.look;
    const auto x = spreadOut(look.x), z = spreadOut(look.z), middle = spreadOut(look.middle);
    for (std::size_t k = 0; k < group.count; ++k) {
      const Waiting& one = group.waiting[k];
      const bool apart = !(look.depth[k] > 0);
      if (look.holds[k] == 0 || (!apart && look.proven[k] == 0)) {
        takeAlone(one);
      } else {
        ++chunk.counts.warm;
        const Vec3 normal = one.seatIsA ? z.take(k) : Vec3(-z.take(k));
        apart ? part(one, normal, -look.depth[k]) : touch(one, normal, look.depth[k], middle.take(k));
      }
    }
    if (placing) place(group, x);
    group.count = 0;
  }

  /// The general way, from a look begun anew.
  void takeAlone(const Waiting& one) {
    Look look;
    beginLook(world, one.index, look);
    Contact& contact = chunk.contacts[one.contact];
    if (takeLook(world, look, chunk, contact.touch)) return;
    waitForGap(world, look);
    contact.a = -1;
  }

  void part(const Waiting& one, const Vec3& normal, double gap) {
    Look look;
    beginLook(world, one.index, look);
    const Pair& pair = world.pairs.pairs[static_cast<std::size_t>(one.index)];
    WarmCache& cache = cacheOf(pair);
    kind().nameApart(pair, cache);
    reportApart(world.bodies.frame[static_cast<std::size_t>(pair.a)].unrotate(normal), gap, cache);
    waitForGap(world, look);
    chunk.contacts[one.contact].a = -1;
  }

  void touch(const Waiting& one, const Vec3& normal, double depth, const Vec3& middle) {
    Contact& contact = chunk.contacts[one.contact];
    WarmCache& cache = cacheOf(world.pairs.pairs[static_cast<std::size_t>(one.index)]);
    const Vec3 outOfA = world.bodies.frame[static_cast<std::size_t>(contact.a)].unrotate(normal);
    rememberTouch(static_cast<WarmCache::Kind>(cache.kind), outOfA, cache, chunk.counts);
    contact.touch.normal = normal;
    contact.touch.overlap = depth;
    contact.touch.placeAbout(seatPlace(one, contact) + middle);
    if (!placing) contact.touch.feature = kind().nameFeature(contact, cache);
  }

  Vec3 seatPlace(const Waiting& one, const Contact& contact) const {
    const Bodies& bodies = world.bodies;
    return one.seatIsA ? bodies.x(static_cast<std::size_t>(contact.a))
                       : Vec3(bodies.x(static_cast<std::size_t>(contact.b)) + contact.shift);
  }

  /// Places the contacts; the feature is named for those that will be placed one by one.
  template <class One>
  void place(const One& group, const TripleLanes<wideSize>& x) {
    const auto& look = group.look;
    const PatchLanes patch = kind().placeGroup(group);
    const Mask<Wide> touching = touchingLanes(group);
    const auto point = spreadOut(patch.point), centre = spreadOut(patch.centre);
    for (std::size_t k = 0; k < group.count; ++k) {
      const Waiting& one = group.waiting[k];
      if (touching[k] == 0) continue;
      Contact& contact = chunk.contacts[one.contact];
      if (patch.good[k] == 0) {
        const WarmCache& cache = cacheOf(world.pairs.pairs[static_cast<std::size_t>(one.index)]);
        contact.touch.feature = kind().nameFeature(contact, cache);
        continue;
      }
      placeFromLane(patch, point, centre, x, look.depth[k], one.seatIsA, seatPlace(one, contact), k, contact);
    }
  }

  std::tuple<Groups<Group>...> ofKinds;
  const bool placing;
};

}  // namespace granular
