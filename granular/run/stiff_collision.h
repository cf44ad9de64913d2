// A collision of two rigid bodies in the limit of infinite stiffness: an independent reference for the contact laws.
//
// As k_n grows the contact time falls as 1/sqrt(k_n), the poses do not change during the contact, and its displacement
// d (of A's contact point relative to B's, zero at first touch) obeys a linear equation with constant coefficients,
//   d'' = -A K d,   A = sum over both bodies of (1/m 1 - [r]x I^-1 [r]x),   K: the spring tensor at the contact,
// without damping and without a friction limit. With B = K^1/2 A K^1/2 = Q diag(w^2) Q^T it is solved exactly:
//   d(t) = K^-1/2 Q diag(sin(w t)/w) Q^T K^1/2 u_0.
// The contact ends when the overlap n.d is back at zero; the energy then left in the springs, d.K d/2, is lost
// (S equation 19). Nothing here comes from the laws or from the step.
#pragma once

#include <string_view>

#include "granular/run/encounter.h"

namespace granular {

/// The spring tensor at the contact.
enum class StiffSpring {
  average,  ///< S 13: k_t from the mean squared distance and the mean moment of either body
  local,    ///< k_t from the contact's own masses: the mean of A across the normal against n.A n
  tensor    ///< K = (k_n/m_n) A^-1: normal and tangential motion take the same time
};

struct StiffCollision {
  double energyBefore = 0;  ///< kinetic, both bodies, J
  double energyLeft = 0;    ///< in the springs when the overlap is back at zero, J
  double duration = 0;      ///< in units of sqrt(mu/k_n)
  Vec3 impulse;             ///< on A, N s
};

/// e = e_t = 1, no friction limit.
StiffCollision resolveStiff(const Encounter& encounter, StiffSpring spring);

}  // namespace granular
