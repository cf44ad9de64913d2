// What a contact remembers from step to step, and the force that came of it.
#pragma once

#include <cstdint>

#include "granular/core/math.h"

namespace granular {

/// What a contact remembers. Zero at its birth.
struct ContactHistory {
  Vec3 spring = Vec3::Zero();  ///< delta_t, m, world axes, perpendicular to `normal`
  Vec3 normal = Vec3::Zero();  ///< normal of the last step (zero: new contact)
  double twist = 0;            ///< torsional spring of a patch, rad
};
static_assert(sizeof(ContactHistory) == 7 * sizeof(double));  // a row of numbers (law/contact_lanes.h)

/// What a pair of spheres remembers, and who they are: one line of the cache.
struct alignas(64) SpherePair {
  ContactHistory history;
  std::int32_t a, b;  ///< body slots
};
static_assert(sizeof(SpherePair) == 64);

struct ContactForce {
  Vec3 force = Vec3::Zero();   ///< on A, acting at the contact point, N
  Vec3 couple = Vec3::Zero();  ///< on A, about the contact point, N m
  double normalForce = 0;      ///< signed: > 0 pushes the bodies apart, N
  bool sliding = false;
};

/// What the energy ledger remembers of a contact: the energy of its springs half a step after t_n, along the velocities
/// of then. Kept only while a ledger is.
struct SpringEnergy {
  double normal = 0, tangential = 0;  ///< J
  std::int64_t step = -1;             ///< after which it was written
};

}  // namespace granular
