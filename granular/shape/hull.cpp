// Qhull merges facets that are coplanar to rounding; what it leaves is cleaned (corners on straight edges), checked
// (closed, convex), and where near-degenerate points spoil the check, built again with a larger tolerance of flatness.
#include "granular/shape/hull.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <string>
#include <utility>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"
#include "granular/shape/flat_faces.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace granular {

namespace {

using Corners = FaceCorners;

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

/// Runs Qhull on normalised points; a point that stands out by less than width is no vertex. False when Qhull gives up.
bool runQhull(std::span<const Vec3> points, double width, RawFaces& raw) {
  std::vector<coordT> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});

  // Pp: no precision warnings; W: a point less than this above a facet is no vertex. Messages go to a scratch file.
  char options[64];
  std::snprintf(options, sizeof options, "qhull Pp W%.3g", width);
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

  dropIdleCorners(points.size(), faces);
  for (Corners& face : faces) {
    const Vec3 normal = polygonNormal(points, face);
    if (normal.dot(points[static_cast<std::size_t>(face[0])] - inside) < 0) std::reverse(face.begin(), face.end());
  }
  return faces;
}

/// True if every directed edge occurs once and its reverse once, and Euler's formula holds.
bool isClosed(const std::vector<Corners>& faces) {
  const std::vector<FaceSide> sides = faceSides(faces);
  Corners used;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const FaceSide& side = sides[k];
    if (used.empty() || used.back() != side.from) used.push_back(side.from);
    if (k > 0 && sides[k - 1].from == side.from && sides[k - 1].to == side.to) return false;
    const auto back = std::lower_bound(sides.begin(), sides.end(), FaceSide{side.to, side.from, -1});
    if (back == sides.end() || back->from != side.to || back->to != side.from) return false;
  }
  return used.size() + faces.size() == sides.size() / 2 + 2;
}

/// True if no vertex lies above a face by more than tolerated (normalised points: the half extent is 1). Of a very
/// large hull only the faces next to each other are compared, which is enough for a closed surface.
bool isConvex(std::span<const Vec3> points, const std::vector<Corners>& faces) {
  const std::vector<FaceSide> sides = faceSides(faces);
  Corners all;
  for (const FaceSide& side : sides) {
    if (all.empty() || all.back() != side.from) all.push_back(side.from);
  }
  const bool large = all.size() * faces.size() > 4000000;
  for (const Corners& face : faces) {
    const Vec3 normal = polygonNormal(points, face);
    double offset = infinity;
    for (std::int32_t c : face) offset = std::min(offset, normal.dot(points[static_cast<std::size_t>(c)]));
    const auto isBelow = [&](std::int32_t v) {
      return normal.dot(points[static_cast<std::size_t>(v)]) - offset <= 2 * tolerance::hullConvexity;
    };
    if (!large) {
      if (!std::all_of(all.begin(), all.end(), isBelow)) return false;
      continue;
    }
    for (std::size_t k = 0; k < face.size(); ++k) {
      const FaceSide back{face[(k + 1) % face.size()], face[k], -1};
      const auto across = std::lower_bound(sides.begin(), sides.end(), back);
      const Corners& next = faces[static_cast<std::size_t>(across->face)];
      if (!std::all_of(next.begin(), next.end(), isBelow)) return false;
    }
  }
  return true;
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
                                                    ", more than 4e-7 is needed)");
}

/// Faces in their final order; vertices renumbered in the order of the input, their coordinates left to be filled in.
ConvexHull canonical(std::size_t pointCount, std::vector<Corners> faces) {
  ConvexHull hull;
  std::vector<std::int32_t> number(pointCount, -1);
  for (const Corners& face : faces) {
    for (std::int32_t c : face) number[static_cast<std::size_t>(c)] = 0;
  }
  for (std::size_t k = 0; k < pointCount; ++k) {
    if (number[k] < 0) continue;
    number[k] = static_cast<std::int32_t>(hull.sources.size());
    hull.sources.push_back(static_cast<std::int32_t>(k));
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

namespace {

/// The hull of normalised points with faces flat to width joined and flattened: faces over the points, and where the
/// points have moved. False if it is not closed and convex.
bool tryHull(std::span<const Vec3> points, double width, std::vector<Corners>& faces, std::vector<Vec3>& flat) {
  RawFaces raw;
  if (!runQhull(points, width, raw)) return false;
  faces = joinFlatFaces(points, cleanFaces(points, raw), 2 * width);
  dropIdleCorners(points.size(), faces);
  if (faces.size() < 4 || !isClosed(faces)) return false;
  flat.assign(points.begin(), points.end());
  return flattenFaces(faces, flat) <= 8 * width && isConvex(flat, faces);
}

}  // namespace

ConvexHull convexHull(std::span<const Vec3> points) {
  const auto [centre, half] = normalisation(points);
  std::vector<Vec3> normalised(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) normalised[k] = (points[k] - centre) / half;
  requireSolid(normalised);

  // as a rule the first width does; points whose noise is about as large make slivers, which a larger one takes away,
  // and where nothing is to be joined the bare hull is as good
  for (const double width : {tolerance::hullWidth, 10 * tolerance::hullWidth, 100 * tolerance::hullWidth, 1e-12}) {
    std::vector<Corners> faces;
    std::vector<Vec3> flat;
    if (!tryHull(normalised, width, faces, flat)) continue;
    ConvexHull hull = canonical(points.size(), std::move(faces));
    std::vector<Vec3> corners;
    for (std::int32_t source : hull.sources) {
      const auto k = static_cast<std::size_t>(source);
      corners.push_back(flat[k]);
      // what was flat to rounding keeps its bits
      hull.vertices.push_back(flat[k] == normalised[k] ? points[k] : Vec3(centre + half * flat[k]));
    }
    for (const Corners& face : hull.faces) hull.normals.push_back(polygonNormal(corners, face));
    return hull;
  }
  throw InputError("convex hull: no closed convex surface found for " + std::to_string(points.size()) +
                   " points; they are too nearly degenerate");
}

}  // namespace granular
