// The table, and the one place where a shape's kind leads back to its class outside the force loop.
#include "granular/shape/shape_table.h"

#include <array>
#include <cstdio>
#include <string>

#include "granular/core/errors.h"
#include "granular/shape/bullet_convex.h"
#include "granular/shape/clump.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/revolution.h"
#include "granular/shape/sphere.h"

namespace granular {

namespace {

using Made = std::shared_ptr<const Shape>;
using Parameters = std::span<const double>;

Made makeSphere(Parameters p) { return std::make_shared<Sphere>(p[0]); }
Made makeEllipsoid(Parameters p) { return std::make_shared<Ellipsoid>(Vec3(p[0], p[1], p[2])); }
Made makeCylinder(Parameters p) { return std::make_shared<Cylinder>(p[0], p[1]); }
Made makeCone(Parameters p) { return std::make_shared<Cone>(p[0], p[1]); }
Made makeCuboid(Parameters p) { return std::make_shared<Cuboid>(Vec3(p[0], p[1], p[2])); }

Made makePolyhedron(Parameters p) {
  require(p.size() >= 12 && p.size() % 3 == 0,
          "polyhedron: " + std::to_string(p.size()) +
              " coordinates given; x, y and z of at least four vertices are needed (12 or more, a multiple of 3)");
  std::vector<Vec3> vertices;
  for (std::size_t k = 0; k < p.size(); k += 3) vertices.emplace_back(p[k], p[k + 1], p[k + 2]);
  return std::make_shared<Polyhedron>(vertices);
}

Made makeClump(Parameters p) {
  require(p.size() % 4 == 0, "clump: " + std::to_string(p.size()) +
                                 " numbers given; x, y, z and radius of every sphere are needed, a multiple of 4");
  std::vector<ChildSphere> spheres;
  for (std::size_t k = 0; k < p.size(); k += 4) spheres.push_back({Vec3(p[k], p[k + 1], p[k + 2]), p[k + 3]});
  return std::make_shared<Clump>(spheres);
}

const std::array<ShapeRow, 7> rows{{
    {"sphere", ShapeKind::sphere, {"radius"}, makeSphere},
    {"ellipsoid", ShapeKind::ellipsoid, {"semi-axis a", "semi-axis b", "semi-axis c"}, makeEllipsoid},
    {"cylinder", ShapeKind::cylinder, {"radius", "height"}, makeCylinder},
    {"cone", ShapeKind::cone, {"radius", "height"}, makeCone},
    {"cuboid", ShapeKind::cuboid, {"half-length x", "half-length y", "half-length z"}, makeCuboid},
    {"polyhedron", ShapeKind::polyhedron, {}, makePolyhedron},
    {"clump", ShapeKind::clump, {}, makeClump},
}};

}  // namespace

std::span<const ShapeRow> shapeTable() { return rows; }

const ShapeRow& findShapeRow(std::string_view name) {
  std::string known;
  for (const ShapeRow& row : rows) {
    if (row.name == name) return row;
    known += (known.empty() ? "" : ", ") + std::string(row.name);
  }
  throw InputError("shape \"" + std::string(name) + "\" is unknown; known shapes are " + known);
}

std::shared_ptr<const Shape> makeShape(std::string_view name, std::span<const double> parameters) {
  const ShapeRow& row = findShapeRow(name);
  if (!row.parameters.empty()) {
    std::string expected;
    for (std::string_view parameter : row.parameters) {
      expected += (expected.empty() ? "" : ", ") + std::string(parameter);
    }
    require(parameters.size() == row.parameters.size(),
            std::string(name) + ": " + std::to_string(parameters.size()) + " parameters given, " +
                std::to_string(row.parameters.size()) + " needed (" + expected + ")");
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      requireLength(std::string(name), std::string(row.parameters[k]), parameters[k]);
    }
  }
  return row.make(parameters);
}

std::shared_ptr<const Shape> scaledShape(const Shape& shape, double factor) {
  char value[32];
  std::snprintf(value, sizeof value, "%.6g", factor);
  require(std::isfinite(factor) && factor > 0,
          "scaling a " + shape.describe() + ": the factor is " + value + "; it must be finite and above 0");
  switch (shape.kind()) {
    case ShapeKind::sphere:
      return std::make_shared<Sphere>(static_cast<const Sphere&>(shape).radius() * factor);
    case ShapeKind::ellipsoid:
      return std::make_shared<Ellipsoid>(static_cast<const Ellipsoid&>(shape).semiAxes() * factor);
    case ShapeKind::cylinder: {
      const auto& cylinder = static_cast<const Cylinder&>(shape);
      return std::make_shared<Cylinder>(cylinder.radius() * factor, cylinder.height() * factor);
    }
    case ShapeKind::cone: {
      const auto& cone = static_cast<const Cone&>(shape);
      return std::make_shared<Cone>(cone.radius() * factor, cone.height() * factor);
    }
    case ShapeKind::cuboid:
      return std::make_shared<Cuboid>(static_cast<const Cuboid&>(shape).halfLengths() * factor);
    case ShapeKind::polyhedron:
      return std::make_shared<Polyhedron>(static_cast<const Polyhedron&>(shape), factor);
    case ShapeKind::bullet:
      return std::make_shared<BulletConvex>(static_cast<const BulletConvex&>(shape), factor);
    case ShapeKind::clump:
      return std::make_shared<Clump>(static_cast<const Clump&>(shape), factor);
  }
  throw InputError("scaling a " + shape.describe() + ": no rule for its kind");
}

}  // namespace granular
