// Random binary encounters: two bodies at the instant they first touch, as two kinds of particles in a dilute gas meet
// (S section 6.2 draws velocities from a Gaussian and says no more; the ensembles here are stated and can be chosen).
//
// In a homogeneous gas with independent velocities, contacts happen in the configurations on the boundary of the
// Minkowski difference C = A - B (orientations uniform, the boundary point uniform by area) with the rate max(u_n, 0),
// u_n being the approach speed of the two contact points, rotation included. u_n is a sum of Gaussians, so that the
// sampling is exact: accept a configuration with a probability proportional to the deviation s of u_n, draw u_n from
// Rayleigh's distribution of that deviation, and the other velocities from the Gaussian given u_n.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>

#include "granular/core/random.h"
#include "granular/shape/shape.h"

namespace granular {

/// A body about to collide. World axes, SI units.
struct Collider {
  std::shared_ptr<const Shape> shape;
  double mass = 0;
  Vec3 inertia = Vec3::Zero();  ///< principal, body axes
  Pose pose;
  Vec3 velocity = Vec3::Zero();
  Vec3 spin = Vec3::Zero();
};

/// Two bodies that touch and approach each other.
struct Encounter {
  std::array<Collider, 2> bodies;
  Vec3 normal;          ///< unit, from A to B
  Vec3 point;           ///< where they touch
  double approach = 0;  ///< relative speed of the contact points along the normal, m/s, > 0
};

/// How velocities are drawn. Deviations per component: translation v, rotation spin * v / size, size being the radius
/// of the sphere of equal volume.
struct VelocityEnsemble {
  std::string_view name;
  std::string_view description;
  enum class Kind {
    gaussian,  ///< independent Gaussians, flux-weighted encounters
    thermal,   ///< the same with equal energy in each degree of freedom
    headOn,    ///< no spin, centres approach along the line that joins them, random orientations
    normal     ///< no spin, the relative velocity along the normal of the contact
  } kind = Kind::gaussian;
  double spin = 1;  ///< deviation of the surface speed due to spin over v
};

/// All ensembles, by name.
std::span<const VelocityEnsemble> velocityEnsembles();
/// Throws InputError listing the names there are.
const VelocityEnsemble& findEnsemble(std::string_view name);

/// A kind of body in the gas.
struct ColliderKind {
  std::shared_ptr<const Shape> shape;
  double density = 2500;  ///< kg/m^3
};

/// Draws one encounter; speed: the deviation v, m/s, > 0. Depends on the arguments alone.
Encounter drawEncounter(const ColliderKind& a, const ColliderKind& b, const VelocityEnsemble& ensemble, double speed,
                        Random& random);

/// Kinetic energy of a body, J.
double kineticEnergyOf(const Collider& body);

}  // namespace granular
