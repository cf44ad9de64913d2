// The overlap of two bodies seen along the contact normal: its height h(x) = (lower surface of what bounds it above)
// minus (upper surface of what bounds it below), integrated with x and x x^T over the region where h > 0.
//
// Two convex polyhedra bound it by concave and convex piecewise linear surfaces. h is linear on each cell, the
// projection of a face of A clipped by one of B, and concave, so the region is convex and its cells hang together:
// starting at the deepest place, the cells beyond each edge on which h > 0 are added until none is left. The integral
// of h is the volume of the overlap, and everything moves continuously with the poses, over edges and corners too. A
// flat face has one cell, and so most contacts of cuboids.
#pragma once

#include "granular/point/moments.h"
#include "granular/point/surface_side.h"

namespace granular {

struct OverlapArea {
  AreaMoments moments;  ///< in the contact plane, about its origin; the depth is h
  double height = 0;    ///< of the middle of the overlap at the centroid of its volume, over the contact plane, m
};

/// False where there is no area: a surface that is curved both ways, or round-off; out is then unspecified. Straight
/// pieces (sides of cylinders) count as strips as wide as the overlap is deep.
bool measureOverlap(const ContactPlane& plane, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                    double overlap, const PowerChoice& power, OverlapArea& out);
/// The same for two bodies with flat faces there by the walk over all cells alone. narrowest: strips beyond an edge
/// that hold less than this part of the first cell are left out; 0 leaves out nothing.
bool measureByWalk(const ContactPlane& plane, const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                   double overlap, const PowerChoice& power, double narrowest, OverlapArea& out);

}  // namespace granular
