// Where the depth of two polyhedra has its local minima: along the normal of a face of either, above a vertex of the
// other, or across a pair of edges. C = A - B then has a flat facet there (the face, or the parallelogram of the two
// edges), and the feature is a local minimum exactly when the origin's foot on the facet's plane lies within the facet.
#pragma once

#include "granular/core/wide.h"
#include "granular/narrow/descent.h"
#include "granular/shape/polyhedron.h"

namespace granular {

/// What a feature says of the pair; axes and points of the reference body, m.
struct FeatureCheck {
  bool holds = false;    ///< the feature is a local minimum of the depth
  LocalMinimum minimum;  ///< its normal, depth and deepest points; filled also when it doesn't hold, unless degenerate
  double margin = 0;     ///< distance of the origin's foot from the facet's rim (0 for ties)
};

/// The face of `reference` against the vertex of `other` deepest below it; other lies at `frame` in the reference's
/// axes. vertex: seed of the climb, receives the deepest vertex. minimum.onA is on the reference, the normal its
/// outward one. tie: m, differences below it don't count.
FeatureCheck checkFace(const PolyhedronTables& reference, std::int32_t face, const PolyhedronTables& other,
                       const Frame& frame, double tie, std::int32_t& vertex);

/// Signed distance of the foot of p on the face from its rim, positive inside, m (outside: at least in sign).
double faceMargin(const PolyhedronTables& tables, std::int32_t face, const Vec3& p);

/// An edge of A against an edge of B, which lies at `frame` in A's axes.
FeatureCheck checkEdges(const PolyhedronTables& a, std::int32_t edgeA, const PolyhedronTables& b, std::int32_t edgeB,
                        const Frame& frame, double tie);

/// Faces that are parallel, or an edge parallel to a face, have several deepest vertices; none of them need lie above
/// the face although the faces overlap (crossed planks). Holds if the hull of the tied vertices meets the face's prism;
/// the deepest points are then the middle of the common part.
FeatureCheck checkTiedFace(const PolyhedronTables& reference, std::int32_t face, const PolyhedronTables& other,
                           const Frame& frame, double tie);

/// isGlobal below for one pair or several side by side, by what of x lies along the normal and across it.
template <class Real>
Mask<Real> isGlobal(const Real& depth, const Real& margin, const Real& along, const Real& across, const Real& inner) {
  const Real k = depth / choose(margin > 0, margin, Real(Real{} + 1)), k2 = k * k;
  const Mask<Real> covers = (inner - depth) * (1 + k2) + along * (1 - k2) - 2 * k * across >= 0;
  return both(both(margin >= depth, along >= 0), covers);
}

/// True if a local minimum is proven to be the global one by three parts of C: the disk of radius `margin` on its
/// facet, which covers all directions within 2 atan(margin/depth) of the normal, and the ball of radius `inner` (the
/// sum of the inner radii) about minus B's centre x, which must cover the rest.
inline bool isGlobal(const Vec3& normal, double depth, double margin, const Vec3& x, double inner) {
  const double along = x.dot(normal), across = std::sqrt(std::max(0.0, x.squaredNorm() - along * along));
  return isGlobal(depth, margin, along, across, inner);
}
template <class Real>
Mask<Real> isGlobal(const Triple<Real>& normal, const Real& depth, const Real& margin, const Triple<Real>& x,
                    const Real& inner) {
  const Real along = x.dot(normal), across = squareRoot(larger(Real(x.dot(x) - along * along), Real{}));
  return isGlobal(depth, margin, along, across, inner);
}

}  // namespace granular
