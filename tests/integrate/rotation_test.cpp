// Order of the rotation schemes on motions known exactly.
#include <gtest/gtest.h>

#include <functional>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/integrate/integrator.h"
#include "granular/integrate/small_rotation.h"
#include "integrate/exact_tops.h"

namespace granular {
namespace {

using Torque = std::function<Vec3(const Quat&, const Vec3&)>;  // world axes, from q and w (world)

struct State {
  Quat q;
  Vec3 w;  // world
};

State integrate(const RotationScheme& scheme, const Vec3& inertia, State state, const Torque& torque, double time,
                int steps, bool halfStart = true) {
  const Vec3 inverse = inertia.cwiseInverse();
  const double dt = time / steps;
  Quat qHalf = state.q;
  Vec3 wHalf = state.q.conjugate() * state.w, alpha = Vec3::Zero();
  RotationMemory memory{qHalf, wHalf, alpha};
  if (halfStart) scheme.start(dt, inertia, inverse, torque(state.q, state.w), state.q, state.w, memory);
  for (int n = 0; n < steps; ++n) {
    scheme.predict(dt, qHalf, wHalf, alpha, state.q, state.w);
    scheme.advance(dt, inertia, inverse, torque(state.q, state.w), state.q, state.w, memory);
  }
  return state;
}

/// The oracle: Runge-Kutta of order four in small steps.
State integrateFinely(const Vec3& inertia, const State& start, const Torque& torque, double time, int steps) {
  State state = start;
  const double h = time / steps;
  using Vec7 = Eigen::Matrix<double, 7, 1>;
  const auto pack = [](const Quat& q, const Vec3& w) {
    Vec7 y;
    y << q.coeffs(), w;
    return y;
  };
  const auto derive = [&](const Vec7& y) {
    const Quat q(Eigen::Vector4d(y.head<4>()));
    const Vec3 w = y.tail<3>(), world = q.normalized() * w;
    const Vec3 a =
        accelerateRotation(inertia, inertia.cwiseInverse(), q.normalized().conjugate() * torque(q, world), w);
    return pack(Quat((q * Quat(0, w.x(), w.y(), w.z())).coeffs() * 0.5), a);
  };
  Vec7 y = pack(state.q, state.q.conjugate() * state.w);
  for (int n = 0; n < steps; ++n) {
    const Vec7 k1 = derive(y), k2 = derive(y + 0.5 * h * k1), k3 = derive(y + 0.5 * h * k2), k4 = derive(y + h * k3);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  const Quat q = Quat(Eigen::Vector4d(y.head<4>())).normalized();
  return {q, q * Vec3(y.tail<3>())};
}

double angleBetween(const Quat& a, const Quat& b) { return a.angularDistance(b); }

class Schemes : public testing::TestWithParam<SchemeKind> {
 protected:
  const RotationScheme& scheme = rotationScheme(GetParam());

  /// Errors fall by 4 when the step is halved, in q and in w.
  void expectOrderTwo(const Vec3& inertia, const State& start, const Torque& torque, const State& end, double time,
                      int steps) {
    State coarse = integrate(scheme, inertia, start, torque, time, steps);
    State fine = integrate(scheme, inertia, start, torque, time, 2 * steps);
    const double orderQ = std::log2(angleBetween(coarse.q, end.q) / angleBetween(fine.q, end.q));
    const double orderW = std::log2((coarse.w - end.w).norm() / (fine.w - end.w).norm());
    EXPECT_NEAR(orderQ, 2, 0.1) << angleBetween(coarse.q, end.q);
    EXPECT_NEAR(orderW, 2, 0.1) << (coarse.w - end.w).norm();
  }
};

INSTANTIATE_TEST_SUITE_P(All, Schemes, testing::Values(SchemeKind::seelen, SchemeKind::spiral),
                         [](const auto& info) { return std::string(rotationScheme(info.param).name); });

const Torque noTorque = [](const Quat&, const Vec3&) { return Vec3::Zero().eval(); };

TEST(FreeTop, ExactSolutionObeysEulersEquationAndKeepsTheMomentumFixed) {
  const FreeTop top(0.8, 1.1);
  const State end =
      integrateFinely(top.inertia, {top.orientation(0), top.orientation(0) * top.velocityBody(0)}, noTorque, 5, 20000);
  EXPECT_LT((end.q.conjugate() * end.w - top.velocityBody(5)).norm(), 1e-11);
  EXPECT_LT(angleBetween(end.q, top.orientation(5)), 1e-11);
}

TEST_P(Schemes, AreOfSecondOrderOnTheFreeAsymmetricTop) {
  const FreeTop top(0.8, 1.1);
  const State start{top.orientation(0), top.orientation(0) * top.velocityBody(0)};
  const State end{top.orientation(7), top.orientation(7) * top.velocityBody(7)};
  expectOrderTwo(top.inertia, start, noTorque, end, 7, 2000);
}

TEST_P(Schemes, AreOfSecondOrderOnTheHeavySymmetricTop) {
  const HeavyTop top;
  const Torque torque = [&](const Quat& q, const Vec3&) { return top.torque(q); };
  const auto exact = [&](double t) { return State{top.orientation(t), top.velocity(t)}; };
  expectOrderTwo(top.inertia, exact(0), torque, exact(4), 4, 2000);
}

TEST_P(Schemes, AreOfSecondOrderUnderADampingTorque) {
  // The torque reads the predicted velocity: with the half-step velocity this would be of first order.
  const Vec3 inertia(1.0, 2.0, 3.0);
  const State start{Quat(0.5, 0.5, -0.5, 0.5), Vec3(1.0, 0.4, -0.7)};
  const Torque torque = [](const Quat&, const Vec3& w) { return Vec3(-0.6 * w); };
  expectOrderTwo(inertia, start, torque, integrateFinely(inertia, start, torque, 4, 20000), 4, 1000);
}

TEST_P(Schemes, FallToFirstOrderWithoutTheHalfStepStart) {
  const FreeTop top(0.8, 1.1);
  const State start{top.orientation(0), top.orientation(0) * top.velocityBody(0)}, end{top.orientation(7), {}};
  const double coarse = angleBetween(integrate(scheme, top.inertia, start, noTorque, 7, 2000, false).q, end.q);
  const double fine = angleBetween(integrate(scheme, top.inertia, start, noTorque, 7, 4000, false).q, end.q);
  EXPECT_NEAR(std::log2(coarse / fine), 1, 0.1);
}

TEST_P(Schemes, KeepQuaternionsUnitOverManySteps) {
  const State end = integrate(scheme, {1, 2, 3}, {Quat::Identity(), Vec3(3, 1, 2)}, noTorque, 1000, 200000);
  EXPECT_NEAR(end.q.norm(), 1, 1e-15);
}

TEST_P(Schemes, LeaveAFixedBodyFixed) {
  Quat q(0.5, 0.5, 0.5, 0.5), qHalf = q;
  Vec3 w = Vec3::Zero(), wHalf = w, alpha = w;
  const Vec3 inertia(1, 2, 3), none = Vec3::Zero(), torque(4, 5, 6);
  scheme.start(0.1, inertia, none, torque, q, w, {qHalf, wHalf, alpha});
  scheme.predict(0.1, qHalf, wHalf, alpha, q, w);
  scheme.advance(0.1, inertia, none, torque, q, w, {qHalf, wHalf, alpha});
  EXPECT_EQ(q.coeffs(), Quat(0.5, 0.5, 0.5, 0.5).coeffs());
  EXPECT_EQ(w, none);
}

TEST(Seelen, OrientationErrorOnTheFreeTopStaysBelowHalfOfDtSquaredTimesT) {
  // For angular velocities near 1, in units of dt^2 T.
  const FreeTop top(0.8, 1.1);
  const State start{top.orientation(0), top.orientation(0) * top.velocityBody(0)};
  const State end = integrate(rotationScheme(SchemeKind::seelen), top.inertia, start, noTorque, 7, 7000);
  EXPECT_LT(angleBetween(end.q, top.orientation(7)) / (1e-6 * 7), 0.5);
}

TEST(SmallRotation, AgreesWithSineAndCosine) {
  for (double angle = 1e-9; angle < 1; angle *= 1.5) {
    const Vec3 r = angle * Vec3(0.6, -0.48, 0.64);
    const Quat exact(Eigen::AngleAxisd(angle, Vec3(0.6, -0.48, 0.64)));
    EXPECT_LT((rotateByStep(r).coeffs() - exact.coeffs()).norm(), 3e-16) << angle;
  }
}

TEST(SmallRotation, TurnsFarInLanesAsAlone) {
  Triple<Wide> r;
  for (std::size_t k = 0; k < wideSize; ++k) {
    r.x[k] = k % 2 == 0 ? 0.1 : 0.5 * static_cast<double>(k);
    r.y[k] = 0.01;
    r.z[k] = -0.02 * static_cast<double>(k);
  }
  const Quadruple<Wide> q = rotateByStep(r);
  for (std::size_t k = 0; k < wideSize; ++k) {
    const Quat alone = rotateByStep(Vec3(r.x[k], r.y[k], r.z[k]));
    EXPECT_EQ(Quat(q.w[k], q.x[k], q.y[k], q.z[k]).coeffs(), alone.coeffs());
  }
}

TEST(Translation, LeapfrogFollowsAParabolaExactly) {
  const Vec3 g(0, 0, -9.81);
  const double dt = 1e-3;
  Vec3 x = Vec3::Zero(), v(1, 2, 3), vHalf;
  startTranslation(dt, g, v, vHalf);
  for (int n = 0; n < 1000; ++n) {
    predictTranslation(dt, vHalf, g, x, v);
    advanceTranslation(dt, g, vHalf);
  }
  EXPECT_LT((x - Vec3(1, 2, 3 - 0.5 * 9.81)).norm(), 1e-12);
  EXPECT_LT((v - Vec3(1, 2, 3 - 9.81)).norm(), 1e-12);
}

TEST(SchemeTable, FindsSchemesByName) {
  EXPECT_EQ(schemeFromName("seelen"), SchemeKind::seelen);
  EXPECT_EQ(schemeFromName("spiral"), SchemeKind::spiral);
  EXPECT_THROW(schemeFromName("euler"), InputError);
}

}  // namespace
}  // namespace granular
