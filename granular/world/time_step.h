// The stable time step, from the stiffest motion the contacts allow rather than from habit.
//
// A contact with stiffness k and arm r gives a body of mass m and inertia I the rate k g, g = 1/m + (r x n).I^-1 (r x
// n); a patch adds its rocking stiffness k <s^2>/I. Several contacts add up, and in the worst case the neighbours move
// in antiphase: omega^2 <= 2 sum k g. With the velocity predicted from the half step, the damped oscillator of damping
// ratio z is stable up to omega dt = 2 (sqrt(1 + 4 z^2) - 2 z): 2 undamped, .72 at z = .6, .40 at z = 1.2 (its
// amplification factor reaches -1 there).
//
// The tensor law's contact swings at w^2 = k_n n.A n, A of both bodies, in every direction. J^T K J has that as its
// largest eigenvalue in the metric of the masses, and each contact gives it to both its bodies: omega^2 <= sum w^2. To
// share the sum above, half of it counts as the body's k g.
//
// Hertz's contact stiffens as it closes: dF/d delta = 2 E* sqrt(R delta), so that a bound needs the largest overlap
// that will come. Before a run it is options.expectedOverlap times the size (an impact of speed v on a plane reaches
// (15 m v^2/(16 E* sqrt(R)))^{2/5}), on a plane where the body is flattest; during a run it is the overlap there is.
// Across, Mindlin's stiffness is up to as large (8 G* a against 2 E* a: 2 (1 - nu)/(2 - nu) of it), and the body turns
// as well: for a sphere k_t g_t = 3.5 k_t/m. The larger of both counts.
#pragma once

#include <string>

#include "granular/world/world.h"

namespace granular {

struct TimeStepBound {
  double bound = infinity;        ///< largest stable step, s
  double contactTime = infinity;  ///< shortest S 14 contact time of any pair that may meet, s
  std::string body;               ///< the body that decides, described
  std::string explanation;        ///< one line for the user
};

/// A kind of body that will take part.
struct BodyKind {
  const Shape* shape;
  int material;
  double density;  ///< kg/m^3
};

/// Before a run: the bodies that will take part, with `contactsAssumed` contacts at once, one of them at the shape's
/// worst place and the others at average places.
TimeStepBound boundBeforeRun(const std::vector<BodyKind>& kinds, const MaterialTable& materials,
                             const WorldOptions& options, int contactsAssumed = 8);

/// During a run: the bodies that move, with the contacts they have now.
TimeStepBound boundOfContacts(const World& world);

/// Largest stable omega dt of a damped oscillator under the predicted velocity.
double stableRange(double dampingRatio);

}  // namespace granular
