// From a heap of triangles to one closed, consistently oriented surface, with an exact count of everything found on the
// way. Order, which the counts depend on: non-finite vertices; weld; degenerate and duplicate triangles; open and
// non-manifold edges of what is left; fins; orientation; parts, of which the largest closed one is kept.
// Not looked for: surfaces that cross themselves or each other.
#pragma once

#include <cstdint>
#include <vector>

#include "granular/mesh/import.h"
#include "granular/shape/shape.h"

namespace granular {

/// Vertices closer than this fraction of the bounding box's diagonal are one vertex: above the rounding of coordinates
/// written with seven digits or stored in single precision, far below an edge of any scan that fits the size limits. It
/// is never less than one single-precision step at the largest coordinate.
inline constexpr double weldFraction = 1e-6;

/// A triangle whose least altitude is below this fraction of its longest edge is a sliver; at or below the weld
/// distance it is degenerate.
inline constexpr double sliverFraction = 0.01;

/// What was found; everything counted, nothing estimated.
struct MeshDefects {
  std::int64_t nonFiniteVertices = 0;     ///< NaN or infinite; a reason to refuse the mesh
  std::int64_t unreferencedVertices = 0;  ///< listed but used by no triangle: dropped
  std::int64_t duplicateVertices =
      0;  ///< listed more than once: welded (where vertices are listed per corner: only inexact copies)
  std::int64_t degenerateTriangles = 0;  ///< two corners welded, or no area: dropped
  std::int64_t zeroAreaKept = 0;         ///< no area, but the surface would open without them: kept
  std::int64_t duplicateTriangles = 0;   ///< the same three corners again, in any order: dropped
  std::int64_t slivers = 0;              ///< kept
  std::int64_t openEdges = 0;            ///< edges of one triangle
  std::int64_t nonManifoldEdges = 0;     ///< edges of three or more triangles
  std::int64_t finTriangles = 0;         ///< open pieces attached along non-manifold edges: dropped
  std::int64_t flippedTriangles = 0;     ///< oriented against the majority of their part: turned
  std::int64_t unorientableEdges = 0;    ///< edges across which no orientation is consistent (a Moebius band has some)
  bool insideOut = false;                ///< the kept part as a whole was oriented inwards: turned
  std::int64_t parts = 0;                ///< connected across edges of two triangles, fins not counted
  std::int64_t droppedParts = 0;         ///< all but the kept one
  std::int64_t droppedTriangles = 0;     ///< the triangles of the dropped parts
  std::int64_t euler = 0;                ///< vertices - edges + faces, before fins and parts are dropped
  double weldDistance = 0;               ///< the distance used, file unit
  double coordinateStep = 0;             ///< spacing of single-precision numbers at the largest coordinate, file unit
};

/// The part that is kept, after all repairs.
struct KeptPart {
  bool closed = false;  ///< every edge is passed as often in one direction as in the other
  std::int64_t openEdges = 0;
  std::int64_t nonManifoldEdges = 0;
  std::int64_t euler = 0;
  std::int64_t handles = 0;  ///< (2 - euler) / 2 of a closed part; 0 for an open one
  double droppedArea = 0;    ///< area of the largest part that was dropped, as a fraction of the kept part's
};

struct RepairedMesh {
  TriangleMesh mesh;  ///< the kept part: used vertices alone, in the order of the file, outward orientation
  MeshDefects defects;
  KeptPart kept;
};

/// Joins vertices and drops degenerate and duplicate triangles; fills in the defects found so far. Triangles with a
/// non-finite vertex are left out.
TriangleMesh weldMesh(const RawMesh& raw, MeshDefects& defects);

/// The whole repair. The mesh is empty when no triangle with an area is left.
RepairedMesh repairMesh(const RawMesh& raw);

/// Least altitude of a triangle and its longest edge.
struct TriangleMeasure {
  double altitude = 0;
  double longestEdge = 0;
};
TriangleMeasure measureTriangle(const TriangleMesh& mesh, const std::array<int, 3>& triangle);

/// One triangle's use of an edge; sorted by edge, then by triangle.
struct EdgeUse {
  std::uint64_t edge;  ///< both ends, the lesser first
  std::int32_t triangle;
  bool forward;  ///< from the lesser to the greater end
};
std::vector<EdgeUse> listEdgeUses(const std::vector<std::array<int, 3>>& triangles);

/// Calls visit(first, last) for the uses of each edge.
template <class Visit>
void forEachEdge(const std::vector<EdgeUse>& uses, Visit visit) {
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t last = first + 1;
    while (last < uses.size() && uses[last].edge == uses[first].edge) ++last;
    visit(uses.data() + first, uses.data() + last);
    first = last;
  }
}

/// Drops vertices that no triangle uses; the others keep their order.
void dropUnusedVertices(TriangleMesh& mesh);

}  // namespace granular
