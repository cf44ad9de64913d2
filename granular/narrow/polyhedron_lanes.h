// The warm looks at two convex polyhedra, an edge across an edge and a corner of one in a face of the other, as
// polyhedron_pair.cpp takes them one by one: here for as many pairs as a register holds. What of the features the
// overlap needs comes along, in the axes of the contact (point/polyhedron_overlap.h).
#pragma once

#include <array>

#include "granular/narrow/lane_look.h"
#include "granular/narrow/polyhedron_features.h"

namespace granular {

/// An edge (PolyhedronTables::Edge), world axes; places from the body's centre, m.
template <class Real>
struct PlacedEdge {
  Triple<Real> a, b;                  ///< its ends
  Triple<Real> left, right;           ///< unit normals of the faces
  std::array<Triple<Real>, 4> wings;  ///< as in the tables
};

template <class Real>
struct EdgePair {
  PlacedEdge<Real> seat, guest;
  Triple<Real> between;  ///< from the seat's centre to the guest's, world, m
  Real tie, inner;       ///< as in polyhedron_pair.cpp, m
};

/// A place or a direction in the contact plane.
template <class Real>
struct FlatPlace {
  Real x, y;
};

/// An edge as the contact sees it: along the direction `along`, from `low` to `high` of the crossing, m. Left and right
/// of it, seen against the contact's z: how much the faces fall away from the other body, per m across the edge, and
/// their corners beside its low and its high end.
template <class Real>
struct CrossedEdge {
  FlatPlace<Real> along;  ///< unit
  Real low, high;
  Real fallLeft, fallRight;
  std::array<FlatPlace<Real>, 2> left, right;
};

/// Places in the contact plane are relative to the crossing; x runs along the seat's edge, the guest's goes from its
/// right to its left.
template <class Real>
struct CrossingLook : LaneLook<Real> {
  Mask<Real> seen;  ///< none of the four faces is steeper than the given cosine
  CrossedEdge<Real> seat, guest;
};

template <class Real>
CrossingLook<Real> lookAtCrossing(const EdgePair<Real>& p, double steepest) {
  CrossingLook<Real> look;
  const PlacedEdge<Real>&s = p.seat, &g = p.guest;
  const Triple<Real> u = s.b - s.a, v = g.b - g.a, start = p.between + g.a;
  const Triple<Real> c = u.cross(v);
  const Real one = Real{} + 1, uu = u.dot(u), vv = v.dot(v), cc = c.dot(c);
  const Mask<Real> crosses = cc > leastLaneSine2 * uu * vv;
  const Real area = squareRoot(choose(crosses, cc, one)), lengthS = squareRoot(uu), lengthG = squareRoot(vv);

  // The common normal, out of the seat; it lies between those of the faces beside either edge.
  const Real side = signOf(c.dot(s.left + s.right));
  const Triple<Real> n = Real(side / area) * c;
  const Triple<Real> x = Real(1 / lengthS) * u, y = n.cross(x);
  const Triple<Real> along = Real(side / lengthG) * v, across = n.cross(along);  // the guest's edge, to the left
  const Real cosineSL = n.dot(s.left), cosineSR = n.dot(s.right), cosineGL = -n.dot(g.left), cosineGR = -n.dot(g.right);
  const Real offSL = y.dot(s.left), offSR = -y.dot(s.right);  // of the seat's normals, away from the edge
  const Mask<Real> runsOn = side > 0;
  const Real offGL = choose(runsOn, -across.dot(g.left), across.dot(g.left));
  const Real offGR = choose(runsOn, across.dot(g.right), Real(-across.dot(g.right)));
  look.holds = both(both(offSL >= 0, offSR >= 0), both(offGL >= 0, offGR >= 0));
  look.holds = both(look.holds, both(cosineSL + cosineSR > 0, cosineGL + cosineGR > 0));

  // Where they cross, as parts of the edges.
  const Triple<Real> w = s.a - start;
  const Real perArea = -side / area;
  const Real onSeat = perArea * w.cross(v).dot(n), onGuest = perArea * w.cross(u).dot(n);
  const Real insideS = smaller(onSeat, Real(1 - onSeat)), insideG = smaller(onGuest, Real(1 - onGuest));
  look.holds = both(both(look.holds, crosses), both(insideS * lengthS >= -p.tie, insideG * lengthG >= -p.tie));
  look.depth = n.dot(w);
  const Real margin = larger(Real(area * smaller(Real(insideS / lengthG), Real(insideG / lengthS))), Real{});
  look.proven = isGlobal(n, look.depth, margin, p.between, p.inner);
  const Triple<Real> crossingS = s.a + onSeat * u, crossingG = start + onGuest * v;
  look.middle = 0.5 * (crossingS + crossingG);
  look.x = x;
  look.y = y;
  look.z = n;

  // The faces beside the edges.
  look.seen = both(both(cosineSL >= steepest, cosineSR >= steepest), both(cosineGL >= steepest, cosineGR >= steepest));
  const auto fall = [&](const Real& off, const Real& cosine) -> Real { return off / choose(look.seen, cosine, one); };
  const auto place = [&](const Triple<Real>& corner, const Triple<Real>& crossing) -> FlatPlace<Real> {
    const Triple<Real> from = corner - crossing;
    return {from.dot(x), from.dot(y)};
  };
  CrossedEdge<Real>& seat = look.seat;
  seat.along = {one, Real{}};
  seat.low = -onSeat * lengthS;
  seat.high = (1 - onSeat) * lengthS;
  seat.fallLeft = fall(offSL, cosineSL);
  seat.fallRight = fall(offSR, cosineSR);
  seat.left = {place(s.wings[0], crossingS), place(s.wings[1], crossingS)};
  seat.right = {place(s.wings[3], crossingS), place(s.wings[2], crossingS)};

  // The guest is seen from inside: what lies left of the way from a to b appears on the right of it. If the way is from
  // the seat's left to its right it is taken backwards.
  CrossedEdge<Real>& guest = look.guest;
  guest.along = {along.dot(x), along.dot(y)};
  guest.low = choose(runsOn, Real(-onGuest), Real(onGuest - 1)) * lengthG;
  guest.high = choose(runsOn, Real(1 - onGuest), onGuest) * lengthG;
  const Real fallGL = fall(offGL, cosineGL), fallGR = fall(offGR, cosineGR);
  guest.fallLeft = choose(runsOn, fallGR, fallGL);
  guest.fallRight = choose(runsOn, fallGL, fallGR);
  const auto wing = [&](std::size_t forwards, std::size_t backwards) {
    return place(choose<Real>(runsOn, p.between + g.wings[forwards], p.between + g.wings[backwards]), crossingG);
  };
  guest.left = {wing(3, 1), wing(2, 0)};
  guest.right = {wing(0, 2), wing(1, 3)};
  return look;
}

/// The most corners of a face, and edges at a vertex, that are looked at in lanes.
inline constexpr std::size_t mostAround = 12;

/// A face of the seat and a vertex of the guest. World axes, m.
template <class Real>
struct TipPair {
  Triple<Real> normal, vertex;  ///< out of the face, unit; from the guest's centre
  Real offset;                  ///< of the face, from the seat's centre
  /// Counter-clockwise from outside: the face's corners, from the seat's centre, and from the vertex to the other ends
  /// of its edges. Pairs with fewer repeat their last.
  std::array<Triple<Real>, mostAround> corners, spokes;
  std::size_t cornerCount, spokeCount;
  Triple<Real> between;  ///< from the seat's centre to the guest's
  Real tie, inner;       ///< as in polyhedron_pair.cpp
};

/// Places in the contact plane are relative to the vertex.
template <class Real>
struct TipLook : LaneLook<Real> {
  Real margin;                                  ///< of the vertex, from the rim of the face; not above 0: outside, m
  std::array<Triple<Real>, mostAround> spokes;  ///< contact axes, m
  std::size_t spokeCount;
};

template <class Real>
TipLook<Real> lookAtTip(const TipPair<Real>& p) {
  TipLook<Real> look;
  const Triple<Real>& n = p.normal;
  const Triple<Real> tip = p.between + p.vertex;
  const Real one = Real{} + 1;
  look.depth = p.offset - n.dot(tip);

  // The distance from the rim, as in faceMargin.
  Real least = Real{} + infinity;
  for (std::size_t k = 0; k < p.cornerCount; ++k) {
    const Triple<Real>& from = p.corners[k > 0 ? k - 1 : p.cornerCount - 1];
    const Triple<Real> edge = p.corners[k] - from;
    const Real area = n.dot(edge.cross(tip - from)), square = edge.dot(edge);
    const Mask<Real> isEdge = square > 0;
    const Real each = area * magnitude(area) / choose(isEdge, square, one);
    least = choose(isEdge, smaller(least, each), least);
  }
  const Real distance = squareRoot(magnitude(least));
  look.margin = choose(least < 0, Real(-distance), distance);

  // The vertex is the deepest if no edge leads deeper.
  const Triple<Real> edge = p.corners[1] - p.corners[0];
  look.z = n;
  look.x = unit(edge - n.dot(edge) * n);
  look.y = n.cross(look.x);
  look.holds = look.margin >= -p.tie;
  look.spokeCount = p.spokeCount;
  for (std::size_t k = 0; k < p.spokeCount; ++k) {
    const Triple<Real>& spoke = p.spokes[k];
    look.spokes[k] = {spoke.dot(look.x), spoke.dot(look.y), spoke.dot(n)};
    look.holds = both(look.holds, look.spokes[k].z >= 0);
  }
  look.proven = isGlobal(n, look.depth, larger(look.margin, Real{}), p.between, p.inner);
  look.middle = tip + Real(0.5 * look.depth) * n;
  return look;
}

}  // namespace granular
