// A wall of triangles: finds the facets, ridges and corners that a body reaches and collects its contacts with them.
#include <algorithm>

#include "granular/core/tolerances.h"
#include "granular/wall/mesh_contact.h"
#include "granular/wall/spot_share.h"
#include "granular/wall/triangle_tree.h"

namespace granular {

namespace {

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// Working memory of one thread, kept between calls.
struct Scratch {
  std::vector<std::int32_t> triangles, ridges, corners;
  std::vector<RidgeDepth> ridgeDepths;
  std::vector<CornerDepth> cornerDepths;
  std::vector<PartTouch> facetTouches, ridgeTouches, cornerTouches;
  std::vector<Claim> claims;
  SunkenSurface surface;
};

void keepUnique(std::vector<std::int32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

class MeshWall final : public Wall {
 public:
  MeshWall(const TriangleMesh& triangles, const std::string& file)
      : source(file),
        mesh(buildFacetMesh(triangles.vertices, triangles.triangles, file)),
        tree(mesh.vertices, mesh.triangles) {}

  void touch(const RuleOptions& rule, const Shape& shape, const Frame& frame,
             std::vector<WallTouch>& out) const override {
    thread_local Scratch scratch;
    scratch.triangles.clear();
    findTriangles(shape, frame, scratch.triangles);
    if (scratch.triangles.empty()) return;
    MeshQuery query{mesh, shape, frame, rule, scratch.triangles, {}};
    findDepths(query, scratch);
    query.ridges = scratch.ridgeDepths;
    touchFacets(query, scratch);
    touchRidges(query, scratch);
    touchCorners(query, scratch);

    // Spots count the parts of each kind in turn: facets 0, 3, 6 ...; ridges 1, 4, 7 ...; corners 2, 5, 8 ...
    const auto begin = static_cast<std::ptrdiff_t>(out.size());
    scratch.claims.clear();
    std::int32_t kind = 0;
    for (const auto* touches : {&scratch.facetTouches, &scratch.ridgeTouches, &scratch.cornerTouches}) {
      for (const PartTouch& part : *touches) {
        out.push_back(part.touch);
        out.back().spot = 3 * part.part + kind;
        scratch.claims.push_back(part.claim);
      }
      ++kind;
    }
    const std::span<WallTouch> mine(out.begin() + begin, out.end());
    if (rule.rule == PointRule::foundation) {
      fadeStiffness(scratch.claims, mine);
    } else {
      shareStiffness(scratch.claims, mine);
    }
    std::sort(mine.begin(), mine.end(), [](const WallTouch& s, const WallTouch& t) { return s.spot < t.spot; });
  }

  double clearance(const Vec3& centre, double radius) const override {
    double squared;
    tree.findNearest(centre, squared);
    return std::sqrt(squared) - radius;
  }

  bool admits(const Vec3& p) const override {
    // At an edge or vertex several triangles are equally near: the one seen most squarely tells the side.
    double squared;
    const std::int32_t nearest = tree.findNearest(p, squared);
    const auto footOn = [&](std::int32_t t) { return tree.findNearestOn(t, p); };
    Aabb around;
    around.include(footOn(nearest));
    std::vector<std::int32_t> near;
    const double slack = tolerance::certificate * mesh.extent;
    tree.findOverlapping(around.grown(slack), near);
    double side = 0;
    for (std::int32_t t : near) {
      const Vec3 away = p - footOn(t);
      if (away.norm() > std::sqrt(squared) + slack) continue;
      const double height = mesh.facets[at(mesh.triangleFacet[at(t)])].normal.dot(away);
      if (std::abs(height) > std::abs(side)) side = height;
    }
    return side > 0;
  }

  std::string describe() const override {
    const auto text = [](std::size_t n, const char* what) { return std::to_string(n) + " " + what; };
    std::string line = source + ": " + text(mesh.triangles.size(), "triangles in ") +
                       text(mesh.facets.size(), "facets, ") + text(mesh.ridges.size(), "ridges, ") +
                       text(mesh.corners.size(), "corners");
    if (mesh.rims > 0) line += ", " + std::to_string(mesh.rims) + " rims";
    if (mesh.joined > 0) line += ", " + std::to_string(mesh.joined) + " vertices joined";
    if (mesh.degenerate > 0) line += ", " + std::to_string(mesh.degenerate) + " triangles without area dropped";
    if (mesh.nonManifold > 0) line += ", " + std::to_string(mesh.nonManifold) + " edges not between two triangles";
    return line;
  }

 private:
  /// The triangles within reach of the body.
  void findTriangles(const Shape& shape, const Frame& frame, std::vector<std::int32_t>& out) const {
    const double margin = reach * shape.boundingRadius();
    tree.findOverlapping(shape.bounds(frame).grown(margin), out);
    // Boxes leave many: a triangle lies behind the plane through its point nearest to the body's centre, and the body
    // may lie before that plane.
    std::erase_if(out, [&](std::int32_t t) {
      const Vec3 foot = tree.findNearestOn(t, frame.x), up = frame.x - foot;
      const double distance = up.norm();
      if (distance > shape.boundingRadius() + margin) return true;
      if (distance <= shape.innerRadius() + margin) return false;
      const Vec3 lowest = frame.toWorld(shape.support(frame.unrotate(-up)));
      return up.dot(lowest - foot) > margin * distance;
    });
  }

  void touchFacets(const MeshQuery& query, Scratch& scratch) const {
    scratch.facetTouches.clear();
    const std::span<const std::int32_t> all = query.triangles;
    for (std::size_t begin = 0, end; begin < all.size(); begin = end) {
      const std::int32_t facet = mesh.triangleFacet[at(all[begin])];
      for (end = begin + 1; end < all.size() && mesh.triangleFacet[at(all[end])] == facet;) ++end;
      PartTouch touch;
      if (touchFacet(query, facet, all.subspan(begin, end - begin), scratch.surface, touch))
        scratch.facetTouches.push_back(touch);
    }
    shareAreas(scratch.facetTouches);
  }

  void findDepths(const MeshQuery& query, Scratch& scratch) const {
    scratch.ridges.clear();
    scratch.corners.clear();
    for (std::int32_t t : query.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t ridge = mesh.triangleRidges[at(t)][k], corner = mesh.triangleCorners[at(t)][k];
        if (ridge >= 0 && mesh.ridges[at(ridge)].convex) scratch.ridges.push_back(ridge);
        if (corner >= 0) scratch.corners.push_back(corner);
      }
    keepUnique(scratch.ridges);
    keepUnique(scratch.corners);

    scratch.cornerDepths.clear();
    CornerDepth depth;
    for (std::int32_t corner : scratch.corners)
      if (findCornerDepth(query, corner, depth)) scratch.cornerDepths.push_back(depth);
    scratch.ridgeDepths.clear();
    if (scratch.ridges.empty()) return;
    const Aabb box = query.shape.bounds(Frame());
    for (std::int32_t ridge : scratch.ridges) scratch.ridgeDepths.push_back(findRidgeDepth(query, box, ridge));
    compareRidges(mesh, scratch.cornerDepths, scratch.ridgeDepths);
  }

  void touchRidges(const MeshQuery& query, Scratch& scratch) const {
    scratch.ridgeTouches.clear();
    for (const RidgeDepth& depth : query.ridges) {
      PartTouch touch;
      if (touchRidge(query, depth, scratch.facetTouches, scratch.surface, touch)) scratch.ridgeTouches.push_back(touch);
    }
  }

  void touchCorners(const MeshQuery& query, Scratch& scratch) const {
    scratch.cornerTouches.clear();
    for (const CornerDepth& depth : scratch.cornerDepths) {
      PartTouch touch;
      if (touchCorner(query, depth, scratch.facetTouches, scratch.ridgeTouches, touch))
        scratch.cornerTouches.push_back(touch);
    }
  }

  std::string source;
  FacetMesh mesh;
  TriangleTree tree;
};

}  // namespace

std::unique_ptr<Wall> makeMeshWall(const TriangleMesh& mesh, const std::string& source) {
  return std::make_unique<MeshWall>(mesh, source);
}

}  // namespace granular
