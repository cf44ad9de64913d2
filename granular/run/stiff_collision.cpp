#include "granular/run/stiff_collision.h"

#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>

namespace granular {
namespace {

Mat3 crossMatrix(const Vec3& r) {
  Mat3 m;
  m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return m;
}

/// How the contact point's velocity changes with the force on it: A of both bodies, 1/kg.
Mat3 findMobility(const Encounter& e) {
  Mat3 sum = Mat3::Zero();
  for (const Collider& body : e.bodies) {
    const Mat3 R = body.pose.q.toRotationMatrix();
    const Mat3 r = crossMatrix(e.point - body.pose.x);
    sum += Mat3::Identity() / body.mass - r * R * body.inertia.cwiseInverse().asDiagonal() * R.transpose() * r;
  }
  return sum;
}

/// k_t/k_n of S 13 at e_n = e_t.
double findAverageRatio(const Encounter& e) {
  double inverseMu = 0, turning = 0;
  for (const Collider& body : e.bodies) {
    inverseMu += 1 / body.mass;
    turning += body.shape->massProperties().meanSquareRadius / body.inertia.mean();
  }
  return inverseMu / (inverseMu + turning);
}

/// Spring tensor over k_n.
Mat3 findSpring(const Encounter& e, const Mat3& mobility, StiffSpring spring) {
  const Vec3& n = e.normal;
  const double along = n.dot(mobility * n);
  if (spring == StiffSpring::tensor) return along * mobility.inverse();
  const double across = 0.5 * (mobility.trace() - along);
  const double ratio = spring == StiffSpring::average ? findAverageRatio(e) : along / across;
  return ratio * Mat3::Identity() + (1 - ratio) * n * n.transpose();
}

}  // namespace

StiffCollision resolveStiff(const Encounter& e, StiffSpring spring) {
  const Collider &a = e.bodies[0], &b = e.bodies[1];
  const double mu = 1 / (1 / a.mass + 1 / b.mass);

  // Time in units of sqrt(mu/k_n): the equation becomes d'' = -(mu A)(K/k_n) d.
  const Mat3 mobility = mu * findMobility(e), stiffness = findSpring(e, mobility, spring);
  const Eigen::SelfAdjointEigenSolver<Mat3> roots(stiffness);
  const Mat3 root = roots.operatorSqrt(), inverseRoot = roots.operatorInverseSqrt();
  const Eigen::SelfAdjointEigenSolver<Mat3> modes(root * mobility * root);
  const Vec3 rate = modes.eigenvalues().cwiseSqrt();
  const Vec3 u = a.velocity + a.spin.cross(e.point - a.pose.x) - b.velocity - b.spin.cross(e.point - b.pose.x);
  const Vec3 amplitude = (modes.eigenvectors().transpose() * root * u).cwiseQuotient(rate);
  const Mat3 back = inverseRoot * modes.eigenvectors();
  const auto displacement = [&](double t) {
    return Vec3(back * amplitude.cwiseProduct(Vec3((t * rate).array().sin())));
  };
  assert(u.dot(e.normal) > 0);

  // The first return of the overlap to zero: march in small parts of the fastest period, then bisect.
  const double stride = pi / rate.maxCoeff() / 64;
  double after = stride;
  while (displacement(after).dot(e.normal) > 0) after += stride;
  double before = after - stride;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (before + after);
    (displacement(middle).dot(e.normal) > 0 ? before : after) = middle;
  }

  // In these units energies are multiplied by mu and the force's impulse is mass times the change of velocity.
  StiffCollision result;
  result.duration = after;
  const Vec3 left = displacement(after);
  result.energyBefore = kineticEnergyOf(a) + kineticEnergyOf(b);
  result.energyLeft = 0.5 * mu * left.dot(stiffness * left);
  const Vec3 slowed = back * amplitude.cwiseProduct(rate).cwiseProduct(Vec3((after * rate).array().cos() - 1));
  result.impulse = mu * mobility.inverse() * slowed;
  return result;
}

}  // namespace granular
