// The convex hull of a set of points, by Qhull (reentrant C interface), with coplanar facets merged into polygons.
// The points are normalised first, so that micrometres and kilometres give the same hull.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "granular/core/math.h"

namespace granular {

/// A convex polyhedron as faces over vertices. Deterministic: vertices in the order of the input, every face starting
/// at its least corner, faces in ascending order of their corners.
struct ConvexHull {
  std::vector<Vec3> vertices;         ///< input points, m, unless moved to make a face planar (see convexHull)
  std::vector<std::int32_t> sources;  ///< their indices in the input, ascending
  std::vector<std::vector<std::int32_t>> faces;  ///< corners counter-clockwise seen from outside, planar to rounding
  std::vector<Vec3> normals;                     ///< outward, unit
};

/// The hull of the points. Duplicates, points inside and points on faces or edges are dropped; so are points that stand
/// out by less than tolerance::hullWidth of the largest extent. Faces flat to that tolerance are joined, and their
/// corners moved (by a few times that) to make them planar to rounding. Where noise just above it would leave slivers,
/// ten or a hundred times the tolerance is taken, so that the hull strays from the points by about five times their
/// noise. Throws InputError for fewer than four points, for points that are not finite, and for points that lie (to the
/// tolerance) in a plane, on a line or in one place.
ConvexHull convexHull(std::span<const Vec3> points);

/// The hull's faces as triangles, each face a fan about its first corner.
std::vector<std::array<int, 3>> fanTriangles(const ConvexHull& hull);

/// Unit normal of a planar polygon, counter-clockwise seen from its tip (Newell's sum: every corner counts).
Vec3 polygonNormal(std::span<const Vec3> vertices, std::span<const std::int32_t> corners);

}  // namespace granular
