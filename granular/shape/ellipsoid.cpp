// V = 4/3 pi abc, I_x = V (b² + c²)/5. Area and <r²> have no elementary form: with s on the unit sphere, x = (a sx, b
// sy, c sz) and dA = abc |(sx/a, sy/b, sz/c)| ds, integrated by Gauss-Legendre in sz and the midpoint rule in azimuth,
// both of which converge geometrically; the number of nodes grows with the aspect ratio, so that rounding is all that
// is left.
#include "granular/shape/ellipsoid.h"

#include <algorithm>
#include <utility>

#include "granular/core/gauss_legendre.h"
#include "granular/core/tolerances.h"
#include "granular/shape/revolution.h"

namespace granular {

namespace {

/// Area and mean squared radius of an ellipsoid whose largest semi-axis is near 1.
std::pair<double, double> surfaceMeasures(const Vec3& axes) {
  // an error of about exp(-2 n / aspect) in either direction
  const double aspect = axes.maxCoeff() / axes.minCoeff();
  const int n = 2 * static_cast<int>(std::clamp(12 * aspect, 32.0, 1024.0));
  const int quarter = n / 2;
  double area = 0, moment = 0;
  for (int k = 0; k < n / 2; ++k) {
    const auto [z, weight] = gaussLegendreNode(n, k);
    const double across = std::sqrt(1 - z * z);
    for (int j = 0; j < quarter; ++j) {
      const double angle = pi / 2 * (j + 0.5) / quarter;
      const Vec3 s(across * std::cos(angle), across * std::sin(angle), z);
      const double element = weight * s.cwiseQuotient(axes).norm();
      area += element;
      moment += element * s.cwiseProduct(axes).squaredNorm();
    }
  }
  // two halves in z, the full circle
  return {2 * axes.prod() * area * 2 * pi / quarter, moment / area};
}

}  // namespace

Ellipsoid::Ellipsoid(const Vec3& semiAxes) : Shape(ShapeKind::ellipsoid), axes(semiAxes) {
  for (int k = 0; k < 3; ++k) requireLength("ellipsoid", std::string("semi-axis ") + "abc"[k], axes[k]);
  const double longestAxis = axes.maxCoeff(), shortestAxis = axes.minCoeff();
  longestOverShortest = longestAxis / shortestAxis;
  sharpest = shortestAxis * shortestAxis / longestAxis;
  MassProperties closed;
  closed.volume = 4.0 / 3 * pi * axes.prod();
  const Vec3 squares = axes.cwiseProduct(axes);
  closed.inertia = closed.volume / 5 * (Vec3::Constant(squares.sum()) - squares);
  const auto [area, meanSquare] = surfaceMeasures(axes / longestAxis);
  closed.area = area * longestAxis * longestAxis;
  closed.meanSquareRadius = meanSquare * longestAxis * longestAxis;
  setMeasures(closed, longestAxis, shortestAxis, 2 * longestAxis, distinctAxis(axes, true));
  numbers = {axes.x(), axes.y(), axes.z(), longestOverShortest, sharpest, boundingRadius(), size()};
}

void Ellipsoid::supportFeature(const Vec3& d, double, Feature& out) const {
  out.clear();
  out.push(support(d));
}

Vec3 Ellipsoid::supportFace(const Vec3& d, double, Feature& out) const {
  out.clear();
  out.push(support(d));
  return d;
}

bool Ellipsoid::contains(const Vec3& p) const { return p.cwiseQuotient(axes).norm() <= 1 + tolerance::onSurface; }

TriangleMesh Ellipsoid::surface(int resolution) const { return ellipsoidMesh(axes, resolution); }

std::string Ellipsoid::describe() const {
  return "ellipsoid of semi-axes " + describeLengths({axes.x(), axes.y(), axes.z()});
}

Aabb Ellipsoid::bounds(const Frame& frame) const {
  const Vec3 reach = (frame.R * axes.asDiagonal()).rowwise().norm();
  Aabb box;
  box.lo = frame.x - reach;
  box.hi = frame.x + reach;
  return box;
}

}  // namespace granular
