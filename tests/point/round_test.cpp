// Contacts of cylinders, cones and rough polyhedra by the patch rule: caps, sides, rims, and the volume of any overlap.
#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/point/contact_point.h"
#include "granular/point/overlap.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"

namespace granular {
namespace {

const Frame below(Mat3::Identity(), Vec3(0, 0, -1));

const Cuboid& makeSlab() {
  static const Cuboid shape(Vec3(4, 4, 1));
  return shape;
}

/// The shape turned, its deepest point `depth` under the slab's face z = 0, and the contact there (normal down).
struct Sunk {
  Frame frame;
  Touch touch;

  Sunk(const Shape& shape, const Mat3& rotation, double depth, double x = 0) : frame(rotation, Vec3(x, 0, 0)) {
    const Vec3 down = -Vec3::UnitZ();
    frame.x.z() = -depth - frame.toWorld(shape.support(frame.unrotate(down))).z();
    const Vec3 deepest = frame.toWorld(shape.support(frame.unrotate(down)));
    touch = {down, depth, deepest, Vec3(deepest.x(), deepest.y(), 0)};
  }
};

Mat3 turnY(double angle) { return Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix(); }

ContactPatch placeOnSlab(PointRule rule, const Shape& shape, const Sunk& sunk) {
  ContactPatch out;
  placeContact({rule}, shape, sunk.frame, makeSlab(), below, sunk.touch, out);
  return out;
}

TEST(Cylinder, StandingOnItsCapTouchesAtTheCentreWithTheDiscsMoments) {
  const Cylinder cylinder(.5, 1);
  const ContactPatch p = placeOnSlab(PointRule::patch, cylinder, Sunk(cylinder, Mat3::Identity(), 1e-3, .3));
  EXPECT_NEAR((p.point - Vec3(.3, 0, -.5e-3)).norm(), 0, 1e-12);
  // The cap is a regular polygon of faceSamples corners: its area is sin(x)/x of the disc's, x = 2 pi/faceSamples.
  const double x = 2 * pi / faceSamples;
  EXPECT_NEAR(p.area / (pi * .25), std::sin(x) / x, 1e-12);
  EXPECT_NEAR(p.uu / (.25 / 4), 1, 2e-2);
  EXPECT_NEAR(p.vv / p.uu, 1, 1e-9);
}

TEST(Cylinder, LyingOnItsSideTouchesAlongAStrip) {
  const Cylinder cylinder(.5, 2);
  const double depth = 1e-3;
  const ContactPatch p = placeOnSlab(PointRule::patch, cylinder, Sunk(cylinder, turnY(pi / 2), depth));
  EXPECT_NEAR((p.point - Vec3(0, 0, -depth / 2)).norm(), 0, 1e-12);
  EXPECT_NEAR(p.area, 2 * depth, 1e-12);
  EXPECT_NEAR(p.uu + p.vv, 4.0 / 12 + depth * depth / 12, 1e-12);
}

// The end of the other is a circle there, not the polygon that stands for it where areas overlap.
TEST(Cylinder, LyingOnTheEndOfAnotherTouchesAlongItsChord) {
  const Cylinder lying(.5, 6), standing(1, 2);
  const double depth = 1e-3;
  for (const double across : {0.0, .3, .77, .99}) {
    // Beyond the end on both sides; then with its own end in the middle.
    for (const double shift : {.4, 3.0}) {
      Sunk sunk(lying, turnY(pi / 2), depth, shift);
      sunk.frame.x.y() = across;
      sunk.touch.onA += Vec3(0, across, 0);
      sunk.touch.onB += Vec3(0, across, 0);
      ContactPatch p;
      placeContact({PointRule::patch}, lying, sunk.frame, standing, below, sunk.touch, p);
      const double half = std::sqrt(1 - across * across), from = std::max(-half, shift - 3);
      EXPECT_NEAR(p.area, depth * (half - from), 1e-12);
      EXPECT_NEAR((p.point - Vec3(.5 * (from + half), across, -depth / 2)).norm(), 0, 1e-12);

      ContactPatch turnedRound;
      const Touch touch{Vec3::UnitZ(), depth, sunk.touch.onB, sunk.touch.onA};
      placeContact({PointRule::patch}, standing, below, lying, sunk.frame, touch, turnedRound);
      EXPECT_NEAR(turnedRound.area, p.area, 1e-15);
      EXPECT_NEAR((turnedRound.point - p.point).norm(), 0, 1e-15);
    }
  }
}

TEST(Round, EndsAreToldWithoutTheirCorners) {
  Random random(2);
  const Cylinder cylinder(.5, 1.2);
  const Cone cone(.5, 1.2);
  int ends = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 d = random.direction();
    for (const Shape* shape : {static_cast<const Shape*>(&cylinder), static_cast<const Shape*>(&cone)}) {
      for (const double cosine : {.5, .7071, std::abs(d.z())}) {
        Feature feature;
        Disk disk;
        const Vec3 normal = shape->supportFace(d, cosine, feature);
        const bool isEnd = shape->supportDisk(d, cosine, disk);
        ASSERT_EQ(isEnd, feature.count == faceSamples);
        if (!isEnd) continue;
        ++ends;
        EXPECT_EQ(disk.normal, normal);
        for (int k = 0; k < feature.count; ++k) {
          EXPECT_NEAR((feature[k] - disk.centre).norm(), disk.radius, 1e-15);
          EXPECT_EQ(disk.normal.dot(feature[k] - disk.centre), 0);
        }
      }
    }
  }
  EXPECT_GT(ends, 1000);
}

TEST(Round, EndsOverlapAsTheWalkOverTheirCornersMeasuresThem) {
  Random random(6);
  int whole = 0, cut = 0;
  for (int n = 0; n < 4000; ++n) {
    const Cylinder lower(random.uniform(.3, 1), 1.5);
    const Cone cone(random.uniform(.3, 1), 1.2);
    const Cylinder cylinder(random.uniform(.3, 1), 1.2);
    const Shape& upper = n % 4 ? static_cast<const Shape&>(cylinder) : cone;
    // An end of either across the normal, tilted by up to 40 degrees, or by as good as nothing.
    const Mat3 upright = random.rotation().toRotationMatrix();
    const Vec3 normal = upright.col(2);
    const auto tilt = [&](bool turnedOver) {
      const double angle = (n % 3 ? .7 : 1e-4) * random.uniform(0, 1);
      const Vec3 about = upright * Vec3(std::cos(n), std::sin(n), 0);
      const Mat3 leaning = Eigen::AngleAxisd(angle, about).toRotationMatrix() * upright;
      return Mat3(turnedOver ? leaning * Eigen::AngleAxisd(pi, Vec3::UnitX()).toRotationMatrix() : leaning);
    };
    Frame below(tilt(n % 2), Vec3::Zero()), above(tilt(false), Vec3::Zero());
    const Vec3 top = below.toWorld(lower.support(below.unrotate(normal)));
    const Vec3 bottom = above.toWorld(upper.support(above.unrotate(-normal)));
    const double depth = std::pow(10, random.uniform(-4, -1));
    above.x = top - bottom - depth * normal + upright * Vec3(random.uniform(-.4, .4), random.uniform(-.4, .4), 0);
    const Vec3 onB = above.toWorld(upper.support(above.unrotate(-normal)));
    const Touch touch{normal, depth, onB + depth * normal, onB};
    const ContactPlane plane(touch);
    for (const PowerChoice& power : {PowerChoice{}, PowerChoice{3, depth}}) {
      OverlapArea found, right;
      const bool overlap = measureOverlap(plane, lower, below, upper, above, depth, power, found);
      ASSERT_EQ(overlap, measureByWalk(plane, lower, below, upper, above, depth, power, 0, right));
      if (!overlap) continue;
      const AreaMoments &f = found.moments, &r = right.moments;
      const double slack = 1e-9 + 1e-13 / depth;  // round-off of heights moves the outline
      EXPECT_NEAR(f.area, r.area, slack * r.area + 1e-15);
      EXPECT_NEAR(f.volume, r.volume, slack * r.volume + 1e-15 * depth);
      EXPECT_NEAR((f.first - r.first).norm(), 0, slack * r.area + 1e-15);
      EXPECT_NEAR((f.firstOfVolume - r.firstOfVolume).norm(), 0, slack * r.volume + 1e-15 * depth);
      EXPECT_NEAR(f.xx + f.yy, r.xx + r.yy, slack * r.area + 1e-15);
      EXPECT_NEAR(f.square, r.square, slack * r.volume * depth + 1e-15 * depth * depth);
      EXPECT_NEAR(f.powers.at, r.powers.at, slack * r.area + 1e-15);
      EXPECT_NEAR(found.height, right.height, 1e-12);
      (r.area > .05 ? whole : cut) += 1;
    }
  }
  EXPECT_GT(whole, 700);
  EXPECT_GT(cut, 700);
}

TEST(Cylinder, LyingAtLiftOffTouchesAtItsThirdPoint) {
  const Cylinder cylinder(.5, 2);
  const double depth = 1e-3, tilt = std::asin(depth / 2);
  const Sunk sunk(cylinder, turnY(pi / 2 + tilt), depth);
  const ContactPatch p = placeOnSlab(PointRule::pressureCentroid, cylinder, sunk);
  EXPECT_NEAR(std::abs(sunk.touch.onA.x() - p.point.x()), 2.0 / 3, 1e-6);
}

TEST(Cylinder, OverhangingTheSlabTouchesOverItAlone) {
  const Cylinder cylinder(.5, 2);
  const ContactPatch p = placeOnSlab(PointRule::patch, cylinder, Sunk(cylinder, turnY(pi / 2), 1e-3, 3.5));
  EXPECT_NEAR(p.point.x(), 3.25, 1e-12);
}

TEST(Cylinder, PointMovesContinuouslyFromCapToSide) {
  // All the way over the rim. At 45 degrees side takes over from cap: a step of the order of the depth.
  const Cylinder cylinder(.5, 1);
  const double depth = 1e-3;
  const int steps = 20000;
  const double h = pi / 2 / steps;
  double last = placeOnSlab(PointRule::pressureCentroid, cylinder, Sunk(cylinder, Mat3::Identity(), depth)).point.x();
  for (int k = 1; k <= steps; ++k) {
    const Sunk sunk(cylinder, turnY(k * h), depth);
    const double x = placeOnSlab(PointRule::pressureCentroid, cylinder, sunk).point.x();
    const bool handover = std::abs(k * h - pi / 4) < 2 * h;
    // Before lift-off of a side of length L the point's speed is at most (L^2/12) 4/depth; that of the cap is less.
    ASSERT_LT(std::abs(x - last), h * (4.0 / 12 / depth + 4) + (handover ? 2 * depth : 0)) << k * h;
    last = x;
  }
}

TEST(Cylinder, CrossingAnotherTouchesAtTheCrossingAndParallelInTheSharedMiddle) {
  const Cylinder cylinder(.5, 4);
  const double depth = 1e-3;
  const Frame lower(turnY(pi / 2), Vec3::Zero());
  for (const double angle : {pi / 2, 1.0, .1, .01}) {
    const Frame upper(Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix() * turnY(pi / 2),
                      Vec3(.3, 0, 1 - depth));
    const Touch touch{-Vec3::UnitZ(), depth, Vec3(.3, 0, .5 - depth), Vec3(.3, 0, .5)};
    for (const PointRule rule : {PointRule::faceCentroid, PointRule::pressureCentroid, PointRule::patch}) {
      ContactPatch p;
      placeContact({rule}, cylinder, upper, cylinder, lower, touch, p);
      EXPECT_NEAR((p.point - Vec3(.3, 0, .5 - depth / 2)).norm(), 0, 1e-9) << angle << pointRuleName(rule);
    }
  }
  // Shifted along by one: they share three metres.
  const Frame upper(turnY(pi / 2), Vec3(1, 0, 1 - depth));
  const Touch touch{-Vec3::UnitZ(), depth, Vec3(3, 0, .5 - depth), Vec3(3, 0, .5)};
  for (const PointRule rule : {PointRule::faceCentroid, PointRule::pressureCentroid, PointRule::patch}) {
    ContactPatch p;
    placeContact({rule}, cylinder, upper, cylinder, lower,
                 Touch{touch.normal, depth, Vec3(-1, 0, .5 - depth), Vec3(-1, 0, .5)}, p);
    EXPECT_NEAR(p.point.x(), .5, 1e-9) << pointRuleName(rule);
  }
}

TEST(Cone, TouchesWithItsTipItsSideAndItsBase) {
  const Cone cone(.5, 1);
  const double depth = 1e-4;
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Sunk sunk(cone, random.rotation().toRotationMatrix(), depth);
    const ContactPatch p = placeOnSlab(PointRule::patch, cone, sunk);
    ASSERT_TRUE(p.point.allFinite() && p.centre.allFinite());
    // Within the overlap, and not far outside the body.
    EXPECT_LE(p.point.z(), 1e-9);
    EXPECT_GE(p.point.z(), -depth - 1e-9);
    EXPECT_TRUE(cone.contains((1 - 4 * depth) * sunk.frame.toBody(p.point + .5 * depth * Vec3::UnitZ())) ||
                (p.point - sunk.touch.onA).norm() < 3 * depth);
  }
}

Polyhedron makeGrain(Random& random, int corners) {
  std::vector<Vec3> points;
  for (int k = 0; k < corners; ++k) points.push_back(random.direction() * random.uniform(.8, 1));
  return Polyhedron(points);
}

/// Where the line x parallel to n leaves the polyhedron upwards, by all its planes; -infinity if it misses.
double findTop(const Polyhedron& shape, const Frame& frame, const ContactPlane& plane, const Vec2& x, double sign) {
  const Vec3 from = frame.toBody(plane.lift(x, 0)), along = frame.unrotate(sign * plane.n);
  double top = infinity, bottom = -infinity;
  for (int f = 0; f < shape.tables().faceCount(); ++f) {
    const Vec3& normal = shape.tables().faces[static_cast<std::size_t>(f)].normal;
    const double cosine = normal.dot(along);
    const double at = (shape.tables().faces[static_cast<std::size_t>(f)].offset - normal.dot(from)) / cosine;
    if (cosine > 0) top = std::min(top, at);
    if (cosine < 0) bottom = std::max(bottom, at);
  }
  return bottom <= top ? top : -infinity;
}

TEST(Overlap, OfGrainsIsTheIntegralOfTheirDepthByLines) {
  // Deep in, so that many faces of both take part.
  Random random(4);
  for (int trial = 0; trial < 12; ++trial) {
    const Polyhedron a = makeGrain(random, 12 + 6 * trial), b = makeGrain(random, 30);
    const Frame frameB(random.rotation().toRotationMatrix(), Vec3::Zero());
    const Vec3 n = random.direction();
    Frame frameA(random.rotation().toRotationMatrix(), Vec3::Zero());
    const double depth = .15;
    const Vec3 topA = frameA.toWorld(a.support(frameA.unrotate(n)));
    const Vec3 topB = frameB.toWorld(b.support(frameB.unrotate(-n)));
    frameA.x = topB - topA + depth * n;
    const Touch touch{n, depth, topB + depth * n, topB};
    const ContactPlane plane(touch);
    OverlapArea area;
    ASSERT_TRUE(measureOverlap(plane, a, frameA, b, frameB, depth, {}, area));

    const int lines = 1000;
    const double h = 2.0 / lines;
    AreaMoments counted;
    for (int k = 0; k < lines * lines; ++k) {
      const int row = k / lines;
      const Vec2 x(-1 + (k % lines + .5) * h, -1 + (row + .5) * h);
      const double d = findTop(a, frameA, plane, x, 1) + findTop(b, frameB, plane, x, -1);
      if (!(d > 0)) continue;
      counted.area += h * h;
      counted.volume += d * h * h;
      counted.firstOfVolume += d * h * h * x;
    }
    // Faces steeper than steepestCosine and thin strips are left out.
    const double size = std::sqrt(counted.area);
    EXPECT_NEAR(area.moments.volume / counted.volume, 1, .03) << trial;
    EXPECT_LT((area.moments.centroidOfVolume() - counted.centroidOfVolume()).norm(), .01 * size) << trial;
  }
}

TEST(PressureCentroid, OfARollingGrainMovesContinuously) {
  // Over faces, edges and vertices: the point may run along a flat face fast, but never jumps. Halving the step must
  // halve the largest step of the point, down to what the thin strips left out may move it.
  Random random(5);
  const double depth = 5e-3;
  for (int trial = 0; trial < 5; ++trial) {
    const Polyhedron grain = makeGrain(random, 25);
    const Vec3 axis = random.direction();
    const Mat3 start = random.rotation().toRotationMatrix();
    const auto findLargestStep = [&](int steps) {
      double largest = 0;
      Vec2 last = Vec2::Zero();
      for (int k = 0; k <= steps; ++k) {
        const Sunk sunk(grain, Eigen::AngleAxisd(1.0 * k / steps, axis).toRotationMatrix() * start, depth);
        const Vec2 x = placeOnSlab(PointRule::pressureCentroid, grain, sunk).point.head<2>();
        if (k > 0) largest = std::max(largest, (x - last).norm());
        last = x;
      }
      return largest;
    };
    const double coarse = findLargestStep(4000), fine = findLargestStep(16000);
    EXPECT_LT(fine, .3 * coarse + 2e-3 * depth) << coarse;
  }
}

}  // namespace
}  // namespace granular
