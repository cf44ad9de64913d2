// The overlap of two round faces, as the walk of overlap.cpp measures it: the polygon that stands for A's face, cut
// where the depth ends and by the polygon that stands for B's. Their corners come from a table a register full at a
// time, and only those of B's edges are clipped against that some corner of the region lies beyond.
#pragma once

#include "granular/point/overlap.h"

namespace granular {

/// Integrals and height for two sides that are round.
void measureDisks(const SurfaceSide& a, const SurfaceSide& b, const PowerChoice& power, OverlapArea& out);

}  // namespace granular
