// Qhull merges facets that are coplanar to rounding; what it leaves is cleaned (corners on straight edges), checked
// (closed, convex), and where near-degenerate points spoil the check, rebuilt without the flattest of them.
#include "granular/shape/hull.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <numeric>
#include <string>
#include <utility>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace granular {

namespace {

using Corners = std::vector<std::int32_t>;

/// Corner lists of Qhull's facets, indices into the points, one facet after the other.
struct RawFaces {
  Corners begin, corners;
};

/// Copies Qhull's facets out. Plain C inside: Qhull leaves by longjmp when it meets an inconsistency.
bool readFacets(qhT* qh, RawFaces& raw) {
  if (setjmp(qh->errexit) != 0) {
    qh->NOerrexit = True;
    return false;
  }
  qh->NOerrexit = False;
  facetT* facet;
  vertexT *vertex, **vertexp;
  FORALLfacets {
    setT* ordered = qh_facet3vertex(qh, facet);
    raw.begin.push_back(static_cast<std::int32_t>(raw.corners.size()));
    FOREACHvertex_(ordered) { raw.corners.push_back(qh_pointid(qh, vertex->point)); }
    qh_settempfree(qh, &ordered);
  }
  raw.begin.push_back(static_cast<std::int32_t>(raw.corners.size()));
  qh->NOerrexit = True;
  return true;
}

/// Runs Qhull on normalised points. Returns false when Qhull gives up.
bool runQhull(std::span<const Vec3> points, RawFaces& raw) {
  std::vector<coordT> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});

  // Pp: no precision warnings; W: a point less than this above a facet is no vertex. Messages go to a scratch file.
  char options[64];
  std::snprintf(options, sizeof options, "qhull Pp W%.3g", tolerance::hullWidth);
  std::FILE* messages = std::tmpfile();
  qhT state;
  qhT* qh = &state;
  qh_zero(qh, messages);
  const int code =
      qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False, options, messages, messages);
  const bool ok = code == 0 && readFacets(qh, raw);

  // Qhull's memory in any case
  qh->NOerrexit = True;
  qh_freeqhull(qh, !qh_ALL);
  int current = 0, total = 0;
  qh_memfreeshort(qh, &current, &total);
  if (messages) std::fclose(messages);
  return ok;
}

/// Faces as lists, outward, without corners that fewer than three faces share (points on straight edges).
std::vector<Corners> cleanFaces(std::span<const Vec3> points, const RawFaces& raw) {
  std::vector<Corners> faces;
  for (std::size_t f = 0; f + 1 < raw.begin.size(); ++f) {
    faces.emplace_back(raw.corners.begin() + raw.begin[f], raw.corners.begin() + raw.begin[f + 1]);
  }
  Vec3 inside = Vec3::Zero();
  for (std::int32_t c : raw.corners) inside += points[static_cast<std::size_t>(c)];
  inside /= static_cast<double>(raw.corners.size());

  for (bool again = true; again;) {
    again = false;
    std::vector<int> uses(points.size(), 0);
    for (const Corners& face : faces) {
      for (std::int32_t c : face) ++uses[static_cast<std::size_t>(c)];
    }
    for (Corners& face : faces) {
      const auto dropped = std::erase_if(face, [&](std::int32_t c) { return uses[static_cast<std::size_t>(c)] < 3; });
      again = again || dropped > 0;
    }
    std::erase_if(faces, [](const Corners& face) { return face.size() < 3; });
  }
  for (Corners& face : faces) {
    const Vec3 normal = polygonNormal(points, face);
    if (normal.dot(points[static_cast<std::size_t>(face[0])] - inside) < 0) std::reverse(face.begin(), face.end());
  }
  return faces;
}

/// True if every directed edge occurs once and its reverse once, and Euler's formula holds.
bool isClosed(const std::vector<Corners>& faces) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  Corners used;
  for (const Corners& face : faces) {
    for (std::size_t k = 0; k < face.size(); ++k) {
      edges.emplace_back(face[k], face[(k + 1) % face.size()]);
      used.push_back(face[k]);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (std::size_t k = 0; k < edges.size(); ++k) {
    if (k > 0 && edges[k] == edges[k - 1]) return false;
    if (!std::binary_search(edges.begin(), edges.end(), std::pair(edges[k].second, edges[k].first))) return false;
  }
  return used.size() + faces.size() == edges.size() / 2 + 2;
}

/// The face with a vertex furthest above its plane, if further than tolerated; -1 if the hull is convex.
/// (Normalised points: the half extent is 1.)
int leastConvexFace(std::span<const Vec3> points, const std::vector<Corners>& faces) {
  Corners used;
  for (const Corners& face : faces) used.insert(used.end(), face.begin(), face.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());

  int worst = -1;
  double most = 2 * tolerance::hullConvexity;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Vec3 normal = polygonNormal(points, faces[f]);
    double offset = infinity;
    for (std::int32_t c : faces[f]) offset = std::min(offset, normal.dot(points[static_cast<std::size_t>(c)]));
    for (std::int32_t v : used) {
      const double above = normal.dot(points[static_cast<std::size_t>(v)]) - offset;
      if (!(above <= most)) {
        most = above;
        worst = static_cast<int>(f);
      }
    }
  }
  return worst;
}

/// The corner of a face nearest to the line through its two neighbours: what makes a sliver of it.
std::int32_t flattestCorner(std::span<const Vec3> points, const Corners& face) {
  std::int32_t flattest = face[0];
  double least = infinity;
  const std::size_t n = face.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3& p = points[static_cast<std::size_t>(face[k])];
    const Vec3 before = points[static_cast<std::size_t>(face[(k + n - 1) % n])] - p;
    const Vec3 after = points[static_cast<std::size_t>(face[(k + 1) % n])] - p;
    const double height = before.cross(after).norm() / std::max((after - before).norm(), 1e-300);
    if (height < least) {
      least = height;
      flattest = face[k];
    }
  }
  return flattest;
}

/// Centre and half of the largest extent. Throws InputError for points that are too few, not finite, or in one place.
std::pair<Vec3, double> normalisation(std::span<const Vec3> points) {
  require(points.size() >= 4, "convex hull: " + std::to_string(points.size()) + " points given, at least 4 are needed");
  Aabb box;
  for (std::size_t k = 0; k < points.size(); ++k) {
    require(points[k].allFinite(), "convex hull: point " + std::to_string(k) + " has a coordinate that is not finite");
    box.include(points[k]);
  }
  const double half = 0.5 * (box.hi - box.lo).maxCoeff();
  require(std::isfinite(half) && half > 0, "convex hull: all " + std::to_string(points.size()) + " points coincide");
  return {0.5 * (box.lo + box.hi), half};
}

/// Throws InputError if the normalised points are thinner than tolerated along any principal direction of their
/// scatter.
void requireSolid(std::span<const Vec3> points) {
  Mat3 scatter = Mat3::Zero();
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  for (const Vec3& p : points) scatter += (p - mean) * (p - mean).transpose();
  // the scatter matrix squares the ratio of extents, so the thin direction comes from the two long ones
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scatter);
  Vec3 thin = solver.eigenvectors().col(0);
  double lo = infinity, hi = -infinity;
  for (const Vec3& p : points) {
    lo = std::min(lo, thin.dot(p - mean));
    hi = std::max(hi, thin.dot(p - mean));
  }
  char ratio[32];
  std::snprintf(ratio, sizeof ratio, "%.2g", (hi - lo) / 2);
  require((hi - lo) / 2 > tolerance::hullWidth, "convex hull: the " + std::to_string(points.size()) +
                                                    " points lie in a plane (thickness over extent " + ratio +
                                                    ", more than 1e-8 is needed)");
}

/// Faces in their final order; vertices renumbered in the order of the input.
ConvexHull canonical(std::span<const Vec3> points, std::span<const std::int32_t> sources, std::vector<Corners> faces) {
  ConvexHull hull;
  std::vector<std::int32_t> number(points.size(), -1);
  for (const Corners& face : faces) {
    for (std::int32_t c : face) number[static_cast<std::size_t>(c)] = 0;
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (number[k] < 0) continue;
    number[k] = static_cast<std::int32_t>(hull.sources.size());
    hull.sources.push_back(sources[k]);
  }
  for (Corners& face : faces) {
    for (std::int32_t& c : face) c = number[static_cast<std::size_t>(c)];
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  }
  std::sort(faces.begin(), faces.end());
  hull.faces = std::move(faces);
  return hull;
}

}  // namespace

Vec3 polygonNormal(std::span<const Vec3> vertices, std::span<const std::int32_t> corners) {
  const Vec3& origin = vertices[static_cast<std::size_t>(corners[0])];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vec3 a = vertices[static_cast<std::size_t>(corners[k])] - origin;
    const Vec3 b = vertices[static_cast<std::size_t>(corners[k + 1])] - origin;
    sum += a.cross(b);
  }
  return sum.stableNormalized();
}

std::vector<std::array<int, 3>> fanTriangles(const ConvexHull& hull) {
  std::vector<std::array<int, 3>> triangles;
  for (const Corners& face : hull.faces) {
    for (std::size_t k = 1; k + 1 < face.size(); ++k) triangles.push_back({face[0], face[k], face[k + 1]});
  }
  return triangles;
}

ConvexHull convexHull(std::span<const Vec3> points) {
  const auto [centre, half] = normalisation(points);
  std::vector<Vec3> kept(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) kept[k] = (points[k] - centre) / half;
  requireSolid(kept);
  Corners sources(points.size());
  std::iota(sources.begin(), sources.end(), 0);

  // as a rule the first attempt stands; each further one leaves out the corner that makes the worst sliver
  for (std::size_t attempt = 0; attempt < 64 && kept.size() >= 4; ++attempt) {
    RawFaces raw;
    if (!runQhull(kept, raw)) break;
    std::vector<Corners> faces = cleanFaces(kept, raw);
    if (faces.size() < 4) break;
    const bool closed = isClosed(faces);
    const int bad = leastConvexFace(kept, faces);
    if (closed && bad < 0) {
      ConvexHull hull = canonical(kept, sources, std::move(faces));
      for (std::int32_t s : hull.sources) hull.vertices.push_back(points[static_cast<std::size_t>(s)]);
      std::vector<Vec3> normalised;
      for (const Vec3& v : hull.vertices) normalised.push_back((v - centre) / half);
      for (const Corners& face : hull.faces) hull.normals.push_back(polygonNormal(normalised, face));
      return hull;
    }
    const Corners& face = faces[static_cast<std::size_t>(std::max(bad, 0))];
    const auto drop = flattestCorner(kept, face);
    kept.erase(kept.begin() + drop);
    sources.erase(sources.begin() + drop);
  }
  throw InputError("convex hull: no closed convex surface found for " + std::to_string(points.size()) +
                   " points; they are too nearly degenerate");
}

}  // namespace granular
