// Shapes by name, their refusals, and copies at another size.
#include "granular/shape/shape_table.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

std::string refusal(std::string_view name, const std::vector<double>& parameters) {
  try {
    makeShape(name, parameters);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ShapeTable, EveryRowMakesItsKind) {
  for (const ShapeRow& row : shapeTable()) {
    std::vector<double> parameters(row.parameters.size(), 2e-3);
    if (row.kind == ShapeKind::polyhedron) parameters = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (row.kind == ShapeKind::clump) parameters = {0, 0, 0, 1, 1, 0, 0, 0.8};
    const auto shape = makeShape(row.name, parameters);
    EXPECT_EQ(shape->kind(), row.kind);
    EXPECT_NE(shape->describe().find(row.name), std::string::npos);
  }
  EXPECT_EQ(makeShape("cuboid", std::vector<double>{1.5e-3, 1.5e-3, 1.5e-3})->describe(), "cuboid 3 x 3 x 3 mm");
}

TEST(ShapeTable, RefusalsNameShapeParameterValueAndLimit) {
  EXPECT_NE(refusal("prism", {1}).find("known shapes are sphere, ellipsoid"), std::string::npos);
  EXPECT_EQ(refusal("sphere", {-1}), "sphere: radius is -1 m; it must be finite and above 0");
  EXPECT_EQ(refusal("cylinder", {1, 0}), "cylinder: height is 0 m; it must be finite and above 0");
  EXPECT_NE(refusal("cuboid", {1, std::nan(""), 1}).find("half-length y is nan"), std::string::npos);
  EXPECT_NE(refusal("ellipsoid", {1, 1}).find("2 parameters given, 3 needed (semi-axis a"), std::string::npos);
  EXPECT_NE(refusal("polyhedron", {1, 2, 3}).find("3 coordinates given"), std::string::npos);
  EXPECT_NE(refusal("clump", {1, 2, 3}).find("3 numbers given"), std::string::npos);
  EXPECT_EQ(refusal("clump", {}), "clump: no spheres given; at least one is needed");
  EXPECT_NE(refusal("polyhedron", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}).find("plane"), std::string::npos);
}

TEST(ShapeTable, ScaledShapesAreTheSameBodyAtAnotherSize) {
  Random random(3);
  for (const ShapeRow& row : shapeTable()) {
    std::vector<double> parameters(row.parameters.size());
    for (double& p : parameters) p = random.uniform(1e-3, 3e-3);
    if (row.kind == ShapeKind::polyhedron) {
      for (int k = 0; k < 90; ++k) parameters.push_back(random.uniform(-1e-3, 1e-3));
    }
    if (row.kind == ShapeKind::clump) {
      for (int k = 0; k < 40; ++k) parameters.push_back(random.uniform(k % 4 == 3 ? 0.1e-3 : -1e-3, 1e-3));
    }
    const auto shape = makeShape(row.name, parameters);
    for (double factor : {0.01, 3.0}) {
      const auto scaled = scaledShape(*shape, factor);
      EXPECT_EQ(scaled->kind(), shape->kind());
      const double length = factor * shape->boundingRadius();
      EXPECT_NEAR(scaled->boundingRadius(), length, 1e-13 * length);
      EXPECT_NEAR(scaled->innerRadius(), factor * shape->innerRadius(), 1e-13 * length);
      EXPECT_NEAR(scaled->longestExtent(), factor * shape->longestExtent(), 1e-13 * length);
      EXPECT_NEAR(scaled->massProperties().volume, std::pow(factor, 3) * shape->massProperties().volume,
                  1e-12 * std::pow(length, 3));
      EXPECT_LT((scaled->massProperties().inertia - std::pow(factor, 5) * shape->massProperties().inertia).norm(),
                1e-12 * std::pow(length, 5));
      EXPECT_NEAR(scaled->massProperties().meanSquareRadius, factor * factor * shape->massProperties().meanSquareRadius,
                  1e-12 * length * length);
      for (int trial = 0; trial < 100; ++trial) {
        const Vec3 d = random.direction();
        EXPECT_LT((scaled->support(d) - factor * shape->support(d)).norm(), 1e-13 * length);
      }
    }
    EXPECT_THROW(scaledShape(*shape, 0), InputError);
    EXPECT_THROW(scaledShape(*shape, -1), InputError);
    EXPECT_THROW(scaledShape(*shape, std::nan("")), InputError);
  }
}

}  // namespace
}  // namespace granular
