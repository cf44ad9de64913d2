// Random binary collisions, simulated with the library's step and measured as S does (section 6.2, table 6): without
// damping and without a friction limit, how much energy stays in the tangential spring when the contact ends?
//
// S 19: E_loss = E_t/E_0, E_0 the kinetic energy of both bodies before (S 17, with the squares of the angular
// velocities that the source lost), E_t = k_t delta_t^2/2 the energy of the tangential spring in the last step of the
// contact (S 18). Beside it stand the change of the total energy, kinetic and what is left in the springs, and that of
// the angular momentum, which a perfect contact and integrator would keep, and the loss of the stiff limit for the same
// encounters (stiff_collision.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "granular/law/law.h"
#include "granular/point/contact_point.h"
#include "granular/run/stiff_collision.h"

namespace granular {

struct CollisionOptions {
  RuleOptions rule;
  LawKind law = LawKind::linear;
  VelocityEnsemble ensemble;
  double speed = 0.1;            ///< deviation v of the velocities, m/s
  double stiffness = 1e6;        ///< k_n, N/m
  double stepsPerContact = 100;  ///< t_c/dt with t_c of S 14, >= 4
  double dt = 0;                 ///< s; 0: from stepsPerContact
  std::int64_t samples = 1000;
  std::uint64_t seed = 1;
};

/// A mean over samples, its standard error and the worst of them.
struct Tally {
  double mean = 0, error = 0, worst = 0;
};

struct CollisionResult {
  double contactTime = 0;       ///< t_c of S 14, s
  double dt = 0;                ///< s
  Tally residual;               ///< S 19, percent
  Tally totalEnergy;            ///< |change of kinetic energy and what is left in the springs| over E_0, percent
  Tally kineticLoss;            ///< (E_0 - kinetic energy after)/E_0, percent; worst by magnitude
  Tally angularMomentum;        ///< |change| over the sum of the magnitudes of orbital and own angular momenta
  Tally stiffLimit;             ///< S 19 of the same encounters in the limit of infinite stiffness, percent
  Tally stiffDifference;        ///< |residual - stiffLimit| of each collision, percent of E_0
  double deepestOverlap = 0;    ///< over the smaller size
  std::int64_t unfinished = 0;  ///< contacts that did not end within maxContactTimes t_c; left out of the tallies
  std::uint64_t uncertified = 0, coarse = 0;  ///< overlaps used without certificate, and certified coarsely (narrow.h)
};

/// A contact that lasts longer is given up and counted.
inline constexpr double maxContactTimes = 20;

/// The shapes of S table 6 by name: sphere, ellipsoid, cylinder, tetrahedron, cube. Throws InputError listing them.
ColliderKind findColliderKind(std::string_view name);
/// The pairs of S table 6, "sphere-sphere" and so on, with S's residuals in percent.
struct CollisionPair {
  std::string_view a, b;
  double published;  ///< S table 6, percent
};
std::span<const CollisionPair> collisionPairs();

/// Runs all samples, in parallel; the result does not depend on the number of threads. Throws InputError for values out
/// of range.
CollisionResult studyCollisions(const ColliderKind& a, const ColliderKind& b, const CollisionOptions& options);

/// The stiff limit's spring that belongs to a law.
StiffSpring stiffSpringOf(LawKind law);

}  // namespace granular
