// Where the rules put the contact of cubes: centre, third point, edge, and continuously between.
#include "granular/point/contact_point.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/point/overlap.h"

namespace granular {
namespace {

const Cuboid& makeCube() {
  static const Cuboid shape(Vec3(1, 1, 1));
  return shape;
}

const Cuboid& makeSlab() {
  static const Cuboid shape(Vec3(4, 4, 1));
  return shape;
}

const Frame below(Mat3::Identity(), Vec3(0, 0, -1));

/// The contact of A above the face z = 0 by brute force over A's vertices: the normal is -z, from A into B.
Touch touchTopFace(const Polyhedron& a, const Frame& frame) {
  Vec3 lowest(0, 0, infinity);
  for (const Vec3& v : a.tables().vertices) {
    const Vec3 p = frame.toWorld(v);
    if (p.z() < lowest.z()) lowest = p;
  }
  return {-Vec3::UnitZ(), -lowest.z(), lowest, Vec3(lowest.x(), lowest.y(), 0)};
}

/// The frame turned by R whose deepest vertex is `depth` under z = 0.
Frame sink(const Mat3& rotation, double depth, double x = 0) {
  Frame frame(rotation, Vec3(x, 0, 0));
  frame.x.z() = -depth - touchTopFace(makeCube(), frame).onA.z();
  return frame;
}

/// Turned about the y axis: the edge at body x = +1 goes down.
Frame tiltedCube(double tilt, double depth, double x = 0) {
  return sink(Eigen::AngleAxisd(tilt, Vec3::UnitY()).toRotationMatrix(), depth, x);
}

ContactPatch placeOnTop(PointRule rule, const Frame& frame, double slab = 1e-2) {
  ContactPatch out;
  placeContact({rule, slab}, makeCube(), frame, makeSlab(), below, touchTopFace(makeCube(), frame), out);
  return out;
}

TEST(Rules, AreFoundByName) {
  for (const PointRule rule : {PointRule::witness, PointRule::manifold, PointRule::faceCentroid,
                               PointRule::pressureCentroid, PointRule::patch}) {
    EXPECT_EQ(pointRuleFromName(pointRuleName(rule)), rule);
  }
  EXPECT_EQ(pointRuleFromName("face_centroid"), PointRule::faceCentroid);
  EXPECT_THROW(pointRuleFromName("centroid"), InputError);
}

TEST(Rules, PutAnAlignedCubeAtTheCentreOfItsFace) {
  for (const PointRule rule : {PointRule::faceCentroid, PointRule::pressureCentroid, PointRule::patch}) {
    const ContactPatch p = placeOnTop(rule, tiltedCube(0, 1e-3, .5));
    EXPECT_NEAR((p.point - Vec3(.5, 0, -.5e-3)).norm(), 0, 1e-14) << pointRuleName(rule);
    EXPECT_NEAR((p.centre - p.point).norm(), 0, 1e-14);
  }
}

TEST(Patch, OfAnAlignedCubeHasTheMomentsOfASquare) {
  const ContactPatch p = placeOnTop(PointRule::patch, tiltedCube(0, 1e-3, .5));
  EXPECT_NEAR(p.area, 4, 1e-13);
  EXPECT_NEAR(p.uu, 1.0 / 3, 1e-13);
  EXPECT_NEAR(p.vv, 1.0 / 3, 1e-13);
  EXPECT_NEAR(p.uv, 0, 1e-13);
}

TEST(Rules, ClipAnOverhangingCube) {
  // The slab ends at x = 4: a cube at 4.5 stands on its left half-metre alone.
  for (const PointRule rule : {PointRule::faceCentroid, PointRule::pressureCentroid, PointRule::patch}) {
    const ContactPatch p = placeOnTop(rule, tiltedCube(0, 1e-3, 4.5));
    EXPECT_NEAR(p.point.x(), 3.75, 1e-13) << pointRuleName(rule);
    EXPECT_NEAR(p.point.y(), 0, 1e-13);
  }
}

TEST(Rules, PutAnExactlyAlignedTwinAtTheCommonCentre) {
  // Coincident edges all around; the deepest points that a search names may be any pair, even a corner.
  const Frame top(Mat3::Identity(), Vec3(0, 0, .999));
  const Touch touch{-Vec3::UnitZ(), 1e-3, Vec3(1, 1, -1e-3), Vec3(1, 1, 0)};
  ContactPatch p;
  for (const PointRule rule : {PointRule::faceCentroid, PointRule::pressureCentroid, PointRule::patch}) {
    placeContact({rule}, makeCube(), top, makeCube(), below, touch, p);
    EXPECT_NEAR((p.point - Vec3(0, 0, -.5e-3)).norm(), 0, 1e-14) << pointRuleName(rule);
  }
  EXPECT_NEAR(p.area, 4, 1e-14);
}

TEST(PressureCentroid, IsTheThirdPointAtLiftOff) {
  // The far edge just lifts off when sin(tilt) is the depth over the face's width.
  const double depth = 1e-3, tilt = std::asin(depth / 2);
  const Frame frame = tiltedCube(tilt, depth);
  const ContactPatch p = placeOnTop(PointRule::pressureCentroid, frame);
  EXPECT_NEAR(frame.toWorld({1, 0, -1}).x() - p.point.x(), 2 * std::cos(tilt) / 3, 1e-12);
}

TEST(PressureCentroid, FollowsTheClosedFormOfATiltedStrip) {
  const double depth = 1e-3;
  for (double tilt = 1e-7; tilt < 1.4; tilt *= 1.2) {
    const Frame frame = tiltedCube(tilt, depth);
    const double c = std::cos(tilt), s = std::sin(tilt), edge = frame.toWorld({1, 0, -1}).x();
    // Depth falls with slope tan(tilt) along the bottom, and with 1/tan(tilt) up the side where it is not too steep.
    const double width = std::min(2 * c, depth * c / s), last = std::max(depth - width * s / c, 0.0);
    double volume = width * (depth + last) / 2;
    double first = -width * width * (depth + 2 * last) / 6;
    if (s >= steepestCosine) {
      const double beyond = depth * s / c;
      volume += beyond * depth / 2;
      first += beyond * beyond * depth / 6;
    }
    const ContactPatch p = placeOnTop(PointRule::pressureCentroid, frame);
    EXPECT_NEAR(p.point.x() - edge, first / volume, 1e-12) << tilt;
    EXPECT_NEAR(p.point.y(), 0, 1e-12);
  }
}

TEST(PressureCentroid, MovesContinuouslyUnderTilt) {
  // From flat, through lift-off, to the edge and over it. Before lift-off the offset is (w^2/12) t/(d - w t/2), t the
  // slope: its derivative is at most (w^2/12) 4/d, at lift-off. Where the side comes in, at a cosine of steepestCosine,
  // the point steps by less than that times the depth.
  const double depth = 1e-2;
  const int steps = 200000;
  const double h = pi / 2 / steps;
  double last = placeOnTop(PointRule::pressureCentroid, tiltedCube(0, depth)).point.x();
  for (int k = 1; k <= steps; ++k) {
    const double x = placeOnTop(PointRule::pressureCentroid, tiltedCube(k * h, depth)).point.x();
    const bool entering = (std::sin(k * h) >= steepestCosine) != (std::sin((k - 1) * h) >= steepestCosine) ||
                          (std::cos(k * h) >= steepestCosine) != (std::cos((k - 1) * h) >= steepestCosine);
    ASSERT_LT(std::abs(x - last), h * (4.0 / 12 * 4 / depth + 2) + (entering ? steepestCosine * depth : 0)) << k * h;
    last = x;
  }
}

TEST(PressureCentroid, MovesContinuouslyOverACorner) {
  // A cube on its corner turns through the exchange of its three lowest faces and of its deepest vertex's faces.
  const double depth = 1e-3;
  Random random(5);
  for (int path = 0; path < 20; ++path) {
    const Quat corner = Quat::FromTwoVectors(Vec3(1, 1, 1), -Vec3::UnitZ());
    const Vec3 axis = random.direction();
    const int steps = 2000;
    const double h = 0.6 / steps;
    Vec3 last;
    for (int k = 0; k <= steps; ++k) {
      const Frame frame = sink((Eigen::AngleAxisd(-.3 + k * h, axis) * corner).toRotationMatrix(), depth);
      const Vec3 x = placeOnTop(PointRule::pressureCentroid, frame).point;
      const Vec3 from = k > 0 ? last : x;
      ASSERT_LT((x - from).norm(), 3 * h) << path << " " << k;
      last = x;
    }
  }
}

TEST(Overlap, IntegralIsTheVolumeOfTheIntersection) {
  // Two cubes in random poses: columns along the normal against points counted in both.
  Random random(8);
  for (int k = 0; k < 10; ++k) {
    const Frame frame = sink(random.rotation().toRotationMatrix(), 0.2);
    const Touch touch = touchTopFace(makeCube(), frame);
    OverlapArea area;
    ASSERT_TRUE(measureOverlap(ContactPlane(touch), makeCube(), frame, makeSlab(), below, touch.overlap, {}, area));
    const int n = 120;
    const double h = 4.0 / n;
    double counted = 0;
    for (int i = 0; i < n * n * n; ++i) {
      const int row = i / n % n, layer = i / n / n;
      const Vec3 p(-2 + (i % n + .5) * h, -2 + (row + .5) * h, -.2 * (layer + .5) / n);
      counted += makeCube().contains(frame.toBody(p));
    }
    counted *= h * h * .2 / n;
    // Columns of steep faces are left out: at most a strip of a tenth of the depth around the region.
    const double strip = 0.5 * 0.1 * 0.2 * 0.2 * 4 * std::sqrt(3.0);
    EXPECT_LT(area.moments.volume, counted * 1.02 + 1e-3);
    EXPECT_GT(area.moments.volume, counted * 0.98 - 1e-3 - strip);
  }
}

TEST(FaceCentroid, TakesTheFaceWithinItsSlabAndTheEdgeBeyond) {
  // With slab 1 a face that tilts within its overlap keeps its centre; with a thin slab the deepest edge is taken.
  const double depth = 1e-3, tilt = 0.4 * depth;
  EXPECT_NEAR(placeOnTop(PointRule::faceCentroid, tiltedCube(tilt, depth), 1).point.x(), 0, 1e-3);
  EXPECT_NEAR(placeOnTop(PointRule::faceCentroid, tiltedCube(tilt, depth), .01).point.x(), 1, 1e-3);
}

TEST(Rules, AgreeOnTheDeepestVertexOfAGenericPose) {
  // Within a few depths of the vertex all rules say the same.
  const double depth = 1e-5;
  Random random(6);
  for (int k = 0; k < 100; ++k) {
    const Quat corner = Quat::FromTwoVectors(Vec3(1, 1, 1), -Vec3::UnitZ());
    const Quat turned(Eigen::AngleAxisd(random.uniform(-.3, .3), random.direction()) * corner);
    const Frame frame = sink(turned.toRotationMatrix(), depth);
    const Vec3 vertex = placeOnTop(PointRule::witness, frame).point;
    EXPECT_LT((placeOnTop(PointRule::faceCentroid, frame).point - vertex).norm(), 1e-12);
    EXPECT_LT((placeOnTop(PointRule::patch, frame).point - vertex).norm(), 5 * depth);
  }
}

TEST(Rules, DoNotDependOnWhichBodyIsCalledA) {
  Random random(7);
  for (int k = 0; k < 200; ++k) {
    const double depth = std::pow(10, random.uniform(-6, -1)), tilt = std::pow(10, random.uniform(-7, 0));
    const Quat turned(Eigen::AngleAxisd(tilt, random.direction()) *
                      Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ()));
    const Frame frame = sink(turned.toRotationMatrix(), depth, random.uniform(-5, 5));
    const Touch touch = touchTopFace(makeCube(), frame), swapped{-touch.normal, touch.overlap, touch.onB, touch.onA};
    if (std::abs(touch.onA.x()) > 4) continue;
    for (const PointRule rule : {PointRule::faceCentroid, PointRule::pressureCentroid, PointRule::patch}) {
      ContactPatch p, q;
      placeContact({rule}, makeCube(), frame, makeSlab(), below, touch, p);
      placeContact({rule}, makeSlab(), below, makeCube(), frame, swapped, q);
      EXPECT_LT((p.point - q.point).norm(), 1e-10) << pointRuleName(rule) << " depth " << depth << " tilt " << tilt;
      EXPECT_LT((p.centre - q.centre).norm(), 1e-10);
      EXPECT_NEAR(p.area, q.area, 1e-9);
    }
  }
}

}  // namespace
}  // namespace granular
