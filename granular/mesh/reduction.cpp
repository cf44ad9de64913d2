#include "granular/mesh/reduction.h"

#include <algorithm>
#include <cmath>

#include "granular/core/errors.h"

namespace granular {
namespace {

// The faces of a hull as a candidate sees them: the volume it adds is the sum of weight * (normal . p - offset)
// over the faces where that is positive. weight: a third of the area.
struct FaceTable {
  std::vector<Vec3> normals;
  std::vector<double> offsets, weights;

  explicit FaceTable(const ConvexHull& hull) {
    for (std::size_t f = 0; f < hull.faces.size(); ++f) {
      const std::vector<std::int32_t>& face = hull.faces[f];
      Vec3 twiceArea = Vec3::Zero();
      for (std::size_t k = 1; k + 1 < face.size(); ++k) {
        const Vec3& a = hull.vertices[face[0]];
        twiceArea += (hull.vertices[face[k]] - a).cross(hull.vertices[face[k + 1]] - a);
      }
      normals.push_back(hull.normals[f]);
      double offset = -infinity;
      for (const std::int32_t corner : face) offset = std::max(offset, hull.normals[f].dot(hull.vertices[corner]));
      offsets.push_back(offset);
      weights.push_back(twiceArea.norm() / 6);
    }
  }

  double gain(const Vec3& p) const {
    double sum = 0;
    for (std::size_t f = 0; f < normals.size(); ++f) sum += weights[f] * std::max(0.0, normals[f].dot(p) - offsets[f]);
    return sum;
  }

  // How far p stands over its furthest face.
  double height(const Vec3& p) const {
    double most = -infinity;
    for (std::size_t f = 0; f < normals.size(); ++f) most = std::max(most, normals[f].dot(p) - offsets[f]);
    return most;
  }
};

struct Candidate {
  int index = -1;
  double gain = 0;
};

// The chosen vertices of the given hull and what adding or exchanging one would gain.
class Selection {
 public:
  explicit Selection(const std::vector<Vec3>& vertices) : all(vertices), taken(vertices.size(), false) {}

  void add(int index) {
    chosen.push_back(index);
    taken[index] = true;
  }
  void replace(std::size_t place, int index) {
    taken[chosen[place]] = false;
    chosen[place] = index;
    taken[index] = true;
  }
  std::size_t size() const { return chosen.size(); }
  int operator[](std::size_t place) const { return chosen[place]; }

  // The hull of the chosen vertices, one place left out if asked for.
  ConvexHull hull(std::size_t without = SIZE_MAX) const {
    std::vector<Vec3> points;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (k != without) points.push_back(all[chosen[k]]);
    }
    return convexHull(points);
  }

  // The vertex not chosen that adds the most.
  Candidate best(const FaceTable& faces) const {
    Candidate best;
    for (std::size_t v = 0; v < all.size(); ++v) {
      if (taken[v]) continue;
      const double gain = faces.gain(all[v]);
      if (gain > best.gain) best = {static_cast<int>(v), gain};
    }
    return best;
  }

 private:
  const std::vector<Vec3>& all;
  std::vector<bool> taken;
  std::vector<int> chosen;
};

// Four far points: the first, the one furthest from it, then furthest from their line and from their plane.
void chooseTetrahedron(const std::vector<Vec3>& vertices, Selection& selection) {
  const auto furthest = [&](auto measure) {
    int best = 0;
    double most = -1;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const double m = measure(vertices[v]);
      if (m > most) {
        most = m;
        best = static_cast<int>(v);
      }
    }
    return best;
  };
  Vec3 middle = Vec3::Zero();
  for (const Vec3& v : vertices) middle += v / static_cast<double>(vertices.size());
  const int a = furthest([&](const Vec3& p) { return (p - middle).norm(); });
  const int b = furthest([&](const Vec3& p) { return (p - vertices[a]).norm(); });
  const Vec3 line = (vertices[b] - vertices[a]).normalized();
  const int c = furthest([&](const Vec3& p) { return line.cross(p - vertices[a]).norm(); });
  const Vec3 normal = line.cross(vertices[c] - vertices[a]).normalized();
  const int d = furthest([&](const Vec3& p) { return std::abs(normal.dot(p - vertices[a])); });
  for (const int index : {a, b, c, d}) selection.add(index);
}

// Exchanges vertices while that gains volume; bounded by a number of candidate evaluations (a second or so).
void exchangeVertices(const std::vector<Vec3>& vertices, double fullVolume, Selection& selection) {
  constexpr double workLimit = 1e9;
  // Gains below this are rounding.
  const double negligible = 1e-9 * fullVolume;
  double work = 0;
  for (bool improved = true; improved && work < workLimit;) {
    improved = false;
    for (std::size_t place = 0; place < selection.size() && work < workLimit; ++place) {
      const FaceTable faces(selection.hull(place));
      work += static_cast<double>(faces.normals.size() * vertices.size());
      const double own = faces.gain(vertices[selection[place]]);
      const Candidate best = selection.best(faces);
      if (best.gain <= own + negligible) continue;
      selection.replace(place, best.index);
      improved = true;
    }
  }
}

// Volume common to two hulls that both hold the centre, by duality: the planes become points, the hull of these points
// has a facet for every vertex of the intersection.
double commonVolume(const ConvexHull& a, const ConvexHull& b, const Vec3& centre) {
  std::vector<Vec3> dual;
  for (const ConvexHull* hull : {&a, &b}) {
    for (std::size_t f = 0; f < hull->faces.size(); ++f) {
      const double offset = hull->normals[f].dot(hull->vertices[hull->faces[f][0]] - centre);
      dual.push_back(hull->normals[f] / offset);
    }
  }
  const ConvexHull dualHull = convexHull(dual);
  std::vector<Vec3> corners;
  for (std::size_t f = 0; f < dualHull.faces.size(); ++f) {
    corners.push_back(dualHull.normals[f] / dualHull.normals[f].dot(dualHull.vertices[dualHull.faces[f][0]]));
  }
  return hullVolume(convexHull(corners));
}

}  // namespace

TriangleMesh hullMesh(const ConvexHull& hull) { return {hull.vertices, fanTriangles(hull)}; }

double hullVolume(const ConvexHull& hull) { return signedVolume(hull.vertices, fanTriangles(hull)); }

HullReduction reduceHull(const ConvexHull& hull, const ReductionOptions& options) {
  require(options.vertexBudget >= 4,
          "vertex budget " + std::to_string(options.vertexBudget) + " is too small: a body has at least 4 vertices");
  HullReduction out;
  out.fullVolume = hullVolume(hull);
  if (hull.vertices.size() <= static_cast<std::size_t>(options.vertexBudget)) {
    out.hull = hull;
    out.volume = out.subsetVolume = out.fullVolume;
    return out;
  }

  // Insertion, then exchange.
  Selection selection(hull.vertices);
  chooseTetrahedron(hull.vertices, selection);
  while (selection.size() < static_cast<std::size_t>(options.vertexBudget)) {
    const Candidate best = selection.best(FaceTable(selection.hull()));
    if (best.index < 0) break;
    selection.add(best.index);
  }
  exchangeVertices(hull.vertices, out.fullVolume, selection);
  out.hull = selection.hull();
  out.subsetVolume = hullVolume(out.hull);

  // Back to the full volume, about the centre of mass.
  const TriangleMesh subset = hullMesh(out.hull);
  const Vec3 centre = solidProperties(subset.vertices, subset.triangles).centroid;
  if (options.matchVolume) {
    out.scale = std::cbrt(out.fullVolume / out.subsetVolume);
    for (Vec3& v : out.hull.vertices) v = centre + out.scale * (v - centre);
  }

  // What it costs.
  out.volume = hullVolume(out.hull);
  out.volumeError = (out.volume - out.fullVolume) / out.fullVolume;
  out.symmetricDifference = (out.volume + out.fullVolume - 2 * commonVolume(hull, out.hull, centre)) / out.fullVolume;
  const FaceTable reducedFaces(out.hull), fullFaces(hull);
  for (const Vec3& v : hull.vertices) out.outside = std::max(out.outside, reducedFaces.height(v));
  for (const Vec3& v : out.hull.vertices) out.inside = std::max(out.inside, fullFaces.height(v));
  return out;
}

}  // namespace granular
