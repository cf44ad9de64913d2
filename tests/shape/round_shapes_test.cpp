// Spheres, ellipsoids, cylinders and cones: closed forms, then fine polyhedra converging to them, then brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace granular {
namespace {

std::vector<std::shared_ptr<const Shape>> roundShapes(double scale) {
  return {std::make_shared<Sphere>(1.5 * scale),
          std::make_shared<Ellipsoid>(scale * Vec3(1, 2, 3)),
          std::make_shared<Ellipsoid>(scale * Vec3(1.5, 1.5, .375)),
          std::make_shared<Cylinder>(1.5 * scale, .75 * scale),
          std::make_shared<Cylinder>(1.5 * scale, 9 * scale),
          std::make_shared<Cone>(1 * scale, 3 * scale),
          std::make_shared<Cone>(2 * scale, 1 * scale)};
}

std::vector<std::shared_ptr<const Shape>> allShapes(double scale) {
  auto shapes = roundShapes(scale);
  shapes.push_back(std::make_shared<Cuboid>(scale * Vec3(1, 2, 3)));
  Random random(21);
  std::vector<Vec3> points;
  for (int k = 0; k < 60; ++k) points.push_back(scale * random.direction().cwiseProduct(Vec3(1, 1, 2)));
  shapes.push_back(std::make_shared<Polyhedron>(points));
  return shapes;
}

TEST(RoundShapes, MeasuresOfASphereAreItsClosedForms) {
  const Sphere sphere(2e-3);
  const double r = 2e-3;
  EXPECT_NEAR(sphere.massProperties().volume, 4 * pi / 3 * r * r * r, 1e-23);
  EXPECT_NEAR(sphere.massProperties().meanSquareRadius, r * r, 1e-20);
  EXPECT_NEAR(sphere.size(), r, 1e-17);
  EXPECT_EQ(sphere.boundingRadius(), r);
  EXPECT_EQ(sphere.innerRadius(), r);
  // R_i = <r²>/<I> gives m_t = 2/7 mu for spheres
  const auto& p = sphere.massProperties();
  EXPECT_NEAR(p.meanSquareRadius / (p.inertia.mean() / p.volume), 2.5, 1e-13);
}

TEST(RoundShapes, EqualAxesMakeASphereOfAnEllipsoid) {
  const Ellipsoid ball(Vec3::Constant(1.5e-3));
  const Sphere sphere(1.5e-3);
  EXPECT_NEAR(ball.massProperties().area, sphere.massProperties().area, 1e-13 * sphere.massProperties().area);
  EXPECT_NEAR(ball.massProperties().meanSquareRadius, 2.25e-6, 1e-18);
  EXPECT_NEAR(ball.massProperties().volume, sphere.massProperties().volume, 1e-14 * sphere.massProperties().volume);
}

TEST(RoundShapes, SpheroidAreasMeetTheirClosedForms) {
  for (double aspect : {0.02, 0.1, 0.25, 0.5, 0.999, 1.001, 2.0, 3.0, 10.0, 50.0}) {
    const double a = 1, c = aspect;
    double area;
    if (c < a) {
      const double e = std::sqrt(1 - c * c / (a * a));
      area = 2 * pi * a * a + pi * c * c / e * std::log((1 + e) / (1 - e));
    } else {
      const double e = std::sqrt(1 - a * a / (c * c));
      area = 2 * pi * a * a * (1 + c / (a * e) * std::asin(e));
    }
    // the closed forms themselves lose digits as 1/e near the sphere
    EXPECT_NEAR(Ellipsoid(Vec3(a, a, c)).massProperties().area, area, 2e-11 * area) << aspect;
    EXPECT_NEAR(Ellipsoid(Vec3(c, a, a)).massProperties().area, area, 2e-11 * area) << aspect;
    EXPECT_NEAR(Ellipsoid(Vec3(a, c, a)).massProperties().area, area, 2e-11 * area) << aspect;
  }
}

TEST(RoundShapes, OrderOfTheAxesOfAnEllipsoidOnlyTurnsIt) {
  const MassProperties p = Ellipsoid(Vec3(1, 2, 5)).massProperties(), q = Ellipsoid(Vec3(5, 1, 2)).massProperties();
  EXPECT_NEAR(p.area, q.area, 1e-12 * p.area);
  EXPECT_NEAR(p.meanSquareRadius, q.meanSquareRadius, 1e-12 * p.meanSquareRadius);
  EXPECT_NEAR(p.inertia[0], q.inertia[1], 1e-13 * p.inertia[0]);
  EXPECT_EQ(Ellipsoid(Vec3(5, 1, 2)).director(), Vec3::UnitX());
  EXPECT_EQ(Ellipsoid(Vec3(1.5, 1.5, .4)).director(), Vec3::UnitZ());
}

TEST(RoundShapes, FinePolyhedraConvergeQuadraticallyToEveryMeasure) {
  for (const auto& shape : roundShapes(1e-3)) {
    const MassProperties& exact = shape->massProperties();
    std::array<Eigen::Vector<double, 6>, 2> errors;
    for (int level : {0, 1}) {
      const TriangleMesh mesh = shape->surface(64 << level);
      const SolidProperties solid = solidProperties(mesh.vertices, mesh.triangles);
      const MassProperties& p = solid.principal;
      EXPECT_LT(solid.centroid.norm(), 1e-3 * shape->size() / (1 << 2 * level)) << shape->describe();
      EXPECT_LT((solid.axes - Mat3::Identity()).norm(), 1e-9) << shape->describe();
      errors[static_cast<std::size_t>(level)] << p.volume / exact.volume - 1, p.area / exact.area - 1,
          p.meanSquareRadius / exact.meanSquareRadius - 1, p.inertia[0] / exact.inertia[0] - 1,
          p.inertia[1] / exact.inertia[1] - 1, p.inertia[2] / exact.inertia[2] - 1;
    }
    // second order: extrapolating removes the error to fourth order
    for (int k = 0; k < 6; ++k) {
      EXPECT_LT(std::abs(errors[0][k]), .02) << shape->describe() << " measure " << k;
      EXPECT_NEAR((4 * errors[1][k] - errors[0][k]) / 3, 0, 2e-5) << shape->describe() << " measure " << k;
    }
  }
}

TEST(Shapes, SurfacesAreWatertightAndFaceOutward) {
  for (const auto& shape : allShapes(1e-3)) {
    for (int resolution : {3, 8, 33}) {
      const TriangleMesh mesh = shape->surface(resolution);
      std::map<std::pair<int, int>, int> edges;
      for (const auto& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
        const Vec3& a = mesh.vertices[static_cast<std::size_t>(t[0])];
        const Vec3& b = mesh.vertices[static_cast<std::size_t>(t[1])];
        const Vec3& c = mesh.vertices[static_cast<std::size_t>(t[2])];
        EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0) << shape->describe();
      }
      for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
      }
      EXPECT_EQ(mesh.vertices.size() + mesh.triangles.size(), edges.size() / 2 + 2);
      for (const Vec3& v : mesh.vertices) EXPECT_TRUE(shape->contains(v)) << shape->describe();
    }
  }
}

TEST(Shapes, SupportIsTheFurthestSurfacePoint) {
  Random random(31);
  for (const auto& shape : allShapes(1e-3)) {
    const TriangleMesh mesh = shape->surface(200);
    double furthest = 0, least = infinity;
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3 d = trial < 6 ? Vec3(Vec3::Unit(trial % 3) * (trial < 3 ? 1 : -1)) : random.direction();
      const Vec3 p = shape->support(d);
      double brute = -infinity;
      for (const Vec3& v : mesh.vertices) brute = std::max(brute, d.dot(v));
      const double size = shape->boundingRadius();
      EXPECT_GE(d.dot(p), brute - 1e-14 * size) << shape->describe();
      EXPECT_LE(d.dot(p), brute + 2e-3 * size) << shape->describe();
      EXPECT_TRUE(shape->contains(p)) << shape->describe();
      EXPECT_EQ(shape->support(3 * d), shape->support(3 * d));
      EXPECT_NEAR(d.dot(shape->support(7 * d)), d.dot(p), 1e-14 * size);
      furthest = std::max(furthest, p.norm());
      least = std::min(least, d.dot(p));
    }
    EXPECT_LE(furthest, shape->boundingRadius() * (1 + 1e-14)) << shape->describe();
    EXPECT_GE(least, shape->innerRadius() * (1 - 1e-14)) << shape->describe();
  }
}

TEST(Shapes, RadiiAndLongestExtentAreTight) {
  for (const auto& shape : allShapes(1e-3)) {
    const TriangleMesh mesh = shape->surface(128);
    double bounding = 0, diameter = 0, inner = infinity;
    for (const Vec3& v : mesh.vertices) {
      bounding = std::max(bounding, v.norm());
      for (const Vec3& w : mesh.vertices) diameter = std::max(diameter, (v - w).norm());
    }
    for (const auto& t : mesh.triangles) {
      const Vec3& a = mesh.vertices[static_cast<std::size_t>(t[0])];
      const Vec3 n = (mesh.vertices[static_cast<std::size_t>(t[1])] - a)
                         .cross(mesh.vertices[static_cast<std::size_t>(t[2])] - a)
                         .normalized();
      inner = std::min(inner, n.dot(a));
    }
    EXPECT_NEAR(shape->boundingRadius(), bounding, 1e-3 * bounding) << shape->describe();
    EXPECT_NEAR(shape->longestExtent(), diameter, 1e-3 * diameter) << shape->describe();
    EXPECT_NEAR(shape->innerRadius(), inner, 2e-3 * inner) << shape->describe();
    EXPECT_GE(shape->longestExtent(), diameter * (1 - 1e-14)) << shape->describe();
  }
}

TEST(Shapes, BoundsAreTheExtremesOfTheSupport) {
  Random random(41);
  for (const auto& shape : allShapes(1e-3)) {
    for (int trial = 0; trial < 100; ++trial) {
      const Frame frame(random.rotation().toRotationMatrix(), random.direction());
      const Aabb box = shape->bounds(frame), generic = shape->Shape::bounds(frame);
      EXPECT_LT((box.lo - generic.lo).norm(), 1e-15) << shape->describe();
      EXPECT_LT((box.hi - generic.hi).norm(), 1e-15) << shape->describe();
    }
  }
}

TEST(Shapes, ContainmentAgreesWithTheSupportHalfSpaces) {
  Random random(51);
  for (const auto& shape : allShapes(1e-3)) {
    const Aabb box = shape->bounds(Frame());
    int inside = 0;
    const int trials = 1500;
    for (int trial = 0; trial < trials; ++trial) {
      Vec3 p;
      for (int k = 0; k < 3; ++k) p[k] = random.uniform(box.lo[k], box.hi[k]);
      const bool contained = shape->contains(p);
      inside += contained;
      bool beyond = false;
      for (int k = 0; k < 200 && !beyond; ++k) {
        const Vec3 d = random.direction();
        beyond = d.dot(p) > d.dot(shape->support(d));
      }
      if (contained) {
        EXPECT_FALSE(beyond) << shape->describe();
      }
    }
    // the share of the box that is inside is the volume's (4 standard errors)
    const double share = shape->massProperties().volume / (box.hi - box.lo).prod();
    EXPECT_NEAR(static_cast<double>(inside) / trials, share, 4 * std::sqrt(share * (1 - share) / trials) + 1e-12)
        << shape->describe();
    EXPECT_TRUE(shape->contains(Vec3::Zero()));
    EXPECT_FALSE(shape->contains(Vec3::Constant(std::nan(""))));
  }
}

TEST(Shapes, EveryMeasureScalesFromMicrometresToKilometres) {
  const auto unit = allShapes(1);
  for (double scale : {1e-6, 1e-3, 1e3}) {
    const auto scaled = allShapes(scale);
    for (std::size_t k = 0; k < unit.size(); ++k) {
      const Shape &u = *unit[k], &s = *scaled[k];
      const double s2 = scale * scale;
      EXPECT_NEAR(s.massProperties().volume / (s2 * scale), u.massProperties().volume,
                  1e-11 * u.massProperties().volume);
      EXPECT_NEAR(s.massProperties().area / s2, u.massProperties().area, 1e-11 * u.massProperties().area);
      EXPECT_NEAR(s.massProperties().meanSquareRadius / s2, u.massProperties().meanSquareRadius,
                  1e-11 * u.massProperties().meanSquareRadius);
      EXPECT_LT((s.massProperties().inertia / (s2 * s2 * scale) - u.massProperties().inertia).norm(),
                1e-11 * u.massProperties().inertia.norm());
      EXPECT_NEAR(s.innerRadius() / scale, u.innerRadius(), 1e-11);
      EXPECT_LT((s.director() - u.director()).norm(), 1e-9);
    }
  }
}

TEST(Shapes, SlabFeaturesLieOnTheShapeWithinTheSlabInOrder) {
  Random random(61);
  for (const auto& shape : allShapes(1e-3)) {
    for (int trial = 0; trial < 500; ++trial) {
      Vec3 d = random.direction();
      if (trial % 3 == 0) d = Vec3(1e-3 * d.x(), 1e-3 * d.y(), d.z() < 0 ? -1 : 1).normalized();
      if (trial % 3 == 1) d = Vec3(d.x(), d.y(), 1e-3 * d.z()).normalized();
      const double slab = shape->size() * random.uniform(0, .02);
      Feature feature;
      shape->supportFeature(d, slab, feature);
      ASSERT_GE(feature.count, 1);
      const double top = d.dot(shape->support(d));
      const double rounding = 4e-14 * shape->boundingRadius();
      // the first corner is the highest (the support point itself may lie inside the polygon seen along d)
      for (int k = 0; k < feature.count; ++k) EXPECT_LE(d.dot(feature[k]), d.dot(feature[0])) << shape->describe();
      EXPECT_LE(d.dot(feature[0]), top + rounding) << shape->describe();
      double area = 0;
      for (int k = 0; k < feature.count; ++k) {
        EXPECT_TRUE(shape->contains(feature[k])) << shape->describe();
        EXPECT_GE(d.dot(feature[k]), top - slab - rounding) << shape->describe();
        area += d.dot(feature[k].cross(feature[(k + 1) % feature.count]));
      }
      EXPECT_GE(area, -rounding * shape->size()) << shape->describe();
    }
  }
}

TEST(Cylinder, CapIsTheInscribedPolygonAndTheSideASegment) {
  const Cylinder cylinder(1e-3, 4e-3);
  Feature feature;
  for (double sign : {1.0, -1.0}) {
    cylinder.supportFeature(Vec3(0, 0, sign), 0, feature);
    ASSERT_EQ(feature.count, faceSamples);
    double twice = 0;
    for (int k = 0; k < feature.count; ++k) twice += sign * feature[k].cross(feature[(k + 1) % feature.count]).z();
    const double angle = 2 * pi / faceSamples;
    EXPECT_NEAR(twice / 2, pi * 1e-6 * std::sin(angle) / angle, 1e-18);
    const Vec3 d = Vec3(.01, .02, sign).normalized();
    EXPECT_EQ(cylinder.supportFace(d, .9, feature), Vec3(0, 0, sign));
    ASSERT_EQ(feature.count, faceSamples);
    EXPECT_LT((feature[0] - cylinder.support(d)).norm(), 1e-17);
    twice = 0;
    for (int k = 0; k < feature.count; ++k) twice += sign * feature[k].cross(feature[(k + 1) % feature.count]).z();
    EXPECT_GT(twice, 0);
  }
  cylinder.supportFeature(Vec3(.6, .8, 0), 0, feature);
  ASSERT_EQ(feature.count, 2);
  EXPECT_NEAR(std::abs(feature[0].z() - feature[1].z()), 4e-3, 1e-17);
  cylinder.supportFace(Vec3(.6, .8, .01).normalized(), .99, feature);
  EXPECT_EQ(feature.count, 2);
  cylinder.supportFace(Vec3(.6, 0, .8), .99, feature);
  EXPECT_EQ(feature.count, 1);
}

TEST(Cone, BaseSideAndApexAreItsThreeFeatures) {
  const Cone cone(1e-3, 2e-3);
  Feature feature;
  cone.supportFeature(-Vec3::UnitZ(), 0, feature);
  EXPECT_EQ(feature.count, faceSamples);
  cone.supportFeature(Vec3::UnitZ(), 0, feature);
  ASSERT_EQ(feature.count, 1);
  EXPECT_EQ(feature[0], Vec3(0, 0, 1.5e-3));
  const Vec3 sideNormal = Vec3(2, 0, 1).normalized();
  cone.supportFeature(sideNormal, 1e-9, feature);
  EXPECT_EQ(feature.count, 2);
  cone.supportFace(sideNormal, .99, feature);
  EXPECT_EQ(feature.count, 2);
  EXPECT_EQ(cone.supportFace(Vec3(.1, 0, -1).normalized(), .9, feature), Vec3(-Vec3::UnitZ()));
  EXPECT_EQ(feature.count, faceSamples);
}

TEST(Shapes, BadSizesAreRefusedByName) {
  const auto messageOf = [](auto make) -> std::string {
    try {
      make();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(messageOf([] { Sphere(-1e-3); }).find("radius is -0.001"), std::string::npos);
  EXPECT_NE(messageOf([] { Sphere(std::nan("")); }).find("radius"), std::string::npos);
  EXPECT_NE(messageOf([] { Cylinder(1, 0); }).find("height is 0"), std::string::npos);
  EXPECT_NE(messageOf([] { Cone(infinity, 1); }).find("cone: radius"), std::string::npos);
  EXPECT_NE(messageOf([] { Ellipsoid(Vec3(1, -2, 1)); }).find("semi-axis b"), std::string::npos);
}

}  // namespace
}  // namespace granular
