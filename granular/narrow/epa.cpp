// The expanding polytope. Facets keep their neighbours, so that the facets a new point sees are found by walking;
// facets in whose plane the point lies count as seen, which keeps slivers from being made of coplanar points.
#include "granular/narrow/epa.h"

namespace granular {
namespace {

/// Corners of a polytope: enough for all but bodies on a common axis or around each other, and for those.
constexpr int fewCorners = 256, manyCorners = 2048;

struct Facet {
  Vec3 normal;
  double distance;
  double bound;                  // least distance at which a direction that counts leaves the facet
  std::array<int, 3> corner;     // counter-clockwise from outside
  std::array<int, 3> neighbour;  // across the edge corner[k] -> corner[k + 1]
};

/// A triangulated polytope with its facets in an array without gaps.
template <int maxVertices>
class Polytope {
  static constexpr int maxFacets = 2 * maxVertices;

 public:
  Polytope(double roundOffLength, const GrantedCone* cone) : roundOff(roundOffLength), granted(cone) {}

  std::array<SupportPoint, maxVertices> vertices;
  int vertexCount = 0;

  int count() const { return alive; }
  const Facet& facet(int slot) const { return facets[static_cast<std::size_t>(order[static_cast<std::size_t>(slot)])]; }

  /// Slot of the facet with the least bound.
  int nearest() const {
    int best = 0;
    for (int slot = 1; slot < alive; ++slot) {
      if (facet(slot).bound < facet(best).bound) best = slot;
    }
    return best;
  }

  /// The first four vertices become a tetrahedron; false if they are flat.
  bool startTetrahedron() {
    const Vec3 normal = (w(1) - w(0)).cross(w(2) - w(0));
    const double height = normal.dot(w(3) - w(0));
    if (!(std::abs(height) > roundOff * normal.norm())) return false;
    if (height > 0) std::swap(vertices[1], vertices[2]);
    constexpr std::array<std::array<int, 3>, 4> corners{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
    constexpr std::array<std::array<int, 3>, 4> neighbours{{{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}}};
    for (std::size_t k = 0; k < 4; ++k) {
      const int id = addFacet(corners[k][0], corners[k][1], corners[k][2]);
      if (id < 0) return false;
      facets[static_cast<std::size_t>(id)].neighbour = neighbours[k];
    }
    return true;
  }

  /// Adds a point that the facet in the slot sees; false, with the polytope unchanged, if round-off forbids it.
  bool expand(int slot, const SupportPoint& p);

 private:
  const Vec3& w(int v) const { return vertices[static_cast<std::size_t>(v)].w; }

  int addFacet(int i, int j, int k) {
    if (freeCount == 0 && used == maxFacets) return -1;
    const Vec3 cross = (w(j) - w(i)).cross(w(k) - w(i));
    const double length = cross.norm();
    if (!(length > 0)) return -1;
    const int id = freeCount ? freeIds[static_cast<std::size_t>(--freeCount)] : used++;
    Facet& f = facets[static_cast<std::size_t>(id)];
    f.normal = cross / length;
    f.distance = f.normal.dot(w(i));
    f.bound = f.distance;
    if (granted && f.distance > 0) {
      const double cosine = f.normal.dot(granted->axis);
      if (cosine > granted->cosine) {
        f.bound /= granted->cosine * cosine + granted->sine * std::sqrt(std::max(0.0, 1 - cosine * cosine));
      }
    }
    f.corner = {i, j, k};
    place[static_cast<std::size_t>(id)] = alive;
    order[static_cast<std::size_t>(alive++)] = id;
    return id;
  }

  void removeFacet(int id) {
    const int slot = place[static_cast<std::size_t>(id)];
    const int last = order[static_cast<std::size_t>(--alive)];
    order[static_cast<std::size_t>(slot)] = last;
    place[static_cast<std::size_t>(last)] = slot;
    freeIds[static_cast<std::size_t>(freeCount++)] = id;
  }

  bool collectSeen(int start, const Vec3& point);

  struct HorizonEdge {
    int from, to, outside, outsideEdge;
  };

  double roundOff;
  const GrantedCone* granted;
  std::array<Facet, maxFacets> facets;
  std::array<int, maxFacets> order, place, freeIds;
  int alive = 0, used = 0, freeCount = 0;

  std::array<int, maxFacets> seen;
  int seenCount = 0;
  std::array<unsigned char, maxFacets> mark{};
  std::array<HorizonEdge, maxVertices> horizon;
  int horizonCount = 0;
};

/// Walks from a facet over all connected facets that see the point; gathers them and the rim around them.
template <int maxVertices>
bool Polytope<maxVertices>::collectSeen(int start, const Vec3& point) {
  seenCount = 0;
  horizonCount = 0;
  seen[static_cast<std::size_t>(seenCount++)] = start;
  mark[static_cast<std::size_t>(start)] = 1;
  for (int next = 0; next < seenCount; ++next) {
    for (const int g : facets[static_cast<std::size_t>(seen[static_cast<std::size_t>(next)])].neighbour) {
      const Facet& other = facets[static_cast<std::size_t>(g)];
      if (mark[static_cast<std::size_t>(g)] || other.normal.dot(point) - other.distance < -roundOff) continue;
      mark[static_cast<std::size_t>(g)] = 1;
      seen[static_cast<std::size_t>(seenCount++)] = g;
    }
  }
  bool fits = seenCount < alive;
  for (int k = 0; k < seenCount && fits; ++k) {
    const Facet& f = facets[static_cast<std::size_t>(seen[static_cast<std::size_t>(k)])];
    for (std::size_t e = 0; e < 3; ++e) {
      const int g = f.neighbour[e];
      if (mark[static_cast<std::size_t>(g)]) continue;
      if (horizonCount == maxVertices) {
        fits = false;
        break;
      }
      const Facet& other = facets[static_cast<std::size_t>(g)];
      int back = 0;
      while (other.corner[static_cast<std::size_t>(back)] != f.corner[(e + 1) % 3]) ++back;
      horizon[static_cast<std::size_t>(horizonCount++)] = {f.corner[e], f.corner[(e + 1) % 3], g, back};
    }
  }
  for (int k = 0; k < seenCount; ++k) mark[static_cast<std::size_t>(seen[static_cast<std::size_t>(k)])] = 0;
  return fits;
}

template <int maxVertices>
bool Polytope<maxVertices>::expand(int slot, const SupportPoint& p) {
  if (vertexCount == maxVertices) return false;
  if (!collectSeen(order[static_cast<std::size_t>(slot)], p.w)) return false;
  if (used - freeCount + horizonCount > maxFacets) return false;

  // The rim must be one simple loop whose new triangles have area; otherwise round-off has the better of the polytope.
  std::array<int, maxVertices> startsAt;
  for (int v = 0; v < vertexCount; ++v) startsAt[static_cast<std::size_t>(v)] = -1;
  for (int k = 0; k < horizonCount; ++k) {
    const HorizonEdge& e = horizon[static_cast<std::size_t>(k)];
    if (startsAt[static_cast<std::size_t>(e.from)] >= 0) return false;
    startsAt[static_cast<std::size_t>(e.from)] = k;
    if (!((w(e.to) - w(e.from)).cross(p.w - w(e.from)).norm() > 0)) return false;
  }

  const int apex = vertexCount;
  vertices[static_cast<std::size_t>(vertexCount++)] = p;
  std::array<int, maxVertices> made;
  for (int k = 0; k < horizonCount; ++k) {
    const HorizonEdge& e = horizon[static_cast<std::size_t>(k)];
    const int id = addFacet(e.from, e.to, apex);
    assert(id >= 0);
    made[static_cast<std::size_t>(k)] = id;
    facets[static_cast<std::size_t>(id)].neighbour[0] = e.outside;
    facets[static_cast<std::size_t>(e.outside)].neighbour[static_cast<std::size_t>(e.outsideEdge)] = id;
  }
  for (int k = 0; k < horizonCount; ++k) {
    const int following = startsAt[static_cast<std::size_t>(horizon[static_cast<std::size_t>(k)].to)];
    const int id = made[static_cast<std::size_t>(k)];
    const int next = made[static_cast<std::size_t>(following)];
    facets[static_cast<std::size_t>(id)].neighbour[1] = next;
    facets[static_cast<std::size_t>(next)].neighbour[2] = id;
  }
  for (int k = 0; k < seenCount; ++k) removeFacet(seen[static_cast<std::size_t>(k)]);
  return true;
}

/// Four points of C far from flat: the extremes along a direction, across it, and across both.
template <int maxVertices>
bool makeStart(Difference& c, const Vec3& start, Polytope<maxVertices>& polytope, DepthBounds& out) {
  auto take = [&](const Vec3& n) {
    const SupportPoint p = c.support(n);
    ++out.supports;
    const double depth = p.w.dot(n);
    if (depth < out.upper) {
      out.upper = depth;
      out.normal = n;
      out.hasFacet = false;
    }
    return p;
  };
  auto& v = polytope.vertices;
  v[0] = take(start);
  v[1] = take(-start);
  const Vec3 axis = (v[0].w - v[1].w).normalized();
  const Vec3 across = perpendicular(axis);
  double best = -1;
  for (const Vec3& d : {across, Vec3(-across), Vec3(axis.cross(across)), Vec3(-axis.cross(across))}) {
    const SupportPoint p = take(d);
    const double away = axis.cross(p.w - v[0].w).norm();
    if (away > best) {
      best = away;
      v[2] = p;
    }
  }
  const Vec3 normal = axis.cross(v[2].w - v[0].w).normalized();
  const SupportPoint above = take(normal), below = take(-normal);
  v[3] = normal.dot(above.w - v[0].w) > normal.dot(v[0].w - below.w) ? above : below;
  polytope.vertexCount = 4;
  return polytope.startTetrahedron();
}

template <int maxVertices>
DepthBounds expandTo(Difference& c, const Vec3& start, double known, double tolerance, const GrantedCone* granted) {
  DepthBounds out;
  Polytope<maxVertices> polytope(8 * std::numeric_limits<double>::epsilon() * c.extent(), granted);
  if (!makeStart(c, start, polytope, out)) return out;
  if (known < out.upper) {
    out.upper = known;
    out.normal = start;
  }

  while (out.upper >= 0) {
    const int slot = polytope.nearest();
    const Facet facet = polytope.facet(slot);
    out.lower = facet.bound;
    if (out.lower >= out.upper - tolerance) break;

    const SupportPoint p = c.support(facet.normal);
    ++out.supports;
    const double depth = p.w.dot(facet.normal);
    if (depth < out.upper) {
      out.upper = depth;
      out.normal = facet.normal;
      out.hasFacet = true;
      for (std::size_t k = 0; k < 3; ++k) out.facet[k] = polytope.vertices[static_cast<std::size_t>(facet.corner[k])];
      if (out.lower >= out.upper - tolerance) break;
    }
    if (!polytope.expand(slot, p)) break;
  }
  out.met = out.upper < 0 || out.lower >= out.upper - tolerance;
  return out;
}

}  // namespace

DepthBounds boundOverlap(Difference& c, const Vec3& start, double known, double tolerance, const GrantedCone* granted) {
  return expandTo<fewCorners>(c, start, known, tolerance, granted);
}

DepthBounds boundOverlapFinely(Difference& c, const Vec3& start, double known, double tolerance) {
  return expandTo<manyCorners>(c, start, known, tolerance, nullptr);
}

}  // namespace granular
