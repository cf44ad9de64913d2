// Contacts of cuboids in batches (lane_looks.h): under the rules `patch`, `stiff_patch` and `pressure_centroid` placed
// while their geometry is at hand (point/cuboid_overlap.h).
#include "granular/world/cuboid_groups.h"
#include "granular/world/lane_looks.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

class CuboidLooks : public LaneLooks<CuboidLooks, CuboidFaceGroup, CuboidEdgeGroup> {
 public:
  CuboidLooks(World& chosen, World::Chunk& into) : LaneLooks(chosen, into), overlaps(chosen.options.rule) {}

  bool add(const Contact& contact, const WarmCache& cache) {
    cache.kind == WarmCache::edgePair ? addEdges(contact, cache) : addFace(contact, cache);
    return true;
  }

  template <class Group>
  void begin(Group& group) {
    lookAt(group);
    if (!places()) return;
    if (overlaps.cells.isFull(mostBoxCells)) overlaps.finish();
    beginOverlap(group.look, touchingLanes(group), overlaps, group.sums);
  }
  void finishOverlaps() { overlaps.finish(); }

  TouchingFeature nameFeature(const Contact& contact, const WarmCache& cache) const {
    const Vec3 outOfB = -world.bodies.frame[at(contact.b)].unrotate(contact.touch.normal);
    return nameCuboidFeature(cache, cache.direction, outOfB);
  }
  void nameApart(const Pair&, WarmCache&) const {}

 private:
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
    auto& faces = groups<CuboidFaceGroup>();
    faces.open().add(
        {last(), contact.pair, seatIsA},
        {seat.col(k), seat.col(l), seat.col(i), guest.col(0), guest.col(1), guest.col(2),
         Vec3(seatHalf[k], seatHalf[l], seatHalf[i]), guestHalf, seatIsA ? boxes.between : Vec3(-boxes.between)},
        {cuboidTie(boxes.a, boxes.b), boxes.a.innerRadius() + boxes.b.innerRadius()});
    closeIfFull(faces);
  }

  void addEdges(const Contact& contact, const WarmCache& cache) {
    const Boxes boxes = view(contact);
    const Mat3 &seat = boxes.frameA.R, &guest = boxes.frameB.R;
    const Vec3 &seatHalf = boxes.a.halfLengths(), &guestHalf = boxes.b.halfLengths();
    const int i = cache.featureA, k = i == 2 ? 0 : i + 1, l = 3 - i - k;
    const int j = cache.featureB, m = j == 2 ? 0 : j + 1, o = 3 - j - m;
    auto& edges = groups<CuboidEdgeGroup>();
    edges.open().add(
        {last(), contact.pair, true},
        {seat.col(i), seat.col(k), seat.col(l), guest.col(j), guest.col(m), guest.col(o),
         Vec3(seatHalf[i], seatHalf[k], seatHalf[l]), Vec3(guestHalf[j], guestHalf[m], guestHalf[o]), boxes.between},
        {cuboidTie(boxes.a, boxes.b), boxes.a.innerRadius() + boxes.b.innerRadius()});
    closeIfFull(edges);
  }

  static void lookAt(CuboidFaceGroup& group) { group.lookWith(lookAtFace<Wide>); }
  static void lookAt(CuboidEdgeGroup& group) { group.lookWith(lookAtEdges<Wide>); }

  OverlapsInLanes overlaps;
};

}  // namespace

void findCuboidContacts(std::size_t c, World& world) { CuboidLooks(world, world.chunks[c]).takeChunk(c); }

}  // namespace granular
