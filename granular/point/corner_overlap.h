// The overlap of the two commonest contacts of polyhedra, without clipping: a corner in a face, and an edge across an
// edge. As long as the overlap reaches neither the next corner nor the rim of the face, it is a fan of triangles about
// the deepest point, on each of which the height falls linearly to nothing: all integrals in closed form.
#pragma once

#include "granular/point/overlap.h"

namespace granular {

/// False where the overlap is anything else: then the walk over all cells answers. feature: what touches; unknown: all
/// that may be is tried. slack: m, as in SurfaceSide::findStartFace.
bool measureCorner(const TouchingFeature& feature, const SurfaceSide& a, const SurfaceSide& b, double overlap,
                   double slack, const PowerChoice& power, OverlapArea& out);

}  // namespace granular
