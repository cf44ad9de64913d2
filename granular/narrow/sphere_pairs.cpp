// Pairs with a sphere: the point of the other shape nearest to the sphere's centre decides, in closed form. With the
// centre outside that point is unique; inside, the least distance to a face counts. Either way the answer is global.
#include <algorithm>

#include "granular/narrow/ball_touch.h"
#include "granular/narrow/kernels.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

/// Where the sphere's centre lies from the other shape, in that shape's axes, m.
struct SurfacePoint {
  Vec3 point;           ///< of the surface, nearest to the centre
  Vec3 outward;         ///< unit, from the shape towards the sphere
  double distance = 0;  ///< of the centre from the surface, negative inside
};

/// From the nearest point to the centre outside; `fallback` where the two coincide.
SurfacePoint lookFromOutside(const Vec3& centre, const Vec3& nearest, const Vec3& fallback) {
  const Vec3 d = centre - nearest;
  const double distance = d.norm();
  return {nearest, distance > 0 ? Vec3(d / distance) : fallback, distance};
}

bool report(const PairView& pair, const SurfacePoint& s, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  const double radius = pair.a.boundingRadius();
  const double overlap = radius - s.distance;
  const Vec3 normal = -pair.frameB.rotate(s.outward);
  const Vec3 direction = pair.frameA.unrotate(normal);
  if (!(overlap > 0)) return reportApart(direction, -overlap, cache);
  if (cache.touched && cache.direction.dot(direction) < flipCosine) ++counts.normalFlips;
  cache.touched = 1;
  cache.direction = direction;
  cache.budget = 0;
  touch.normal = normal;
  touch.overlap = overlap;
  touch.onB = pair.frameB.toWorld(s.point);
  touch.onA = touch.onB + overlap * normal;
  return true;
}

/// One of the closed forms, for the kernels below.
template <typename FindPoint>
bool touchByPoint(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch, FindPoint findPoint) {
  ++counts.warm;
  cache.kind = WarmCache::smooth;
  return report(pair, findPoint(pair.frameB.toBody(pair.frameA.x)), cache, counts, touch);
}

SurfacePoint findOnBox(const Vec3& half, const Vec3& c) {
  const Vec3 inside = c.cwiseMin(half).cwiseMax(-half);
  if (inside != c) return lookFromOutside(c, inside, Vec3::UnitX());
  int i = 0;
  const Vec3 depth = half - c.cwiseAbs();
  depth.minCoeff(&i);
  SurfacePoint s;
  s.outward = (c[i] < 0 ? -1 : 1) * Vec3::Unit(i);
  s.distance = -depth[i];
  s.point = c;
  s.point[i] = c[i] < 0 ? -half[i] : half[i];
  return s;
}

double distanceFromAxis(const Vec3& c) { return std::sqrt(c.x() * c.x() + c.y() * c.y()); }

/// In the half-plane through the axis of revolution: (distance from the axis, z).
SurfacePoint liftFromProfile(const Vec3& c, const Vec2& nearest, const Vec2& outward, double distance) {
  const double across = distanceFromAxis(c);
  const Vec2 azimuth = across > 0 ? Vec2(c.x() / across, c.y() / across) : Vec2(1, 0);
  return {Vec3(azimuth.x() * nearest.x(), azimuth.y() * nearest.x(), nearest.y()),
          Vec3(azimuth.x() * outward.x(), azimuth.y() * outward.x(), outward.y()), distance};
}

SurfacePoint findOnCylinder(double radius, double half, const Vec3& c) {
  const Vec2 p(distanceFromAxis(c), c.z());
  const Vec2 inside(std::min(p.x(), radius), std::clamp(p.y(), -half, half));
  const double end = p.y() < 0 ? -1 : 1;
  if (inside != p) {
    const Vec2 d = p - inside;
    const double distance = d.norm();
    return liftFromProfile(c, inside, d / distance, distance);
  }
  const double toSide = radius - p.x(), toCap = half - std::abs(p.y());
  if (toSide < toCap) return liftFromProfile(c, {radius, p.y()}, {1, 0}, -toSide);
  return liftFromProfile(c, {p.x(), end * half}, {0, end}, -toCap);
}

SurfacePoint findOnCone(const Cone& cone, const Vec3& c) {
  const Vec2 p(distanceFromAxis(c), c.z());
  const Vec2 rim(cone.radius(), cone.baseZ()), slant(-cone.radius(), cone.height());
  const double length = slant.norm();
  const Vec2 outward(cone.height() / length, cone.radius() / length);
  const double toSide = outward.dot(p - rim), toBase = cone.baseZ() - p.y();

  // Inside: the nearer of the two surfaces.
  if (toSide <= 0 && toBase <= 0) {
    if (toBase > toSide) return liftFromProfile(c, {p.x(), cone.baseZ()}, {0, -1}, toBase);
    return liftFromProfile(c, p - toSide * outward, outward, toSide);
  }
  // Outside: the nearer of the base disk and the generator. Beside the latter its own normal, whatever is left of p.
  const Vec2 onBase(std::min(p.x(), cone.radius()), cone.baseZ());
  const double along = slant.dot(p - rim) / (length * length);
  const bool beside = along > 0 && along < 1;
  const Vec2 onSide = beside ? Vec2(p - toSide * outward) : Vec2(rim + std::clamp(along, 0.0, 1.0) * slant);
  const bool base = (p - onBase).squaredNorm() < (p - onSide).squaredNorm();
  if (beside && !base) return liftFromProfile(c, onSide, outward, toSide);
  const Vec2 nearest = base ? onBase : onSide;
  const double distance = (p - nearest).norm();
  return liftFromProfile(c, nearest, distance > 0 ? Vec2((p - nearest) / distance) : outward, distance);
}

/// Nearest point of a polyhedron, feature by feature. A candidate is the nearest point of the whole body when the
/// direction from it to the centre is a supporting direction there (Kuhn and Tucker): each look decides alone.
class PolyhedronLook {
 public:
  PolyhedronLook(const PolyhedronTables& tables, const Vec3& centre, double tieLength)
      : t(tables), c(centre), tie(tieLength) {}

  /// The face with the largest signed distance; negative: the centre is inside, and this face is the nearest.
  std::int32_t furthestFace(double& distance) const {
    std::int32_t best = 0;
    distance = -infinity;
    for (std::size_t f = 0; f < t.faces.size(); ++f) {
      const double d = t.faces[f].normal.dot(c) - t.faces[f].offset;
      if (d > distance) {
        distance = d;
        best = static_cast<std::int32_t>(f);
      }
    }
    return best;
  }

  bool lookAtFace(std::int32_t face, SurfacePoint& out) const {
    const auto f = static_cast<std::size_t>(face);
    const Vec3& n = t.faces[f].normal;
    const double distance = n.dot(c) - t.faces[f].offset;
    if (distance < 0) return false;
    const auto corners = t.cornersOf(face);
    Vec3 from = corner(corners.back().vertex);
    for (const PolyhedronTables::Corner& each : corners) {
      const Vec3 to = corner(each.vertex);
      const Vec3 edge = to - from;
      if (n.dot(edge.cross(c - from)) < -tie * edge.norm()) return false;
      from = to;
    }
    out = {c - distance * n, n, distance};
    return true;
  }

  bool lookAtEdge(std::int32_t edge, SurfacePoint& out) const {
    const PolyhedronTables::Edge& e = t.edges[static_cast<std::size_t>(edge)];
    const Vec3 from = corner(e.a), along = corner(e.b) - from;
    const double s = along.dot(c - from) / along.squaredNorm();
    if (s < 0 || s > 1) return false;
    const Vec3& left = t.faces[static_cast<std::size_t>(e.faceLeft)].normal;
    const Vec3& right = t.faces[static_cast<std::size_t>(e.faceRight)].normal;
    out = lookFromOutside(c, from + s * along, left);
    const double cosine = left.dot(right), l = out.outward.dot(left), r = out.outward.dot(right);
    return out.distance > 0 && l >= cosine * r - 1e-12 && r >= cosine * l - 1e-12 && l + r > 0;
  }

  bool lookAtVertex(std::int32_t vertex, SurfacePoint& out) const {
    const Vec3 at = corner(vertex);
    const Vec3 d = c - at;
    for (const PolyhedronTables::Spoke& spoke : t.spokesOf(vertex)) {
      if (d.dot(corner(spoke.vertex) - at) > 0) return false;
    }
    out = lookFromOutside(c, at, Vec3::UnitX());
    return out.distance > 0;
  }

  /// The nearest point of all edges, for the rare centre that no single look settles.
  SurfacePoint searchEdges() const {
    SurfacePoint best;
    best.distance = infinity;
    for (const PolyhedronTables::Edge& e : t.edges) {
      const Vec3 from = corner(e.a), along = corner(e.b) - from;
      const double s = std::clamp(along.dot(c - from) / along.squaredNorm(), 0.0, 1.0);
      const SurfacePoint point =
          lookFromOutside(c, from + s * along, t.faces[static_cast<std::size_t>(e.faceLeft)].normal);
      if (point.distance < best.distance) best = point;
    }
    return best;
  }

 private:
  const Vec3& corner(std::int32_t v) const { return t.vertices[static_cast<std::size_t>(v)]; }

  const PolyhedronTables& t;
  const Vec3& c;
  double tie;
};

/// Looks at the cached feature: featureB is a face (kind faceOfB), an edge (edgePair) or a vertex (smooth).
bool lookAgain(const PolyhedronLook& look, const WarmCache& cache, SurfacePoint& out) {
  if (cache.kind == WarmCache::faceOfB) return look.lookAtFace(cache.featureB, out);
  if (cache.kind == WarmCache::edgePair) return look.lookAtEdge(cache.featureB, out);
  return cache.kind == WarmCache::smooth && look.lookAtVertex(cache.featureB, out);
}

/// Searches all features: the furthest face first, then edges, then vertices.
SurfacePoint searchFeatures(const PolyhedronTables& t, const PolyhedronLook& look, const Vec3& centre,
                            WarmCache& cache) {
  double distance = 0;
  const std::int32_t face = look.furthestFace(distance);
  SurfacePoint out;
  if (distance <= 0) {
    cache.kind = WarmCache::cold;
    const Vec3& n = t.faces[static_cast<std::size_t>(face)].normal;
    return {centre - distance * n, n, distance};
  }
  auto keep = [&](WarmCache::Kind kind, std::size_t feature) {
    cache.kind = kind;
    cache.featureB = static_cast<std::int32_t>(feature);
    return out;
  };
  if (look.lookAtFace(face, out)) return keep(WarmCache::faceOfB, static_cast<std::size_t>(face));
  for (std::size_t e = 0; e < t.edges.size(); ++e) {
    if (look.lookAtEdge(static_cast<std::int32_t>(e), out)) return keep(WarmCache::edgePair, e);
  }
  for (std::size_t v = 0; v < t.vertices.size(); ++v) {
    if (look.lookAtVertex(static_cast<std::int32_t>(v), out)) return keep(WarmCache::smooth, v);
  }
  for (std::size_t f = 0; f < t.faces.size(); ++f) {
    if (look.lookAtFace(static_cast<std::int32_t>(f), out)) return keep(WarmCache::faceOfB, f);
  }
  cache.kind = WarmCache::cold;
  return look.searchEdges();
}

}  // namespace

bool touchSpheres(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  ++counts.warm;
  const double radiusA = pair.a.boundingRadius(), radiusB = pair.b.boundingRadius();
  const BallLook look = lookAtBalls(pair.frameA.x, radiusA, pair.frameB.x, radiusB);
  cache.kind = look.overlap > 0 ? WarmCache::smooth : WarmCache::apart;
  cache.touched = look.overlap > 0;
  cache.direction = pair.frameA.unrotate(look.normal);
  cache.budget = std::max(0.0, -look.overlap);
  if (!(look.overlap > 0)) return false;
  fillBallTouch(look, pair.frameA.x, radiusA, touch);
  return true;
}

bool touchSphereCuboid(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  const Vec3& half = static_cast<const Cuboid&>(pair.b).halfLengths();
  return touchByPoint(pair, cache, counts, touch, [&](const Vec3& c) { return findOnBox(half, c); });
}

bool touchSphereCylinder(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  const auto& cylinder = static_cast<const Cylinder&>(pair.b);
  return touchByPoint(pair, cache, counts, touch,
                      [&](const Vec3& c) { return findOnCylinder(cylinder.radius(), cylinder.halfHeight(), c); });
}

bool touchSphereCone(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  const auto& cone = static_cast<const Cone&>(pair.b);
  return touchByPoint(pair, cache, counts, touch, [&](const Vec3& c) { return findOnCone(cone, c); });
}

bool touchSpherePolyhedron(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  const PolyhedronTables& tables = static_cast<const Polyhedron&>(pair.b).tables();
  const Vec3 centre = pair.frameB.toBody(pair.frameA.x);
  const PolyhedronLook look(tables, centre, 0);

  // Apart: the last direction keeps its proof while the feature is not looked for.
  if (cache.kind == WarmCache::apart && !pair.searchAlways) {
    const Vec3 d = pair.frameB.unrotate(pair.frameA.rotate(cache.direction));
    const double gap = -d.dot(centre) - pair.a.boundingRadius() +
                       tables.vertices[static_cast<std::size_t>(tables.climb(-d, 0))].dot(d);
    if (gap > 0) {
      ++counts.warm;
      return reportApart(cache.direction, gap, cache);
    }
  }
  SurfacePoint s;
  if (!pair.searchAlways && cache.touched && lookAgain(look, cache, s)) {
    ++counts.warm;
  } else {
    ++(cache.kind == WarmCache::cold && !cache.touched ? counts.cold : counts.searches);
    s = searchFeatures(tables, look, centre, cache);
  }
  return report(pair, s, cache, counts, touch);
}

}  // namespace granular
