// Contacts of cylinders in batches (lane_looks.h): a side across a side, a rim on a side and a rim in a cap. Under the
// rules `patch` and `pressure_centroid` those in which at least one shows its side are placed while their geometry is
// at hand (point/cylinder_overlap.h).
#include "granular/narrow/kept_proof.h"
#include "granular/narrow/support_piece.h"
#include "granular/point/cylinder_overlap.h"
#include "granular/shape/cylinder.h"
#include "granular/world/lane_looks.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Pairs of one kind of look, a register full, and what of them their proofs need.
template <LaneLook<Wide> (*lookAt)(const CylinderPair<Wide>&)>
struct CylinderGroup : LaneGroup<CylinderPair<Wide>, LaneLook<Wide>> {
  std::array<const Frame*, wideSize> frameA, frameB;
  std::array<const KeptProof*, wideSize> proof;
  alignas(64) double boundingRadius[wideSize];  ///< B's, m
  alignas(64) double fromA[wideSize];           ///< 1 if the seat is A, else -1
  Wide height;                                  ///< of the overlap's middle (cylinder_overlap.h)

  void find() {
    lookWith(lookAt);
    std::fill(frameA.begin() + count, frameA.end(), frameA[count - 1]);
    std::fill(frameB.begin() + count, frameB.end(), frameB[count - 1]);
    std::fill(proof.begin() + count, proof.end(), proof[count - 1]);
    std::fill(boundingRadius + count, boundingRadius + wideSize, boundingRadius[count - 1]);
    std::fill(fromA + count, fromA + wideSize, fromA[count - 1]);
    if (!all(look.proven)) proveAgain();
  }

 private:
  /// By the proofs that the pairs keep.
  void proveAgain() {
    const PlacedAxes<Wide> a = loadAxes(frameA), b = loadAxes(frameB);
    const Wide sign = loadWide(fromA);
    const RelativePlace<Wide> place = {a.unrotate(b.column0), a.unrotate(b.column1), a.unrotate(b.column2),
                                       a.unrotate(sign * pairs.between)};
    const Mask<Wide> holds = keptProofHolds(loadProofs(proof), place, a.unrotate(sign * look.z), look.depth,
                                            loadWide(boundingRadius), pairs.extent);
    look.proven = either(look.proven, holds);
  }
};
using Sides = CylinderGroup<lookAtSides<Wide>>;
using RimsOnSides = CylinderGroup<lookAtRimOnSide<Wide>>;
using RimsInCaps = CylinderGroup<lookAtRimInCap<Wide>>;

class CylinderLooks : public LaneLooks<CylinderLooks, Sides, RimsOnSides, RimsInCaps> {
 public:
  CylinderLooks(World& chosen, World::Chunk& into) : LaneLooks(chosen, into, placesStrips(chosen.options.rule.rule)) {}

  bool add(const Contact& contact, const WarmCache& cache) {
    if (cache.kind != WarmCache::smooth) return false;
    const PieceName a = decodePiece(cache.featureA), b = decodePiece(cache.featureB);
    if (a.kind == PieceName::side && b.kind == PieceName::side) return addTo<Sides>(contact, cache, true);
    if (b.kind == PieceName::rim) return addRim(contact, cache, a.kind, true);
    return a.kind == PieceName::rim && addRim(contact, cache, b.kind, false);
  }

  template <class Group>
  void begin(Group& group) {
    group.find();
    if (!places()) return;
    group.height = integrateStrip(group.pairs, group.look, loadWide(group.fromA) > 0, touchingLanes(group), group.sums);
  }
  void finishOverlaps() {}
  template <class Group>
  PatchLanes placeGroup(const Group& group) const {
    return placePress(group.look, findPress(group.sums), group.height, group.sums, world.options.rule);
  }

  static TouchingFeature nameFeature(const Contact&, const WarmCache&) { return {}; }
  void nameApart(const Pair&, WarmCache&) const {}

 private:
  /// A stiff patch's powers of the depth are not integrated over strips here.
  static bool placesStrips(PointRule rule) { return placesInLanes(rule) && rule != PointRule::stiffPatch; }

  /// A rim of the guest on what of the seat has this kind.
  bool addRim(const Contact& contact, const WarmCache& cache, std::int32_t seatKind, bool seatIsA) {
    if (seatKind == PieceName::side) return addTo<RimsOnSides>(contact, cache, seatIsA);
    return seatKind == PieceName::face && addTo<RimsInCaps>(contact, cache, seatIsA);
  }

  template <class Group>
  bool addTo(const Contact& contact, const WarmCache& cache, bool seatIsA) {
    const Bodies& bodies = world.bodies;
    const std::size_t a = at(contact.a), b = at(contact.b);
    const auto &shapeA = static_cast<const Cylinder&>(*bodies.shape[a]),
               &shapeB = static_cast<const Cylinder&>(*bodies.shape[b]);
    const Frame &frameA = bodies.frame[a], &frameB = bodies.frame[b];
    const Vec3 between = frameB.x + contact.shift - frameA.x, last = frameA.rotate(cache.direction);
    const Cylinder &seat = seatIsA ? shapeA : shapeB, &guest = seatIsA ? shapeB : shapeA;
    const auto endOf = [](std::int32_t feature) { return decodePiece(feature).index ? -1.0 : 1.0; };
    const double endA = endOf(cache.featureA), endB = endOf(cache.featureB), sign = seatIsA ? 1 : -1;
    auto& some = groups<Group>();
    Group& group = some.open();
    const std::size_t k = group.count;
    group.frameA[k] = &frameA;
    group.frameB[k] = &frameB;
    group.proof[k] = &cache.proof;
    group.boundingRadius[k] = shapeB.boundingRadius();
    group.fromA[k] = sign;
    group.add({this->last(), contact.pair, seatIsA},
              {(seatIsA ? frameA : frameB).R.col(2), (seatIsA ? frameB : frameA).R.col(2), sign * between, sign * last},
              {seat.radius(), seat.halfHeight(), guest.radius(), guest.halfHeight(), seatIsA ? endA : endB,
               seatIsA ? endB : endA, seat.innerRadius() + guest.innerRadius(),
               seat.boundingRadius() + guest.boundingRadius() + between.norm()});
    closeIfFull(some);
    return true;
  }
};

}  // namespace

void findCylinderContacts(std::size_t c, World& world) { CylinderLooks(world, world.chunks[c]).takeChunk(c); }

}  // namespace granular
