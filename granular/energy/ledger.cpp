#include "granular/energy/ledger.h"

#include <cmath>

namespace granular {
namespace {

double powerOf(const Vec3& force, const Vec3& couple, const Vec3& velocity, const Vec3& spin) {
  return force.dot(velocity) + couple.dot(spin);
}

}  // namespace

void LedgerSums::add(const LedgerSums& other) {
  normalSprings += other.normalSprings;
  tangentialSprings += other.tangentialSprings;
  normalArrived += other.normalArrived;
  tangentialArrived += other.tangentialArrived;
  normalDashpots += other.normalDashpots;
  tangentialDashpots += other.tangentialDashpots;
  friction += other.friction;
  rule += other.rule;
  wall += other.wall;
  contactWork += other.contactWork;
  begun += other.begun;
}

void BodySums::add(const BodySums& other) {
  kineticBefore += other.kineticBefore;
  kineticAfter += other.kineticAfter;
  potentialBefore += other.potentialBefore;
  potentialAfter += other.potentialAfter;
  bodies += other.bodies;
  frozen += other.frozen;
}

void EnergyLedger::close(const LedgerSums& contacts, const BodySums& now, double heldNormal, double heldTangential) {
  // Bodies put in, taken out or stopped since the step before.
  exchanged += now.kineticBefore + now.potentialBefore - (begun ? kinetic + potential : 0) + contacts.begun;

  // Springs of contacts that ended: with their bodies, or because these parted. A parting contact's normal spring is
  // spent but for what the last step leaves, which the residual shows.
  if (begun) {
    const double normalEnded = normalSprings - contacts.normalArrived - heldNormal;
    const double tangentialEnded = tangentialSprings - contacts.tangentialArrived - heldTangential;
    if (now.bodies < bodies || now.frozen != frozen) {
      exchanged -= normalEnded + tangentialEnded;
    } else {
      parted += tangentialEnded;
    }
  }

  kinetic = now.kineticAfter;
  potential = now.potentialAfter;
  normalSprings = contacts.normalSprings + heldNormal;
  tangentialSprings = contacts.tangentialSprings + heldTangential;
  normalDashpots += contacts.normalDashpots;
  tangentialDashpots += contacts.tangentialDashpots;
  friction += contacts.friction;
  rule += contacts.rule;
  wall += contacts.wall;
  contactWork += contacts.contactWork;
  gravityWork += now.potentialBefore - now.potentialAfter;
  peak = std::max(peak, kinetic + normalSprings + tangentialSprings);
  bodies = now.bodies;
  frozen = now.frozen;
  begun = true;
}

double EnergyLedger::residual() const {
  return kinetic + potential + normalSprings + tangentialSprings + dissipated() - rule - wall - exchanged;
}

double EnergyLedger::relativeResidual() const {
  const double scale = peak + std::abs(dissipated());
  return scale > 0 ? residual() / scale : 0;
}

std::vector<std::pair<std::string_view, double>> EnergyLedger::entries() const {
  return {{"kinetic_j", kinetic},
          {"potential_j", potential},
          {"normal_springs_j", normalSprings},
          {"tangential_springs_j", tangentialSprings},
          {"normal_dashpots_j", normalDashpots},
          {"tangential_dashpots_j", tangentialDashpots},
          {"friction_j", friction},
          {"parted_j", parted},
          {"wall_work_j", wall},
          {"contact_rule_work_j", rule},
          {"exchanged_j", exchanged},
          {"residual_j", residual()}};
}

void bookContact(const ContactAccount& account, const ContactForce& force, const KickMotion& motion, const Vec3& normal,
                 double dt, std::int64_t step, bool begun, SpringEnergy& memory, LedgerSums& sums) {
  const Vec3 mean = 0.5 * (motion.before + motion.after), meanSpin = 0.5 * (motion.spinBefore + motion.spinAfter);

  // Half a kick's work of the springs on the bodies, along the normal and apart from it.
  const double h = 0.5 * dt, along = normal.dot(account.elasticForce);
  const double normalAfter = h * along * normal.dot(motion.after);
  const double allAfter = h * powerOf(account.elasticForce, account.elasticCouple, motion.after, motion.spinAfter);
  const double allBefore = h * powerOf(account.elasticForce, account.elasticCouple, motion.before, motion.spinBefore);

  // The springs before the kick should hold what they had after the last one, less friction's heat.
  const double stored = account.normalSpring + account.tangentialSpring + account.slipHeat + allBefore;
  if (memory.step == step - 1) {
    sums.normalArrived += memory.normal;
    sums.tangentialArrived += memory.tangential;
    sums.rule += stored - memory.normal - memory.tangential;
  } else if (!begun) {
    sums.begun += stored;
  }
  memory.normal = account.normalSpring - normalAfter;
  memory.tangential = account.tangentialSpring - (allAfter - normalAfter);
  memory.step = step;
  sums.normalSprings += memory.normal;
  sums.tangentialSprings += memory.tangential;

  // Heat.
  sums.normalDashpots -= dt * powerOf(account.dampingForce, account.dampingCouple, mean, meanSpin);
  (account.slides ? sums.friction : sums.tangentialDashpots) -= dt * account.viscousForce.dot(mean);
  (account.twists ? sums.friction : sums.tangentialDashpots) -= dt * account.viscousCouple.dot(meanSpin);
  sums.friction += account.slipHeat;

  // Bodies feel the relative motion and the wall's.
  const double wall = dt * powerOf(force.force, force.couple, motion.wallVelocity, motion.wallSpin);
  sums.wall += wall;
  sums.contactWork += dt * powerOf(force.force, force.couple, mean, meanSpin) + wall;
}

BodySums bookBodies(const Bodies& bodies, const std::vector<Vec3>& vBefore, const std::vector<Vec3>& wBefore,
                    const Vec3& gravity, double dt, std::size_t first, std::size_t last) {
  BodySums sums;
  for (std::size_t i = first; i < last; ++i) {
    ++sums.bodies;
    sums.frozen += bodies.state[i] == BodyState::frozen;
    const double height = -bodies.mass[i] * gravity.dot(bodies.x(i));
    sums.potentialBefore += height;
    sums.potentialAfter += height;
    if (!bodies.moves(i)) continue;
    const double weight = 0.5 * dt * bodies.mass[i];
    sums.potentialBefore += weight * gravity.dot(vBefore[i]);
    sums.potentialAfter -= weight * gravity.dot(bodies.vHalf(i));
    sums.kineticBefore += bodies.kineticEnergy(i, vBefore[i], wBefore[i]);
    sums.kineticAfter += bodies.kineticEnergy(i, bodies.vHalf(i), bodies.wHalfOf(i));
  }
  return sums;
}

}  // namespace granular
