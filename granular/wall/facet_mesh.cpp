#include "granular/wall/facet_mesh.h"

#include <algorithm>
#include <numeric>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"

namespace granular {

namespace {

using Indices = std::array<std::int32_t, 3>;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// Sine of the angle that two pieces of one ridge may make: short ones in single precision.
constexpr double straight = 1e-3;

/// One side of a triangle as a directed edge from corner `side` to the next.
struct HalfEdge {
  std::int32_t lo, hi;  ///< its vertices, sorted
  std::int32_t triangle, side;
  bool operator<(const HalfEdge& o) const {
    return std::tie(lo, hi, triangle, side) < std::tie(o.lo, o.hi, o.triangle, o.side);
  }
  bool joins(const HalfEdge& o) const { return lo == o.lo && hi == o.hi; }
};

/// Steps of the construction share this.
struct Builder {
  FacetMesh mesh;
  double tolerance = 0;             ///< distance within which points lie in one plane or line, m
  std::vector<HalfEdge> halfEdges;  ///< sorted: the sides of one edge are neighbours
  std::vector<Indices> across;      ///< neighbour triangle across each side, -1 where there is no single consistent one
  std::vector<Ridge> pieces;        ///< ridges before straight ones are joined
  std::vector<std::int32_t> pieceRidge;

  Vec3 corner(std::int32_t triangle, int k) const { return mesh.vertices[at(mesh.triangles[at(triangle)][at(k)])]; }
  /// Twice the area times the normal.
  Vec3 areaVector(std::int32_t t) const { return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)); }
  std::int32_t count() const { return static_cast<std::int32_t>(mesh.triangles.size()); }
};

void joinVertices(std::span<const Vec3> vertices, Builder& build, std::vector<std::int32_t>& joined) {
  // Sort by position; adding 0 turns -0 into +0.
  std::vector<std::int32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::int32_t k) {
    const Vec3& p = vertices[at(k)];
    return std::array<double, 3>{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0};
  };
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });

  // Each keeps the first index of its position, so that the numbering follows the file.
  std::vector<std::int32_t> first(vertices.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    first[at(order[k])] = k > 0 && key(order[k]) == key(order[k - 1]) ? first[at(order[k - 1])] : order[k];
  joined.resize(vertices.size());
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(vertices.size()); ++k) {
    if (first[at(k)] == k) {
      joined[at(k)] = static_cast<std::int32_t>(build.mesh.vertices.size());
      build.mesh.vertices.push_back(vertices[at(k)]);
    } else {
      joined[at(k)] = joined[at(first[at(k)])];
      ++build.mesh.joined;
    }
  }
}

void readTriangles(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles,
                   const std::string& source, Builder& build) {
  require(!triangles.empty(), source + ": a mesh wall needs at least one triangle");
  for (std::size_t k = 0; k < vertices.size(); ++k)
    require(vertices[k].allFinite(), source + ": vertex " + std::to_string(k) + " has a coordinate that is not finite");
  std::vector<std::int32_t> joined;
  joinVertices(vertices, build, joined);

  Aabb bounds;
  double largest = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Indices triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const int index = triangles[t][k];
      require(index >= 0 && index < static_cast<int>(vertices.size()),
              source + ": triangle " + std::to_string(t) + " refers to vertex " + std::to_string(index) + " of " +
                  std::to_string(vertices.size()));
      triangle[k] = joined[at(index)];
      bounds.include(vertices[at(index)]);
      largest = std::max(largest, vertices[at(index)].cwiseAbs().maxCoeff());
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
      ++build.mesh.degenerate;
    else
      build.mesh.triangles.push_back(triangle);
  }
  build.mesh.extent = (bounds.hi - bounds.lo).norm();
  build.tolerance = tolerance::coplanar * std::max(largest, build.mesh.extent);
}

void findNeighbours(Builder& build) {
  for (std::int32_t t = 0; t < build.count(); ++t)
    for (std::int32_t side = 0; side < 3; ++side) {
      const Indices& triangle = build.mesh.triangles[at(t)];
      const auto [lo, hi] = std::minmax(triangle[at(side)], triangle[at((side + 1) % 3)]);
      build.halfEdges.push_back({lo, hi, t, side});
    }
  std::sort(build.halfEdges.begin(), build.halfEdges.end());

  // Two triangles that run along their edge in opposite directions are neighbours; anything else is a rim of each.
  build.across.assign(build.mesh.triangles.size(), {-1, -1, -1});
  const auto start = [&](const HalfEdge& e) { return build.mesh.triangles[at(e.triangle)][at(e.side)]; };
  for (std::size_t k = 0, end; k < build.halfEdges.size(); k = end) {
    for (end = k + 1; end < build.halfEdges.size() && build.halfEdges[end].joins(build.halfEdges[k]);) ++end;
    const HalfEdge& e = build.halfEdges[k];
    if (end - k == 2 && start(e) != start(build.halfEdges[k + 1])) {
      const HalfEdge& f = build.halfEdges[k + 1];
      build.across[at(e.triangle)][at(e.side)] = f.triangle;
      build.across[at(f.triangle)][at(f.side)] = e.triangle;
    } else if (end - k > 1) {
      ++build.mesh.nonManifold;
    }
  }
}

/// Floods one facet from its largest triangle. Triangles without area go along: they join what lies on either side.
void floodFacet(std::int32_t seed, std::int32_t facet, Builder& build) {
  FacetMesh& mesh = build.mesh;
  const Vec3 normal = build.areaVector(seed).normalized();
  const double offset = normal.dot(build.corner(seed, 0));
  const auto belongs = [&](std::int32_t t) {
    for (int k = 0; k < 3; ++k)
      if (std::abs(normal.dot(build.corner(t, k)) - offset) > build.tolerance) return false;
    // Not the back of a folded sheet: triangles too thin to tell may face anywhere.
    return build.areaVector(t).dot(normal) > -build.tolerance * mesh.extent;
  };

  std::vector<std::int32_t> stack{seed};
  mesh.triangleFacet[at(seed)] = facet;
  // Thousands of triangles are added up: in double precision their plane would be a hundred roundings off.
  using Long3 = Eigen::Matrix<long double, 3, 1>;
  Long3 sum = Long3::Zero();
  long double moment = 0, weight = 0;
  while (!stack.empty()) {
    const std::int32_t t = stack.back();
    stack.pop_back();
    // The plane through all: area vectors add up whatever the cut; centroids are weighted by area.
    const Vec3 area = build.areaVector(t);
    sum += area.cast<long double>();
    weight += area.norm();
    moment += area.norm() *
              normal.dot((build.corner(t, 0) + build.corner(t, 1) + build.corner(t, 2)) / 3 - build.corner(seed, 0));
    for (std::int32_t neighbour : build.across[at(t)])
      if (neighbour >= 0 && mesh.triangleFacet[at(neighbour)] < 0 && belongs(neighbour)) {
        mesh.triangleFacet[at(neighbour)] = facet;
        stack.push_back(neighbour);
      }
  }
  Plane plane;
  plane.normal = sum.normalized().cast<double>();
  plane.offset = plane.normal.dot(build.corner(seed, 0)) + static_cast<double>(moment / weight);
  mesh.facets.push_back(plane);
}

void findFacets(const std::string& source, Builder& build) {
  FacetMesh& mesh = build.mesh;
  std::vector<double> area(mesh.triangles.size());
  std::vector<std::int32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  double longest = 0;
  for (std::int32_t t : order) {
    area[at(t)] = build.areaVector(t).norm();
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (build.corner(t, k) - build.corner(t, (k + 1) % 3)).norm());
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return area[at(a)] > area[at(b)]; });

  // A triangle lower than the rounding of its coordinates has no normal.
  const auto height = [&](std::int32_t t) {
    double base = 0;
    for (int k = 0; k < 3; ++k) base = std::max(base, (build.corner(t, k) - build.corner(t, (k + 1) % 3)).norm());
    return area[at(t)] / base;
  };
  const double flat = tolerance::tie * mesh.extent;
  mesh.triangleFacet.assign(mesh.triangles.size(), -1);
  for (std::int32_t t : order) {
    if (!(height(t) > flat))
      ++mesh.degenerate;
    else if (mesh.triangleFacet[at(t)] < 0)
      floodFacet(t, static_cast<std::int32_t>(mesh.facets.size()), build);
  }
  require(!mesh.facets.empty(), source + ": none of its triangles has an area");
}

/// Every edge between two facets or at a rim, as one piece each, left < right where there are two.
void findPieces(Builder& build) {
  FacetMesh& mesh = build.mesh;
  mesh.triangleRidges.assign(mesh.triangles.size(), {-1, -1, -1});
  for (std::int32_t t = 0; t < build.count(); ++t) {
    const std::int32_t left = mesh.triangleFacet[at(t)];
    if (left < 0) continue;
    for (std::int32_t side = 0; side < 3; ++side) {
      const std::int32_t other = build.across[at(t)][at(side)];
      const std::int32_t right = other < 0 ? -1 : mesh.triangleFacet[at(other)];
      if (right == left || (right >= 0 && right < left)) continue;
      const std::int32_t piece = static_cast<std::int32_t>(build.pieces.size());
      Ridge ridge;
      ridge.a = mesh.triangles[at(t)][at(side)];
      ridge.b = mesh.triangles[at(t)][at((side + 1) % 3)];
      ridge.left = left;
      ridge.right = right;
      build.pieces.push_back(ridge);
      mesh.triangleRidges[at(t)][at(side)] = piece;
      if (right < 0) continue;
      for (std::size_t k = 0; k < 3; ++k)
        if (build.across[at(other)][k] == t && mesh.triangles[at(other)][k] == ridge.b)
          mesh.triangleRidges[at(other)][k] = piece;
    }
  }
}

/// Completes a ridge whose ends and facets are known.
void measureRidge(const FacetMesh& mesh, Ridge& ridge) {
  const Vec3 along = mesh.vertices[at(ridge.b)] - mesh.vertices[at(ridge.a)];
  ridge.length = along.norm();
  ridge.direction = along / ridge.length;
  ridge.intoLeft = mesh.facets[at(ridge.left)].normal.cross(ridge.direction).normalized();
  if (ridge.right < 0) {
    // At a rim the sheet ends: its other side faces away, in the plane of the facet.
    ridge.intoRight = -mesh.facets[at(ridge.left)].normal;
    return;
  }
  ridge.intoRight = ridge.direction.cross(mesh.facets[at(ridge.right)].normal).normalized();
  ridge.convex = ridge.intoLeft.dot(mesh.facets[at(ridge.right)].normal) <= 0;
}

/// Joins straight runs of pieces between the same facets into ridges, and finds the corners in between.
void joinPieces(Builder& build) {
  FacetMesh& mesh = build.mesh;
  std::vector<std::vector<std::int32_t>> meeting(mesh.vertices.size());
  for (std::size_t p = 0; p < build.pieces.size(); ++p)
    for (std::int32_t v : {build.pieces[p].a, build.pieces[p].b})
      meeting[at(v)].push_back(static_cast<std::int32_t>(p));

  // The piece that continues p straight on beyond its end vertex, or -1.
  const auto continuation = [&](std::int32_t p, bool forwards) -> std::int32_t {
    const Ridge& piece = build.pieces[at(p)];
    const std::int32_t v = forwards ? piece.b : piece.a;
    if (meeting[at(v)].size() != 2) return -1;
    const std::int32_t next = meeting[at(v)][0] == p ? meeting[at(v)][1] : meeting[at(v)][0];
    const Ridge& other = build.pieces[at(next)];
    if (other.left != piece.left || other.right != piece.right || (forwards ? other.a : other.b) != v) return -1;
    const Vec3 first = mesh.vertices[at(forwards ? piece.a : other.a)];
    const Vec3 last = mesh.vertices[at(forwards ? other.b : piece.b)];
    const Vec3 line = (last - first).normalized();
    const Vec3 from = mesh.vertices[at(v)] - first, on = last - mesh.vertices[at(v)];
    // A piece shorter than the tolerance may still turn a corner.
    if (from.normalized().cross(on.normalized()).norm() > straight || from.dot(on) < 0) return -1;
    return (from - line * line.dot(from)).norm() <= build.tolerance ? next : -1;
  };

  build.pieceRidge.assign(build.pieces.size(), -1);
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(build.pieces.size()); ++p) {
    if (build.pieceRidge[at(p)] >= 0) continue;
    // Back to the start of the run, then forwards along it. A run can't close on itself: it is straight.
    std::int32_t first = p;
    for (std::int32_t previous; (previous = continuation(first, false)) >= 0 && previous != p;) first = previous;
    Ridge ridge = build.pieces[at(first)];
    const std::int32_t number = static_cast<std::int32_t>(mesh.ridges.size());
    for (std::int32_t next = first; next >= 0 && build.pieceRidge[at(next)] < 0; next = continuation(next, true)) {
      build.pieceRidge[at(next)] = number;
      ridge.b = build.pieces[at(next)].b;
    }
    measureRidge(mesh, ridge);
    mesh.rims += ridge.right < 0;
    mesh.ridges.push_back(ridge);
  }
  for (Indices& sides : mesh.triangleRidges)
    for (std::int32_t& side : sides)
      if (side >= 0) side = build.pieceRidge[at(side)];
}

/// True if all that meets at the corner lies below the planes of its facets; at a rim, within its line as well.
bool isConvex(const FacetMesh& mesh, const Corner& corner) {
  const auto liesBelow = [&](const Vec3& normal) {
    for (std::int32_t k = corner.spokeBegin; k < corner.spokeEnd; ++k)
      if (normal.dot(mesh.spokes[at(k)]) > tolerance::certificate) return false;
    return true;
  };
  for (std::int32_t k = corner.ridgeBegin; k < corner.ridgeEnd; ++k) {
    const Ridge& ridge = mesh.ridges[at(mesh.cornerRidges[at(k)])];
    const Vec3 other = ridge.right < 0 ? Vec3(-ridge.intoLeft) : mesh.facets[at(ridge.right)].normal;
    if (!ridge.convex || !liesBelow(mesh.facets[at(ridge.left)].normal) || !liesBelow(other)) return false;
  }
  return true;
}

/// Corners: ends of ridges where at least one convex ridge arrives, with all mesh edges there as the cone.
void findCorners(Builder& build) {
  FacetMesh& mesh = build.mesh;
  std::vector<std::int32_t> cornerOf(mesh.vertices.size(), -1);
  for (const Ridge& ridge : mesh.ridges)
    if (ridge.convex)
      for (std::int32_t v : {ridge.a, ridge.b}) cornerOf[at(v)] = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (cornerOf[v] == 0) {
      cornerOf[v] = static_cast<std::int32_t>(mesh.corners.size());
      mesh.corners.push_back({static_cast<std::int32_t>(v), 0, 0, 0, 0, false});
    }

  // Ridges that end at each corner, and the far ends of all mesh edges there, by counting.
  std::vector<std::vector<std::int32_t>> ridges(mesh.corners.size()), spokes(mesh.corners.size());
  for (std::size_t r = 0; r < mesh.ridges.size(); ++r)
    for (std::int32_t v : {mesh.ridges[r].a, mesh.ridges[r].b})
      if (cornerOf[at(v)] >= 0) ridges[at(cornerOf[at(v)])].push_back(static_cast<std::int32_t>(r));
  mesh.triangleCorners.assign(mesh.triangles.size(), {-1, -1, -1});
  for (std::int32_t t = 0; t < build.count(); ++t) {
    if (mesh.triangleFacet[at(t)] < 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t corner = cornerOf[at(mesh.triangles[at(t)][k])];
      mesh.triangleCorners[at(t)][k] = corner;
      if (corner >= 0)
        for (std::size_t j : {(k + 1) % 3, (k + 2) % 3}) spokes[at(corner)].push_back(mesh.triangles[at(t)][j]);
    }
  }
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    Corner& corner = mesh.corners[c];
    corner.ridgeBegin = static_cast<std::int32_t>(mesh.cornerRidges.size());
    mesh.cornerRidges.insert(mesh.cornerRidges.end(), ridges[c].begin(), ridges[c].end());
    corner.ridgeEnd = static_cast<std::int32_t>(mesh.cornerRidges.size());
    corner.spokeBegin = static_cast<std::int32_t>(mesh.spokes.size());
    std::sort(spokes[c].begin(), spokes[c].end());
    spokes[c].erase(std::unique(spokes[c].begin(), spokes[c].end()), spokes[c].end());
    for (std::int32_t v : spokes[c])
      mesh.spokes.push_back((mesh.vertices[at(v)] - mesh.vertices[at(corner.vertex)]).normalized());
    corner.spokeEnd = static_cast<std::int32_t>(mesh.spokes.size());
    corner.convex = isConvex(mesh, corner);
  }
  for (Ridge& ridge : mesh.ridges) {
    ridge.cornerA = cornerOf[at(ridge.a)];
    ridge.cornerB = cornerOf[at(ridge.b)];
  }
}

/// Removes triangles that belong to no facet and puts the rest in the order of their facets.
void orderTriangles(FacetMesh& mesh) {
  std::vector<std::int32_t> order;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t)
    if (mesh.triangleFacet[at(t)] >= 0) order.push_back(t);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return mesh.triangleFacet[at(a)] < mesh.triangleFacet[at(b)];
  });
  const auto arrange = [&](auto& items) {
    auto old = items;
    items.clear();
    for (std::int32_t t : order) items.push_back(old[at(t)]);
  };
  arrange(mesh.triangles);
  arrange(mesh.triangleFacet);
  arrange(mesh.triangleRidges);
  arrange(mesh.triangleCorners);

  std::vector<int> count(mesh.facets.size());
  for (std::int32_t facet : mesh.triangleFacet) ++count[at(facet)];
  for (int n : count) mesh.facetIsConvex.push_back(n == 1);
}

}  // namespace

FacetMesh buildFacetMesh(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles,
                         const std::string& source) {
  Builder build;
  readTriangles(vertices, triangles, source, build);
  findNeighbours(build);
  require(!build.mesh.triangles.empty(), source + ": none of its triangles has an area");
  findFacets(source, build);
  findPieces(build);
  joinPieces(build);
  findCorners(build);
  orderTriangles(build.mesh);
  return std::move(build.mesh);
}

}  // namespace granular
