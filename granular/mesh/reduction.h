// A convex hull of few vertices that stands for one of many.
// Greedy insertion: from a tetrahedron of far points, each step takes the vertex that adds the most volume, which is
// known exactly for every candidate (the tetrahedra between it and the faces it sees). Local improvement: one vertex at
// a time is taken out and the best one put in, until no exchange gains volume. The vertices are a subset of the given
// hull's, so the result lies inside it; optionally it is then scaled about its centre of mass to the full volume, which
// halves the distance between the two surfaces.
#pragma once

#include <vector>

#include "granular/shape/hull.h"
#include "granular/shape/shape.h"

namespace granular {

struct ReductionOptions {
  int vertexBudget = 60;    ///< at least 4
  bool matchVolume = true;  ///< scale the reduced hull to the volume of the full one
};

/// What the reduction did; lengths and volumes in the unit of the points.
struct HullReduction {
  ConvexHull hull;                 ///< the reduced hull, scaled if asked for
  double fullVolume = 0;           ///< of the given hull
  double subsetVolume = 0;         ///< of the hull of the chosen vertices, unscaled
  double volume = 0;               ///< of the reduced hull as returned
  double scale = 1;                ///< linear factor applied about the centre of mass
  double volumeError = 0;          ///< (volume - fullVolume) / fullVolume
  double symmetricDifference = 0;  ///< volume inside exactly one of the two, as a fraction of fullVolume
  double outside = 0;              ///< how far the given hull stands out, at most, over the faces of the reduced one
  double inside = 0;               ///< how far the reduced hull stands out, at most, over the faces of the given one
};

/// Reduces a hull to the vertex budget; one that meets it is returned unchanged. Deterministic. Throws InputError for a
/// budget below 4.
HullReduction reduceHull(const ConvexHull& hull, const ReductionOptions& options);

/// The hull's faces as a triangle mesh.
TriangleMesh hullMesh(const ConvexHull& hull);

/// Volume of the hull, > 0.
double hullVolume(const ConvexHull& hull);

}  // namespace granular
