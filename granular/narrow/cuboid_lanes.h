// The warm looks at two cuboids, a face of one against a corner of the other and an edge across an edge, as
// cuboid_pair.cpp takes them one by one: here for as many pairs as a register holds. Of each pair one body is the seat;
// its axes are handed over so that the feature lies along fixed ones, and the answer is given in axes of the contact,
// in which the overlap is simplest (point/cuboid_overlap.h).
#pragma once

#include <array>
#include <limits>

#include "granular/core/wide.h"
#include "granular/narrow/lane_look.h"
#include "granular/narrow/polyhedron_features.h"

namespace granular {

/// Two cuboids. Half-lengths along the axes, in their order.
template <class Real>
struct CuboidPair {
  std::array<Triple<Real>, 3>
      seat;  ///< unit axes, right-handed, world; the last across the face, the first along the edge
  std::array<Triple<Real>, 3> guest;  ///< unit axes, right-handed, world; the first along the edge
  Triple<Real> seatHalf, guestHalf;   ///< m
  Triple<Real> between;               ///< from the seat's centre to the guest's, world, m
  Real tie, inner;                    ///< as in cuboid_pair.cpp, m
};

/// A face of the seat under a corner of the guest. Places in the contact plane are relative to the corner.
template <class Real>
struct FaceLook : LaneLook<Real> {
  Real lowX, highX, lowY, highY;            ///< the seat's face, m
  std::array<Triple<Real>, 3> axes, edges;  ///< the guest's, contact axes: upwards (z >= 0) from the corner; unit, m
};

/// An edge of the seat (along x) across one of the guest. Places in the contact plane are relative to the crossing.
template <class Real>
struct EdgeLook : LaneLook<Real> {
  Real lowX, highX;                  ///< the ends of the seat's edge, m
  Real along, across;                ///< unit direction of the guest's edge, x and y
  Real low, high;                    ///< its ends along it, m
  std::array<Triple<Real>, 2> down;  ///< the seat's other edges, from its edge downwards, contact axes, m; no x
  std::array<Triple<Real>, 2> up;    ///< the guest's other edges, from its edge upwards, contact axes, m
  std::array<Real, 2> seatCosine,
      guestCosine;  ///< to the normal, of the faces that hold these edges and the touching one
};

/// True where none of the fifteen axes (Gottschalk, Lin and Manocha 1996) has less depth than this one, by more than
/// the tie. In the seat's axes: the guest's, and its centre. ownEdges: the first two edges cross at this very depth.
/// Without a root or a quotient: all lengths times the sine between the edges, squared.
template <class Real>
Mask<Real> isLeastOfAllAxes(const CuboidPair<Real>& p, const std::array<Triple<Real>, 3>& guest,
                            const Triple<Real>& centre, const Real& depth, bool ownEdges) {
  const std::array<Real, 3> a = {p.seatHalf.x, p.seatHalf.y, p.seatHalf.z};
  const std::array<Real, 3> b = {p.guestHalf.x, p.guestHalf.y, p.guestHalf.z};
  const std::array<Real, 3> c = {centre.x, centre.y, centre.z};
  std::array<std::array<Real, 3>, 3> R, size;  // [axis of the seat][axis of the guest]
  for (std::size_t j = 0; j < 3; ++j) {
    R[0][j] = guest[j].x;
    R[1][j] = guest[j].y;
    R[2][j] = guest[j].z;
    for (std::size_t i = 0; i < 3; ++i) size[i][j] = magnitude(R[i][j]);
  }
  const Real least = depth - p.tie;
  Mask<Real> holds = p.tie >= 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Real ofSeat = a[i] + b[0] * size[i][0] + b[1] * size[i][1] + b[2] * size[i][2] - magnitude(c[i]);
    const Real ofGuest =
        b[i] + a[0] * size[0][i] + a[1] * size[1][i] + a[2] * size[2][i] - magnitude(centre.dot(guest[i]));
    holds = both(holds, both(ofSeat >= least, ofGuest >= least));
  }
  // Round-off of the lengths below, which short sines would blow up, counts against the axis.
  const Real roundOff = 8 * std::numeric_limits<double>::epsilon() * (a[0] + a[1] + a[2] + b[0] + b[1] + b[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = i == 2 ? 0 : i + 1, l = 3 - i - k;
    for (std::size_t j = 0; j < 3; ++j) {
      if (ownEdges && i == 0 && j == 0) continue;
      const std::size_t m = j == 2 ? 0 : j + 1, o = 3 - j - m;
      const Real sine2 = R[k][j] * R[k][j] + R[l][j] * R[l][j];
      const Real reach = a[k] * size[l][j] + a[l] * size[k][j] + b[m] * size[i][o] + b[o] * size[i][m];
      const Real surplus = reach - magnitude(Real(R[k][j] * c[l] - R[l][j] * c[k])) - roundOff;
      holds = both(holds, both(surplus >= 0, surplus * surplus >= least * least * sine2));
    }
  }
  return holds;
}

template <class Real>
FaceLook<Real> lookAtFace(const CuboidPair<Real>& p) {
  FaceLook<Real> look;
  const Real side = signOf(p.between.dot(p.seat[2]));
  look.x = p.seat[0];
  look.y = side * p.seat[1];
  look.z = side * p.seat[2];
  const Triple<Real> centre{p.between.dot(look.x), p.between.dot(look.y), p.between.dot(look.z)};

  // The guest's axes upwards; its lowest corner lies half an edge below its centre along each.
  const std::array<Real, 3> half = {p.guestHalf.x, p.guestHalf.y, p.guestHalf.z};
  Triple<Real> corner = centre;
  look.depth = p.seatHalf.z - centre.z;
  Mask<Real> clear = p.tie >= 0;
  for (std::size_t j = 0; j < 3; ++j) {
    const Triple<Real> axis{p.guest[j].dot(look.x), p.guest[j].dot(look.y), p.guest[j].dot(look.z)};
    look.axes[j] = signOf(axis.z) * axis;
    const Triple<Real> halfEdge = half[j] * look.axes[j];
    look.edges[j] = Real(Real{} + 2) * halfEdge;
    look.depth += halfEdge.z;
    corner = corner - halfEdge;
    clear = both(clear, look.edges[j].z > p.tie);  // else parallel to the face
  }

  const Real margin = smaller(Real(p.seatHalf.x - magnitude(corner.x)), Real(p.seatHalf.y - magnitude(corner.y)));
  look.holds = both(clear, margin >= -p.tie);
  const Real across = squareRoot(Real(centre.x * centre.x + centre.y * centre.y));
  look.proven = isGlobal(look.depth, larger(margin, Real{}), centre.z, across, p.inner);
  if (!all(look.proven)) {
    look.proven = either(look.proven, isLeastOfAllAxes(p, look.axes, centre, look.depth, false));
  }

  look.lowX = -p.seatHalf.x - corner.x;
  look.highX = p.seatHalf.x - corner.x;
  look.lowY = -p.seatHalf.y - corner.y;
  look.highY = p.seatHalf.y - corner.y;
  const Real height = p.seatHalf.z - 0.5 * look.depth;
  look.middle = corner.x * look.x + corner.y * look.y + height * look.z;
  return look;
}

template <class Real>
EdgeLook<Real> lookAtEdges(const CuboidPair<Real>& p) {
  EdgeLook<Real> look;
  const auto inSeat = [&](const Triple<Real>& v) -> Triple<Real> {
    return {v.dot(p.seat[0]), v.dot(p.seat[1]), v.dot(p.seat[2])};
  };
  const Triple<Real> centre = inSeat(p.between), edge = inSeat(p.guest[0]);
  const Real sine2 = edge.y * edge.y + edge.z * edge.z;
  const Mask<Real> crosses = sine2 > leastLaneSine2;
  const Real sine = squareRoot(choose(crosses, sine2, Real(Real{} + 1)));

  // The normal has no component along the seat's edge; the contact's y axis neither.
  const Real scale = signOf(Real(edge.y * centre.z - edge.z * centre.y)) / sine;
  const Real ny = -edge.z * scale, nz = edge.y * scale;
  look.x = p.seat[0];
  look.y = nz * p.seat[1] - ny * p.seat[2];
  look.z = ny * p.seat[1] + nz * p.seat[2];
  const auto inContact = [&](const Triple<Real>& v) -> Triple<Real> {
    return {v.x, v.y * nz - v.z * ny, v.y * ny + v.z * nz};
  };

  // The seat's other axes upwards, from its centre to the edge; the guest's, from its edge to its centre.
  const Real signY = signOf(ny), signZ = signOf(nz);
  const Triple<Real> seat1{Real{}, signY * nz, signY * ny}, seat2{Real{}, -signZ * ny, signZ * nz};
  const Triple<Real> half1 = p.seatHalf.y * seat1, half2 = p.seatHalf.z * seat2;
  const Triple<Real> other1 = inSeat(p.guest[1]), other2 = inSeat(p.guest[2]);
  const Triple<Real> axis1 = inContact(other1), axis2 = inContact(other2);
  const Triple<Real> guest1 = signOf(axis1.z) * axis1, guest2 = signOf(axis2.z) * axis2;
  const Triple<Real> half3 = p.guestHalf.y * guest1, half4 = p.guestHalf.z * guest2;
  const Triple<Real> away = inContact(centre);
  const Triple<Real> lowest = away - half3 - half4;
  const Real edgeY = half1.y + half2.y, top = half1.z + half2.z;
  look.depth = top - lowest.z;

  // Where the edges cross, seen along the normal.
  const Triple<Real> direction = inContact(edge);
  look.along = direction.x;
  look.across = direction.y;
  const Real onGuest = (edgeY - lowest.y) / choose(crosses, direction.y, Real(Real{} + 1));
  const Real onSeat = lowest.x + onGuest * direction.x;
  const Real margin = sine * smaller(Real(p.seatHalf.x - magnitude(onSeat)), Real(p.guestHalf.x - magnitude(onGuest)));
  look.holds = both(crosses, margin >= -p.tie);
  const Real across = squareRoot(Real(away.x * away.x + away.y * away.y));
  look.proven = isGlobal(look.depth, larger(margin, Real{}), away.z, across, p.inner);
  if (!all(look.proven)) {
    look.proven = either(look.proven, isLeastOfAllAxes(p, {edge, other1, other2}, centre, look.depth, true));
  }

  look.lowX = -p.seatHalf.x - onSeat;
  look.highX = p.seatHalf.x - onSeat;
  look.low = -p.guestHalf.x - onGuest;
  look.high = p.guestHalf.x - onGuest;
  const Real two = Real{} + 2;
  look.down = {Real(-two) * half2, Real(-two) * half1};
  look.up = {two * half4, two * half3};
  look.seatCosine = {seat1.z, seat2.z};
  look.guestCosine = {guest1.z, guest2.z};
  const Real height = top - 0.5 * look.depth;
  look.middle = onSeat * look.x + edgeY * look.y + height * look.z;
  return look;
}

}  // namespace granular
