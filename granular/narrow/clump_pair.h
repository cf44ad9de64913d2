// Pairs with a clump: every child of one body against every child of the other (or against the whole of a convex one),
// found through the bounding trees of both. A step looks only at children that the last search found near; between
// searches the bodies may travel as far as the search reached (docs/architecture.md, "Clumps").
#pragma once

#include <vector>

#include "granular/narrow/narrow.h"
#include "granular/pair/child_pair.h"

namespace granular {

/// Two placed shapes of which at least one is a clump; B's frame holds the periodic image next to A.
struct ClumpPairView {
  const Shape& a;
  const Frame& frameA;
  const Shape& b;
  const Frame& frameB;
};

/// Fills out, sorted, with the pairs of children whose gap may be below reach (m, >= 0): all whose gap is, and some
/// more where the other body is convex and not round.
void findNearChildren(const ClumpPairView& pair, double reach, std::vector<ChildPair>& out);

/// True of clumps and spheres.
inline bool isOfBalls(const Shape& shape) {
  return shape.kind() == ShapeKind::sphere || shape.kind() == ShapeKind::clump;
}
/// True if children only meet balls.
inline bool meetsBalls(const Shape& a, const Shape& b) { return isOfBalls(a) && isOfBalls(b); }

/// Looks at one pair of children of two bodies that meetsBalls. Returns the overlap, and fills touch where it is
/// positive; otherwise minus the gap.
double touchBallChildren(const ClumpPairView& pair, const ChildPair& children, Touch& touch);

/// The same for a child and a convex body, by the kernel of spheres.
double touchChildAndConvex(const ClumpPairView& pair, const ChildPair& children, bool searchAlways, WarmCache& cache,
                           NarrowCounts& counts, Touch& touch);

/// One contact of two shapes.
struct ChildTouch {
  ChildPair children;
  Touch touch;
};

/// All contacts of two placed shapes of any kind, from nothing: for set-up and analysis.
void findTouches(const ClumpPairView& pair, std::vector<ChildTouch>& out);

}  // namespace granular
