// Contacts of cuboids in batches. In a bed nearly all pairs touch as they did in the last step: along the same face, or
// across the same edges. They are looked at side by side (narrow/cuboid_lanes.h), and under the rules `patch`,
// `stiff_patch` and `pressure_centroid` placed while their geometry is at hand (point/cuboid_overlap.h). Whatever is
// not proven there, a tie, another feature, a sliver, a birth, goes the general way. A pair's answer does not depend on
// who shares its batch.
#include "granular/narrow/kernels.h"
#include "granular/world/cuboid_groups.h"
#include "granular/world/looks.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

class CuboidLooks {
 public:
  CuboidLooks(World& chosen, World::Chunk& into)
      : world(chosen), chunk(into), places(placesInLanes(chosen.options.rule.rule)), overlaps(chosen.options.rule) {}

  /// Looks at a pair that is due; its contact, if there is one, is the chunk's next.
  void take(std::int32_t index) {
    const Pair& pair = world.pairs.pairs[at(index)];
    std::vector<Contact>& held = world.pairs.memory.held;
    if (at(pair.slot) < held.size()) held[at(pair.slot)].a = -1;
    const WarmCache& cache = world.pairs.memory.cache[at(pair.slot)];
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
    cache.kind == WarmCache::edgePair ? addEdges(contact, cache) : addFace(contact, cache);
  }

  /// Ends the looks begun. After that contacts whose `a` is -1 are none.
  void finish() {
    finish(faces);
    finish(edges);
  }

 private:
  static constexpr std::size_t most = 2;  // their lanes and cells stay in the first cache

  /// Groups of one kind; those closed wait for their integrals.
  template <class AnyLook>
  struct Groups {
    std::array<Group<AnyLook>, most> all;
    std::size_t closed = 0;
    Group<AnyLook>& open() { return all[closed]; }
  };

  /// Both bodies of a contact.
  struct Boxes {
    const Frame &frameA, &frameB;
    const Cuboid &a, &b;
    Vec3 between;
  };
  Boxes view(const Contact& contact) const {
    const Bodies& bodies = world.bodies;
    const std::size_t a = at(contact.a), b = at(contact.b);
    return {bodies.frame[a], bodies.frame[b], static_cast<const Cuboid&>(*bodies.shape[a]),
            static_cast<const Cuboid&>(*bodies.shape[b]), bodies.frame[b].x + contact.shift - bodies.frame[a].x};
  }

  void addFace(const Contact& contact, const WarmCache& cache) {
    const Boxes boxes = view(contact);
    const bool seatIsA = cache.kind == WarmCache::faceOfA;
    const Mat3 &seat = (seatIsA ? boxes.frameA : boxes.frameB).R, &guest = (seatIsA ? boxes.frameB : boxes.frameA).R;
    const Vec3& seatHalf = (seatIsA ? boxes.a : boxes.b).halfLengths();
    const Vec3& guestHalf = (seatIsA ? boxes.b : boxes.a).halfLengths();
    const int i = seatIsA ? cache.featureA : cache.featureB, k = i == 2 ? 0 : i + 1, l = 3 - i - k;
    Group<FaceLook<Wide>>& group = faces.open();
    group.add({chunk.contacts.size() - 1, contact.pair, seatIsA},
              {seat.col(k), seat.col(l), seat.col(i), guest.col(0), guest.col(1), guest.col(2),
               Vec3(seatHalf[k], seatHalf[l], seatHalf[i]), guestHalf, seatIsA ? boxes.between : Vec3(-boxes.between)},
              cuboidTie(boxes.a, boxes.b), boxes.a.innerRadius() + boxes.b.innerRadius());
    if (group.count == wideSize) close(faces);
  }

  void addEdges(const Contact& contact, const WarmCache& cache) {
    const Boxes boxes = view(contact);
    const Mat3 &seat = boxes.frameA.R, &guest = boxes.frameB.R;
    const Vec3 &seatHalf = boxes.a.halfLengths(), &guestHalf = boxes.b.halfLengths();
    const int i = cache.featureA, k = i == 2 ? 0 : i + 1, l = 3 - i - k;
    const int j = cache.featureB, m = j == 2 ? 0 : j + 1, o = 3 - j - m;
    Group<EdgeLook<Wide>>& group = edges.open();
    group.add(
        {chunk.contacts.size() - 1, contact.pair, true},
        {seat.col(i), seat.col(k), seat.col(l), guest.col(j), guest.col(m), guest.col(o),
         Vec3(seatHalf[i], seatHalf[k], seatHalf[l]), Vec3(guestHalf[j], guestHalf[m], guestHalf[o]), boxes.between},
        cuboidTie(boxes.a, boxes.b), boxes.a.innerRadius() + boxes.b.innerRadius());
    if (group.count == wideSize) close(edges);
  }

  template <class AnyLook>
  void begin(Group<AnyLook>& group) {
    lookAt(group);
    if (!places) return;
    const AnyLook& look = group.look;
    if (overlaps.cells.isFull(mostBoxCells)) overlaps.finish();
    // Lanes beyond the last pair are left out, so that no cell is integrated twice.
    Mask<Wide> chosen = both(both(look.holds, look.proven), look.depth > 0);
    for (std::size_t k = group.count; k < wideSize; ++k) chosen[k] = 0;
    beginOverlap(look, chosen, overlaps, group.sums);
  }

  static void lookAt(Group<FaceLook<Wide>>& group) { group.lookWith(lookAtFace<Wide>); }
  static void lookAt(Group<EdgeLook<Wide>>& group) { group.lookWith(lookAtEdges<Wide>); }

  /// Takes the looks of the open group; ends all when there is no room for another.
  template <class AnyLook>
  void close(Groups<AnyLook>& groups) {
    begin(groups.open());
    if (++groups.closed == most) endAll(groups);
  }

  /// Ends the looks of all groups, the open one of which may be part full, and empties them.
  template <class AnyLook>
  void finish(Groups<AnyLook>& groups) {
    if (groups.open().count > 0) close(groups);
    if (groups.closed > 0) endAll(groups);
  }
  template <class AnyLook>
  void endAll(Groups<AnyLook>& groups) {
    overlaps.finish();
    for (std::size_t g = 0; g < groups.closed; ++g) end(groups.all[g]);
    groups.closed = 0;
  }

  template <class AnyLook>
  void end(Group<AnyLook>& group) {
    const AnyLook& look = group.look;
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
    if (places) place(group, x);
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
    const Pair& pair = world.pairs.pairs[at(one.index)];
    reportApart(world.bodies.frame[at(pair.a)].unrotate(normal), gap, world.pairs.memory.cache[at(pair.slot)]);
    waitForGap(world, look);
    chunk.contacts[one.contact].a = -1;
  }

  void touch(const Waiting& one, const Vec3& normal, double depth, const Vec3& middle) {
    const Bodies& bodies = world.bodies;
    Contact& contact = chunk.contacts[one.contact];
    const Pair& pair = world.pairs.pairs[at(one.index)];
    WarmCache& cache = world.pairs.memory.cache[at(pair.slot)];
    const Vec3 outOfA = bodies.frame[at(contact.a)].unrotate(normal);
    if (cache.direction.dot(outOfA) < flipCosine) ++chunk.counts.normalFlips;
    cache.direction = outOfA;
    cache.budget = 0;
    contact.touch.normal = normal;
    contact.touch.overlap = depth;
    const Vec3 place = seatPlace(one, contact) + middle;
    contact.touch.onA = place + (0.5 * depth) * normal;
    contact.touch.onB = place - (0.5 * depth) * normal;
    if (!places) nameFeature(contact, cache);
  }

  /// For those who place the contact one by one.
  void nameFeature(Contact& contact, const WarmCache& cache) const {
    const Vec3 outOfB = -world.bodies.frame[at(contact.b)].unrotate(contact.touch.normal);
    contact.touch.feature = nameCuboidFeature(cache, cache.direction, outOfB);
  }

  Vec3 seatPlace(const Waiting& one, const Contact& contact) const {
    return one.seatIsA ? world.bodies.x[at(contact.a)] : Vec3(world.bodies.x[at(contact.b)] + contact.shift);
  }

  template <class AnyLook>
  void place(const Group<AnyLook>& group, const TripleLanes<wideSize>& x) {
    const AnyLook& look = group.look;
    const PatchLanes patch = endOverlap(look, group.sums, world.options.rule);
    const auto point = spreadOut(patch.point), centre = spreadOut(patch.centre);
    for (std::size_t k = 0; k < group.count; ++k) {
      const Waiting& one = group.waiting[k];
      if (look.holds[k] == 0 || look.proven[k] == 0 || !(look.depth[k] > 0)) continue;
      Contact& contact = chunk.contacts[one.contact];
      if (patch.good[k] == 0) {
        nameFeature(contact, world.pairs.memory.cache[at(world.pairs.pairs[at(one.index)].slot)]);
        continue;
      }
      const Vec3 seat = seatPlace(one, contact);
      placeFromLane(patch, point, centre, x, look.depth[k], one.seatIsA, seat, k, contact);
    }
  }

  World& world;
  World::Chunk& chunk;
  const bool places;
  Groups<FaceLook<Wide>> faces;
  Groups<EdgeLook<Wide>> edges;
  OverlapsInLanes overlaps;
};

}  // namespace

void keepTouching(const std::size_t* positions, std::size_t count, World& world, World::Chunk& chunk) {
  const auto sizeOf = [&](std::int32_t body) { return body < 0 ? infinity : world.bodies.shape[at(body)]->size(); };
  chunk.deepest = 0;
  // Those that stay move towards the front a run at a time.
  const auto contacts = chunk.contacts.begin();
  std::int32_t kept = 0, run = 0;
  const auto moveRun = [&](std::int32_t end) {
    const std::int32_t to = kept - (end - run);
    if (to != run) std::copy(contacts + run, contacts + end, contacts + to);
    run = end + 1;
  };
  for (std::size_t p = 0; p < count; ++p) {
    World::ContactRange& range = world.contactsOfPair[positions[p]];
    const std::int32_t before = kept;
    for (std::int32_t k = range.first; k < range.first + range.count; ++k) {
      const Contact& contact = chunk.contacts[at(k)];
      if (contact.a < 0) {
        moveRun(k);
        continue;
      }
      chunk.noteDepth(contact.touch.overlap, std::min(sizeOf(contact.a), sizeOf(contact.b)), at(kept));
      ++kept;
    }
    range = {before, kept - before};
  }
  moveRun(static_cast<std::int32_t>(chunk.contacts.size()));
  chunk.contacts.resize(at(kept));
}

void findCuboidContacts(std::size_t c, World& world) {
  World::Chunk& chunk = world.chunks[c];
  CuboidLooks looks(world, chunk);
  std::array<std::size_t, World::chunkSize> due;
  const std::size_t dueCount = listDue(world, chunkRange(c, world.activePairs.size()), due.data());
  constexpr std::size_t ahead = 4;
  for (std::size_t k = 0; k < dueCount; ++k) {
    if (k + ahead < dueCount) {
      const Pair& next = world.pairs.pairs[at(world.activePairs[due[k + ahead]])];
      __builtin_prefetch(&world.pairs.memory.cache[at(next.slot)]);
    }
    const auto before = static_cast<std::int32_t>(chunk.contacts.size());
    looks.take(world.activePairs[due[k]]);
    world.contactsOfPair[due[k]] = {before, static_cast<std::int32_t>(chunk.contacts.size()) - before};
  }
  looks.finish();

  keepTouching(due.data(), dueCount, world, chunk);
}

}  // namespace granular
