// The bodies, as a structure of arrays: what the force loop reads each step apart from what it reads rarely.
// Index = slot in spatial order; id = the stable number a user and a checkpoint know. (design 2.5)
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "granular/shape/shape.h"

namespace granular {

struct Material {
  std::string name;
  double density = 2500;  ///< kg/m^3
};

/// All shapes of a run; bodies refer to them by index.
using ShapeTable = std::vector<std::shared_ptr<const Shape>>;

struct Bodies {
  // Hot: state, read and written each step.
  std::vector<Vec3> x;          ///< position at t_n, m
  std::vector<Quat> q;          ///< orientation at t_n, body to world
  std::vector<Vec3> v;          ///< velocity at t_n (predicted), m/s
  std::vector<Vec3> w;          ///< angular velocity at t_n (predicted), world axes, rad/s
  std::vector<Vec3> vHalf;      ///< velocity at t_{n-1/2}, later t_{n+1/2}
  std::vector<Quat> qHalf;      ///< orientation at the half step
  std::vector<Vec3> wHalf;      ///< angular velocity at the half step, body axes
  std::vector<Vec3> alpha;      ///< angular acceleration of the last step, body axes
  std::vector<Vec3> acceleration;  ///< of the last step, world axes
  std::vector<Frame> frame;     ///< x and the matrix of q, for the kernels
  std::vector<Vec3> force, torque;  ///< gathered, world axes, torque about the centre of mass

  // Properties.
  std::vector<double> inverseMass;    ///< 0: fixed
  std::vector<Vec3> inverseInertia;   ///< body axes; 0: fixed
  std::vector<Vec3> inertia;          ///< principal, kg m^2
  std::vector<double> mass;
  std::vector<double> radiusRatio;    ///< <r^2>/<I> of S 13, 1/kg
  std::vector<double> boundingRadius; ///< m
  std::vector<const Shape*> shape;
  std::vector<std::int32_t> shapeIndex, material;

  // Bookkeeping.
  std::vector<std::int64_t> id;
  std::vector<std::uint8_t> state;    ///< BodyState
  std::vector<double> travel;         ///< bound on the motion of any surface point since the last search, m

  std::size_t size() const { return x.size(); }
};

enum class BodyState : std::uint8_t { moving, frozen, asleep };

}  // namespace granular
