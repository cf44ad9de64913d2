// The shapes a scene file can name, one row each, and copies of any shape at another size.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "granular/shape/shape.h"

namespace granular {

/// One kind of shape as scene files know it.
struct ShapeRow {
  std::string_view name;
  ShapeKind kind;
  /// Names of the parameters in order, each a length in m. A polyhedron takes x, y, z of every vertex instead, a clump
  /// x, y, z and radius of every sphere.
  std::vector<std::string_view> parameters;
  std::shared_ptr<const Shape> (*make)(std::span<const double> parameters);
};

/// All rows: sphere (radius), ellipsoid (semi-axes a, b, c), cylinder (radius, height), cone (radius, height),
/// cuboid (half-lengths x, y, z), polyhedron (x, y, z of each vertex, at least four vertices), clump (x, y, z, radius
/// of each sphere).
std::span<const ShapeRow> shapeTable();

/// The row of that name. Throws InputError, listing the names there are, for any other.
const ShapeRow& findShapeRow(std::string_view name);

/// A shape from its name and its parameters (m, in the order of its row). Throws InputError naming shape, parameter,
/// value and limit when their count is wrong or one is not finite and, except for coordinates, above 0.
std::shared_ptr<const Shape> makeShape(std::string_view name, std::span<const double> parameters);

/// The same shape multiplied by factor, in the same body axes. Throws InputError unless factor is finite and above 0.
std::shared_ptr<const Shape> scaledShape(const Shape& shape, double factor);

}  // namespace granular
