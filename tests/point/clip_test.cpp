// Clipping and moments: closed forms, then cells counted by brute force.
#include "granular/point/clip.h"

#include <gtest/gtest.h>

#include "granular/point/moments.h"
#include "point/random_polygon.h"

namespace granular {
namespace {

using test::integrateByCells;
using test::isInside;
using test::makeRandomPolygon;

const Linear unitDepth{1, Vec2::Zero()};

Polygon makeRectangle(double x0, double y0, double x1, double y1) {
  Polygon p;
  p.push({x0, y0}, 0);
  p.push({x1, y0}, 1);
  p.push({x1, y1}, 2);
  p.push({x0, y1}, 3);
  return p;
}

double areaOf(const Polygon& p) { return integrate(p, unitDepth).area; }

TEST(Clip, PolygonWithItselfKeepsItsArea) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Polygon p = makeRandomPolygon(random, 3 + static_cast<int>(random.below(30)));
    Polygon clipped = p;
    clipPolygon(p, clipped);
    EXPECT_NEAR(areaOf(clipped), areaOf(p), 1e-15);
  }
}

TEST(Clip, CoincidentEdgesKeepTheSharedArea) {
  Polygon p = makeRectangle(0, 0, 2, 1);
  clipPolygon(makeRectangle(0, 0, 1, 1), p);
  EXPECT_DOUBLE_EQ(areaOf(p), 1);
  p = makeRectangle(0, 0, 1, 1);
  clipPolygon(makeRectangle(1, 0, 2, 1), p);
  EXPECT_EQ(areaOf(p), 0);
}

TEST(Clip, EmptyWhenApartAndWholeWhenInside) {
  Polygon p = makeRectangle(0, 0, 1, 1);
  clipPolygon(makeRectangle(3, 0, 4, 1), p);
  EXPECT_EQ(p.count, 0);
  p = makeRectangle(0, 0, 1, 1);
  clipPolygon(makeRectangle(-1e6, -1e6, 1e6, 1e6), p);
  EXPECT_EQ(p.count, 4);
  EXPECT_EQ(areaOf(p), 1);
}

TEST(Clip, EdgesKeepTheirNames) {
  Polygon p = makeRectangle(0, 0, 2, 2), q = makeRectangle(1, 1, 3, 3);
  for (std::size_t k = 0; k < 4; ++k) q.edges[k] = 10 + static_cast<int>(k);
  clipPolygon(q, p);
  // The square from (1, 1) to (2, 2): right and top from p, left and bottom from q.
  ASSERT_EQ(p.count, 4);
  for (int k = 0; k < 4; ++k) {
    const Vec2 middle = 0.5 * (p[k] + p[p.next(k)]);
    const int expected = middle.x() == 2 ? 1 : middle.y() == 2 ? 2 : middle.x() == 1 ? 13 : 10;
    EXPECT_EQ(p.edge(k), expected) << middle.transpose();
  }
}

TEST(Clip, MovesByRoundOffWhenAnEdgeMovesByRoundOff) {
  // A slightly shrunk or grown and turned copy changes the area by the order of the change, never by a corner.
  const Polygon p = makeRectangle(0, 0, 1, 1);
  for (double e = 1e-17; e < 1e-3; e *= 10) {
    for (const double side : {-1.0, 1.0}) {
      Polygon q;
      for (int k = 0; k < 4; ++k) q.push(p[k] + side * e * Vec2(1 - p[k].y(), p[k].x()), k);
      Polygon clipped = p;
      clipPolygon(q, clipped);
      EXPECT_NEAR(areaOf(clipped), 1, 4 * e + 1e-15) << e;
    }
  }
}

TEST(Clip, SegmentIsCutByPolygonAndByTheReachOfAnotherSegment) {
  const Polygon square = makeRectangle(0, 0, 1, 1);
  Segment s{{-1, .5}, {3, .5}};
  ASSERT_TRUE(clipSegment(square, s));
  EXPECT_EQ(s.from, Vec2(0, .5));
  EXPECT_EQ(s.to, Vec2(1, .5));
  s = {{-1, 2}, {3, 2}};
  EXPECT_FALSE(clipSegment(square, s));
  // Along an edge: kept.
  s = {{-1, 1}, {3, 1}};
  ASSERT_TRUE(clipSegment(square, s));
  EXPECT_DOUBLE_EQ((s.to - s.from).norm(), 1);

  // Parallel: what they share. Crossing: around the crossing.
  s = {{-1, 0}, {1, 0}};
  ASSERT_TRUE(clipSegment({{0, 1e-9}, {5, 1e-9}}, 1e-3, s));
  EXPECT_NEAR((s.from - Vec2(0, 0)).norm() + (s.to - Vec2(1, 0)).norm(), 0, 1e-12);
  s = {{-1, 0}, {1, 0}};
  ASSERT_TRUE(clipSegment({{.25, -1}, {.25, 1}}, 1e-3, s));
  EXPECT_NEAR((0.5 * (s.from + s.to) - Vec2(.25, 0)).norm(), 0, 1e-15);
  s = {{-1, 0}, {1, 0}};
  EXPECT_FALSE(clipSegment({{2, -1}, {2, 1}}, 1e-3, s));
}

TEST(Clip, AgreesWithCountedCellsOnRandomPolygons) {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const Polygon p = makeRandomPolygon(random, 3 + static_cast<int>(random.below(8)));
    const Polygon q = makeRandomPolygon(random, 3 + static_cast<int>(random.below(8)));
    Polygon clipped = p;
    clipPolygon(q, clipped);
    const double counted =
        integrateByCells(400, [&](const Vec2& x) { return isInside(p, x) && isInside(q, x) ? 1.0 : 0.0; });
    // Some 600 cells of 1e-4 lie on the border, each wrong by half at random.
    EXPECT_NEAR(areaOf(clipped), counted, 4e-3);
  }
}

TEST(Moments, OfARectangleAreTheClosedForms) {
  const AreaMoments m = integrate(makeRectangle(1, 2, 4, 4), Linear{0, {1, 0}});
  EXPECT_DOUBLE_EQ(m.area, 6);
  EXPECT_TRUE(m.centroid().isApprox(Vec2(2.5, 3)));
  EXPECT_NEAR(m.xx - 6 * 2.5 * 2.5, 6 * 9.0 / 12, 1e-13);
  EXPECT_NEAR(m.yy - 6 * 9, 6 * 4.0 / 12, 1e-13);
  EXPECT_NEAR(m.xy, 6 * 2.5 * 3, 1e-13);
  // Depth x: the volume is area times 2.5, its centroid at 2.5 + (9/12)/2.5.
  EXPECT_DOUBLE_EQ(m.volume, 15);
  EXPECT_NEAR(m.centroidOfVolume().x(), 2.5 + .75 / 2.5, 1e-14);
}

TEST(Moments, OfATriangularPressureLieAtTheThirdPoint) {
  const AreaMoments m = integrate(makeRectangle(0, 0, 3, 1), Linear{0, {2, 0}});
  EXPECT_DOUBLE_EQ(m.centroidOfVolume().x(), 2);
  EXPECT_DOUBLE_EQ(m.centroidOfVolume().y(), .5);
}

TEST(Moments, AgreeWithQuadratureOverRandomPolygons) {
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    const Polygon p = makeRandomPolygon(random, 3 + static_cast<int>(random.below(10)));
    const Linear depth{3, {random.uniform(-1, 1), random.uniform(-1, 1)}};
    const AreaMoments m = integrate(p, depth);
    const auto sum = [&](auto&& f) {
      return integrateByCells(500, [&](const Vec2& x) { return isInside(p, x) ? double(f(x)) : 0.0; });
    };
    EXPECT_NEAR(m.area, sum([](const Vec2&) { return 1; }), 4e-3);
    EXPECT_NEAR(m.first.x(), sum([](const Vec2& x) { return x.x(); }), 4e-3);
    EXPECT_NEAR(m.first.y(), sum([](const Vec2& x) { return x.y(); }), 4e-3);
    EXPECT_NEAR(m.xx, sum([](const Vec2& x) { return x.x() * x.x(); }), 4e-3);
    EXPECT_NEAR(m.yy, sum([](const Vec2& x) { return x.y() * x.y(); }), 4e-3);
    EXPECT_NEAR(m.xy, sum([](const Vec2& x) { return x.x() * x.y(); }), 4e-3);
    EXPECT_NEAR(m.volume, sum([&](const Vec2& x) { return depth.at(x); }), 2e-2);
    EXPECT_NEAR(m.firstOfVolume.x(), sum([&](const Vec2& x) { return depth.at(x) * x.x(); }), 2e-2);
    EXPECT_NEAR(m.firstOfVolume.y(), sum([&](const Vec2& x) { return depth.at(x) * x.y(); }), 2e-2);
  }
}

TEST(Moments, OfPiecesAddUpToTheWhole) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Polygon p = makeRandomPolygon(random, 3 + static_cast<int>(random.below(10)));
    const Linear depth{3, {random.uniform(-1, 1), random.uniform(-1, 1)}};
    const Linear cut{random.uniform(-.2, .2), {random.uniform(-1, 1), random.uniform(-1, 1)}};
    Polygon left = p, right = p;
    clipPolygon(cut, noEdge, left);
    clipPolygon({-cut.offset, -cut.slope}, noEdge, right);
    AreaMoments sum = integrate(left, depth);
    sum += integrate(right, depth);
    const AreaMoments whole = integrate(p, depth);
    EXPECT_NEAR(sum.area, whole.area, 1e-14);
    EXPECT_NEAR(sum.xy, whole.xy, 1e-14);
    EXPECT_NEAR(sum.yy, whole.yy, 1e-14);
    EXPECT_NEAR((sum.firstOfVolume - whole.firstOfVolume).norm(), 0, 1e-14);
  }
}

TEST(Moments, OfASliverFarFromTheOriginKeepTheirCentroid) {
  // A strip 1 long and 1e-9 wide at distance 1000: its corners are rounded to 1e-13.
  const AreaMoments m = integrate(makeRectangle(1000, 1000, 1001, 1000 + 1e-9), unitDepth);
  EXPECT_NEAR(m.area / 1e-9, 1, 2e-4);
  EXPECT_NEAR(m.centroid().x(), 1000.5, 1e-9);
}

TEST(Moments, OfAStripAreThoseOfItsRectangle) {
  const AreaMoments strip = integrate(Segment{{1, 3}, {4, 3}}, 2, 1, 4);
  const AreaMoments rectangle = integrate(makeRectangle(1, 2, 4, 4), Linear{0, {1, 0}});
  EXPECT_NEAR(strip.area, rectangle.area, 1e-13);
  EXPECT_NEAR(strip.xx, rectangle.xx, 1e-12);
  EXPECT_NEAR(strip.yy, rectangle.yy, 1e-12);
  EXPECT_NEAR(strip.xy, rectangle.xy, 1e-12);
  EXPECT_NEAR(strip.volume, rectangle.volume, 1e-13);
  EXPECT_NEAR((strip.firstOfVolume - rectangle.firstOfVolume).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace granular
