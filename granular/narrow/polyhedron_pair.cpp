// Two convex polyhedra. Warm: the last feature, verified as a local minimum by its own test and as the global one by
// three parts of C (isGlobal), both in a few dozen operations. Otherwise both bounds by the expanding polytope, whose
// last facet names the new feature; where round-off stops it, the exhaustive search answers.
#include <algorithm>
#include <array>

#include "granular/core/tolerances.h"
#include "granular/narrow/epa.h"
#include "granular/narrow/exhaustive.h"
#include "granular/narrow/gjk.h"
#include "granular/narrow/kernels.h"
#include "granular/narrow/polyhedron_features.h"

namespace granular {
namespace {

/// A feature with its name, for the cache. Axes of A.
struct NamedFeature {
  FeatureCheck check;
  WarmCache::Kind kind = WarmCache::cold;
  std::int32_t featureA = 0, featureB = 0;
};

/// The pair with its tables and both relative frames.
struct Pair {
  const PolyhedronTables& a;
  const PolyhedronTables& b;
  Frame bInA, aInB;
  double tie, inner;

  explicit Pair(const PairView& view)
      : a(static_cast<const Polyhedron&>(view.a).tables()),
        b(static_cast<const Polyhedron&>(view.b).tables()),
        bInA(relativeFrame(view.frameA, view.frameB)),
        aInB(bInA.R.transpose(), -bInA.unrotate(bInA.x)),
        tie(tolerance::tie * std::min(view.a.size(), view.b.size())),
        inner(view.a.innerRadius() + view.b.innerRadius()) {}
};

/// Turns a check made in B's axes with B's face as the reference into A's axes.
FeatureCheck turnRound(const FeatureCheck& inB, const Frame& bInA) {
  FeatureCheck out = inB;
  out.minimum.normal = -bInA.rotate(inB.minimum.normal);
  out.minimum.onA = bInA.toWorld(inB.minimum.onB);
  out.minimum.onB = bInA.toWorld(inB.minimum.onA);
  return out;
}

NamedFeature lookAtFaceOfA(const Pair& pair, std::int32_t face, std::int32_t vertex) {
  NamedFeature f{checkFace(pair.a, face, pair.b, pair.bInA, pair.tie, vertex), WarmCache::faceOfA, face, 0};
  f.featureB = vertex;
  return f;
}

NamedFeature lookAtFaceOfB(const Pair& pair, std::int32_t face, std::int32_t vertex) {
  const FeatureCheck inB = checkFace(pair.b, face, pair.a, pair.aInB, pair.tie, vertex);
  return {turnRound(inB, pair.bInA), WarmCache::faceOfB, vertex, face};
}

NamedFeature lookAtEdges(const Pair& pair, std::int32_t edgeA, std::int32_t edgeB) {
  return {checkEdges(pair.a, edgeA, pair.b, edgeB, pair.bInA, pair.tie), WarmCache::edgePair, edgeA, edgeB};
}

NamedFeature lookAgain(const Pair& pair, const WarmCache& cache) {
  switch (cache.kind) {
    case WarmCache::faceOfA:
      return lookAtFaceOfA(pair, cache.featureA, cache.featureB);
    case WarmCache::faceOfB:
      return lookAtFaceOfB(pair, cache.featureB, cache.featureA);
    case WarmCache::edgePair:
      return lookAtEdges(pair, cache.featureA, cache.featureB);
    default:
      return {};
  }
}

/// The face around the vertex whose normal is nearest to n.
std::int32_t alignedFace(const PolyhedronTables& t, std::int32_t vertex, const Vec3& n) {
  const auto spokes = t.spokesOf(vertex);
  const auto cosine = [&](const PolyhedronTables::Spoke& s) {
    return t.faces[static_cast<std::size_t>(s.face)].normal.dot(n);
  };
  const auto best = std::max_element(spokes.begin(), spokes.end(),
                                     [&](const auto& p, const auto& q) { return cosine(p) < cosine(q); });
  return best->face;
}

/// The edges around the support vertex of n that lie within `slope` of n's supporting plane: the one whose two faces'
/// normals enclose n comes with them.
void collectFlatEdges(const PolyhedronTables& t, std::int32_t vertex, const Vec3& n, double slope,
                      std::vector<std::int32_t>& out) {
  out.clear();
  for (std::size_t e = 0; e < t.edges.size(); ++e) {
    const PolyhedronTables::Edge& edge = t.edges[e];
    if (edge.a != vertex && edge.b != vertex) continue;
    const Vec3 along = t.vertices[static_cast<std::size_t>(edge.b)] - t.vertices[static_cast<std::size_t>(edge.a)];
    if (std::abs(along.dot(n)) <= slope * along.norm()) out.push_back(static_cast<std::int32_t>(e));
  }
}

/// Names the feature of a minimum found as a direction, whose exact normal replaces the direction. Faces come before
/// edges, so that ties fall to faces whatever the round-off.
NamedFeature nameFeature(const Pair& pair, const Vec3& n, double depth) {
  const Vec3 inB = -pair.bInA.unrotate(n);
  const std::int32_t vertexA = pair.a.climb(n, 0), vertexB = pair.b.climb(inB, 0);
  const double enough = depth + 100 * pair.tie;

  // A face of either: its own normal, and the vertex above it.
  constexpr double aligned = 1 - 1e-9;
  const std::int32_t faceA = alignedFace(pair.a, vertexA, n), faceB = alignedFace(pair.b, vertexB, inB);
  const bool nearA = pair.a.faces[static_cast<std::size_t>(faceA)].normal.dot(n) > aligned;
  const bool nearB = pair.b.faces[static_cast<std::size_t>(faceB)].normal.dot(inB) > aligned;
  if (nearA) {
    const NamedFeature f = lookAtFaceOfA(pair, faceA, vertexB);
    if (f.check.holds && f.check.minimum.depth <= enough) return f;
  }
  if (nearB) {
    const NamedFeature f = lookAtFaceOfB(pair, faceB, vertexA);
    if (f.check.holds && f.check.minimum.depth <= enough) return f;
  }

  // Two edges that both lie flat across n.
  constexpr double slope = 1e-5;
  std::vector<std::int32_t> edgesA, edgesB;
  collectFlatEdges(pair.a, vertexA, n, slope, edgesA);
  collectFlatEdges(pair.b, vertexB, inB, slope, edgesB);
  for (const std::int32_t ea : edgesA) {
    for (const std::int32_t eb : edgesB) {
      const NamedFeature f = lookAtEdges(pair, ea, eb);
      if (f.check.holds && f.check.minimum.depth <= enough) return f;
    }
  }

  // Faces whose common part holds no vertex of either.
  if (nearA) {
    NamedFeature f{checkTiedFace(pair.a, faceA, pair.b, pair.bInA, pair.tie), WarmCache::faceOfA, faceA, vertexB};
    if (f.check.holds && f.check.minimum.depth <= enough) return f;
  }
  if (nearB) {
    NamedFeature f{turnRound(checkTiedFace(pair.b, faceB, pair.a, pair.aInB, pair.tie), pair.bInA), WarmCache::faceOfB,
                   vertexA, faceB};
    if (f.check.holds && f.check.minimum.depth <= enough) return f;
  }
  return {};
}

/// The global minimum by both bounds, or by the exhaustive search where round-off stops the polytope. start, known: the
/// best direction at hand and its depth (or infinity).
DepthBounds boundExactly(Difference& c, const PairView& view, const Vec3& start, double known, double tie) {
  DepthBounds bounds = boundOverlap(c, start, known, tie);
  if (bounds.met) return bounds;
  const ExhaustiveDepth all = searchExhaustively(view.a, view.frameA, view.b, view.frameB);
  if (all.depth < bounds.upper) {
    bounds.upper = all.depth;
    bounds.normal = view.frameA.unrotate(all.normal);
  }
  bounds.lower = bounds.upper;
  bounds.met = true;
  return bounds;
}

/// A vertex of the feature. ownFace: the kind that names a face of this body.
std::int32_t nameVertex(const PolyhedronTables& t, WarmCache::Kind kind, WarmCache::Kind ownFace,
                        std::int32_t feature) {
  if (kind == WarmCache::edgePair) return t.edges[static_cast<std::size_t>(feature)].a;
  return kind == ownFace ? t.cornersOf(feature).front().vertex : feature;
}

bool report(const PairView& view, const NamedFeature& f, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  cache.featureA = f.featureA;
  cache.featureB = f.featureB;
  reportTouch(view, f.kind, f.check.minimum, cache, counts, touch);
  touch.feature = namePolyhedronFeature(cache);
  return true;
}

/// Apart, with the vertices between which the gap was found.
bool reportGap(const Difference& c, const Vec3& direction, double gap, WarmCache& cache) {
  cache.featureA = c.lastVertexOfA();
  cache.featureB = c.lastVertexOfB();
  return reportApart(direction, gap, cache);
}

/// The search proper. `kept`: the last feature where it still holds.
bool searchPolyhedra(const PairView& view, const Pair& pair, Difference& c, const NamedFeature& kept, WarmCache& cache,
                     NarrowCounts& counts, Touch& touch) {
  // A contact that is born: separated after all, or Bullet's proposal.
  const Vec3 guess = guessNormal(c, cache);
  PenetrationAnswer proposal;
  if (!cache.touched) {
    if (cache.kind == WarmCache::cold) ++counts.cold;
    const Nearest nearest = findNearest(c, Vec3::Zero(), guess, separationPrecision);
    if (nearest.gap > 0) return reportGap(c, nearest.direction, nearest.gap, cache);
    proposal = askBullet(c, guess);
  }
  ++counts.searches;

  // Both bounds, from the feature at hand if there is one.
  const bool known = kept.check.holds;
  const DepthBounds bounds = boundExactly(c, view, known ? kept.check.minimum.normal : guess,
                                          known ? kept.check.minimum.depth : infinity, pair.tie);
  if (!(bounds.upper > 0)) return reportGap(c, bounds.normal, std::max(0.0, -bounds.upper), cache);
  if (!cache.touched) countProposal(c, proposal, bounds.upper, counts);
  if (known && bounds.upper >= kept.check.minimum.depth - pair.tie) return report(view, kept, cache, counts, touch);

  const NamedFeature found = nameFeature(pair, bounds.normal, bounds.upper);
  if (found.kind != WarmCache::cold) return report(view, found, cache, counts, touch);

  // No feature owns up to the minimum within the tolerances: the direction itself is the answer, certified by the
  // bounds.
  return reportTouch(view, WarmCache::smooth, descend(c, bounds.normal), cache, counts, touch);
}

}  // namespace

TouchingFeature namePolyhedronFeature(const WarmCache& cache) {
  switch (cache.kind) {
    case WarmCache::faceOfA:
      return {TouchingFeature::faceOfA, cache.featureA, cache.featureB};
    case WarmCache::faceOfB:
      return {TouchingFeature::faceOfB, cache.featureA, cache.featureB};
    case WarmCache::edgePair:
      return {TouchingFeature::edges, cache.featureA, cache.featureB};
    default:
      return {};
  }
}

void nameVertices(const PolyhedronTables& a, const PolyhedronTables& b, WarmCache& cache) {
  const auto kind = static_cast<WarmCache::Kind>(cache.kind);
  cache.featureA = nameVertex(a, kind, WarmCache::faceOfA, cache.featureA);
  cache.featureB = nameVertex(b, kind, WarmCache::faceOfB, cache.featureB);
}

bool touchPolyhedra(const PairView& view, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  // Warm and apart: does the last direction still separate?
  if (cache.kind == WarmCache::apart && !view.searchAlways) {
    Difference c(view.a, view.frameA, view.b, view.frameB);
    c.seed(cache.featureA, cache.featureB);
    const double depth = c.depth(cache.direction);
    if (depth < 0) {
      ++counts.warm;
      return reportGap(c, cache.direction, -depth, cache);
    }
  }

  // Warm and touching: the last feature, if it is a minimum and proves to be the global one.
  const Pair pair(view);
  NamedFeature last;
  if (cache.touched && !view.searchAlways) {
    last = lookAgain(pair, cache);
    const LocalMinimum& m = last.check.minimum;
    if (last.check.holds && !(m.depth > 0)) {
      ++counts.warm;
      cache.featureA = last.featureA;
      cache.featureB = last.featureB;
      nameVertices(pair.a, pair.b, cache);
      return reportApart(m.normal, -m.depth, cache);
    }
    if (last.check.holds && isGlobal(m.normal, m.depth, last.check.margin, pair.bInA.x, pair.inner)) {
      ++counts.warm;
      return report(view, last, cache, counts, touch);
    }
  }
  Difference c(view.a, view.frameA, view.b, view.frameB);
  return searchPolyhedra(view, pair, c, last, cache, counts, touch);
}

}  // namespace granular
