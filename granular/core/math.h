// Vectors, rotations and poses: Eigen's types under short names, and the few helpers that all rooms share.
#pragma once

#include <cmath>
#include <limits>

// Where the compiler may use fused products, Eigen uses them by itself, whatever -ffp-contract says, and a build for
// this machine would round otherwise than one for any x86-64. So its choice of instructions is made first, and without
// them.
// clang-format off
#include <Eigen/src/Core/util/Macros.h>
#include <Eigen/src/Core/util/ConfigureVectorization.h>
// clang-format on
#undef EIGEN_VECTORIZE_FMA
#include <Eigen/Geometry>

namespace granular {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Position and orientation of a body: x in m, q rotates body axes into world axes (unit quaternion).
struct Pose {
  Vec3 x = Vec3::Zero();
  Quat q = Quat::Identity();
};

/// A pose as the kernels read it: the rotation as a matrix, computed once per body and step.
struct Frame {
  Mat3 R = Mat3::Identity();
  Vec3 x = Vec3::Zero();

  Frame() = default;
  Frame(const Mat3& rotation, const Vec3& position) : R(rotation), x(position) {}
  explicit Frame(const Pose& pose) : R(pose.q.toRotationMatrix()), x(pose.x) {}

  Vec3 toWorld(const Vec3& p) const { return R * p + x; }
  Vec3 toBody(const Vec3& p) const { return R.transpose() * (p - x); }
  Vec3 rotate(const Vec3& d) const { return R * d; }
  Vec3 unrotate(const Vec3& d) const { return R.transpose() * d; }
};

/// Axis-aligned bounds in world axes, m.
struct Aabb {
  Vec3 lo = Vec3::Constant(infinity);
  Vec3 hi = Vec3::Constant(-infinity);

  void include(const Vec3& p) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  bool overlaps(const Aabb& other) const {
    return (lo.array() <= other.hi.array()).all() && (other.lo.array() <= hi.array()).all();
  }
  Aabb grown(double by) const {
    Aabb box;
    box.lo = lo.array() - by;
    box.hi = hi.array() + by;
    return box;
  }
};

/// A unit vector perpendicular to the unit vector n; it depends on n alone.
inline Vec3 perpendicular(const Vec3& n) {
  const Vec3 other = std::abs(n.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY();
  return n.cross(other).normalized();
}

/// The rotation by |r| radians about r, as a unit quaternion: E(r) of Seelen et al. 2016.
inline Quat rotationFromVector(const Vec3& r) {
  const double half = 0.5 * r.norm();
  // sin(half)/(2 half), by its series where the quotient loses digits
  const double s = half > 1e-4 ? std::sin(half) / (2 * half) : 0.5 - half * half / 12;
  Quat q;
  q.w() = std::cos(half);
  q.vec() = s * r;
  return q;
}

}  // namespace granular
