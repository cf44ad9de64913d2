// M 3 to 8. The sphere about x_k that touches the ellipse from within has R_k^2 = b^2/(a^2 - b^2) (a^2 - b^2 - x_k^2)
// and touches it at x_k a^2/(a^2 - b^2), which must not lie beyond a: x_n = a - b^2/a is the last, R_n = b^2/a, the
// radius of curvature of the tip. Spacings shrink with the ellipse's ordinate, d_{k+1} = d_k y(x_k)/y(x_{k-1}), and d_1
// follows from sum d_k = x_n.
#include "granular/shape/ellipsoid_chain.h"

#include <algorithm>

#include "granular/core/errors.h"
#include "granular/shape/revolution.h"

namespace granular {
namespace {

struct Ellipse {
  double a, b;
  double ordinate(double x) const { return b * std::sqrt(std::max(0.0, (1 - x / a) * (1 + x / a))); }
  double lastCentre() const { return (a - b) * (a + b) / a; }
  double radiusAt(double x) const {
    const double square = (a - b) * (a + b);
    return b * std::sqrt(std::max(0.0, 1 - x * x / square));
  }
};

/// Centres x_1 ... x_n from the first spacing; those beyond the last centre are left at infinity.
std::vector<double> placeCentres(const Ellipse& ellipse, int n, double first) {
  std::vector<double> x(static_cast<std::size_t>(n), infinity);
  double before = 0, spacing = first;
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = before + spacing;
    if (x[k] >= ellipse.a) return x;
    spacing *= ellipse.ordinate(x[k]) / ellipse.ordinate(before);
    before = x[k];
  }
  return x;
}

/// M 8 by bisection: the last centre grows with the first spacing.
std::vector<double> solveCentres(const Ellipse& ellipse, int n) {
  const double last = ellipse.lastCentre();
  double lo = 0, hi = last;
  for (int k = 0; k < 200 && lo < hi; ++k) {
    const double middle = 0.5 * (lo + hi);
    if (middle == lo || middle == hi) break;
    (placeCentres(ellipse, n, middle).back() < last ? lo : hi) = middle;
  }
  std::vector<double> x = placeCentres(ellipse, n, n == 1 ? last : lo);
  x.back() = last;
  return x;
}

/// True if every sphere cuts the one before it.
bool hangsTogether(const Ellipse& ellipse, const std::vector<double>& x) {
  double before = 0;
  for (const double centre : x) {
    if (centre - before >= ellipse.radiusAt(before) + ellipse.radiusAt(centre)) return false;
    before = centre;
  }
  return true;
}

std::vector<ChildSphere> mirrored(double middleRadius, const std::vector<double>& x, const std::vector<double>& radii) {
  std::vector<ChildSphere> chain;
  for (std::size_t k = x.size(); k-- > 0;) chain.push_back({Vec3(-x[k], 0, 0), radii[k]});
  chain.push_back({Vec3::Zero(), middleRadius});
  for (std::size_t k = 0; k < x.size(); ++k) chain.push_back({Vec3(x[k], 0, 0), radii[k]});
  return chain;
}

}  // namespace

int smallestChain(double a, double b) {
  const Ellipse ellipse{a, b};
  int n = 2;
  while (!hangsTogether(ellipse, solveCentres(ellipse, n))) ++n;
  return 2 * n + 1;
}

std::vector<ChildSphere> makeEllipsoidChain(double a, double b, int count) {
  requireLength("clump for an ellipsoid", "semi-axis along", a);
  requireLength("clump for an ellipsoid", "semi-axis across", b);
  require(a > b, "clump for an ellipsoid: the semi-axes along and across are " + describeLength(a) + " and " +
                     describeLength(b) + "; the one along must be larger");
  require(count >= 3 && count % 2 == 1, "clump for an ellipsoid: " + std::to_string(count) +
                                            " spheres; the construction needs an odd number from 3 on");
  if (count == 3) return mirrored(b, {0.5 * (a + b)}, {0.5 * (a - b)});

  const Ellipse ellipse{a, b};
  const std::vector<double> x = solveCentres(ellipse, count / 2);
  if (!hangsTogether(ellipse, x)) {
    char aspect[32];
    std::snprintf(aspect, sizeof aspect, "%.4g", a / b);
    throw InputError("clump for an ellipsoid of aspect ratio " + std::string(aspect) + ": a chain of " +
                     std::to_string(count) + " spheres has gaps; the smallest number that works is " +
                     std::to_string(smallestChain(a, b)));
  }
  std::vector<double> radii;
  for (const double centre : x) radii.push_back(ellipse.radiusAt(centre));
  return mirrored(b, x, radii);
}

double ChainQuality::areaFactor() const { return std::abs(area - 1); }
double ChainQuality::perimeterFactor() const { return std::abs(perimeter - 1); }

ChainQuality measureChain(const std::vector<ChildSphere>& chain, double a, double b) {
  double area = 0, perimeter = 0, volume = 0;
  for (std::size_t k = 0; k < chain.size(); ++k) {
    // Distances of the cutting planes from the centre, at most the radius.
    const double r = chain[k].radius;
    const auto cutTowards = [&](const ChildSphere& other) {
      const double d = (other.centre - chain[k].centre).norm();
      return std::min(r, (d * d + (r - other.radius) * (r + other.radius)) / (2 * d));
    };
    const double left = k > 0 ? cutTowards(chain[k - 1]) : r;
    const double right = k + 1 < chain.size() ? cutTowards(chain[k + 1]) : r;
    const double angle = pi - std::acos(left / r) - std::acos(right / r);
    const auto chord = [r](double cut) { return std::sqrt(std::max(0.0, (r - cut) * (r + cut))); };
    area += r * r * angle + left * chord(left) + right * chord(right);
    perimeter += 2 * r * angle;
    volume += pi * (r * r * (left + right) - (left * left * left + right * right * right) / 3);
  }
  const double eccentricity = std::sqrt((1 - b / a) * (1 + b / a));
  return {area / (pi * a * b), perimeter / (4 * a * std::comp_ellint_2(eccentricity)),
          volume / (4 * pi / 3 * a * b * b)};
}

}  // namespace granular
