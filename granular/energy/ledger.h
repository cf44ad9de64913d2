// The energy ledger: where the energy of a run went, kept so that what a step does is counted as it is done.
//
// Positions live at t_n, velocities at the half steps. The kick at t_n, v+ = v- + dt F/m, changes the kinetic energy by
// exactly dt F.(v- + v+)/2: every force's work is its product with the mean velocity of its kick, so that kinetic
// energy changes by the work of all forces to round-off (rotation: but for the scheme's error in the gyroscopic term,
// which the residual shows). All entries are those of t_{n+1/2}:
//   kinetic        of the half-step velocities
//   potential      -m g.x, x half a step ahead: exact for a constant force
//   springs        E = W(t_n) + dt/2 dW/dt along v+. For a linear spring that is 1/2 k d_n d_{n+1}, which with the
//                  kinetic energy of v+ is the exact invariant of the leapfrog oscillator
//   dashpots, friction   -dt (their force).(mean velocity), and friction heat of springs that gave way (law/account.h)
//   rule           what the springs gained beyond the work the bodies did on them, W - (E of the kick before) + half a
//                  kick's work of the elastic force: the force acts elsewhere than where the overlap is made
//                  (contact-point rules), or its stiffness turned. Also holds the trapezoidal rule's error, second
//                  order
//   wall           work of the walls' motion on the bodies, in
//   exchanged      energy of bodies put in, less of those taken out, frozen, or put to sleep
//   parted         left in the tangential springs of contacts that ended
// residual = kinetic + potential + springs + dashpots + friction + parted - rule - wall - exchanged. It holds what the
// step leaves: where contacts begin and end within a step, and the rotation scheme; of second order in dt.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "granular/body/bodies.h"
#include "granular/law/law.h"

namespace granular {

/// Velocities of A relative to B at a contact point, before (-) and after (+) the kick; and of the wall if B is one.
struct KickMotion {
  Vec3 before, after;          ///< m/s
  Vec3 spinBefore, spinAfter;  ///< rad/s
  Vec3 wallVelocity = Vec3::Zero(), wallSpin = Vec3::Zero();
};

/// Sums over contacts of one step; added in a fixed order. J.
struct LedgerSums {
  double normalSprings = 0, tangentialSprings = 0;    ///< of all contacts, half a step ahead
  double normalArrived = 0, tangentialArrived = 0;    ///< what they had after the step before
  double normalDashpots = 0, tangentialDashpots = 0;  ///< heat
  double friction = 0;                                ///< heat
  double rule = 0, wall = 0;                          ///< work in
  double contactWork = 0;                             ///< of all contact forces on bodies
  double begun = 0;                                   ///< springs of contacts found when the ledger began

  void add(const LedgerSums& other);
};

/// Energy of the bodies before and after the kick, J; and who takes part.
struct BodySums {
  double kineticBefore = 0, kineticAfter = 0, potentialBefore = 0, potentialAfter = 0;
  std::int64_t bodies = 0, frozen = 0;

  void add(const BodySums& other);
};

struct EnergyLedger {
  bool begun = false;
  double kinetic = 0, potential = 0, normalSprings = 0, tangentialSprings = 0;  ///< now
  double normalDashpots = 0, tangentialDashpots = 0, friction = 0;              ///< heat so far
  double wall = 0, rule = 0, exchanged = 0, parted = 0;                         ///< so far
  double contactWork = 0, gravityWork = 0;  ///< on bodies so far: kinetic = these + exchanges, to round-off
  double peak = 0;                          ///< largest kinetic + elastic energy so far
  std::int64_t bodies = 0, frozen = 0;      ///< of the step before

  /// Books one step. held: springs of contacts between bodies asleep, which the step did not look at.
  void close(const LedgerSums& contacts, const BodySums& bodies, double heldNormal, double heldTangential);

  double dissipated() const { return normalDashpots + tangentialDashpots + friction + parted; }
  /// J; 0 in a scheme without error.
  double residual() const;
  /// Over the largest kinetic and elastic energy there was plus all that was dissipated; 0 if there was none.
  double relativeResidual() const;

  /// All entries by their names in result.json, J.
  std::vector<std::pair<std::string_view, double>> entries() const;

  /// Calls visit(name, value) for every number a checkpoint must hold.
  template <class Visitor>
  void visitState(Visitor&& visit) {
    visit("begun", begun);
    visit("kinetic", kinetic);
    visit("potential", potential);
    visit("normal_springs", normalSprings);
    visit("tangential_springs", tangentialSprings);
    visit("normal_dashpots", normalDashpots);
    visit("tangential_dashpots", tangentialDashpots);
    visit("friction", friction);
    visit("wall", wall);
    visit("rule", rule);
    visit("exchanged", exchanged);
    visit("parted", parted);
    visit("contact_work", contactWork);
    visit("gravity_work", gravityWork);
    visit("peak", peak);
    visit("bodies", bodies);
    visit("frozen", frozen);
  }
};

/// Books one contact's kick and remembers its springs. step: number of steps with this one; begun: the ledger was kept
/// before it.
void bookContact(const ContactAccount& account, const ContactForce& force, const KickMotion& motion, const Vec3& normal,
                 double dt, std::int64_t step, bool begun, SpringEnergy& memory, LedgerSums& sums);

/// Books the bodies from slot first up to last. vBefore, wBefore: half-step velocities before the kick, as Bodies keeps
/// them.
BodySums bookBodies(const Bodies& bodies, const std::vector<Vec3>& vBefore, const std::vector<Vec3>& wBefore,
                    const Vec3& gravity, double dt, std::size_t first, std::size_t last);

}  // namespace granular
