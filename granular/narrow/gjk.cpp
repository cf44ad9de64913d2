// GJK with signed volumes. Notation: the simplex holds up to four points of C minus the given point; v is the point of
// their hull nearest to the origin.
#include "granular/narrow/gjk.h"

#include <cstddef>

namespace granular {
namespace {

constexpr int maxIterations = 200;

/// Fresh starts from the last support point, when round-off in a simplex of nearly coinciding points stops the
/// progress.
constexpr int maxRestarts = 3;

/// Points of the simplex that carry the nearest point, with their weights.
struct Carrier {
  int count = 0;
  std::array<int, 4> index{};
  std::array<double, 4> weight{};
  Vec3 v = Vec3::Zero();
  bool inside = false;

  double squaredLength() const { return count ? v.squaredNorm() : infinity; }
};

struct Simplex {
  std::array<SupportPoint, 4> made;
  std::array<Vec3, 4> w;
  int count = 0;

  const Vec3& operator[](int k) const { return w[static_cast<std::size_t>(k)]; }
};

Carrier nearestOfPoint(const Simplex& s, int i) {
  Carrier c;
  c.count = 1;
  c.index[0] = i;
  c.weight[0] = 1;
  c.v = s[i];
  return c;
}

Carrier nearestOfSegment(const Simplex& s, int i, int j) {
  const Vec3 edge = s[j] - s[i];
  const double length2 = edge.squaredNorm();
  const double t = -s[i].dot(edge);
  if (!(t > 0)) return nearestOfPoint(s, i);
  if (t >= length2) return nearestOfPoint(s, j);
  Carrier c;
  c.count = 2;
  c.index = {i, j, 0, 0};
  c.weight = {1 - t / length2, t / length2, 0, 0};
  c.v = s[i] + c.weight[1] * edge;
  return c;
}

Carrier nearer(const Carrier& a, const Carrier& b) { return b.squaredLength() < a.squaredLength() ? b : a; }

Carrier nearestOfTriangle(const Simplex& s, int i, int j, int k) {
  const Vec3 &a = s[i], &b = s[j], &c = s[k];
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 n = ab.cross(ac);
  const double nn = n.squaredNorm();

  // A sliver has no trustworthy plane: its edges answer.
  const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  const bool sliver = !(nn > 1e-28 * longest2 * longest2);

  // Signed areas of the origin's foot against the three edges.
  const double areaA = sliver ? -1 : b.cross(c).dot(n);
  const double areaB = sliver ? -1 : c.cross(a).dot(n);
  const double areaC = sliver ? -1 : a.cross(b).dot(n);
  if (areaA > 0 && areaB > 0 && areaC > 0) {
    const double sum = areaA + areaB + areaC;
    Carrier out;
    out.count = 3;
    out.index = {i, j, k, 0};
    out.weight = {areaA / sum, areaB / sum, areaC / sum, 0};
    out.v = a + out.weight[1] * ab + out.weight[2] * ac;
    return out;
  }
  Carrier out;
  if (areaA <= 0) out = nearer(out, nearestOfSegment(s, j, k));
  if (areaB <= 0) out = nearer(out, nearestOfSegment(s, k, i));
  if (areaC <= 0) out = nearer(out, nearestOfSegment(s, i, j));
  return out;
}

Carrier nearestOfTetrahedron(const Simplex& s) {
  constexpr std::array<std::array<int, 4>, 4> faces{{{1, 2, 3, 0}, {0, 3, 2, 1}, {0, 1, 3, 2}, {0, 2, 1, 3}}};
  Carrier out;
  bool outside = false;
  for (const auto& f : faces) {
    // The origin lies outside a face when the face's plane parts it from the fourth corner; a flat tetrahedron has no
    // inside, so that all its faces are looked at.
    const Vec3 ab = s[f[1]] - s[f[0]], ac = s[f[2]] - s[f[0]];
    const Vec3 n = ab.cross(ac);
    const Vec3 toFourth = s[f[3]] - s[f[0]];
    const double fourth = n.dot(toFourth);
    const double origin = -n.dot(s[f[0]]);
    const bool flat = std::abs(fourth) <= 1e-14 * ab.norm() * ac.norm() * toFourth.norm();
    if (!flat && fourth * origin > 0) continue;
    outside = true;
    out = nearer(out, nearestOfTriangle(s, f[0], f[1], f[2]));
  }
  if (outside) return out;
  out.inside = true;
  return out;
}

Carrier nearestOfSimplex(const Simplex& s) {
  if (s.count == 1) return nearestOfPoint(s, 0);
  if (s.count == 2) return nearestOfSegment(s, 0, 1);
  if (s.count == 3) return nearestOfTriangle(s, 0, 1, 2);
  return nearestOfTetrahedron(s);
}

/// Keeps the carrying points alone, in their order.
void reduce(const Carrier& c, Simplex& s) {
  Simplex kept;
  for (int k = 0; k < c.count; ++k) {
    const auto from = static_cast<std::size_t>(c.index[static_cast<std::size_t>(k)]);
    kept.made[static_cast<std::size_t>(k)] = s.made[from];
    kept.w[static_cast<std::size_t>(k)] = s.w[from];
  }
  kept.count = c.count;
  s = kept;
}

void fillAnswer(const Simplex& s, const Carrier& c, Nearest& out) {
  out.offset = c.v;
  out.distance = c.v.norm();
  out.onA.setZero();
  out.onB.setZero();
  for (int k = 0; k < s.count; ++k) {
    const auto n = static_cast<std::size_t>(k);
    out.onA += c.weight[n] * s.made[n].a;
    out.onB += c.weight[n] * s.made[n].b;
  }
}

}  // namespace

Nearest findNearest(Difference& c, const Vec3& point, const Vec3& start, double precision) {
  const double roundOff = 4 * std::numeric_limits<double>::epsilon() * (c.extent() + point.norm());
  Nearest out;
  Simplex s;
  s.made[0] = c.support(start);
  s.w[0] = s.made[0].w - point;
  s.count = 1;
  Carrier carrier = nearestOfPoint(s, 0);
  out.distance = infinity;
  int restarts = 0;

  for (int iteration = 0; iteration < maxIterations; ++iteration) {
    const double distance = carrier.v.norm();
    if (distance < out.distance) fillAnswer(s, carrier, out);
    if (distance <= roundOff) {
      out.inside = true;
      break;
    }

    // The supporting plane across v bounds the distance from below.
    const Vec3 n = -carrier.v / distance;
    const SupportPoint next = c.support(n);
    const Vec3 w = next.w - point;
    const double gap = -n.dot(w);
    if (gap > out.gap) {
      out.gap = gap;
      out.direction = n;
    }
    if (out.distance - out.gap <= precision * out.distance + roundOff) break;

    // Add the point, and keep the part of the simplex that is nearest.
    Simplex grown = s;
    grown.made[static_cast<std::size_t>(s.count)] = next;
    grown.w[static_cast<std::size_t>(s.count)] = w;
    ++grown.count;
    const Carrier nextCarrier = nearestOfSimplex(grown);
    if (nextCarrier.inside) {
      out.inside = true;
      break;
    }
    if (!(nextCarrier.v.norm() < distance)) {
      // No progress: round-off rules this simplex. A fresh one around the answer may do better.
      if (restarts++ == maxRestarts) break;
      s.made[0] = next;
      s.w[0] = w;
      s.count = 1;
      carrier = nearestOfPoint(s, 0);
      continue;
    }
    s = grown;
    carrier = nextCarrier;
    reduce(carrier, s);
  }
  return out;
}

}  // namespace granular
