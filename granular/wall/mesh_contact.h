// A convex body against the parts of a mesh wall: facets, ridges and corners.
//
// A normal belongs to the part whose Voronoi cone holds it: to a facet its own normal alone, to a ridge those between
// the normals of its two facets, to a corner those within its spokes. So a body meets each place of the wall once.
//  * Facet: overlap and patch as on the plane, over the facet's own area. Where nothing but flat surface or a concave
//    ridge is near (the body reaches under the neighbour there), the result is that of the plane wall, bit by bit.
//  * Ridge: a local minimum of the depth h(n) over the normals between the two facets, found by closing in on the two
//    surface points between which it lies (a two-dimensional portal).
//  * Corner: the least depth of the vertex below the body's surface.
// The body leaves a ridge's wedge by its least depth over all normals of the ridge, the facets' own included: a facet
// or ridge whose overlap is twice that doesn't hold the body (the side of a step that the body lies on), and fades
// before. A flat face meets facets, ridges and corners at the same time; then the larger part holds it and the lesser
// ones fade with the angle between face and part, so that nothing jumps when the deepest point crosses a rim.
//
// Limits: a facet pushes a body back as long as the body reaches to both sides of the facet's plane and the depth stays
// within a tenth of its bounding radius of the facet's triangles' bounds; beyond, a single sheet has been tunnelled.
#pragma once

#include <algorithm>

#include "granular/wall/facet_mesh.h"
#include "granular/wall/spot_share.h"

namespace granular {

/// How far beyond the body's bounds triangles are looked for, relative to its bounding radius: the foot of a deepest
/// point lies up to one overlap outside.
inline constexpr double reach = 0.1;

/// The depth of a body below the infinite line of a convex ridge. Normals point out of the wall.
struct RidgeDepth {
  std::int32_t ridge;
  double around;  ///< least of this, its convex corners and the ridges that meet there, m
  double least;   ///< over all normals of the ridge's cone, m; not positive: apart
  bool near;      ///< the body's own box reaches the ridge
  bool found;     ///< there is a local minimum between the facets' normals; what follows describes the least of them
  Vec3 normal;
  double overlap;  ///< m
  Vec3 deepest;    ///< of the body, straight below the line, world axes
};

/// The depth of a corner's vertex below the body's surface, along a normal of the corner's cone (from the body
/// outwards).
struct CornerDepth {
  std::int32_t corner;
  double overlap;  ///< m, > 0
  Vec3 normal;
};

/// A body against a mesh, the triangles that its bounds reach, and the convex ridges.
struct MeshQuery {
  const FacetMesh& mesh;
  const Shape& shape;
  const Frame& frame;
  const RuleOptions& rule;
  std::span<const std::int32_t> triangles;  ///< ascending, hence grouped by facet
  std::span<const RidgeDepth> ridges;       ///< ascending

  /// The point of the body furthest along d, world axes.
  Vec3 support(const Vec3& d) const { return frame.toWorld(shape.support(frame.unrotate(d))); }
};

/// A contact with a part of the mesh before the stiffness is shared.
struct PartTouch {
  std::int32_t part;  ///< index of the facet, ridge or corner
  bool broad;         ///< over an area or a line, not at a point: lesser parts give way to it
  WallTouch touch;
  Claim claim;
};

/// The contact with the facet of a group of triangles, false if there is none.
bool touchFacet(const MeshQuery& query, std::int32_t facet, std::span<const std::int32_t> triangles,
                SunkenSurface& surface, PartTouch& out);
/// The depth below a convex ridge. bodyBox: bounds in body axes.
RidgeDepth findRidgeDepth(const MeshQuery& query, const Aabb& bodyBox, std::int32_t ridge);
/// The contact with a convex ridge. facets: contacts found with facets, ascending.
bool touchRidge(const MeshQuery& query, const RidgeDepth& depth, std::span<const PartTouch> facets,
                SunkenSurface& surface, PartTouch& out);
/// Finds the depth of a corner; false if its vertex is outside the body or the normal outside the corner's cone.
bool findCornerDepth(const MeshQuery& query, std::int32_t corner, CornerDepth& out);
/// The contact with a corner. ridges: contacts found with ridges, ascending.
bool touchCorner(const MeshQuery& query, const CornerDepth& depth, std::span<const PartTouch> facets,
                 std::span<const PartTouch> ridges, PartTouch& out);

/// 1 for a contact that is the least way out, to nine tenths (far above round-off), falling to 0 at half its overlap.
inline double leastWeight(double least, double overlap) { return std::clamp((least / overlap - 0.5) / 0.4, 0.0, 1.0); }

/// The contact with a part, or null; touches ascending by part.
const PartTouch* findPart(std::span<const PartTouch> touches, std::int32_t part);

/// Completes `around` of all ridges, ascending.
void compareRidges(const FacetMesh& mesh, std::span<const CornerDepth> corners, std::span<RidgeDepth> depths);

/// Facets that lie in one plane, or nearly, share their claims by area: each becomes its part of the whole.
void shareAreas(std::span<PartTouch> facets);

}  // namespace granular
