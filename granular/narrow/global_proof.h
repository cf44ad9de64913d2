// Is a local minimum of the depth the global one? Proofs by parts of C = A - B whose support in a direction is no less
// than the depth at hand, the cheapest first, and a proof kept from an earlier step: if no direction outside a cone
// around the normal had a depth below some floor, then none has one below the floor less what the surfaces have moved
// since. The directions within 10 degrees of a minimum are taken for granted (a convex function of n on the tangent
// plane, stationary at the minimum, leaves no more than the cosine of the angle to be gained there).
#pragma once

#include "granular/narrow/kernels.h"

namespace granular {

/// Radius of a ball that rolls freely inside: an ellipsoid's least curvature radius (Blaschke), a sphere's own; m.
double rollingRadius(const Shape& shape);

/// True if the local minimum is proven to be the global one. margin: distance of the origin's foot from the rim of C's
/// flat facet, 0 for none. Proofs that outlast a step are kept in the cache.
bool isGlobalMinimum(const PairView& pair, Difference& c, const LocalMinimum& m, double margin, WarmCache& cache);

}  // namespace granular
