#include "granular/shape/curvature.h"

#include <algorithm>
#include <cassert>

#include "granular/shape/clump.h"
#include "granular/shape/ellipsoid.h"

namespace granular {

Curvature curvatureOf(const Shape& shape, const Vec3& n, const Vec3& u) {
  assert(shape.kind() != ShapeKind::clump);
  // The size of a sphere is its radius; of a body with faces, edges or vertices, that of the sphere of equal volume.
  if (shape.kind() != ShapeKind::ellipsoid) return ballCurvature(shape.size());
  return curvatureOfEllipsoid(toTriple(static_cast<const Ellipsoid&>(shape).semiAxes()), toTriple(n), toTriple(u));
}

double effectiveRadius(const Curvature& sum, double flattest) {
  if (isRound(sum, flattest)) return radiusOfRound(sum);
  const double least = 1 / flattest;
  const double middle = 0.5 * (sum.uu + sum.vv), half = 0.5 * (sum.uu - sum.vv);
  const double spread = std::sqrt(half * half + sum.uv * sum.uv);
  return 1 / std::sqrt(std::max(middle + spread, least) * std::max(middle - spread, least));
}

double largestRadius(const Shape& shape) {
  if (const Clump* clump = asClump(shape)) {
    double largest = 0;
    for (const ChildSphere& child : clump->children()) largest = std::max(largest, child.radius);
    return largest;
  }
  if (shape.kind() != ShapeKind::ellipsoid) return shape.size();
  // At the end of the shortest semi-axis c the principal radii are a^2/c and b^2/c.
  const Vec3& semi = static_cast<const Ellipsoid&>(shape).semiAxes();
  return semi.prod() / (semi.minCoeff() * semi.minCoeff());
}

}  // namespace granular
