#include "granular/shape/curvature.h"

#include <algorithm>
#include <cassert>

#include "granular/shape/clump.h"
#include "granular/shape/ellipsoid.h"

namespace granular {

Mat3 curvatureOf(const Shape& shape, const Vec3& n) {
  assert(shape.kind() != ShapeKind::clump);
  const Mat3 plane = Mat3::Identity() - n * n.transpose();
  // The size of a sphere is its radius; of a body with faces, edges or vertices, that of the sphere of equal volume.
  if (shape.kind() != ShapeKind::ellipsoid) return (1 / shape.size()) * plane;
  const Vec3& semi = static_cast<const Ellipsoid&>(shape).semiAxes();
  const double height = semi.cwiseProduct(n).norm();
  const Vec3 inverse = semi.cwiseProduct(semi).cwiseInverse();
  return height * (plane * inverse.asDiagonal() * plane);
}

double effectiveRadius(const Mat3& sum, double flattest) {
  // One eigenvalue is 0, along the normal: the other two from the invariants.
  const double middle = 0.5 * sum.trace();
  const double product = 0.5 * (sum.trace() * sum.trace() - sum.squaredNorm());
  const double spread = std::sqrt(std::max(0.0, middle * middle - product));
  const double least = 1 / flattest;
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
