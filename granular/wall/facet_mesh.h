// A triangle mesh as a wall sees it: not triangles but flat facets, the ridges between them and the corners where
// ridges meet, each counted once however finely the surface is cut. Built once, at load.
//
// Equal positions are joined; triangles of no area are dropped; neighbours in one plane form one facet, so that the
// edges between them are nothing. What is left of the edges are ridges: straight pieces between the same two facets are
// one ridge, and a vertex where nothing but such pieces meet is nothing either.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "granular/wall/plane_patch.h"

namespace granular {

/// A straight edge between two facets, or at the rim of an open sheet.
struct Ridge {
  std::int32_t a, b;  ///< end vertices; facet `left` lies to the left of a -> b, seen from the granular side
  std::int32_t left, right = -1;            ///< facets; right = -1 at a rim
  bool convex = true;                       ///< it stands out towards the grains; rims do. Concave ridges touch nothing
  Vec3 direction;                           ///< unit, a to b
  double length;                            ///< m
  std::int32_t cornerA = -1, cornerB = -1;  ///< into corners
  Vec3 intoLeft, intoRight;  ///< unit, in the plane of either facet, perpendicular to the ridge, into the facet
};

/// A vertex where a convex ridge ends. A normal n belongs to it if n . d <= 0 for each of its spokes d.
struct Corner {
  std::int32_t vertex;
  std::int32_t ridgeBegin, ridgeEnd;  ///< into cornerRidges
  std::int32_t spokeBegin, spokeEnd;  ///< into spokes
  bool convex = false;                ///< the solid at the corner lies below every one of its facets
};

struct FacetMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< ordered by facet
  std::vector<std::int32_t> triangleFacet;
  std::vector<Plane> facets;
  std::vector<std::uint8_t> facetIsConvex;  ///< known to be: a facet of a single triangle
  std::vector<Ridge> ridges;
  std::vector<Corner> corners;             ///< those that can touch
  std::vector<std::int32_t> cornerRidges;  ///< ridges that meet at each corner, CSR
  std::vector<Vec3> spokes;                ///< unit directions of all mesh edges that leave each corner, CSR
  /// Per triangle and side k (from corner k to k + 1): the ridge it is part of, -1 inside a facet.
  std::vector<std::array<std::int32_t, 3>> triangleRidges;
  /// Per triangle and corner k: the index into corners, -1 where nothing can touch.
  std::vector<std::array<std::int32_t, 3>> triangleCorners;

  double extent = 0;    ///< diagonal of the bounds, m
  int joined = 0;       ///< vertices merged with another at the same position
  int degenerate = 0;   ///< triangles dropped because they have no area
  int nonManifold = 0;  ///< edges of more than two triangles, or of two that disagree about the side; each is a rim
  int rims = 0;         ///< ridges with a facet on one side only
};

/// Throws InputError, naming `source`, for no triangle, a bad index, a coordinate that is not finite, or no area at
/// all.
FacetMesh buildFacetMesh(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles,
                         const std::string& source);

}  // namespace granular
