// By the divergence theorem every moment of the union is an integral over its surface: with the origin at the reference
// and x.n the height of the tangent plane,
//
//   V = 1/3 int x.n dA,   int x dV = 1/4 int x (x.n) dA,   int x x^T dV = 1/5 int x x^T (x.n) dA.
//
// Of sphere i (centre c, radius r) that surface is the sphere less one cap per sphere that cuts it. On it x = c + r u,
// and all that is needed are the integrals of 1, u, u u^T and u u u over the exposed directions u. A cap covers, on the
// circle of latitude z, one interval of azimuth known in closed form, so the integral over azimuth is exact. Along the
// latitude the rest is analytic between the ends of the caps' circles, where it has square roots, and the corners where
// two circles cross on the surface. z = mid + half sin(t) turns the square roots into analytic functions, so
// Gauss-Legendre converges geometrically; a piece is halved until it agrees with the sum of its halves.
#include "granular/shape/sphere_union.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

#include "granular/core/gauss_legendre.h"
#include "granular/core/tolerances.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

/// The directions u of a sphere with u . axis > cosine lie inside another sphere.
struct Cap {
  Vec3 axis;
  double cosine;
};

/// True if ball a lies in ball b; of equal balls the one of higher index does.
bool liesIn(const ChildSphere& a, std::size_t indexA, const ChildSphere& b, std::size_t indexB) {
  const double reach = (b.centre - a.centre).norm() + a.radius;
  if (reach != b.radius) return reach < b.radius;
  return a.radius < b.radius || indexB < indexA;
}

/// True if cap a lies in cap b. Ties go to the lower index.
bool isCovered(const Cap& a, std::size_t indexA, const Cap& b, std::size_t indexB) {
  const double between = std::atan2(a.axis.cross(b.axis).norm(), a.axis.dot(b.axis));
  const double spare = std::acos(b.cosine) - std::acos(a.cosine) - between;
  return spare > 0 || (spare == 0 && indexB < indexA);
}

/// The caps that other spheres cut off sphere i, without those inside another cap.
std::vector<Cap> findCaps(std::span<const ChildSphere> spheres, std::size_t i) {
  const ChildSphere& own = spheres[i];
  std::vector<Cap> all;
  for (std::size_t j = 0; j < spheres.size(); ++j) {
    if (j == i) continue;
    const Vec3 d = spheres[j].centre - own.centre;
    const double distance = d.norm();
    if (distance >= own.radius + spheres[j].radius || distance <= std::abs(own.radius - spheres[j].radius)) continue;
    const double cosine = (distance * distance + own.radius * own.radius - spheres[j].radius * spheres[j].radius) /
                          (2 * distance * own.radius);
    all.push_back({d / distance, std::clamp(cosine, -1.0, 1.0)});
  }
  std::vector<Cap> kept;
  for (std::size_t a = 0; a < all.size(); ++a) {
    bool covered = false;
    for (std::size_t b = 0; b < all.size() && !covered; ++b) covered = b != a && isCovered(all[a], a, all[b], b);
    if (!covered) kept.push_back(all[a]);
  }
  return kept;
}

/// Integrals of the monomials x^p y^q z^k, p + q + k <= 3, of the unit vector over a set of directions.
struct Moments {
  std::array<double, 64> values{};
  double& at(int p, int q, int k) { return values[static_cast<std::size_t>(16 * p + 4 * q + k)]; }
  double of(int p, int q, int k) const { return values[static_cast<std::size_t>(16 * p + 4 * q + k)]; }
  /// The monomial that is the product of these components.
  double product(std::initializer_list<int> components) const {
    std::array<int, 3> power{};
    for (const int c : components) ++power[static_cast<std::size_t>(c)];
    return of(power[0], power[1], power[2]);
  }
  void add(const Moments& other) {
    for (std::size_t n = 0; n < values.size(); ++n) values[n] += other.values[n];
  }
  double distanceTo(const Moments& other) const {
    double most = 0;
    for (std::size_t n = 0; n < values.size(); ++n) most = std::max(most, std::abs(values[n] - other.values[n]));
    return most;
  }
};

/// Antiderivatives of cos^p sin^q, p + q <= 3.
struct AzimuthIntegrals {
  std::array<std::array<double, 4>, 4> value{};
  void addAt(double angle, double sign) {
    const double c = std::cos(angle), s = std::sin(angle);
    value[0][0] += sign * angle;
    value[1][0] += sign * s;
    value[0][1] -= sign * c;
    value[2][0] += sign * 0.5 * (angle + s * c);
    value[0][2] += sign * 0.5 * (angle - s * c);
    value[1][1] += sign * 0.5 * s * s;
    value[3][0] += sign * (s - s * s * s / 3);
    value[0][3] += sign * (c * c * c / 3 - c);
    value[2][1] -= sign * c * c * c / 3;
    value[1][2] += sign * s * s * s / 3;
  }
};

/// The exposed part of one sphere, by latitude.
class ExposedSphere {
 public:
  explicit ExposedSphere(std::vector<Cap> cutting) : caps(std::move(cutting)) {
    for (int k = 0; k < nodeCount; ++k) nodes[static_cast<std::size_t>(k)] = gaussLegendreNode(nodeCount, k);
  }

  Moments integrate() {
    const std::vector<double> ends = findEnds();
    Moments sum;
    for (std::size_t k = 1; k < ends.size(); ++k) {
      if (ends[k] > ends[k - 1]) sum.add(refine(ends[k - 1], ends[k], -pi / 2, pi / 2, 0));
    }
    return sum;
  }

 private:
  static constexpr int nodeCount = 16;
  static constexpr double tolerance = 1e-12;  // of a piece, absolute: the whole sphere is 4 pi
  static constexpr int deepest = 24;

  /// Latitudes between which the integrand is analytic.
  std::vector<double> findEnds() const {
    std::vector<double> ends{-1, 1};
    for (const Cap& cap : caps) {
      const double tilt = std::acos(std::clamp(cap.axis.z(), -1.0, 1.0)), half = std::acos(cap.cosine);
      ends.push_back(std::cos(tilt - half));
      ends.push_back(std::cos(tilt + half));
    }
    for (std::size_t a = 0; a < caps.size(); ++a) {
      for (std::size_t b = a + 1; b < caps.size(); ++b) addCrossings(a, b, ends);
    }
    std::sort(ends.begin(), ends.end());
    return ends;
  }

  /// Latitudes of the exposed points where the circles of two caps cross.
  void addCrossings(std::size_t a, std::size_t b, std::vector<double>& ends) const {
    const Vec3 across = caps[a].axis.cross(caps[b].axis);
    const double square = across.squaredNorm();
    if (!(square > 0)) return;
    const double g = caps[a].axis.dot(caps[b].axis);
    const Vec3 middle =
        ((caps[a].cosine - g * caps[b].cosine) * caps[a].axis + (caps[b].cosine - g * caps[a].cosine) * caps[b].axis) /
        square;
    const double left = 1 - middle.squaredNorm();
    if (left < 0) return;
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 u = middle + sign * std::sqrt(left / square) * across;
      bool exposed = true;
      for (std::size_t k = 0; k < caps.size() && exposed; ++k)
        exposed = k == a || k == b || u.dot(caps[k].axis) <= caps[k].cosine + 1e-9;
      if (exposed) ends.push_back(std::clamp(u.z(), -1.0, 1.0));
    }
  }

  /// The piece t in [from, to] of z = mid + half sin(t), by the rule or by its halves.
  Moments refine(double lo, double hi, double from, double to, int depth) {
    const double middle = 0.5 * (from + to);
    const Moments whole = applyRule(lo, hi, from, to);
    Moments halves = applyRule(lo, hi, from, middle);
    halves.add(applyRule(lo, hi, middle, to));
    if (whole.distanceTo(halves) <= tolerance || depth == deepest) return halves;
    halves = refine(lo, hi, from, middle, depth + 1);
    halves.add(refine(lo, hi, middle, to, depth + 1));
    return halves;
  }

  Moments applyRule(double lo, double hi, double from, double to) {
    Moments sum;
    for (const auto& [node, weight] : nodes) {
      const double t = 0.5 * (from + to) + 0.5 * (to - from) * node;
      const double z = 0.5 * (lo + hi) + 0.5 * (hi - lo) * std::sin(t);
      const double factor = weight * 0.5 * (to - from) * 0.5 * (hi - lo) * std::cos(t);
      addCircle(std::clamp(z, -1.0, 1.0), factor, sum);
    }
    return sum;
  }

  /// The circle of latitude z less the intervals its caps cover.
  void addCircle(double z, double factor, Moments& sum) {
    const double across = std::sqrt((1 - z) * (1 + z));
    covered.clear();
    for (const Cap& cap : caps) {
      // u . axis > cosine: swing cos(azimuth - azimuth of the axis) > rest
      const double swing = across * std::hypot(cap.axis.x(), cap.axis.y());
      const double rest = cap.cosine - z * cap.axis.z();
      if (rest >= swing) continue;
      if (rest <= -swing) return;
      const double half = std::acos(rest / swing);
      double begin = std::atan2(cap.axis.y(), cap.axis.x()) - half;
      if (begin < 0) begin += 2 * pi;
      const double end = begin + 2 * half;
      covered.emplace_back(begin, std::min(end, 2 * pi));
      if (end > 2 * pi) covered.emplace_back(0.0, end - 2 * pi);
    }
    std::sort(covered.begin(), covered.end());
    AzimuthIntegrals open;
    double reached = 0;
    for (const auto& [begin, end] : covered) {
      if (begin > reached) {
        open.addAt(begin, 1);
        open.addAt(reached, -1);
      }
      reached = std::max(reached, end);
    }
    if (reached < 2 * pi) {
      open.addAt(2 * pi, 1);
      open.addAt(reached, -1);
    }
    addPowers(open, across, z, factor, sum);
  }

  static void addPowers(const AzimuthIntegrals& open, double across, double z, double factor, Moments& sum) {
    const std::array<double, 4> acrosses{1, across, across * across, across * across * across};
    const std::array<double, 4> heights{1, z, z * z, z * z * z};
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = 0; p + q < 4; ++q)
        for (std::size_t k = 0; p + q + k < 4; ++k)
          sum.at(static_cast<int>(p), static_cast<int>(q), static_cast<int>(k)) +=
              factor * acrosses[p + q] * heights[k] * open.value[p][q];
  }

  std::vector<Cap> caps;
  std::array<std::pair<double, double>, nodeCount> nodes;
  std::vector<std::pair<double, double>> covered;
};

/// Sums over the surface, about the reference.
struct SurfaceSums {
  double volume = 0, area = 0, squares = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
};

/// What the exposed part of one sphere adds; c: its centre from the reference.
void addSphere(const Vec3& c, double r, const Moments& m, SurfaceSums& sums) {
  const double m0 = m.of(0, 0, 0), square = r * r;
  Vec3 m1, m2c;
  Mat3 m2, m3c;
  for (int a = 0; a < 3; ++a) {
    m1[a] = m.product({a});
    for (int b = 0; b < 3; ++b) {
      m2(a, b) = m.product({a, b});
      m3c(a, b) = m.product({a, b, 0}) * c[0] + m.product({a, b, 1}) * c[1] + m.product({a, b, 2}) * c[2];
    }
  }
  m2c = m2 * c;
  const double along = c.dot(m1);
  sums.volume += square / 3 * (r * m0 + along);
  sums.area += square * m0;
  sums.squares += square * ((c.squaredNorm() + square) * m0 + 2 * r * along);
  sums.first += square / 4 * ((r * m0 + along) * c + square * m1 + r * m2c);
  const Mat3 mixed = c * (r * m1 + m2c).transpose();
  sums.second +=
      square / 5 *
      ((r * m0 + along) * c * c.transpose() + r * (mixed + mixed.transpose()) + r * square * m2 + square * m3c);
}

}  // namespace

SolidProperties unionProperties(std::span<const ChildSphere> spheres) {
  assert(!spheres.empty());
  const std::vector<ChildSphere> kept = withoutHidden(spheres);
  SolidProperties solid;
  if (kept.size() == 1) {
    solid.principal = Sphere(kept[0].radius).massProperties();
    solid.centroid = kept[0].centre;
    solid.inertia = solid.principal.inertia.asDiagonal();
    return solid;
  }

  std::vector<Moments> moments;
  for (std::size_t i = 0; i < kept.size(); ++i) moments.push_back(ExposedSphere(findCaps(kept, i)).integrate());
  const auto sumAbout = [&](const Vec3& reference) {
    SurfaceSums sums;
    for (std::size_t i = 0; i < kept.size(); ++i)
      addSphere(kept[i].centre - reference, kept[i].radius, moments[i], sums);
    return sums;
  };

  // About the mean of the centres first, then about the centre of mass, where no digits cancel.
  Vec3 reference = Vec3::Zero();
  for (const ChildSphere& child : kept) reference += child.centre / static_cast<double>(kept.size());
  const SurfaceSums rough = sumAbout(reference);
  solid.centroid = reference + rough.first / rough.volume;
  const SurfaceSums sums = sumAbout(solid.centroid);
  solid.inertia = sums.second.trace() * Mat3::Identity() - sums.second;
  const PrincipalAxes principal = principalAxes(solid.inertia);
  solid.axes = principal.axes;
  solid.principal.volume = sums.volume;
  solid.principal.area = sums.area;
  solid.principal.inertia = principal.moments;
  solid.principal.meanSquareRadius = sums.squares / sums.area;
  return solid;
}

std::vector<ChildSphere> withoutHidden(std::span<const ChildSphere> spheres) {
  std::vector<ChildSphere> kept;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    bool hidden = false;
    for (std::size_t j = 0; j < spheres.size() && !hidden; ++j) hidden = j != i && liesIn(spheres[i], i, spheres[j], j);
    if (!hidden) kept.push_back(spheres[i]);
  }
  return kept;
}

int countParts(std::span<const ChildSphere> spheres) {
  std::vector<std::size_t> leader(spheres.size());
  std::iota(leader.begin(), leader.end(), 0u);
  const auto find = [&](std::size_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  auto parts = static_cast<int>(spheres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double reach = (spheres[i].radius + spheres[j].radius) * (1 + tolerance::certificate);
      if ((spheres[i].centre - spheres[j].centre).norm() > reach || find(i) == find(j)) continue;
      leader[find(i)] = find(j);
      --parts;
    }
  }
  return parts;
}

}  // namespace granular
