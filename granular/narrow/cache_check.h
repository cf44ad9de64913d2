// Whether what a pair remembers names features that its shapes have: for memories that come from a file.
#pragma once

#include "granular/pair/warm_cache.h"
#include "granular/shape/shape.h"

namespace granular {

/// False if the kernel of the two convex shapes, given in any order, would look up a feature that is not there.
bool cacheFits(const WarmCache& cache, const Shape& a, const Shape& b);

}  // namespace granular
