// Signed tetrahedra: with a, b, c seen from the reference point, V = a.(b x c)/6, the first moment is V (a+b+c)/4 and
// the second V/20 (s s^T + a a^T + b b^T + c c^T), s = a+b+c. Over a triangle of area A the mean of |x|^2 is
// (|s|^2 + |a|^2 + |b|^2 + |c|^2)/12. Both passes keep the reference inside the body, where no digits cancel.
#include "granular/shape/mass_properties.h"

#include <Eigen/Eigenvalues>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"

namespace granular {

namespace {

using Triangle = std::array<int, 3>;

/// A corner of a triangle seen from the reference point.
Vec3 corner(std::span<const Vec3> vertices, const Triangle& t, std::size_t k, const Vec3& reference) {
  return vertices[static_cast<std::size_t>(t[k])] - reference;
}

Vec3 meanVertex(std::span<const Vec3> vertices) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : vertices) sum += v;
  return vertices.empty() ? sum : Vec3(sum / static_cast<double>(vertices.size()));
}

/// The permutations of three axes, even ones first; the identity comes first, so that it wins every tie.
constexpr std::array<std::array<int, 3>, 6> axisOrders{
    {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}}};

/// Columns of v reordered and reflected into the proper rotation nearest to the identity; moments follow.
PrincipalAxes nearestToIdentity(const Vec3& moments, const Mat3& v) {
  PrincipalAxes best;
  double bestTrace = -infinity;
  for (const auto& order : axisOrders) {
    for (int signs = 0; signs < 8; ++signs) {
      PrincipalAxes candidate;
      for (int k = 0; k < 3; ++k) {
        const int from = order[static_cast<std::size_t>(k)];
        candidate.axes.col(k) = (signs >> k & 1) ? Vec3(-v.col(from)) : Vec3(v.col(from));
        candidate.moments[k] = moments[from];
      }
      // a strict gain, beyond rounding, so that equal candidates keep the first order
      const double trace = candidate.axes.trace();
      if (candidate.axes.determinant() > 0 && trace > bestTrace + 1e-12) {
        bestTrace = trace;
        best = candidate;
      }
    }
  }
  return best;
}

/// The least rotation that takes the nearest coordinate axis onto the line of u, for a body round about u.
PrincipalAxes aboutOneAxis(const Vec3& u, double alone, double shared) {
  int k = 2;
  for (int i : {0, 1}) {
    if (std::abs(u[i]) > std::abs(u[k]) * (1 + 1e-12)) k = i;
  }
  const Vec3 target = u[k] < 0 ? Vec3(-u) : u;
  PrincipalAxes result;
  result.axes = Quat::FromTwoVectors(Vec3::Unit(k), target).toRotationMatrix();
  result.moments = Vec3::Constant(shared);
  result.moments[k] = alone;
  return result;
}

}  // namespace

PrincipalAxes principalAxes(const Mat3& inertia) {
  const Mat3 symmetric = 0.5 * (inertia + inertia.transpose());
  // scaled to one, so that neither micrometres nor kilometres under- or overflow inside the solver
  const double scale = symmetric.cwiseAbs().maxCoeff();
  if (!(scale > 0)) return {};
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(symmetric / scale);
  const Vec3 moments = solver.eigenvalues() * scale;  // ascending
  const Mat3& v = solver.eigenvectors();

  const double tie = tolerance::equalMoments * moments[2];
  const bool low = moments[1] - moments[0] <= tie;
  const bool high = moments[2] - moments[1] <= tie;
  if (low && high) {
    PrincipalAxes round;
    round.moments = symmetric.diagonal();
    return round;
  }
  if (low) return aboutOneAxis(v.col(2), moments[2], 0.5 * (moments[0] + moments[1]));
  if (high) return aboutOneAxis(v.col(0), moments[0], 0.5 * (moments[1] + moments[2]));
  return nearestToIdentity(moments, v);
}

double signedVolume(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  const Vec3 reference = meanVertex(vertices);
  double six = 0;
  for (const Triangle& t : triangles) {
    six += corner(vertices, t, 0, reference)
               .dot(corner(vertices, t, 1, reference).cross(corner(vertices, t, 2, reference)));
  }
  return six / 6;
}

double surfaceArea(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  double twice = 0;
  for (const Triangle& t : triangles) {
    const Vec3& a = vertices[static_cast<std::size_t>(t[0])];
    twice += corner(vertices, t, 1, a).cross(corner(vertices, t, 2, a)).norm();
  }
  return twice / 2;
}

namespace {

/// Centre of mass of the enclosed solid. Throws InputError unless the volume is positive.
Vec3 solidCentroid(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  const Vec3 reference = meanVertex(vertices);
  double volume = 0;
  Vec3 moment = Vec3::Zero();
  for (const Triangle& t : triangles) {
    const Vec3 a = corner(vertices, t, 0, reference);
    const Vec3 b = corner(vertices, t, 1, reference);
    const Vec3 c = corner(vertices, t, 2, reference);
    const double v = a.dot(b.cross(c)) / 6;
    volume += v;
    moment += v / 4 * (a + b + c);
  }
  require(std::isfinite(volume) && volume > 0,
          "mass properties: the mesh encloses a volume of " + std::to_string(volume) +
              " m^3; it must be positive (triangles counter-clockwise seen from outside)");
  return reference + moment / volume;
}

}  // namespace

SolidProperties solidProperties(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  SolidProperties solid;
  solid.centroid = solidCentroid(vertices, triangles);

  // second pass about the centre of mass: volume, second moments, area and squared distance
  double volume = 0, area = 0, squares = 0;
  Mat3 second = Mat3::Zero();
  for (const Triangle& t : triangles) {
    const Vec3 a = corner(vertices, t, 0, solid.centroid);
    const Vec3 b = corner(vertices, t, 1, solid.centroid);
    const Vec3 c = corner(vertices, t, 2, solid.centroid);
    const Vec3 s = a + b + c;
    const double v = a.dot(b.cross(c)) / 6;
    const double triangleArea = (b - a).cross(c - a).norm() / 2;
    volume += v;
    second += v / 20 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
    area += triangleArea;
    squares += triangleArea / 12 * (s.squaredNorm() + a.squaredNorm() + b.squaredNorm() + c.squaredNorm());
  }

  solid.inertia = second.trace() * Mat3::Identity() - second;
  const PrincipalAxes principal = principalAxes(solid.inertia);
  solid.axes = principal.axes;
  solid.principal.volume = volume;
  solid.principal.area = area;
  solid.principal.inertia = principal.moments;
  solid.principal.meanSquareRadius = squares / area;
  return solid;
}

}  // namespace granular
