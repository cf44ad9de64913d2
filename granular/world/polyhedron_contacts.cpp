// Contacts of polyhedra in batches (lane_looks.h): under the rules `patch`, `stiff_patch` and `pressure_centroid` those
// whose overlap is a tip or a crossing placed while their geometry is at hand (point/polyhedron_overlap.h).
#include <algorithm>
#include <new>

#include "granular/core/placed_axes.h"
#include "granular/core/tolerances.h"
#include "granular/point/polyhedron_overlap.h"
#include "granular/point/surface_side.h"
#include "granular/world/lane_looks.h"

namespace granular {
namespace {

using Tables = PolyhedronTables;

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// One body of each pair.
struct PartyLanes {
  std::array<const Frame*, wideSize> frames;
  std::array<const Tables*, wideSize> tables;
  std::array<std::int32_t, wideSize> feature;  ///< face, edge or vertex

  void repeatLast(std::size_t count) {
    std::fill(frames.begin() + count, frames.end(), frames[count - 1]);
    std::fill(tables.begin() + count, tables.end(), tables[count - 1]);
    std::fill(feature.begin() + count, feature.end(), feature[count - 1]);
  }
};

/// Loads what pick(lane) points to.
template <class Pick>
Triple<Wide> loadPicked(Pick&& pick) {
  std::array<const Vec3*, wideSize> picked;
  for (std::size_t k = 0; k < wideSize; ++k) picked[k] = pick(k);
  return loadVectors(picked);
}

/// Pairs of one kind of look, a register full.
template <class AnyLook>
struct PolyhedronGroup {
  std::size_t count = 0;
  std::array<Waiting, wideSize> waiting;
  PartyLanes seat, guest;
  TripleLanes<wideSize> shift;  ///< from the seat's place to that next to the guest: of B's image, or back
  alignas(64) double tie[wideSize], inner[wideSize];
  AnyLook look;
  OverlapLanes sums;

  /// Fills the lanes beyond the last pair.
  void fill() {
    seat.repeatLast(count);
    guest.repeatLast(count);
    for (std::size_t k = count; k < wideSize; ++k) {
      shift.put(k, shift.at(count - 1));
      tie[k] = tie[count - 1];
      inner[k] = inner[count - 1];
    }
  }
};

PlacedEdge<Wide> loadEdge(const PartyLanes& party, const PlacedAxes<Wide>& axes) {
  std::array<const Tables::Edge*, wideSize> edges;
  for (std::size_t k = 0; k < wideSize; ++k) edges[k] = &party.tables[k]->edges[at(party.feature[k])];
  const auto vertex = [&](auto&& index) {
    return axes.rotate(loadPicked([&](std::size_t k) { return &party.tables[k]->vertices[at(index(*edges[k]))]; }));
  };
  const auto normal = [&](auto&& index) {
    return axes.rotate(loadPicked([&](std::size_t k) { return &party.tables[k]->faces[at(index(*edges[k]))].normal; }));
  };
  PlacedEdge<Wide> edge;
  edge.a = vertex([](const Tables::Edge& e) { return e.a; });
  edge.b = vertex([](const Tables::Edge& e) { return e.b; });
  edge.left = normal([](const Tables::Edge& e) { return e.faceLeft; });
  edge.right = normal([](const Tables::Edge& e) { return e.faceRight; });
  for (std::size_t n = 0; n < edge.wings.size(); ++n) {
    edge.wings[n] = vertex([n](const Tables::Edge& e) { return e.wings[n]; });
  }
  return edge;
}

void lookAt(PolyhedronGroup<CrossingLook<Wide>>& group) {
  const PlacedAxes<Wide> seat = loadAxes(group.seat.frames), guest = loadAxes(group.guest.frames);
  const EdgePair<Wide> pairs = {loadEdge(group.seat, seat), loadEdge(group.guest, guest),
                                guest.x + group.shift.load(0) - seat.x, loadWide(group.tie), loadWide(group.inner)};
  ::new (&group.look) CrossingLook<Wide>(lookAtCrossing(pairs, steepestCosine));  // made where it stays: kilobytes
}

void lookAt(PolyhedronGroup<TipLook<Wide>>& group) {
  const PlacedAxes<Wide> seat = loadAxes(group.seat.frames), guest = loadAxes(group.guest.frames);
  std::array<std::span<const Tables::Corner>, wideSize> corners;
  std::array<std::span<const Tables::Spoke>, wideSize> spokes;
  std::array<const Vec3*, wideSize> tips;
  TipPair<Wide> pairs;
  pairs.cornerCount = pairs.spokeCount = 0;
  for (std::size_t k = 0; k < wideSize; ++k) {
    corners[k] = group.seat.tables[k]->cornersOf(group.seat.feature[k]);
    spokes[k] = group.guest.tables[k]->spokesOf(group.guest.feature[k]);
    tips[k] = &group.guest.tables[k]->vertices[at(group.guest.feature[k])];
    pairs.offset[k] = group.seat.tables[k]->faces[at(group.seat.feature[k])].offset;
    pairs.cornerCount = std::max(pairs.cornerCount, corners[k].size());
    pairs.spokeCount = std::max(pairs.spokeCount, spokes[k].size());
  }
  pairs.normal = seat.rotate(
      loadPicked([&](std::size_t k) { return &group.seat.tables[k]->faces[at(group.seat.feature[k])].normal; }));
  const Triple<Wide> tip = loadVectors(tips);
  pairs.vertex = guest.rotate(tip);
  for (std::size_t n = 0; n < pairs.cornerCount; ++n) {
    pairs.corners[n] = seat.rotate(loadPicked([&](std::size_t k) {
      return &group.seat.tables[k]->vertices[at(corners[k][std::min(n, corners[k].size() - 1)].vertex)];
    }));
  }
  for (std::size_t n = 0; n < pairs.spokeCount; ++n) {
    const Triple<Wide> end = loadPicked([&](std::size_t k) {
      return &group.guest.tables[k]->vertices[at(spokes[k][std::min(n, spokes[k].size() - 1)].vertex)];
    });
    pairs.spokes[n] = guest.rotate(end - tip);
  }
  pairs.between = guest.x + group.shift.load(0) - seat.x;
  pairs.tie = loadWide(group.tie);
  pairs.inner = loadWide(group.inner);
  ::new (&group.look) TipLook<Wide>(lookAtTip(pairs));
}

using TipGroup = PolyhedronGroup<TipLook<Wide>>;
using CrossingGroup = PolyhedronGroup<CrossingLook<Wide>>;

class PolyhedronLooks : public LaneLooks<PolyhedronLooks, TipGroup, CrossingGroup> {
 public:
  PolyhedronLooks(World& chosen, World::Chunk& into) : LaneLooks(chosen, into) {}

  bool add(const Contact& contact, const WarmCache& cache) {
    switch (cache.kind) {
      case WarmCache::faceOfA:
        return addTip(contact, cache, true);
      case WarmCache::faceOfB:
        return addTip(contact, cache, false);
      case WarmCache::edgePair:
        addTo(groups<CrossingGroup>(), contact, cache, true);
        return true;
      default:
        return false;
    }
  }

  template <class AnyLook>
  void begin(PolyhedronGroup<AnyLook>& group) {
    group.fill();
    lookAt(group);
    if (places()) integrateOverlap(group.look, touchingLanes(group), powerInLanes(world.options.rule), group.sums);
  }
  void finishOverlaps() {}

  static TouchingFeature nameFeature(const Contact&, const WarmCache& cache) { return namePolyhedronFeature(cache); }
  void nameApart(const Pair& pair, WarmCache& cache) const { nameVertices(tablesAt(pair.a), tablesAt(pair.b), cache); }

  void fetchWhere(const Pair& pair) const { fetchShapes(world, pair); }
  void fetchWhat(const Pair& pair) const {
    __builtin_prefetch(&world.pairs.memory.cache[at(pair.slot)]);
    for (const std::int32_t body : {pair.a, pair.b}) {
      const auto* frame = reinterpret_cast<const std::byte*>(&world.bodies.frame[at(body)]);
      __builtin_prefetch(frame);
      __builtin_prefetch(frame + 64);
    }
  }

 private:
  const Tables& tablesAt(std::int32_t body) const {
    return static_cast<const Polyhedron&>(*world.bodies.shape[at(body)]).tables();
  }

  bool addTip(const Contact& contact, const WarmCache& cache, bool seatIsA) {
    const std::int32_t face = seatIsA ? cache.featureA : cache.featureB;
    const std::int32_t vertex = seatIsA ? cache.featureB : cache.featureA;
    if (tablesAt(seatIsA ? contact.a : contact.b).cornersOf(face).size() > mostAround) return false;
    if (tablesAt(seatIsA ? contact.b : contact.a).spokesOf(vertex).size() > mostAround) return false;
    addTo(groups<TipGroup>(), contact, cache, seatIsA);
    return true;
  }

  template <class One>
  void addTo(Groups<One>& some, const Contact& contact, const WarmCache& cache, bool seatIsA) {
    const Bodies& bodies = world.bodies;
    One& group = some.open();
    const std::size_t a = at(contact.a), b = at(contact.b), k = group.count++;
    group.waiting[k] = {last(), contact.pair, seatIsA};
    PartyLanes &ofA = seatIsA ? group.seat : group.guest, &ofB = seatIsA ? group.guest : group.seat;
    ofA.frames[k] = &bodies.frame[a];
    ofB.frames[k] = &bodies.frame[b];
    ofA.tables[k] = &tablesAt(contact.a);
    ofB.tables[k] = &tablesAt(contact.b);
    ofA.feature[k] = cache.featureA;
    ofB.feature[k] = cache.featureB;
    group.shift.put(k, seatIsA ? contact.shift : Vec3(-contact.shift));
    group.tie[k] = tolerance::tie * std::min(bodies.shape[a]->size(), bodies.shape[b]->size());
    group.inner[k] = bodies.shape[a]->innerRadius() + bodies.shape[b]->innerRadius();
    closeIfFull(some);
  }
};

}  // namespace

void findPolyhedronContacts(std::size_t c, World& world) { PolyhedronLooks(world, world.chunks[c]).takeChunk(c); }

}  // namespace granular
