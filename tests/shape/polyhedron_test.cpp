// Polyhedra against closed forms, cuboids against polyhedra, the climb against the scan, features against brute force.
#include "granular/shape/polyhedron.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "granular/core/errors.h"
#include "granular/core/random.h"

namespace granular {
namespace {

std::vector<Vec3> randomPoints(Random& random, int n, const Vec3& semiAxes) {
  std::vector<Vec3> points;
  for (int k = 0; k < n; ++k) points.push_back(random.direction().cwiseProduct(semiAxes));
  return points;
}

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// All tables tell the same story.
void expectConsistentTables(const PolyhedronTables& t) {
  EXPECT_EQ(t.vertexCount() + t.faceCount(), static_cast<int>(t.edges.size()) + 2);
  for (std::int32_t f = 0; f < t.faceCount(); ++f) {
    const auto corners = t.cornersOf(f);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::int32_t p = corners[k].vertex, q = corners[(k + 1) % corners.size()].vertex;
      const auto& edge = t.edges[at(corners[k].edge)];
      EXPECT_EQ(edge.a, std::min(p, q));
      EXPECT_EQ(edge.b, std::max(p, q));
      EXPECT_EQ(p < q ? edge.faceLeft : edge.faceRight, f);
      EXPECT_EQ(p < q ? edge.faceRight : edge.faceLeft, corners[k].beyond);
      EXPECT_EQ(edge.wings[p < q ? 0 : 2], corners[(k + corners.size() - 1) % corners.size()].vertex);
      EXPECT_EQ(edge.wings[p < q ? 1 : 3], corners[(k + 2) % corners.size()].vertex);
    }
    for (const Vec3& v : t.vertices) EXPECT_LE(t.faces[at(f)].normal.dot(v), t.faces[at(f)].offset + 1e-14 * v.norm());
  }
  std::size_t spokeCount = 0;
  for (std::int32_t v = 0; v < t.vertexCount(); ++v) {
    const auto spokes = t.spokesOf(v);
    spokeCount += spokes.size();
    for (std::size_t k = 0; k < spokes.size(); ++k) {
      const auto &here = spokes[k], &next = spokes[(k + 1) % spokes.size()];
      // The face runs from the next spoke's end through the vertex to this spoke's end.
      const auto corners = t.cornersOf(here.face);
      const std::size_t n = corners.size();
      std::size_t c = 0;
      while (c < n && corners[c].vertex != v) ++c;
      ASSERT_LT(c, n);
      EXPECT_EQ(corners[(c + 1) % n].vertex, here.vertex);
      EXPECT_EQ(corners[(c + n - 1) % n].vertex, next.vertex);
    }
  }
  EXPECT_EQ(spokeCount, 2 * t.edges.size());
}

TEST(Polyhedron, TablesAgreeWithEachOther) {
  Random random(1);
  for (int n : {4, 8, 30, 400}) expectConsistentTables(Polyhedron(randomPoints(random, n, Vec3(1, 2, 3))).tables());
  expectConsistentTables(Cuboid(Vec3(1, 2, 3)).tables());
}

TEST(Polyhedron, HullOfACuboidIsTheCuboid) {
  for (double scale : {1e-6, 1e-3, 1.0, 1e3}) {
    for (const Vec3& half : {Vec3(1, 2, 3), Vec3(3, 1, 2), Vec3(1, 1, 4), Vec3(2, 1, 2), Vec3(1, 1, 1)}) {
      const Cuboid cuboid(scale * half);
      Frame frame;
      const Vec3 shift = scale * Vec3(5, -1, 2);
      std::vector<Vec3> corners(cuboid.tables().vertices.begin(), cuboid.tables().vertices.end());
      for (Vec3& c : corners) c += shift;
      const Polyhedron hull(corners, &frame);
      // the axes given are kept
      EXPECT_LT((frame.R - Mat3::Identity()).norm(), 1e-12);
      EXPECT_LT((frame.x - shift).norm(), 1e-14 * scale * 5);
      ASSERT_EQ(hull.tables().vertexCount(), 8);
      const double length = scale * half.norm();
      for (int k = 0; k < 8; ++k) {
        EXPECT_LT((hull.tables().vertices[at(k)] - cuboid.tables().vertices[at(k)]).norm(), 1e-14 * 5 * length);
      }
      const MassProperties &p = hull.massProperties(), &c = cuboid.massProperties();
      EXPECT_NEAR(p.volume, c.volume, 1e-13 * c.volume);
      EXPECT_NEAR(p.area, c.area, 1e-13 * c.area);
      EXPECT_LT((p.inertia - c.inertia).norm(), 1e-13 * c.inertia.norm());
      EXPECT_NEAR(p.meanSquareRadius, c.meanSquareRadius, 1e-13 * c.meanSquareRadius);
      EXPECT_NEAR(hull.boundingRadius(), cuboid.boundingRadius(), 1e-13 * length);
      EXPECT_NEAR(hull.innerRadius(), cuboid.innerRadius(), 1e-13 * length);
      EXPECT_NEAR(hull.longestExtent(), cuboid.longestExtent(), 1e-13 * length);
      EXPECT_NEAR(hull.size(), cuboid.size(), 1e-13 * length);
    }
  }
}

TEST(Polyhedron, TurnedBodiesComeBackWithTheSameMoments) {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const auto points = randomPoints(random, 40, Vec3(1, 1.5, 2));
    auto turned = points;
    const Mat3 turn = random.rotation().toRotationMatrix();
    for (Vec3& p : turned) p = turn * p + Vec3(1, 2, 3);
    Frame frame;
    const Polyhedron a(points), b(turned, &frame);
    Vec3 left = a.massProperties().inertia, right = b.massProperties().inertia;
    std::sort(left.begin(), left.end());
    std::sort(right.begin(), right.end());
    EXPECT_LT((left - right).norm(), 1e-12 * left.norm());
    // the frame maps body points back onto the input, by a proper rotation
    EXPECT_NEAR(frame.R.determinant(), 1, 1e-13);
    for (const Vec3& v : b.tables().vertices) {
      double nearest = infinity;
      for (const Vec3& p : turned) nearest = std::min(nearest, (frame.toWorld(v) - p).norm());
      EXPECT_LT(nearest, 1e-14 * 10);
    }
  }
}

TEST(Polyhedron, RegularSolidsMeetTheirClosedForms) {
  const double a = 1e-3;
  // tetrahedron: edge 2 sqrt2 a
  const Polyhedron tetrahedron(std::vector<Vec3>{{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}});
  const double edge = 2 * std::sqrt(2.0) * a;
  const double volume = edge * edge * edge / (6 * std::sqrt(2.0));
  EXPECT_NEAR(tetrahedron.massProperties().volume, volume, 1e-14 * volume);
  EXPECT_NEAR(tetrahedron.massProperties().area, std::sqrt(3.0) * edge * edge, 1e-13 * edge * edge);
  for (double moment : tetrahedron.massProperties().inertia) {
    EXPECT_NEAR(moment, volume * edge * edge / 20, 1e-13 * volume * edge * edge);
  }
  EXPECT_NEAR(tetrahedron.innerRadius(), edge / (2 * std::sqrt(6.0)), 1e-14 * edge);
  // mean over a face: its distance squared plus edge²/12
  EXPECT_NEAR(tetrahedron.massProperties().meanSquareRadius, edge * edge * (1.0 / 24 + 1.0 / 12), 1e-14 * edge * edge);

  // octahedron: edge sqrt2 a, V = sqrt2/3 edge³, I = m edge²/10
  const Polyhedron octahedron(std::vector<Vec3>{{a, 0, 0}, {-a, 0, 0}, {0, a, 0}, {0, -a, 0}, {0, 0, a}, {0, 0, -a}});
  EXPECT_NEAR(octahedron.massProperties().volume, 4.0 / 3 * a * a * a, 1e-14 * a * a * a);
  for (double moment : octahedron.massProperties().inertia) {
    EXPECT_NEAR(moment, 4.0 / 3 * a * a * a * a * a / 5, 1e-14 * a * a * a * a * a);
  }
  EXPECT_EQ(octahedron.tables().faceCount(), 8);
}

TEST(Polyhedron, ClimbingFindsTheVertexOfTheScan) {
  Random random(6);
  for (int n : {21, 60, 500, 2000}) {
    const Polyhedron body(randomPoints(random, n, Vec3(1, 1, 2) * 1e-3));
    const PolyhedronTables& t = body.tables();
    for (int trial = 0; trial < 2000; ++trial) {
      const Vec3 d = random.direction();
      double furthest = -infinity;
      for (const Vec3& v : t.vertices) furthest = std::max(furthest, d.dot(v));
      const auto start = static_cast<std::int32_t>(random.below(t.vertices.size()));
      EXPECT_GE(d.dot(t.vertices[at(t.supportVertex(d, start))]), furthest - 1e-15 * body.boundingRadius());
      EXPECT_GE(d.dot(body.support(d)), furthest - 1e-15 * body.boundingRadius());
    }
  }
}

TEST(Polyhedron, CubeOnItsFaceGivesTheSquareOnItsEdgeTheEdge) {
  const Cuboid cube(Vec3(1, 1, 1));
  Feature feature;
  cube.supportFeature(Vec3::UnitZ(), 0, feature);
  ASSERT_EQ(feature.count, 4);
  // counter-clockwise seen from above
  double twiceArea = 0;
  for (int k = 0; k < 4; ++k) twiceArea += feature[k].cross(feature[(k + 1) % 4]).z();
  EXPECT_NEAR(twiceArea, 8, 1e-14);
  cube.supportFeature(Vec3(1, 0, 1).normalized(), 0, feature);
  EXPECT_EQ(feature.count, 2);
  cube.supportFeature(Vec3(1, 1, 1).normalized(), 0, feature);
  EXPECT_EQ(feature.count, 1);
  EXPECT_EQ(cube.supportFace(Vec3(.1, 0, 1).normalized(), 0.9, feature), Vec3::UnitZ());
  EXPECT_EQ(feature.count, 4);
  cube.supportFace(Vec3(1, 0.01, 1).normalized(), 0.99, feature);
  EXPECT_EQ(feature.count, 2);
  cube.supportFace(Vec3(1, 1, 1).normalized(), 0.99, feature);
  EXPECT_EQ(feature.count, 1);
}

TEST(Polyhedron, SlabFeatureIsTheHullOfTheVerticesInTheSlab) {
  Random random(8);
  for (int n : {8, 40, 300}) {
    const Polyhedron body(randomPoints(random, n, Vec3(1, 1, 1)));
    for (int trial = 0; trial < 300; ++trial) {
      const Vec3 d = random.direction();
      const double slab = random.uniform(0, n > 100 ? .1 : .6);
      Feature feature;
      body.supportFeature(d, slab, feature);
      const double top = d.dot(body.support(d));
      ASSERT_GE(feature.count, 1);
      for (int k = 0; k < feature.count; ++k) EXPECT_GE(d.dot(feature[k]), top - slab - 1e-14);
      // every vertex in the slab lies within the polygon seen along d
      for (const Vec3& v : body.tables().vertices) {
        if (d.dot(v) < top - slab || feature.count < 3) continue;
        for (int k = 0; k < feature.count; ++k) {
          const Vec3 side = feature[(k + 1) % feature.count] - feature[k];
          EXPECT_GE(d.dot(side.cross(v - feature[k])), -1e-14);
        }
      }
    }
  }
}

TEST(Polyhedron, FeaturesOfVeryManyCornersStayWithinCapacityAndBody) {
  std::vector<Vec3> points;
  for (int k = 0; k < 500; ++k) {
    const double angle = 2 * pi * k / 500;
    points.emplace_back(std::cos(angle), std::sin(angle), -.5);
    points.emplace_back(std::cos(angle), std::sin(angle), .5);
  }
  const Polyhedron drum(points);
  Feature feature;
  drum.supportFeature(Vec3::UnitZ(), 1e-3, feature);
  EXPECT_GT(feature.count, 2);
  drum.supportFeature(Vec3::UnitX(), 2.1, feature);
  for (int k = 0; k < feature.count; ++k) EXPECT_TRUE(drum.contains(feature[k]));
  EXPECT_EQ(drum.supportFace(Vec3::UnitZ(), .9, feature), Vec3::UnitZ());
  EXPECT_EQ(feature.count, Feature::capacity);
  double twiceArea = 0;
  for (int k = 0; k < feature.count; ++k) twiceArea += feature[k].cross(feature[(k + 1) % feature.count]).z();
  EXPECT_GT(twiceArea, 2 * pi * .99);
}

TEST(Polyhedron, ContainsWhatEverySupportPlaneLeavesInside) {
  Random random(10);
  const Polyhedron body(randomPoints(random, 25, Vec3(1, 2, 1)));
  int inside = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 p(random.uniform(-1, 1), random.uniform(-2, 2), random.uniform(-1, 1));
    bool beyond = false;
    for (int k = 0; k < 500; ++k) {
      const Vec3 d = random.direction();
      beyond = beyond || d.dot(p) > d.dot(body.support(d));
    }
    const bool contained = body.contains(p);
    inside += contained;
    if (contained) {
      EXPECT_FALSE(beyond);
    }
  }
  EXPECT_NEAR(inside / 2000.0, body.massProperties().volume / 16, .05);
  for (const Vec3& v : body.tables().vertices) {
    EXPECT_TRUE(body.contains(v));
    EXPECT_FALSE(body.contains(v * (1 + 1e-9)));
  }
}

TEST(Cuboid, BadHalfLengthsAreRefusedByName) {
  EXPECT_THROW(Cuboid(Vec3(1, 0, 1)), InputError);
  EXPECT_THROW(Cuboid(Vec3(1, 1, -1)), InputError);
  EXPECT_THROW(Cuboid(Vec3(std::nan(""), 1, 1)), InputError);
}

}  // namespace
}  // namespace granular
