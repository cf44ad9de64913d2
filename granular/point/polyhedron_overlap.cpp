#include "granular/point/polyhedron_overlap.h"

#include "granular/point/surface_side.h"

namespace granular {
namespace {

using FlatWide = FlatPlace<Wide>;

Place toPlace(const FlatWide& p) { return {p.x, p.y}; }
Place at(const CrossedEdge<Wide>& edge, const Wide& along) { return along * toPlace(edge.along); }

/// How far along the other edge the height falls by the depth, where its direction leads across this one by `across`
/// per m.
Wide reach(const Wide& depth, const Wide& fall, const Wide& across) {
  const Wide perMetre = fall * across;
  return choose(perMetre > 0, Wide(depth / perMetre), Wide{} + infinity);
}

/// True if a place on the face's side of the edge, which runs round the face from first to last, lies in the
/// quadrilateral of the edge and the face's corners next to it.
Mask<Wide> isInside(const Place& first, const Place& last, const Place& afterLast, const Place& beforeFirst,
                    const Place& p) {
  return both(cross(afterLast - last, p - last) >= 0, both(cross(beforeFirst - afterLast, p - afterLast) >= 0,
                                                           cross(first - beforeFirst, p - beforeFirst) >= 0));
}
Mask<Wide> isInsideLeft(const CrossedEdge<Wide>& edge, const Place& p) {
  return isInside(at(edge, edge.low), at(edge, edge.high), toPlace(edge.left[1]), toPlace(edge.left[0]), p);
}
Mask<Wide> isInsideRight(const CrossedEdge<Wide>& edge, const Place& p) {
  return isInside(at(edge, edge.high), at(edge, edge.low), toPlace(edge.right[0]), toPlace(edge.right[1]), p);
}

/// How far the edge's own surface lies off its edge at a place: the nearer of both faces.
Wide fallAt(const CrossedEdge<Wide>& edge, const Place& p) {
  const Wide across = cross(toPlace(edge.along), p);
  return larger(Wide(edge.fallLeft * across), Wide(-edge.fallRight * across));
}

/// Out of the face between spoke k and the next, of any length.
Triple<Wide> outOf(const TipLook<Wide>& look, std::size_t k) {
  return look.spokes[k].cross(look.spokes[k + 1 < look.spokeCount ? k + 1 : 0]);
}
/// True if a face with this outward normal, of any length, is not too steep to count.
Mask<Wide> isSeen(const Triple<Wide>& out) {
  return both(out.z < 0, out.z * out.z >= steepestCosine * steepestCosine * out.dot(out));
}

}  // namespace

void integrateOverlap(const CrossingLook<Wide>& look, const Mask<Wide>& chosen, int exponent, OverlapLanes& sums) {
  // Both edges divide the contact plane in four; in each quarter the depth falls linearly from the crossing to nothing,
  // along one edge by what the other's face falls away.
  const CrossedEdge<Wide>&seat = look.seat, &guest = look.guest;
  const Wide turn = guest.along.y;
  const Wide ahead = reach(look.depth, guest.fallRight, turn), behind = -reach(look.depth, guest.fallLeft, turn);
  const Wide left = reach(look.depth, seat.fallLeft, turn), right = -reach(look.depth, seat.fallRight, turn);
  Mask<Wide> simple = both(both(chosen, look.seen), both(ahead <= seat.high, behind >= seat.low));
  simple = both(simple, both(left <= guest.high, right >= guest.low));
  const auto stay = [&](const Wide& x) { return choose(simple, x, Wide{}); };
  const std::array<Place, 4> rim = {at(seat, stay(ahead)), at(guest, stay(left)), at(seat, stay(behind)),
                                    at(guest, stay(right))};
  simple = both(simple, both(isInsideLeft(seat, rim[1]), isInsideRight(seat, rim[3])));
  simple = both(simple, both(isInsideRight(guest, rim[0]), isInsideLeft(guest, rim[2])));
  Fan fan;
  for (std::size_t k = 0; k < 4; ++k) fan.add(rim[k], rim[k < 3 ? k + 1 : 0], look.depth, Wide{}, Wide{}, simple);
  storeTips(fan, exponent, sums);
}

void integrateOverlap(const TipLook<Wide>& look, const Mask<Wide>& chosen, int exponent, OverlapLanes& sums) {
  // Where the depth falls to nothing along each edge: within it, and within the face.
  Mask<Wide> simple = both(chosen, look.margin > 0);
  std::array<Place, mostAround> rim;
  for (std::size_t k = 0; k < look.spokeCount; ++k) {
    const Triple<Wide>& spoke = look.spokes[k];
    const Mask<Wide> leads = both(spoke.z >= look.depth, spoke.z > 0);
    const Wide part = look.depth / choose(leads, spoke.z, 1 + Wide{});
    rim[k] = {part * spoke.x, part * spoke.y};
    simple = both(both(simple, leads), rim[k].x * rim[k].x + rim[k].y * rim[k].y <= look.margin * look.margin);
  }
  Fan fan;
  for (std::size_t k = 0; k < look.spokeCount; ++k) {
    const std::size_t next = k + 1 < look.spokeCount ? k + 1 : 0;
    fan.add(rim[k], rim[next], look.depth, Wide{}, Wide{}, both(simple, isSeen(outOf(look, k))));
  }
  storeTips(fan, exponent, sums);
}

PatchLanes endOverlap(const CrossingLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule) {
  const PressLanes press = findPress(sums);
  const Wide height = 0.5 * (fallAt(look.guest, press.press) - fallAt(look.seat, press.press));
  return placePress(look, press, height, sums, rule);
}

PatchLanes endOverlap(const TipLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule) {
  const PressLanes press = findPress(sums);
  Wide rise = Wide{} - infinity;
  for (std::size_t k = 0; k < look.spokeCount; ++k) {
    const Triple<Wide> out = outOf(look, k);
    const Mask<Wide> seen = isSeen(out);
    const Wide each = -(out.x * press.press.x + out.y * press.press.y) / choose(seen, out.z, 1 + Wide{});
    rise = choose(seen, larger(rise, each), rise);
  }
  return placePress(look, press, 0.5 * rise, sums, rule);
}

}  // namespace granular
