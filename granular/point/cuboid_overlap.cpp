#include "granular/point/cuboid_overlap.h"

#include "granular/point/surface_side.h"

namespace granular {
namespace {

Mask<Wide> isWithin(const Wide& x, const Wide& low, const Wide& high) { return both(x >= low, x <= high); }

/// Of the guest's face across its edge j at the corner: how its height over the contact plane rises.
Place riseOf(const FaceLook<Wide>& look, std::size_t j) {
  const Triple<Wide>& axis = look.axes[j];
  return {-axis.x / axis.z, -axis.y / axis.z};
}
/// Of the guest's face that holds its touching edge and up[k]. The height over the contact plane is 0 along the edge.
Place riseOf(const EdgeLook<Wide>& look, std::size_t k) {
  const Triple<Wide>& up = look.up[k];
  const Wide slope = up.z / (look.along * up.y - look.across * up.x);
  return {-slope * look.across, slope * look.along};
}
/// Of the seat's face that holds its touching edge and down[k], along y.
Wide riseOfSeat(const EdgeLook<Wide>& look, std::size_t k) { return look.down[k].z / look.down[k].y; }

/// The middle of the overlap over the contact plane at a place in it: between the seat's lowest face and the guest's
/// highest.
Wide findMiddle(const FaceLook<Wide>& look, const Place& c) {
  Wide guest = Wide{} - infinity;
  for (std::size_t j = 0; j < 3; ++j) {
    const Place rise = riseOf(look, j);
    guest = choose(look.axes[j].z >= steepestCosine, larger(guest, Wide(rise.x * c.x + rise.y * c.y)), guest);
  }
  return 0.5 * guest;
}
Wide findMiddle(const EdgeLook<Wide>& look, const Place& c) {
  Wide seat = Wide{} + infinity, guest = Wide{} - infinity;
  for (std::size_t k = 0; k < 2; ++k) {
    const Place rise = riseOf(look, k);
    seat = choose(look.seatCosine[k] >= steepestCosine, smaller(seat, Wide(riseOfSeat(look, k) * c.y)), seat);
    guest = choose(look.guestCosine[k] >= steepestCosine, larger(guest, Wide(rise.x * c.x + rise.y * c.y)), guest);
  }
  return 0.5 * (seat + guest);
}

template <class Look>
PatchLanes endAnyOverlap(const Look& look, const OverlapLanes& sums, const RuleOptions& rule) {
  const PressLanes press = findPress(sums);
  return placePress(look, press, findMiddle(look, press.press), sums, rule);
}

}  // namespace

void beginOverlap(const FaceLook<Wide>& look, const Mask<Wide>& chosen, OverlapsInLanes& overlaps, OverlapLanes& sums) {
  sums = {};
  Fan fan;
  Wide tips{}, tipsX{}, tipsY{};
  overlaps.triangles.makeRoom(9 * wideSize);  // tips come first
  std::array<Mask<Wide>, 3> beyond;
  for (std::size_t j = 0; j < 3; ++j) {
    // From the corner along both edges of the face, as far as there is depth; then across, as far as there is.
    const Triple<Wide>&e = look.edges[j == 2 ? 0 : j + 1], &f = look.edges[j == 0 ? 2 : j - 1];
    const Place edge1{e.x, e.y}, edge2{f.x, f.y};
    const Wide one = 1 + Wide{}, depth = choose(look.depth > 0, look.depth, one);
    const Wide per1 = depth / choose(e.z > 0, e.z, depth), per2 = depth / choose(f.z > 0, f.z, depth);
    const Wide end1 = smaller(per1, one), end2 = smaller(per2, one);
    const Wide depth1 = choose(per1 > 1, depth - e.z, Wide{}), depth2 = choose(per2 > 1, depth - f.z, Wide{});
    const Wide on2 = smaller(Wide(per2 * (depth1 / depth)), one), on1 = smaller(Wide(per1 * (depth2 / depth)), one);
    const Wide depth12 = choose(on2 < 1, Wide{}, depth1 - f.z), depth21 = choose(on1 < 1, Wide{}, depth2 - e.z);
    const Place p1 = end1 * edge1, p2 = end2 * edge2, p12 = p1 + on2 * edge2, p21 = p2 + on1 * edge1;

    Mask<Wide> inside = both(chosen, look.axes[j].z >= steepestCosine);
    const Mask<Wide> seen = inside;
    for (const Place& p : {p1, p2, p12, p21}) {
      inside = both(inside, both(isWithin(p.x, look.lowX, look.highX), isWithin(p.y, look.lowY, look.highY)));
    }
    inside = both(inside, both(isWithin(Wide{}, look.lowX, look.highX), isWithin(Wide{}, look.lowY, look.highY)));
    const auto add = [&](const Place& p, const Wide& depthP, const Place& q, const Wide& depthQ) {
      fan.add(p, q, depth, depthP, depthQ, inside);
      if (!overlaps.triangles.isWanted()) return;
      const Wide twice = choose(inside, magnitude(cross(p, q)), Wide{});
      const Mask<Wide> isTip = both(depthP <= 0, depthQ <= 0);
      const Wide area = choose(isTip, Wide(0.5 * twice), Wide{});
      tips += area;
      tipsX += (1.0 / 3) * area * (p.x + q.x);
      tipsY += (1.0 / 3) * area * (p.y + q.y);
      const Wide overP = depthP / depth, overQ = depthQ / depth;
      for (std::size_t k = 0; k < wideSize; ++k) {
        if (isTip[k] || !(twice[k] > 0)) continue;
        overlaps.triangles.add({p.x[k], p.y[k], q.x[k], q.y[k], overP[k], overQ[k], twice[k]}, {&sums, k});
      }
    };
    add(p1, depth1, p12, depth12);
    add(p12, depth12, p21, depth21);
    add(p21, depth21, p2, depth2);
    beyond[j] = seen & ~inside;
  }
  store(fan, sums);
  if (overlaps.triangles.isWanted()) storePowers(tips, tipsX, tipsY, overlaps.triangles.exponent(), sums);
  for (std::size_t j = 0; j < 3; ++j) {
    if (!any(beyond[j])) continue;
    const Triple<Wide>&e = look.edges[j == 2 ? 0 : j + 1], &f = look.edges[j == 0 ? 2 : j - 1];
    const Place rise = riseOf(look, j);
    overlaps.cells.add(
        {look.lowX, look.highX, look.lowY, look.highY, {}, {e.x, e.y}, {f.x, f.y}, look.depth, {-rise.x, -rise.y}},
        beyond[j], sums);
  }
}

void beginOverlap(const EdgeLook<Wide>& look, const Mask<Wide>& chosen, OverlapsInLanes& overlaps, OverlapLanes& sums) {
  // Both edges and the faces beside them divide the contact plane in four; in each quarter the depth falls linearly
  // from the crossing, along the seat's edge by what the guest's face rises, along the guest's by what the seat's
  // falls.
  sums = {};
  Fan fan;
  std::array<Mask<Wide>, 4> beyond;
  for (std::size_t q = 0; q < 4; ++q) {
    const Triple<Wide>&down = look.down[q / 2], &up = look.up[q % 2];
    const Wide turn = look.along * up.y - look.across * up.x;
    const Mask<Wide> seen =
        both(chosen, both(look.seatCosine[q / 2] >= steepestCosine, look.guestCosine[q % 2] >= steepestCosine));
    // Where the depth has fallen to 0: as parts of the faces' other edges.
    const Wide partUp = look.depth / choose(up.z > 0, up.z, look.depth);
    const Wide partDown = look.depth / choose(down.z < 0, Wide(-down.z), look.depth);
    const Wide perAcross = 1 / look.across;
    const Place onSeat{-(partUp * turn) * perAcross, Wide{}};  // its place on the guest's face is -partUp up.y/across
    const Wide alongGuest = -(partUp * up.y) * perAcross;
    const Wide y = partDown * down.y, onEdge = y * perAcross;
    const Place onGuest{onEdge * look.along, y};

    Mask<Wide> inside = both(seen, both(partUp <= 1, partDown <= 1));
    inside = both(inside, both(isWithin(onSeat.x, look.lowX, look.highX), isWithin(onGuest.x, look.lowX, look.highX)));
    inside = both(inside, both(isWithin(alongGuest, look.low, look.high), isWithin(onEdge, look.low, look.high)));
    inside = both(inside, both(up.z > 0, down.z < 0));
    fan.add(onSeat, onGuest, look.depth, Wide{}, Wide{}, inside);
    beyond[q] = seen & ~inside;
  }
  storeTips(fan, overlaps.triangles.exponent(), sums);
  for (std::size_t q = 0; q < 4; ++q) {
    if (!any(beyond[q])) continue;
    const Triple<Wide>&down = look.down[q / 2], &up = look.up[q % 2];
    const Place rise = riseOf(look, q % 2);
    const Wide length = look.high - look.low;
    overlaps.cells.add({look.lowX,
                        look.highX,
                        smaller(down.y, Wide{}),
                        larger(down.y, Wide{}),
                        {look.low * look.along, look.low * look.across},
                        {length * look.along, length * look.across},
                        {up.x, up.y},
                        look.depth,
                        {-rise.x, riseOfSeat(look, q / 2) - rise.y}},
                       beyond[q], sums);
  }
}

PatchLanes endOverlap(const FaceLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule) {
  return endAnyOverlap(look, sums, rule);
}
PatchLanes endOverlap(const EdgeLook<Wide>& look, const OverlapLanes& sums, const RuleOptions& rule) {
  return endAnyOverlap(look, sums, rule);
}

}  // namespace granular
