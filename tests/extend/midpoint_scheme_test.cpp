// The scheme of examples/extend/midpoint_scheme.h: its order, and that a world runs by it.
#include "examples/extend/midpoint_scheme.h"

#include <gtest/gtest.h>

#include "extend/scene_of_own.h"
#include "granular/core/errors.h"
#include "granular/shape/polyhedron.h"
#include "granular/world/world.h"
#include "integrate/exact_tops.h"

namespace granular {
namespace {

const SchemeKind midpoint = extend::addMidpointScheme();

/// The angle by which a free top has gone wrong after a time, rad.
double findError(const FreeTop& top, double time, int steps) {
  const RotationScheme& scheme = rotationScheme(midpoint);
  const double dt = time / steps;
  Quat q = top.orientation(0), qHalf = q;
  Vec3 w = q * top.velocityBody(0), wHalf = w, alpha = w;
  const Vec3 inverse = top.inertia.cwiseInverse(), none = Vec3::Zero();
  scheme.start(dt, top.inertia, inverse, none, q, w, {qHalf, wHalf, alpha});
  for (int n = 0; n < steps; ++n) {
    scheme.predict(dt, qHalf, wHalf, alpha, q, w);
    scheme.advance(dt, top.inertia, inverse, none, q, w, {qHalf, wHalf, alpha});
  }
  return q.angularDistance(top.orientation(time));
}

TEST(MidpointScheme, IsOfSecondOrderOnTheFreeAsymmetricTop) {
  const FreeTop top(0.8, 1.1);
  const double coarse = findError(top, 7, 2000), fine = findError(top, 7, 4000);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1) << coarse;
}

/// Where a spinning block that nothing touches has turned in a world.
Quat turnInWorld(SchemeKind scheme, int steps) {
  WorldOptions options;
  options.integrator = scheme;
  World world(options, MaterialTable{});
  NewBody body;
  body.shapeIndex = world.addShape(std::make_shared<Cuboid>(Vec3(1e-3, 2e-3, 3e-3)));
  body.spin = Vec3(100, 30, -50);
  world.addBody(body);
  startHalfSteps(world, 0.1 / steps, 0, false);
  for (int n = 0; n < steps; ++n) step(world, 0.1 / steps);
  return world.bodies.orientation(0);
}

TEST(MidpointScheme, TurnsABlockInAWorldAsTheLibrarysSchemesDo) {
  const auto apart = [](int steps) {
    return turnInWorld(midpoint, steps).angularDistance(turnInWorld(SchemeKind::spiral, steps));
  };
  const double coarse = apart(1000), fine = apart(2000);
  EXPECT_GT(coarse, 1e-7);  // another scheme
  EXPECT_LT(coarse, 1e-2);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2) << coarse;
}

TEST(MidpointScheme, CanBeChosenInAScene) {
  EXPECT_EQ(runWithModel("integrator = \"midpoint\"").world().options.integrator, midpoint);
}

TEST(SchemesTable, RefusesARowThatCannotServe) {
  EXPECT_THROW(addScheme({"spiral", extend::startMidpoint, extend::predictMidpoint, extend::advanceMidpoint}),
               InputError);
  EXPECT_THROW(addScheme({"halved", extend::startMidpoint, nullptr, extend::advanceMidpoint}), InputError);
}

}  // namespace
}  // namespace granular
