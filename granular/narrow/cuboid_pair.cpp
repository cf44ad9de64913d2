// Two cuboids: the least depth lies along one of fifteen axes, three face normals of each and nine products of edges
// (Gottschalk, Lin and Manocha 1996), so that the search is exact and short, apart or touching. Warm, the last axis
// alone is looked at, verified as for all polyhedra (polyhedron_features.h).
#include <algorithm>
#include <array>
#include <limits>

#include "granular/core/tolerances.h"
#include "granular/narrow/kernels.h"
#include "granular/narrow/polyhedron_features.h"

namespace granular {
namespace {

/// Half-lengths, and B's frame in A's axes.
struct Boxes {
  const Vec3& a;
  const Vec3& b;
  Frame frame;
  double tie, inner;

  explicit Boxes(const PairView& view)
      : a(static_cast<const Cuboid&>(view.a).halfLengths()),
        b(static_cast<const Cuboid&>(view.b).halfLengths()),
        frame(relativeFrame(view.frameA, view.frameB)),
        tie(cuboidTie(view.a, view.b)),
        inner(view.a.innerRadius() + view.b.innerRadius()) {}
};

double depthAlongAxis(const Boxes& p, const Vec3& n) {
  return p.a.dot(n.cwiseAbs()) + p.b.dot(p.frame.unrotate(n).cwiseAbs()) - n.dot(p.frame.x);
}

/// The middle of the part of a segment or rectangle (free: its half edges, parallel to the face across axis i) about
/// `centre` that lies above that face of the box with half-lengths a grown by the tie; false if there is none.
bool findCommonMiddle(const Vec3& a, int i, const Vec3& centre, const std::array<Vec3, 2>& free, int edges, double tie,
                      Vec3& middle) {
  const int k = i == 2 ? 0 : i + 1, l = 3 - i - k;
  std::array<Vec3, 12> corners, kept;
  int count = 0;
  if (edges == 1) {
    corners[0] = centre - free[0];
    corners[1] = centre + free[0];
    count = 2;
  } else {
    corners[0] = centre - free[0] - free[1];
    corners[1] = centre + free[0] - free[1];
    corners[2] = centre + free[0] + free[1];
    corners[3] = centre - free[0] + free[1];
    count = 4;
  }
  // Clipped by the face's four edges (Sutherland and Hodgman 1974); each adds a corner at most.
  for (int side = 0; side < 4 && count > 0; ++side) {
    const int axis = side < 2 ? k : l;
    const double sign = side % 2 ? 1 : -1, bound = a[axis] + tie;
    const auto inside = [&](const Vec3& p) { return bound - sign * p[axis]; };
    int number = 0;
    for (int n = 0; n < count; ++n) {
      const Vec3 &p = corners[n], &q = corners[n + 1 < count ? n + 1 : 0];
      const double dp = inside(p), dq = inside(q);
      if (dp >= 0) kept[number++] = p;
      if ((dp >= 0) != (dq >= 0)) kept[number++] = p + (q - p) * (dp / (dp - dq));
    }
    corners = kept;
    count = number;
  }
  if (count == 0) return false;
  middle.setZero();
  for (int n = 0; n < count; ++n) middle += corners[n] / count;
  return true;
}

/// The face across axis i of the box with half-lengths a, on the side of the other box, which has half-lengths b and
/// lies at `frame`. Axes parallel to the face within the tie leave the deepest point free along them: it is taken
/// nearest to the middle of the face, and where that lies beyond the face's rim, in the middle of what lies above it.
FeatureCheck checkBoxFace(const Vec3& a, const Vec3& b, const Frame& frame, int i, double tie) {
  const double side = frame.x[i] < 0 ? -1 : 1;
  Vec3 p = frame.x;
  double depth = a[i] - side * frame.x[i];
  for (int j = 0; j < 3; ++j) {
    const double slope = frame.R(i, j);
    depth += b[j] * std::abs(slope);
    if (2 * b[j] * std::abs(slope) <= tie) continue;
    p -= (side * slope < 0 ? -b[j] : b[j]) * frame.R.col(j);
  }
  const Vec3 centre = p;
  std::array<Vec3, 2> free;
  int edges = 0;
  for (int j = 0; j < 3; ++j) {
    if (2 * b[j] * std::abs(frame.R(i, j)) > tie) continue;
    Vec3 along = frame.R.col(j);
    along[i] = 0;
    p -= std::clamp(along.dot(p), -b[j], b[j]) * along;
    if (edges < 2) free[edges++] = b[j] * along;
  }

  FeatureCheck out;
  const int k = i == 2 ? 0 : i + 1, l = 3 - i - k;
  const auto marginOf = [&](const Vec3& q) { return std::min(a[k] - std::abs(q[k]), a[l] - std::abs(q[l])); };
  double margin = marginOf(p);
  if (margin < -tie && edges > 0 && findCommonMiddle(a, i, centre, free, edges, tie, p)) margin = marginOf(p);
  out.holds = margin >= -tie;
  out.margin = std::max(0.0, margin);
  out.minimum.normal = side * Vec3::Unit(i);
  out.minimum.depth = depth;
  out.minimum.onA = p;
  out.minimum.onA[i] = side * a[i];
  out.minimum.onB = out.minimum.onA - depth * out.minimum.normal;
  return out;
}

FeatureCheck checkFaceOfB(const Boxes& p, int j) {
  const Frame aInB(p.frame.R.transpose(), -p.frame.unrotate(p.frame.x));
  FeatureCheck out = checkBoxFace(p.b, p.a, aInB, j, p.tie);
  const LocalMinimum inB = out.minimum;
  out.minimum.normal = -p.frame.rotate(inB.normal);
  out.minimum.onA = p.frame.toWorld(inB.onB);
  out.minimum.onB = p.frame.toWorld(inB.onA);
  return out;
}

/// Squared sine between two edges below which their product is no axis: a face then holds the same minimum.
constexpr double leastSine2 = 1e-14;

/// The axis across A's edges along i and B's along j, towards B; false where the two are parallel.
bool makeEdgeAxis(const Boxes& p, int i, int j, Vec3& n) {
  const auto axis = p.frame.R.col(j);
  const int k = i == 2 ? 0 : i + 1, l = 3 - i - k;
  const double sine2 = axis[k] * axis[k] + axis[l] * axis[l];
  if (!(sine2 > leastSine2)) return false;
  double scale = 1 / std::sqrt(sine2);
  if (axis[k] * p.frame.x[l] - axis[l] * p.frame.x[k] < 0) scale = -scale;
  n[i] = 0;
  n[k] = -axis[l] * scale;
  n[l] = axis[k] * scale;
  return true;
}

FeatureCheck checkEdges(const Boxes& p, int i, int j) {
  FeatureCheck out;
  Vec3 n;
  if (!makeEdgeAxis(p, i, j, n)) return out;

  // The supporting edge of either box: its middle, and where it is closest to the other.
  const Vec3 inB = p.frame.unrotate(n);
  Vec3 middleA = Vec3::Zero(), middleB = Vec3::Zero();
  for (int m = 0; m < 3; ++m) {
    if (m != i) middleA[m] = n[m] < 0 ? -p.a[m] : p.a[m];
    if (m != j) middleB[m] = inB[m] < 0 ? p.b[m] : -p.b[m];
  }
  const Vec3 onLineB = p.frame.toWorld(middleB), axis = p.frame.R.col(j);
  const Vec3 w = middleA - onLineB;
  const int k = i == 2 ? 0 : i + 1, l = 3 - i - k;
  const double cosine = axis[i], wB = w.dot(axis), sine2 = axis[k] * axis[k] + axis[l] * axis[l];
  const double s = (cosine * wB - w[i]) / sine2, t = (wB - cosine * w[i]) / sine2;

  const double margin = std::sqrt(sine2) * std::min(p.a[i] - std::abs(s), p.b[j] - std::abs(t));
  out.holds = margin >= -p.tie;
  out.margin = std::max(0.0, margin);
  out.minimum.normal = n;
  out.minimum.depth = depthAlongAxis(p, n);
  // Where the lines meet beyond the edges, this is no minimum; the points stay on the bodies all the same.
  middleA[i] = std::clamp(s, -p.a[i], p.a[i]);
  const Vec3 middle = 0.5 * (middleA + onLineB + std::clamp(t, -p.b[j], p.b[j]) * axis);
  out.minimum.onA = middle + 0.5 * out.minimum.depth * n;
  out.minimum.onB = middle - 0.5 * out.minimum.depth * n;
  return out;
}

/// Which of the fifteen axes.
struct Axis {
  WarmCache::Kind kind = WarmCache::cold;
  int i = 0, j = 0;
  double depth = infinity;
};

/// The axis of least depth; within a tie faces before edges, and A's face before B's.
Axis findLeastAxis(const Boxes& p) {
  const Mat3 size = p.frame.R.cwiseAbs();
  const Vec3 depthA = p.a + size * p.b - p.frame.x.cwiseAbs();
  const Vec3 depthB = p.b + size.transpose() * p.a - p.frame.unrotate(p.frame.x).cwiseAbs();
  Axis best;
  for (int i = 0; i < 3; ++i) {
    if (depthA[i] < best.depth) best = {WarmCache::faceOfA, i, 0, depthA[i]};
  }
  for (int j = 0; j < 3; ++j) {
    if (depthB[j] < best.depth - p.tie) best = {WarmCache::faceOfB, 0, j, depthB[j]};
  }
  for (int i = 0; i < 3; ++i) {
    const int k = i == 2 ? 0 : i + 1, l = 3 - i - k;
    for (int j = 0; j < 3; ++j) {
      const int m = j == 2 ? 0 : j + 1, o = 3 - j - m;
      // All lengths times the sine between the edges.
      const double sine2 = p.frame.R(k, j) * p.frame.R(k, j) + p.frame.R(l, j) * p.frame.R(l, j);
      if (!(sine2 > leastSine2)) continue;
      const double reach = p.a[k] * size(l, j) + p.a[l] * size(k, j) + p.b[m] * size(i, o) + p.b[o] * size(i, m);
      const double apart = std::abs(p.frame.R(k, j) * p.frame.x[l] - p.frame.R(l, j) * p.frame.x[k]);
      if (!((reach - apart) / std::sqrt(sine2) < best.depth - p.tie)) continue;
      // Of edges that are nearly parallel the quotient has lost digits; along the axis itself the depth has all.
      Vec3 n;
      makeEdgeAxis(p, i, j, n);
      const double depth = depthAlongAxis(p, n);
      if (depth < best.depth - p.tie) best = {WarmCache::edgePair, i, j, depth};
    }
  }
  return best;
}

FeatureCheck checkAxis(const Boxes& p, WarmCache::Kind kind, int i, int j) {
  if (kind == WarmCache::faceOfA) return checkBoxFace(p.a, p.b, p.frame, i, p.tie);
  if (kind == WarmCache::faceOfB) return checkFaceOfB(p, j);
  return checkEdges(p, i, j);
}

/// Where the least axis is a face that no corner or edge lies above, another is as shallow within the tie and has its
/// deepest points in place: boxes tilted against each other by hardly more than round-off. Receives it, if there is
/// one.
void findHoldingAxis(const Boxes& p, Axis& best, FeatureCheck& found) {
  for (const auto kind : {WarmCache::edgePair, WarmCache::faceOfA, WarmCache::faceOfB}) {
    for (int i = 0; i < (kind == WarmCache::faceOfB ? 1 : 3); ++i) {
      for (int j = 0; j < (kind == WarmCache::faceOfA ? 1 : 3); ++j) {
        const FeatureCheck check = checkAxis(p, kind, i, j);
        if (!check.holds || !(check.minimum.depth <= best.depth + p.tie)) continue;
        best = {kind, i, j, check.minimum.depth};
        found = check;
        return;
      }
    }
  }
}

/// The corner of a cuboid furthest along d: sign bits.
std::int32_t cornerAlong(const Vec3& d) { return (d.x() > 0) + 2 * (d.y() > 0) + 4 * (d.z() > 0); }

/// The edge along axis i through a corner, in the tables' order (by its ends).
std::int32_t edgeThrough(std::int32_t corner, int i) {
  constexpr std::int32_t edges[8][3] = {{0, 1, 2},  {-1, 3, 4},   {5, -1, 6},   {-1, -1, 7},
                                        {8, 9, -1}, {-1, 10, -1}, {11, -1, -1}, {-1, -1, -1}};
  return edges[corner & ~(1 << i)][i];
}

bool report(const PairView& view, const Boxes& p, const Axis& axis, const LocalMinimum& found, WarmCache& cache,
            NarrowCounts& counts, Touch& touch) {
  cache.featureA = axis.i;
  cache.featureB = axis.j;
  reportTouch(view, axis.kind, found, cache, counts, touch);
  touch.feature = nameCuboidFeature(cache, found.normal, -p.frame.unrotate(found.normal));
  return true;
}

}  // namespace

double cuboidTie(const Shape& a, const Shape& b) {
  const auto longest = [](const Shape& shape) { return static_cast<const Cuboid&>(shape).halfLengths().maxCoeff(); };
  return std::max(tolerance::tie * std::min(a.size(), b.size()),
                  8 * std::numeric_limits<double>::epsilon() * (longest(a) + longest(b)));
}

TouchingFeature nameCuboidFeature(const WarmCache& cache, const Vec3& outOfA, const Vec3& outOfB) {
  const int i = cache.featureA, j = cache.featureB;
  switch (cache.kind) {
    case WarmCache::faceOfA:
      return {TouchingFeature::faceOfA, 2 * i + (outOfA[i] > 0), cornerAlong(outOfB)};
    case WarmCache::faceOfB:
      return {TouchingFeature::faceOfB, cornerAlong(outOfA), 2 * j + (outOfB[j] > 0)};
    default:
      return {TouchingFeature::edges, edgeThrough(cornerAlong(outOfA), i), edgeThrough(cornerAlong(outOfB), j)};
  }
}

bool touchCuboids(const PairView& view, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  const Boxes p(view);

  // Warm and apart: does the last direction still separate?
  if (cache.kind == WarmCache::apart && !view.searchAlways) {
    const double depth = depthAlongAxis(p, cache.direction);
    if (depth < 0) {
      ++counts.warm;
      return reportApart(cache.direction, -depth, cache);
    }
  }

  // Warm and touching: the last axis, if it is a minimum and proves to be the global one.
  if (cache.touched && !view.searchAlways) {
    const Axis axis{static_cast<WarmCache::Kind>(cache.kind), cache.featureA, cache.featureB, 0};
    const FeatureCheck last = checkAxis(p, axis.kind, axis.i, axis.j);
    const LocalMinimum& m = last.minimum;
    if (last.holds && !(m.depth > 0)) {
      ++counts.warm;
      return reportApart(m.normal, -m.depth, cache);
    }
    if (last.holds && isGlobal(m.normal, m.depth, last.margin, p.frame.x, p.inner)) {
      ++counts.warm;
      return report(view, p, axis, m, cache, counts, touch);
    }
  }

  // All fifteen axes.
  ++counts.searches;
  if (cache.kind == WarmCache::cold) ++counts.cold;
  Axis best = findLeastAxis(p);
  FeatureCheck found = checkAxis(p, best.kind, best.i, best.j);
  if (!found.holds && best.depth > 0) findHoldingAxis(p, best, found);
  if (!(found.minimum.depth > 0)) return reportApart(found.minimum.normal, -found.minimum.depth, cache);

  // A contact is born with Bullet's proposal, checked against the least of the fifteen.
  if (!cache.touched) {
    Difference c(view.a, view.frameA, view.b, view.frameB);
    countProposal(c, askBullet(c, guessNormal(c, cache)), best.depth, counts);
  }
  return report(view, p, best, found.minimum, cache, counts, touch);
}

}  // namespace granular
