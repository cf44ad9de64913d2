// Inscribed convex polytopes of a body that is known by its support function, refined until no face is further below
// its supporting plane than asked.
#pragma once

#include <functional>
#include <vector>

#include "granular/shape/hull.h"
#include "granular/shape/mass_properties.h"

namespace granular {

/// The surface point furthest along a unit direction.
using SupportFunction = std::function<Vec3(const Vec3&)>;

struct SupportPolytope {
  ConvexHull hull;           ///< vertices are support points, so the polytope lies inside the body
  std::vector<double> gaps;  ///< per face: distance to the supporting plane of its normal, m
  /// Sum of area times gap over the faces, m^3: what the polytope misses of the volume is less, and in proportion.
  double missing = 0;
};

/// Adds support points along face normals to the given points until every gap is at most tolerance (m) or the polytope
/// has maxVertices. points: start and result, so that the next call refines further. Throws InputError as convexHull.
SupportPolytope refineSupportPolytope(const SupportFunction& support, double tolerance, std::size_t maxVertices,
                                      std::vector<Vec3>& points);

/// Support points along 26 directions (axes, edges and corners of a cube) to start with.
std::vector<Vec3> firstSupportPoints(const SupportFunction& support);

}  // namespace granular
