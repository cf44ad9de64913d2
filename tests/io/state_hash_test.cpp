#include "granular/io/state_hash.h"

#include <gtest/gtest.h>

#include <cmath>

#include "granular/shape/sphere.h"

namespace granular {
namespace {

NewBody makeBody(std::int64_t id, const Vec3& x) {
  NewBody body;
  body.id = id;
  body.pose.x = x;
  body.velocity = Vec3(-0.5, 0, 0.25);
  body.spin = Vec3(0, 0, 8);
  return body;
}

const Sphere ball(1e-3);

TEST(StateHash, IsTheSha256OfIdPositionOrientationVelocityAndSpin) {
  Bodies bodies;
  bodies.add(makeBody(7, Vec3(1, 2, 3)), ball);
  // By another program: one int64 and thirteen doubles, the lowest byte first.
  EXPECT_EQ(hashState(bodies), "4a804a1e9aaf2631fc8ba9194972b20fc5acf55fdb0f7d532d15fa1c57a11c1b");
}

TEST(StateHash, DoesNotDependOnTheOrderOfSlots) {
  Bodies forwards, backwards;
  for (const std::int64_t id : {0, 1, 2}) forwards.add(makeBody(id, Vec3(id, 0, 0)), ball);
  for (const std::int64_t id : {2, 1, 0}) backwards.add(makeBody(id, Vec3(id, 0, 0)), ball);
  EXPECT_EQ(hashState(forwards), hashState(backwards));
  // Ids belong to it: the same places with two of them exchanged are another state.
  std::swap(backwards.id[0], backwards.id[1]);
  EXPECT_NE(hashState(forwards), hashState(backwards));
}

TEST(StateHash, ChangesWithTheLastBitOfEveryNumber) {
  Bodies bodies;
  for (const std::int64_t id : {0, 1}) bodies.add(makeBody(id, Vec3(1, 2, 3)), ball);
  const std::string before = hashState(bodies);
  const auto expectChange = [&](double& number) {
    const double kept = number;
    number = std::nextafter(number, 1e9);
    EXPECT_NE(hashState(bodies), before);
    number = kept;
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      expectChange(bodies.x(i)[k]);
      expectChange(bodies.v(i)[k]);
      expectChange(bodies.w(i)[k]);
    }
    for (int k = 0; k < 4; ++k) expectChange(bodies.q[i].coeffs()[k]);
  }
  EXPECT_EQ(hashState(bodies), before);
}

}  // namespace
}  // namespace granular
