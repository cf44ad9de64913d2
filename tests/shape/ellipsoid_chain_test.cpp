// The chain of spheres for an ellipsoid (M section 2): its defining equations, M's own numbers, and three routes to its
// volume.
#include "granular/shape/ellipsoid_chain.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/shape/clump.h"

namespace granular {
namespace {

std::string refusal(double a, double b, int count) {
  try {
    makeEllipsoidChain(a, b, count);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// Counts of M that hang together, per aspect ratio.
std::vector<int> countsOf(double aspect) {
  std::vector<int> counts;
  for (const int count : {5, 7, 9, 11, 13, 15, 17, 33, 55})
    if (count >= smallestChain(aspect, 1)) counts.push_back(count);
  return counts;
}

TEST(EllipsoidChain, EachSphereTouchesTheEllipsoidFromWithin) {
  for (const double a : {1.5, 2.35, 5.0, 10.0}) {
    for (const int count : countsOf(a)) {
      for (const ChildSphere& child : makeEllipsoidChain(a, 1, count)) {
        const double c = child.centre.x(), r = child.radius;
        // The nearest point of the ellipse to c on its axis (M 3) is r away.
        const double x = c * a * a / (a * a - 1);
        EXPECT_LE(std::abs(x), a * (1 + 1e-15));
        const double y = std::sqrt(std::max(0.0, 1 - x * x / (a * a)));
        EXPECT_NEAR(std::hypot(x - c, y), r, 3e-8 * (std::abs(x) > 0.999 * a) + 2e-14) << a << " " << count;
        for (int k = 0; k <= 1000; ++k) {
          const double t = pi * k / 1000;
          EXPECT_GE(std::hypot(a * std::cos(t) - c, std::sin(t)), r - 1e-13);
        }
      }
    }
  }
}

TEST(EllipsoidChain, SpacingsShrinkWithTheOrdinateAndEndAtTheTip) {
  for (const double a : {1.5, 2.35, 5.0, 10.0}) {
    for (const int count : countsOf(a)) {
      const auto chain = makeEllipsoidChain(a, 1, count);
      ASSERT_EQ(static_cast<int>(chain.size()), count);
      const auto n = static_cast<std::size_t>(count / 2);
      EXPECT_EQ(chain[n].centre.x(), 0);
      EXPECT_EQ(chain[n].radius, 1);
      EXPECT_NEAR(chain.back().centre.x(), a - 1 / a, 1e-15 * a);
      EXPECT_NEAR(chain.back().radius, 1 / a, 1e-13);
      const auto y = [a](double x) { return std::sqrt((1 - x / a) * (1 + x / a)); };
      for (std::size_t k = n + 1; k + 1 < chain.size(); ++k) {
        const double x0 = chain[k - 1].centre.x(), x1 = chain[k].centre.x(), x2 = chain[k + 1].centre.x();
        EXPECT_NEAR((x2 - x1) * y(x0), (x1 - x0) * y(x1), 1e-13 * a);
        EXPECT_EQ(chain[k].centre.x(), -chain[chain.size() - 1 - k].centre.x());
      }
    }
  }
}

TEST(EllipsoidChain, ThreeSpheresAreMsSpecialCase) {
  const auto chain = makeEllipsoidChain(2.7e-3, 1.15e-3, 3);
  ASSERT_EQ(chain.size(), 3u);
  EXPECT_EQ(chain[1].radius, 1.15e-3);
  EXPECT_NEAR(chain[2].radius, 0.775e-3, 1e-18);
  EXPECT_NEAR(chain[2].centre.x() + chain[2].radius, 2.7e-3, 1e-18);
  EXPECT_NEAR(chain[2].centre.x() - chain[2].radius, 1.15e-3, 1e-18);
  EXPECT_EQ(countParts(chain), 1);
}

TEST(EllipsoidChain, HasTheSectionPerimeterAndVolumeOfAnIndependentIntegration) {
  // Profiles of 100001 points per sphere, integrated by the trapezoidal rule (a Python script of a few lines).
  struct Row {
    double aspect;
    int count;
    double area, perimeter, volume;
  };
  for (const Row& row : {Row{1.5, 5, 0.97792, 0.99715, 0.96089}, Row{1.5, 17, 0.99855, 0.99972, 0.99754},
                         Row{2.35, 3, 0.81330, 1.34769, 0.68727}, Row{2.35, 5, 0.91483, 1.03612, 0.85756},
                         Row{2.35, 9, 0.97932, 1.00562, 0.96359}, Row{2.35, 13, 0.99079, 1.00223, 0.98365},
                         Row{2.35, 15, 0.99322, 1.00159, 0.98795}, Row{2.35, 17, 0.99480, 1.00119, 0.99075},
                         Row{5, 11, 0.92278, 1.07738, 0.86662}, Row{5, 33, 0.99262, 1.00556, 0.98597},
                         Row{10, 55, 0.98829, 1.01115, 0.97723}}) {
    const ChainQuality quality = measureChain(makeEllipsoidChain(row.aspect, 1, row.count), row.aspect, 1);
    EXPECT_NEAR(quality.area, row.area, 1e-5) << row.aspect << " " << row.count;
    EXPECT_NEAR(quality.perimeter, row.perimeter, 2e-5) << row.aspect << " " << row.count;
    EXPECT_NEAR(quality.volume, row.volume, 1e-5) << row.aspect << " " << row.count;
    EXPECT_NEAR(quality.areaFactor(), 1 - row.area, 1e-5);
    EXPECT_NEAR(quality.perimeterFactor(), std::abs(row.perimeter - 1), 2e-5);
  }
}

TEST(EllipsoidChain, ItsVolumeIsThatOfTheUnion) {
  for (const double a : {1.5, 2.35, 5.0, 10.0}) {
    for (const int count : countsOf(a)) {
      const auto chain = makeEllipsoidChain(a, 1, count);
      const double exact = unionProperties(chain).principal.volume;
      // Far neighbours don't cut: the union is the sum of its zones.
      EXPECT_NEAR(measureChain(chain, a, 1).volume * 4 * pi / 3 * a, exact, 1e-10 * exact) << a << " " << count;
    }
  }
}

TEST(EllipsoidChain, ReachesOnePercentOfTheSectionWithMsThirteenSpheres) {
  EXPECT_LT(measureChain(makeEllipsoidChain(2.35, 1, 13), 2.35, 1).areaFactor(), 0.01);
  EXPECT_GT(measureChain(makeEllipsoidChain(2.35, 1, 11), 2.35, 1).areaFactor(), 0.01);
}

TEST(EllipsoidChain, IsRefusedWithTheReason) {
  EXPECT_NE(refusal(5, 1, 9).find("a chain of 9 spheres has gaps; the smallest number that works is 11"),
            std::string::npos);
  EXPECT_NE(refusal(10, 1, 17).find("the smallest number that works is 23"), std::string::npos) << refusal(10, 1, 17);
  EXPECT_EQ(refusal(10, 1, smallestChain(10, 1)), "accepted");
  EXPECT_NE(refusal(10, 1, smallestChain(10, 1) - 2).find("gaps"), std::string::npos);
  EXPECT_NE(refusal(2, 1, 6).find("6 spheres; the construction needs an odd number"), std::string::npos);
  EXPECT_NE(refusal(2, 1, 1).find("from 3 on"), std::string::npos);
  EXPECT_NE(refusal(1, 1, 5).find("the one along must be larger"), std::string::npos);
  EXPECT_NE(refusal(1, 2, 5).find("the one along must be larger"), std::string::npos);
  EXPECT_NE(refusal(-1, 2, 5).find("is -1 m"), std::string::npos);
}

}  // namespace
}  // namespace granular
