// (h) Free rotation in the world's own step: the exact asymmetric top, the heavy symmetric top and the flip about the
// intermediate axis.
#include <fmt/format.h>

#include "granular/integrate/integrator.h"
#include "integrate/exact_tops.h"
#include "verification/record.h"
#include "verification/scenes.h"

namespace granular {
namespace {

/// Angles between what the world finds and the exact motion, rad, and the error of the angular velocity, rad/s.
struct RotationError {
  double orientation = 0, velocity = 0;
};

/// A body whose moments are those of the top, in free flight.
RotationError flyFree(SchemeKind scheme, const FreeTop& top, double time, int steps) {
  WorldOptions options = plainOptions();
  options.integrator = scheme;
  auto world = makeWorld(options, ContactParameters{});
  place(*world, makeShape("ellipsoid", std::vector{1.0, 2.0, 3.0}), Vec3::Zero(), top.orientation(0));
  world->bodies.inertia[0] = top.inertia;
  world->bodies.inverseInertia[0] = top.inertia.cwiseInverse();
  move(*world, 0, Vec3::Zero(), top.orientation(0) * top.velocityBody(0));
  startHalfSteps(*world, time / steps, 0, true);
  for (int n = 0; n < steps; ++n) step(*world, time / steps);
  const Quat q = top.orientation(time);
  return {world->bodies.orientation(0).angularDistance(q), (world->bodies.w(0) - q * top.velocityBody(time)).norm()};
}

/// A scheme alone under a torque of q and w (world axes).
template <class Torque>
RotationError turnUnder(SchemeKind kind, const Vec3& inertia, Quat q, Vec3 w, const Torque& torque, double time,
                        int steps, const Quat& endQ, const Vec3& endW) {
  const RotationScheme& scheme = rotationScheme(kind);
  const Vec3 inverse = inertia.cwiseInverse();
  const double dt = time / steps;
  Quat qHalf = q;
  Vec3 wHalf = q.conjugate() * w, alpha = Vec3::Zero();
  const RotationMemory memory{qHalf, wHalf, alpha};
  scheme.start(dt, inertia, inverse, torque(q, w), q, w, memory);
  for (int n = 0; n < steps; ++n) {
    scheme.predict(dt, qHalf, wHalf, alpha, q, w);
    scheme.advance(dt, inertia, inverse, torque(q, w), q, w, memory);
  }
  return {q.angularDistance(endQ), (w - endW).norm()};
}

void verifyOrder(const std::string& name, const RotationError& coarse, const RotationError& fine) {
  verify('h', name + ": order in q", 2, std::log2(coarse.orientation / fine.orientation), .1,
         "exact motion; next order at these steps");
  verify('h', name + ": order in w", 2, std::log2(coarse.velocity / fine.velocity), .1,
         "exact motion; next order at these steps");
}

TEST(Rotation, IsOfSecondOrderOnTheFreeAsymmetricTop) {
  const FreeTop top(0.8, 1.1);
  for (const SchemeKind scheme : {SchemeKind::seelen, SchemeKind::spiral}) {
    verifyOrder(fmt::format("free top, {}", rotationScheme(scheme).name), flyFree(scheme, top, 7, 2000),
                flyFree(scheme, top, 7, 4000));
  }
}

TEST(Rotation, IsOfSecondOrderOnTheHeavySymmetricTop) {
  const HeavyTop top;
  const auto torque = [&](const Quat& q, const Vec3&) { return top.torque(q); };
  for (const SchemeKind scheme : {SchemeKind::seelen, SchemeKind::spiral}) {
    const auto run = [&](int steps) {
      return turnUnder(scheme, top.inertia, top.orientation(0), top.velocity(0), torque, 4, steps, top.orientation(4),
                       top.velocity(4));
    };
    verifyOrder(fmt::format("heavy top, {}", rotationScheme(scheme).name), run(2000), run(4000));
  }
}

TEST(Rotation, IsOfSecondOrderUnderADampingTorque) {
  // Axisymmetric body, torque -c I w in every direction: the motion is that of the free body with time (1 - exp(-c
  // t))/c, and w decays with exp(-c t).
  const Vec3 inertia(1.5, 1.5, 0.7);
  const double rate = 0.6, time = 3, stretched = (1 - std::exp(-rate * time)) / rate;
  const Vec3 w0(0.5, 0.3, 2);
  // Free symmetric top: turns about L by |L|/I1, and about its own axis by (1 - I3/I1) w3.
  const auto exact = [&](double s) {
    const Vec3 momentum = inertia.cwiseProduct(w0);
    const double spin = (1 - inertia.z() / inertia.x()) * w0.z();
    return Quat(Eigen::AngleAxisd(momentum.norm() / inertia.x() * s, momentum.normalized()) *
                Eigen::AngleAxisd(spin * s, Vec3::UnitZ()));
  };
  const auto torque = [&](const Quat& q, const Vec3& w) {
    return Vec3(-rate * (q * inertia.cwiseProduct(q.conjugate() * w)));
  };
  const Quat endQ = exact(stretched);
  const Vec3 momentum = std::exp(-rate * time) * inertia.cwiseProduct(w0);
  const Vec3 endW = endQ * inertia.cwiseInverse().cwiseProduct(endQ.conjugate() * momentum);
  for (const SchemeKind scheme : {SchemeKind::seelen, SchemeKind::spiral}) {
    const auto run = [&](int steps) {
      return turnUnder(scheme, inertia, Quat::Identity(), w0, torque, time, steps, endQ, endW);
    };
    verifyOrder(fmt::format("damped symmetric top, {}", rotationScheme(scheme).name), run(1000), run(2000));
  }
}

TEST(Rotation, BodySpunAboutItsIntermediateAxisFlips) {
  // A cuboid 1:2:3 spun about its intermediate axis with a perturbation of 1e-3: half of the motion's period is
  // 2 K(m)/rate of the exact top.
  WorldOptions options = plainOptions();
  auto world = makeWorld(options, ContactParameters{});
  place(*world, cuboidOf({3e-3, 2e-3, 1e-3}), Vec3::Zero());
  const Vec3 I = world->bodies.inertiaOf(0);
  ASSERT_LT(I.x(), I.y());
  ASSERT_LT(I.y(), I.z());
  const Vec3 w0(1e-1, 100, 0);
  move(*world, 0, Vec3::Zero(), w0);

  // Quarter period of w2 between its extremes +-: K(m)/rate each, from the invariants.
  const Vec3 momentum = I.cwiseProduct(w0);
  const double square = momentum.squaredNorm(), energy2 = momentum.dot(w0);
  // w1 keeps its sign if L^2 < 2 E I2 (I1 side).
  const bool lowSide = square < energy2 * I.y();
  ASSERT_TRUE(lowSide);
  const double rate = std::sqrt((I.y() - I.x()) * (energy2 * I.z() - square) / I.prod());
  const double m = (I.z() - I.y()) * (square - energy2 * I.x()) / ((I.y() - I.x()) * (energy2 * I.z() - square));
  double a = 1, b = std::sqrt(1 - m);
  while (std::abs(a - b) > 1e-15) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  const double flip = 2 * pi / (2 * a) / rate;

  // Time at which w2 is at its other extreme: halfway between two zero crossings.
  const double dt = 1e-5;
  startHalfSteps(*world, dt, 0, true);
  std::vector<double> crossings;
  double last = w0.y();
  while (crossings.size() < 2 && world->time < 4 * flip) {
    step(*world, dt);
    const double now = (world->bodies.orientation(0).conjugate() * world->bodies.w(0)).y();
    if (now * last < 0) crossings.push_back(world->time - dt * now / (now - last));
    last = now;
  }
  ASSERT_EQ(crossings.size(), 2u);
  verify('h', "cuboid 1:2:3 about its intermediate axis: time of flip / exact", 1, (crossings[1] - crossings[0]) / flip,
         1e-4, "Jacobi's K(m); (w dt)^2 = 1e-6 times the growth of a perturbation, ln(1e3)");
}

}  // namespace
}  // namespace granular
