// Two ellipsoids that creep over each other: how well a look that begins where the last ones point has converged.
#include "granular/shape/ellipsoid.h"

#include <gtest/gtest.h>

#include "narrow/scenes.h"

namespace granular {
namespace {

TEST(Ellipsoids, WarmNormalsAreStationaryToRoundOffWhateverTheStep) {
  // Exactly stationary, the deepest points along the normal lie on one line along it. Newton's last step is taken to
  // first order, which leaves up to (2.5e-7)^2 or, after two, some 1e-13 times the axes' ratio.
  Random random(21);
  long touching = 0;
  for (const Vec3& axes : {Vec3(1, 1, 2), Vec3(1, .6, .25), Vec3(1, .3, .3), Vec3(1, .98, .99)}) {
    const Ellipsoid a(axes), b(Vec3(.8, .8, 1.1));
    const double ratio = axes.maxCoeff() / axes.minCoeff();
    for (const double rate : {1e-10, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
      for (int run = 0; run < 10; ++run) {
        Pose poseB{Vec3::Zero(), random.rotation()};
        const Frame frameA(Pose{Vec3::Zero(), random.rotation()});
        Frame frameB(poseB);
        testing::setDepth(a, frameA, b, random.direction(), 1e-3, frameB);
        poseB.x = frameB.x;
        const Vec3 spin = rate * random.direction(), slide = 1e-2 * rate * random.direction();
        WarmCache cache;
        NarrowCounts counts;
        for (int step = 0; step < 30; ++step) {
          Touch touch;
          if (!findTouch(a, frameA, b, Frame(poseB), false, cache, counts, touch)) break;
          ++touching;
          const Frame now(poseB);
          const Vec3& n = touch.normal;
          const Vec3 onA = frameA.toWorld(a.support(frameA.unrotate(n))),
                     onB = now.toWorld(b.support(now.unrotate(-n)));
          const Vec3 between = onA - onB;
          ASSERT_LE((between - between.dot(n) * n).norm(), 1e-12 * ratio * ratio)
              << "rate " << rate << ", step " << step;
          ASSERT_NEAR(touch.overlap, between.dot(n), 4e-15);
          ASSERT_LE((0.5 * (touch.onA + touch.onB) - 0.5 * (onA + onB)).norm(), 1e-12 * ratio * ratio);
          poseB.q = (rotationFromVector(spin) * poseB.q).normalized();
          poseB.x += slide;
        }
      }
    }
  }
  EXPECT_GT(touching, 5000);
}

}  // namespace
}  // namespace granular
