#include "granular/core/random.h"

#include <gtest/gtest.h>

namespace granular {
namespace {

TEST(Random, SavedStateContinuesTheSameSequence) {
  Random random(7);
  for (int i = 0; i < 10; ++i) random.bits();
  Random copy(1);
  copy.setState(random.state());
  for (int i = 0; i < 10; ++i) EXPECT_EQ(random.bits(), copy.bits());
}

TEST(Random, DirectionsAreUnitVectorsWithZeroMean) {
  Random random(3);
  Vec3 sum = Vec3::Zero();
  const int count = 100000;
  for (int i = 0; i < count; ++i) {
    const Vec3 d = random.direction();
    ASSERT_NEAR(d.norm(), 1, 1e-12);
    sum += d;
  }
  // Each component of the mean has variance 1/(3 count): five standard deviations.
  EXPECT_LT((sum / count).cwiseAbs().maxCoeff(), 5 / std::sqrt(3.0 * count));
}

TEST(Random, NormalHasUnitVariance) {
  Random random(4);
  const int count = 200000;
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const double v = random.normal();
    sum += v;
    squares += v * v;
  }
  EXPECT_NEAR(sum / count, 0, 5 / std::sqrt(double(count)));
  EXPECT_NEAR(squares / count, 1, 5 * std::sqrt(2.0 / count));
}

}  // namespace
}  // namespace granular
