// Faces of a convex hull that are flat to a tolerance, made truly flat: neighbours that lie in one plane are joined
// into one polygon, and vertices are moved onto the planes of their faces. A cuboid read from a single-precision file
// comes out as a cuboid of six faces instead of twelve triangles, and what a face says of itself is true to rounding.
#pragma once

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "granular/core/math.h"

namespace granular {

using FaceCorners = std::vector<std::int32_t>;

/// Joins neighbouring faces whose corners lie within flatness (m) of the plane of the largest of them, corners
/// counter-clockwise seen from outside. Faces whose union is no simple polygon stay apart.
std::vector<FaceCorners> joinFlatFaces(std::span<const Vec3> vertices, const std::vector<FaceCorners>& faces,
                                       double flatness);

/// Moves vertices, each as little as possible, until every face is planar to rounding. Returns the furthest a vertex
/// moved, m, or infinity if the faces could not be made planar.
double flattenFaces(const std::vector<FaceCorners>& faces, std::vector<Vec3>& vertices);

/// Drops corners that fewer than three faces share (points on straight edges) and faces left with fewer than three
/// corners.
void dropIdleCorners(std::size_t vertexCount, std::vector<FaceCorners>& faces);

/// The edges at which two faces meet: directed edge (from, to) and the face whose corners run that way, sorted.
struct FaceSide {
  std::int32_t from, to, face;
  bool operator<(const FaceSide& other) const {
    return std::tie(from, to, face) < std::tie(other.from, other.to, other.face);
  }
};
std::vector<FaceSide> faceSides(const std::vector<FaceCorners>& faces);

}  // namespace granular
