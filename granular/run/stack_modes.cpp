#include "granular/run/stack_modes.h"

#include <Eigen/Eigenvalues>

#include "granular/core/errors.h"
#include "granular/law/law.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

using Matrix = Eigen::MatrixXd;

/// Stiffness of the interface below cuboid k.
struct Interface {
  double rocking, shear;
};
Interface findInterface(const StackSettings& settings, int k, const LawConstants& constants) {
  const Vec3 half = halfLengths(settings, k), below = halfLengths(settings, k > 0 ? k - 1 : k);
  const double side = 2 * std::min(half.x(), below.x());
  double stiffness = settings.contact.stiffness;
  if (settings.rule.rule == PointRule::foundation) stiffness *= foundationShare(settings, k);

  // Shear by the law, between the two or with the ground.
  const auto bodyOf = [&](int which) {
    const Cuboid shape(halfLengths(settings, which));
    ContactBody body;
    body.inverseMass = 1 / massOf(settings, which);
    body.radiusRatio =
        shape.massProperties().meanSquareRadius / (settings.density * shape.massProperties().inertia.mean());
    return body;
  };
  const ContactStiffness law = stiffnessOf(LawKind::linear, constants, LawOptions{}, bodyOf(k),
                                           k > 0 ? bodyOf(k - 1) : ContactBody{}, Vec3::UnitZ());
  return {rockingStiffness(settings.rule) * stiffness * side * side / 12,
          law.tangential * stiffness / settings.contact.stiffness};
}

}  // namespace

SwayMode findLowestSway(const StackSettings& settings) {
  const PointRule rule = settings.rule.rule;
  require(rule == PointRule::pressureCentroid || rule == PointRule::patch || rule == PointRule::stiffPatch ||
              rule == PointRule::foundation,
          "rule " + std::string(pointRuleName(rule)) + ": has no finite rocking stiffness, and so no sway modes");
  const LawConstants constants = prepareLaw(settings.contact);
  const int n = settings.count;
  Matrix stiffness = Matrix::Zero(n, n), way = Matrix::Zero(n, n), inertia = Matrix::Zero(n, n);
  double above = 0;  // weight above cuboid k
  for (int k = n - 1; k >= 0; --k) {
    const Vec3 half = halfLengths(settings, k);
    const double mass = massOf(settings, k), weight = mass * settings.gravity, h = half.z();
    const Interface foot = findInterface(settings, k, constants);

    // Rocking of the interface below: tilt of k against tilt of k - 1, or the ground.
    stiffness(k, k) += foot.rocking;
    if (k > 0) {
      stiffness(k - 1, k - 1) += foot.rocking;
      stiffness(k, k - 1) -= foot.rocking;
      stiffness(k - 1, k) -= foot.rocking;
    }
    // A tilt t lowers the own centre by h t^2/2 and what is above by h t^2; the load slides down its tilted seat
    // against the shear spring.
    const double load = above + weight;
    stiffness(k, k) -= h * (weight + 2 * above) + load * load / foot.shear;
    above = load;

    // Centres: x_i = sum over k < i of 2 h_k t_k, plus h_i t_i.
    way(k, k) = h;
    for (int i = k + 1; i < n; ++i) way(i, k) = 2 * h;
    inertia(k, k) = mass * (half.x() * half.x() + h * h) / 3;
  }
  Matrix mass = inertia;
  for (int i = 0; i < n; ++i) mass += massOf(settings, i) * way.row(i).transpose() * way.row(i);

  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(stiffness, mass);
  Eigen::VectorXd tilt = solver.eigenvectors().col(0);
  Eigen::VectorXd ways = way * tilt;
  tilt /= ways(n - 1);
  ways /= Eigen::VectorXd(ways)(n - 1);
  SwayMode mode;
  mode.square = solver.eigenvalues()(0);
  mode.tilt.assign(tilt.data(), tilt.data() + n);
  mode.way.assign(ways.data(), ways.data() + n);
  return mode;
}

}  // namespace granular
