#include "granular/narrow/exhaustive.h"

#include <algorithm>
#include <limits>

#include "granular/core/random.h"
#include "granular/narrow/narrow.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

/// Corners in world axes relative to A's centre, so that h(n) is a scan over both lists.
struct Corners {
  std::vector<Vec3> points;
  Corners(const PolyhedronTables& tables, const Mat3& R, const Vec3& x) {
    for (const Vec3& v : tables.vertices) points.push_back(R * v + x);
  }
  double highest(const Vec3& n) const {
    double best = -infinity;
    for (const Vec3& p : points) best = std::max(best, p.dot(n));
    return best;
  }
};

/// Unit vectors along the normals of an edge's two faces, world axes.
struct Arc {
  Vec3 left, right, along, end;
};

std::vector<Arc> arcsOf(const PolyhedronTables& tables, const Mat3& R, const Corners& corners) {
  std::vector<Arc> arcs;
  for (const PolyhedronTables::Edge& e : tables.edges) {
    const Vec3& from = corners.points[static_cast<std::size_t>(e.a)];
    arcs.push_back({R * tables.faces[static_cast<std::size_t>(e.faceLeft)].normal,
                    R * tables.faces[static_cast<std::size_t>(e.faceRight)].normal,
                    corners.points[static_cast<std::size_t>(e.b)] - from, from});
  }
  return arcs;
}

/// True if n, perpendicular to the edge, lies between the normals of its two faces (with a margin against round-off).
bool lieWithin(const Arc& arc, const Vec3& n) {
  const double cosine = arc.left.dot(arc.right), left = n.dot(arc.left), right = n.dot(arc.right);
  constexpr double margin = 1e-6;
  return left >= cosine * right - margin && right >= cosine * left - margin && left + right > 0;
}

ExhaustiveDepth searchPolyhedra(const PolyhedronTables& a, const Frame& frameA, const PolyhedronTables& b,
                                const Frame& frameB) {
  const Corners cornersA(a, frameA.R, Vec3::Zero()), cornersB(b, frameB.R, frameB.x - frameA.x);
  ExhaustiveDepth best;
  auto look = [&](const Vec3& n) {
    const double depth = cornersA.highest(n) + cornersB.highest(-n);
    if (depth < best.depth) best = {depth, n};
  };
  // B's corners are subtracted: h(n) = max over A of n.a + max over B of -n.b.
  for (const auto& face : a.faces) look(frameA.R * face.normal);
  for (const auto& face : b.faces) look(-(frameB.R * face.normal));

  const std::vector<Arc> arcsA = arcsOf(a, frameA.R, cornersA), arcsB = arcsOf(b, frameB.R, cornersB);
  for (const Arc& p : arcsA) {
    for (const Arc& q : arcsB) {
      Vec3 n = p.along.cross(q.along);
      const double length = n.norm();
      if (length <= 1e-9 * p.along.norm() * q.along.norm()) continue;
      n /= length;
      if (lieWithin(p, n) && lieWithin(q, -n)) look(n);
      if (lieWithin(p, -n) && lieWithin(q, n)) look(-n);
    }
  }
  return best;
}

/// Tries random neighbours at a distance that shrinks whenever none of a dozen is better. Where one was, what lies as
/// far again and half beyond it comes next: down a valley with steep sides, in which few neighbours are better, small
/// steps would go on for ever. Better by round-off does not count, as a level surface always has such.
void refine(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, double step, Random& random,
            ExhaustiveDepth& best) {
  const double roundOff = std::numeric_limits<double>::epsilon() * (a.boundingRadius() + b.boundingRadius());
  Vec3 move = Vec3::Zero();
  const auto improve = [&](const Vec3& direction) {
    const Vec3 n = direction.normalized();
    const double depth = depthAlong(a, frameA, b, frameB, n);
    if (!(depth < best.depth - roundOff)) return false;
    move = n - best.normal;
    best = {depth, n};
    return true;
  };
  while (step > 1e-9) {
    bool better = false;
    for (int trial = 0; trial < 12 && !better; ++trial) {
      const double far = step * random.uniform();
      better = improve(best.normal + far * random.direction());
    }
    while (better && improve(best.normal + 1.5 * move)) {
    }
    step *= better ? 1.3 : 0.6;
  }
}

}  // namespace

ExhaustiveDepth searchDirections(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, int nodes) {
  // Fibonacci's spiral covers the sphere evenly.
  std::vector<ExhaustiveDepth> net;
  for (int k = 0; k < nodes; ++k) {
    const double z = 1 - (2.0 * k + 1) / nodes, s = std::sqrt(1 - z * z), azimuth = 2.399963229728653 * k;
    const Vec3 n(s * std::cos(azimuth), s * std::sin(azimuth), z);
    net.push_back({depthAlong(a, frameA, b, frameB, n), n});
  }
  auto shallower = [](const ExhaustiveDepth& p, const ExhaustiveDepth& q) { return p.depth < q.depth; };
  std::sort(net.begin(), net.end(), shallower);

  // The best nodes that are not each other's neighbours start a refinement each.
  const double spacing = std::sqrt(4 * pi / nodes);
  std::vector<ExhaustiveDepth> starts;
  for (const ExhaustiveDepth& node : net) {
    const bool apart = std::all_of(starts.begin(), starts.end(), [&](const ExhaustiveDepth& other) {
      return (node.normal - other.normal).norm() > 3 * spacing;
    });
    if (apart) starts.push_back(node);
    if (starts.size() == 6) break;
  }
  Random random(7);
  for (ExhaustiveDepth& start : starts) refine(a, frameA, b, frameB, spacing, random, start);
  return *std::min_element(starts.begin(), starts.end(), shallower);
}

ExhaustiveDepth searchExhaustively(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB,
                                   int nodes) {
  const PolyhedronTables* tablesA = tablesOf(a);
  const PolyhedronTables* tablesB = tablesOf(b);
  if (tablesA && tablesB) return searchPolyhedra(*tablesA, frameA, *tablesB, frameB);
  return searchDirections(a, frameA, b, frameB, nodes);
}

}  // namespace granular
