// A convex body against the parts of a mesh wall: facets, ridges and corners.
//
// A normal belongs to the part whose Voronoi cone holds it: to a facet its own normal alone, to a ridge those between
// the normals of its two facets, to a corner those within its spokes. So a body meets each place of the wall once.
//  * Facet: overlap and patch as on the plane, over the facet's own area. Where nothing but flat surface or a concave
//    ridge is near (the body reaches under the neighbour there), the result is that of the plane wall, bit by bit.
//  * Ridge: the least depth h(n) over the normals between the two facets, h' changing sign inside; found by closing in
//  on
//    the two surface points between which the least depth lies (a two-dimensional portal).
//  * Corner: the least depth of the vertex below the body's surface.
// A flat face meets facets, ridges and corners at the same time; then the larger part holds it and the lesser ones
// fade, continuously, with the cosine between face and facet (or ridge), so that nothing jumps when the deepest point
// crosses a rim.
//
// Limits: a facet pushes a body back as long as the body reaches to both sides of the facet's plane and the depth stays
// within a tenth of its bounding radius of the facet's triangles' bounds; beyond, a single sheet has been tunnelled.
#pragma once

#include "granular/wall/facet_mesh.h"

namespace granular {

/// A body against a mesh, and the triangles that its bounds reach.
struct MeshQuery {
  const FacetMesh& mesh;
  const Shape& shape;
  const Frame& frame;
  const RuleOptions& rule;
  std::span<const std::int32_t> triangles;  ///< ascending, hence grouped by facet

  /// The point of the body furthest along d, world axes.
  Vec3 support(const Vec3& d) const { return frame.toWorld(shape.support(frame.unrotate(d))); }
};

/// A contact with a part of the mesh before the stiffness is shared; touch.share holds its weight.
struct PartTouch {
  std::int32_t part;  ///< index of the facet, ridge or corner
  bool broad;         ///< over an area or a line, not at a point: lesser parts give way to it
  WallTouch touch;
};

/// The contact with the facet of a group of triangles, false if there is none.
bool touchFacet(const MeshQuery& query, std::int32_t facet, std::span<const std::int32_t> triangles,
                SunkenSurface& surface, PartTouch& out);
/// The contact with a convex ridge. facets: contacts found with facets, ascending.
bool touchRidge(const MeshQuery& query, std::int32_t ridge, std::span<const PartTouch> facets, SunkenSurface& surface,
                PartTouch& out);
/// The contact with a corner. ridges: contacts found with ridges, ascending.
bool touchCorner(const MeshQuery& query, std::int32_t corner, std::span<const PartTouch> facets,
                 std::span<const PartTouch> ridges, PartTouch& out);

/// 1 for a face that lies flat on a part (cosine 1), falling to 0 at `fadeCosine`.
inline constexpr double fadeCosine = 0.999;
inline double flatWeight(double cosine) { return std::max(0.0, (cosine - fadeCosine) / (1 - fadeCosine)); }

/// The contact with a part, or null; touches ascending by part.
const PartTouch* findPart(std::span<const PartTouch> touches, std::int32_t part);

}  // namespace granular
