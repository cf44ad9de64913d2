// The oracle of the narrow phase: the least depth over all directions by looking everywhere, slow and plain. Polyhedra:
// all faces of both and all pairs of edges. Any other shape: a dense net of directions, the best of which are refined
// by a pattern search that uses nothing but h(n).
#pragma once

#include "granular/shape/shape.h"

namespace granular {

/// World axes. depth is h(normal), m: an upper bound of the overlap that no direction looked at improves; negative if
/// the normal separates the two.
struct ExhaustiveDepth {
  double depth = infinity;
  Vec3 normal = Vec3::UnitX();
};

/// nodes: directions of the net for shapes that are not both polyhedra.
ExhaustiveDepth searchExhaustively(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                                   int nodes = 2000);

/// The same by the net of directions alone, for any shapes: for polyhedra with more pairs of edges than can be looked
/// at.
ExhaustiveDepth searchDirections(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, int nodes);

}  // namespace granular
