// The convex hull: topology, scale, degenerate input, and the oracle "no point outside, every face held by its
// corners".
#include "granular/shape/hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/core/tolerances.h"

namespace granular {
namespace {

std::vector<Vec3> cubeCorners(double half) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k) {
    corners.emplace_back((k & 1) ? half : -half, (k & 2) ? half : -half, (k & 4) ? half : -half);
  }
  return corners;
}

/// Every point below every face (slack), every face planar (both relative to size), every edge shared by two faces,
/// Euler's formula.
void expectConvexAndClosed(const ConvexHull& hull, std::span<const Vec3> points, double size, double slack,
                           double planar = 4e-14) {
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const auto& face = hull.faces[f];
    const Vec3& n = hull.normals[f];
    EXPECT_NEAR(n.norm(), 1, 1e-14);
    const double offset = n.dot(hull.vertices[static_cast<std::size_t>(face[0])]);
    for (std::int32_t c : face) {
      EXPECT_NEAR(n.dot(hull.vertices[static_cast<std::size_t>(c)]), offset, planar * size);
    }
    double worst = -infinity;
    for (const Vec3& p : points) worst = std::max(worst, n.dot(p) - offset);
    EXPECT_LE(worst, slack * size);
    for (std::size_t k = 0; k < face.size(); ++k) ++edges[{face[k], face[(k + 1) % face.size()]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_EQ(hull.vertices.size() + hull.faces.size(), edges.size() / 2 + 2);
}

TEST(Hull, CubeHasSixSquareFaces) {
  const auto corners = cubeCorners(1);
  const ConvexHull hull = convexHull(corners);
  ASSERT_EQ(hull.vertices.size(), 8u);
  ASSERT_EQ(hull.faces.size(), 6u);
  for (const auto& face : hull.faces) EXPECT_EQ(face.size(), 4u);
  expectConvexAndClosed(hull, corners, 2, 1e-14);
}

TEST(Hull, TurnedCubesStillHaveSixFacesAtEveryScale) {
  Random random(3);
  for (double scale : {1e-6, 1e-3, 1.0, 1e3}) {
    for (int trial = 0; trial < 50; ++trial) {
      const Mat3 turn = random.rotation().toRotationMatrix();
      auto corners = cubeCorners(scale);
      for (Vec3& c : corners) c = turn * c + scale * Vec3(3, -2, 1);
      const ConvexHull hull = convexHull(corners);
      ASSERT_EQ(hull.faces.size(), 6u);
      expectConvexAndClosed(hull, corners, 2 * scale, 1e-14);
    }
  }
}

TEST(Hull, PointsOnFacesEdgesInsideAndTwiceAreNoVertices) {
  std::vector<Vec3> grid;
  for (int twice = 0; twice < 2; ++twice) {
    for (int i = 0; i <= 6; ++i) {
      for (int j = 0; j <= 6; ++j) {
        for (int k = 0; k <= 6; ++k) grid.push_back(Vec3(i, j, k) * 1e-4);
      }
    }
  }
  for (bool turned : {false, true}) {
    if (turned) {
      const Mat3 turn = Random(9).rotation().toRotationMatrix();
      for (Vec3& p : grid) p = turn * p;
    }
    const ConvexHull hull = convexHull(grid);
    EXPECT_EQ(hull.vertices.size(), 8u);
    EXPECT_EQ(hull.faces.size(), 6u);
    expectConvexAndClosed(hull, grid, 6e-4, 1e-14);
  }
}

TEST(Hull, RandomPointsLieBelowEveryFace) {
  Random random(5);
  for (int n : {4, 5, 8, 30, 300, 2000}) {
    std::vector<Vec3> onSphere, inBall;
    for (int k = 0; k < n; ++k) {
      onSphere.push_back(random.direction());
      inBall.push_back(random.direction() * std::cbrt(random.uniform()));
    }
    expectConvexAndClosed(convexHull(inBall), inBall, 2, tolerance::hullWidth);
    const ConvexHull hull = convexHull(onSphere);
    expectConvexAndClosed(hull, onSphere, 2, tolerance::hullWidth);
    EXPECT_EQ(hull.vertices.size(), onSphere.size());
  }
}

TEST(Hull, PrismOfManyCosphericalCornersKeepsItsTwoPolygons) {
  std::vector<Vec3> points;
  for (int k = 0; k < 100; ++k) {
    const double angle = 2 * pi * k / 100;
    points.emplace_back(std::cos(angle), std::sin(angle), -1);
    points.emplace_back(std::cos(angle), std::sin(angle), 1);
  }
  const ConvexHull hull = convexHull(points);
  EXPECT_EQ(hull.vertices.size(), 200u);
  EXPECT_EQ(hull.faces.size(), 102u);
  expectConvexAndClosed(hull, points, 2, 1e-13);
}

TEST(Hull, NearlyDegeneratePointsStillGiveAClosedConvexSurface) {
  Random random(11);
  for (double noise : {1e-16, 1e-15, 1e-14, 1e-12, 1e-10, 1e-8, 1e-7, 3e-7, 1e-6, 3e-6, 1e-5, 1e-4}) {
    for (int trial = 0; trial < 20; ++trial) {
      // a cube's faces covered with points that are off by the noise
      std::vector<Vec3> points;
      for (int k = 0; k < 200; ++k) {
        Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const auto axis = static_cast<int>(random.below(3));
        p[axis] = p[axis] > 0 ? 1 : -1;
        if (k % 3 == 0) p[(axis + 1) % 3] = 1;
        points.push_back(p + noise * random.direction());
      }
      const Mat3 turn = random.rotation().toRotationMatrix();
      for (Vec3& p : points) p = turn * p;
      // noise above the width that counts as flat leaves slender faces, whose normals are known to eps over their width
      const double planar = noise < tolerance::hullWidth ? 4e-14 : tolerance::hullConvexity;
      expectConvexAndClosed(convexHull(points), points, 2, std::max(tolerance::hullWidth, 5 * noise), planar);
    }
  }
}

TEST(Hull, CuboidsInSinglePrecisionHaveSixPlanarFaces) {
  Random random(13);
  for (int trial = 0; trial < 100; ++trial) {
    const Mat3 turn = random.rotation().toRotationMatrix();
    std::vector<Vec3> corners;
    for (const Vec3& c : cubeCorners(1e-3)) {
      corners.push_back((turn * c.cwiseProduct(Vec3(1, 2, 3))).cast<float>().cast<double>());
    }
    const ConvexHull hull = convexHull(corners);
    ASSERT_EQ(hull.faces.size(), 6u);
    expectConvexAndClosed(hull, corners, 6e-3, tolerance::hullWidth);
    for (std::size_t k = 0; k < 8; ++k) EXPECT_LT((hull.vertices[k] - corners[k]).norm(), 1e-9);
  }
}

TEST(Hull, SameHullInMicrometresAndKilometres) {
  Random random(7);
  std::vector<Vec3> points, small, large;
  for (int k = 0; k < 60; ++k) {
    points.push_back(random.direction());
    small.push_back(points.back() * std::ldexp(1.0, -20));
    large.push_back(points.back() * std::ldexp(1.0, 10));
  }
  const ConvexHull hull = convexHull(points);
  EXPECT_EQ(convexHull(small).faces, hull.faces);
  EXPECT_EQ(convexHull(large).faces, hull.faces);
}

TEST(Hull, BadPointsAreRefusedWithTheReason) {
  const auto messageOf = [](const std::vector<Vec3>& points) -> std::string {
    try {
      convexHull(points);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  auto corners = cubeCorners(1e-3);
  EXPECT_NE(messageOf({corners[0], corners[1], corners[2]}).find("at least 4"), std::string::npos);
  EXPECT_NE(messageOf(std::vector<Vec3>(6, corners[0])).find("coincide"), std::string::npos);
  EXPECT_NE(messageOf({corners[0], corners[1], corners[2], corners[3]}).find("plane"), std::string::npos);
  EXPECT_NE(messageOf({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}).find("plane"), std::string::npos);
  corners[3].y() = std::nan("");
  EXPECT_NE(messageOf(corners).find("point 3"), std::string::npos);
  corners[3].y() = infinity;
  EXPECT_NE(messageOf(corners).find("point 3"), std::string::npos);
  // a turned flat set is flat still
  Random random(2);
  const Mat3 turn = random.rotation().toRotationMatrix();
  std::vector<Vec3> flat;
  for (int k = 0; k < 50; ++k) flat.push_back(turn * Vec3(random.uniform(), random.uniform(), 0));
  EXPECT_NE(messageOf(flat).find("plane"), std::string::npos);
}

}  // namespace
}  // namespace granular
