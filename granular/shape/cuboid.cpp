// The cuboid: tables written down, measures in closed form, support by signs.
#include "granular/core/errors.h"
#include "granular/core/tolerances.h"
#include "granular/shape/polyhedron.h"

namespace granular {

namespace {

/// Faces -x, +x, -y, +y, -z, +z over corners numbered by sign bits.
const std::array<std::vector<std::int32_t>, 6> cuboidFaces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// Volume, area, moments (b² + c²)/3 V, and the mean over the six faces of h² + (i² + j²)/3 for half-lengths h; i, j.
MassProperties cuboidProperties(const Vec3& h) {
  MassProperties mass;
  mass.volume = 8 * h.prod();
  const Vec3 squares = h.cwiseProduct(h);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double pairArea = 8 * h[i] * h[j];
    mass.area += pairArea;
    mass.inertia[k] = mass.volume / 3 * (squares[i] + squares[j]);
    mass.meanSquareRadius += pairArea * (squares[k] + (squares[i] + squares[j]) / 3);
  }
  mass.meanSquareRadius /= mass.area;
  return mass;
}

}  // namespace

Cuboid::Cuboid(const Vec3& halfLengths) : Polyhedron(ShapeKind::cuboid), half(halfLengths) {
  for (int k = 0; k < 3; ++k) {
    require(std::isfinite(half[k]) && half[k] > 0,
            "cuboid: half-length " + std::to_string(k) + " is " + std::to_string(half[k]) + " m; it must be above 0");
  }
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k) {
    corners.emplace_back((k & 1) ? half.x() : -half.x(), (k & 2) ? half.y() : -half.y(),
                         (k & 4) ? half.z() : -half.z());
  }
  topology = makePolyhedronTables(std::move(corners), cuboidFaces);
  findOctantVertices();
  setMeasures(cuboidProperties(half), half.norm(), half.minCoeff(), 2 * half.norm(), distinctAxis(half, true));
}

Vec3 Cuboid::support(const Vec3& d) const {
  return {d.x() > 0 ? half.x() : -half.x(), d.y() > 0 ? half.y() : -half.y(), d.z() > 0 ? half.z() : -half.z()};
}

bool Cuboid::contains(const Vec3& p) const {
  const double slack = tolerance::onSurface * boundingRadius();
  return (p.array().abs() <= half.array() + slack).all();
}

std::string Cuboid::describe() const { return "cuboid " + describeLengths({2 * half.x(), 2 * half.y(), 2 * half.z()}); }

Aabb Cuboid::bounds(const Frame& frame) const {
  const Vec3 reach = frame.R.cwiseAbs() * half;
  Aabb box;
  box.lo = frame.x - reach;
  box.hi = frame.x + reach;
  return box;
}

}  // namespace granular
