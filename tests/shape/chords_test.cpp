// Vertical lines through placed shapes against what contains() says, and sections against closed forms.
#include "granular/shape/chords.h"

#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/shape/clump.h"
#include "granular/shape/ellipsoid_chain.h"
#include "granular/shape/shape_table.h"

namespace granular {
namespace {

std::vector<std::shared_ptr<const Shape>> makeShapes() {
  const std::vector<ChildSphere> dumbbell = {{Vec3(-1.5, 0, 0), 1}, {Vec3(1.5, .3, 0), 1.2}};
  return {makeShape("sphere", std::vector{1.3}), makeShape("ellipsoid", std::vector{2.0, 1.0, .6}),
          makeShape("cuboid", std::vector{1.0, .7, .4}), std::make_shared<Clump>(dumbbell),
          std::make_shared<Clump>(makeEllipsoidChain(2.7, 1.15, 9))};
}

TEST(Chords, EndWhereTheShapeDoes) {
  Random random(1);
  ChordFinder finder;
  std::vector<Chord> chords;
  int met = 0;
  for (const auto& shape : makeShapes()) {
    for (int k = 0; k < 300; ++k) {
      const Frame frame(Pose{random.direction(), random.rotation()});
      const double reach = shape->boundingRadius();
      const double x = frame.x.x() + random.uniform(-reach, reach), y = frame.x.y() + random.uniform(-reach, reach);
      finder.find(*shape, frame, x, y, chords);
      const auto inside = [&](double z) { return shape->contains(frame.toBody({x, y, z})); };
      const double hair = 1e-9;
      double last = -infinity;
      for (const Chord& c : chords) {
        ++met;
        EXPECT_GT(c.low, last);
        last = c.high;
        if (c.high - c.low < 4 * hair) continue;
        EXPECT_TRUE(inside(c.low + hair) && inside(c.high - hair)) << shape->describe();
        EXPECT_FALSE(inside(c.low - hair) || inside(c.high + hair)) << shape->describe();
      }
      // Nothing of the line is left out.
      for (int s = 0; s < 40; ++s) {
        const double z = frame.x.z() + random.uniform(-reach, reach);
        const bool found =
            std::any_of(chords.begin(), chords.end(), [&](const Chord& c) { return c.low <= z && z <= c.high; });
        EXPECT_EQ(found, inside(z)) << shape->describe();
      }
    }
  }
  EXPECT_GT(met, 500);
}

TEST(Chords, SectionsOfEllipsoidsAndChainsAreThoseOfTheClosedForms) {
  const double a = 2.7, b = 1.15;
  ChordFinder finder;
  const auto ellipsoid = makeShape("ellipsoid", std::vector{a, b, b});
  for (const double turn : {0.0, .3, 1.2}) {
    const Frame frame(Pose{{.4, 0, .8}, Quat(Eigen::AngleAxisd(turn, Vec3::UnitY()))});
    // Chords end as a root at both ends; the sampling in t makes them smooth: midpoints converge as n^-2 and faster.
    EXPECT_NEAR(finder.sectionArea(*ellipsoid, frame, 0), pi * a * b, 1e-5 * pi * a * b);
    for (const int n : {3, 5, 17}) {
      const auto spheres = makeEllipsoidChain(a, b, n);
      const double area = measureChain(spheres, a, b).area * pi * a * b;
      EXPECT_NEAR(finder.sectionArea(Clump(spheres, ellipsoid->massProperties()), frame, 0), area, 2e-4 * area) << n;
    }
  }
}

}  // namespace
}  // namespace granular
