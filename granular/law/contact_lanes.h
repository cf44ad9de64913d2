// Contacts side by side, for laws that work on as many at once as a register holds (core/wide.h): what ContactMotion
// and its companions of law.h are for one contact, each quantity in a lane of its own. The lanes of a batch stay in the
// first cache.
#pragma once

#include "granular/body/bodies.h"
#include "granular/core/wide.h"
#include "granular/law/law.h"
#include "granular/pair/contact.h"

namespace granular {

struct ContactLanes {
  static constexpr std::size_t capacity = 32;
  static_assert(capacity % wideSize == 0);
  struct alignas(64) Lane {
    double at[capacity];

    double& operator[](std::size_t k) { return at[k]; }
    double operator[](std::size_t k) const { return at[k]; }
    Wide load(std::size_t k) const { return loadWide(at + k); }
    void store(std::size_t k, const Wide& wide) { storeWide(wide, at + k); }
  };
  using Lanes = TripleLanes<capacity>;

  /// One party of each contact. A wall: no inverse mass, no arm, and the velocities of its surface at the contact
  /// point.
  struct Party {
    Lanes arm, v, w;        ///< from the centre to the contact point, m; velocity and spin at t_n
    Lanes vHalf, spinHalf;  ///< at the half step
    Lane inverseMass, radiusRatio;

    /// Body i, apart from its arm.
    void put(std::size_t k, const Bodies& bodies, std::size_t i) {
      v.put(k, bodies.v[i]);
      w.put(k, bodies.w[i]);
      vHalf.put(k, bodies.vHalf[i]);
      spinHalf.put(k, bodies.spinHalf[i]);
      inverseMass[k] = bodies.inverseMass[i];
      radiusRatio[k] = bodies.radiusRatio[i];
    }
  };

  /// A law works on whole registers: what the lanes beyond hold is of no account, but should be numbers.
  std::size_t count = 0;
  double dt = 0;
  double rocking = 1;  ///< as in ContactMotion

  Party a, b;
  Lanes normal;
  Lane overlap, share;
  Lane area;  ///< 0: no patch, and what follows is not read
  Lanes centreArm, u;
  Lane uu, vv, uv;
  Lane stiffness, stiffnessRatio, dampingN, dampingT, friction;  ///< of LawConstants, dampingN as the tension asks
  // Read if lawReadsCurvature: as in ContactMotion, and of LawConstants.
  Lane radius, squaredDepth;
  Lane hertz, mindlin, dampingRateN, dampingRateT, pulledDamping;  ///< the last one: dampingN with the tension kept
  Lanes spring, oldNormal;                                         ///< the history: in, and out as the law leaves it
  Lane twist;
  // Out, as in ContactForce; torques about either centre; sliding: 0 or 1.
  Lanes force, couple, torqueA, torqueB;
  Lane normalForce, sliding;

  void putConstants(std::size_t k, const LawConstants& c, bool tension) {
    stiffness[k] = c.parameters.stiffness;
    stiffnessRatio[k] = c.stiffnessRatio;
    dampingN[k] = c.dampingN[tension];
    dampingT[k] = c.dampingT;
    friction[k] = c.parameters.friction;
  }
  void putElasticity(std::size_t k, const LawConstants& c) {
    hertz[k] = c.hertz;
    mindlin[k] = c.mindlin;
    dampingRateN[k] = c.parameters.dampingRateN;
    dampingRateT[k] = c.parameters.dampingRateT;
    pulledDamping[k] = c.dampingN[1];
  }
  void putHistory(std::size_t k, const ContactHistory& history) {
    spring.put(k, history.spring);
    oldNormal.put(k, history.normal);
    twist[k] = history.twist;
  }
  // Number by number: what is made whole first and then copied waits for itself on its way through memory.
  void takeHistory(std::size_t k, ContactHistory& history) const {
    history.spring = spring.take(k);
    history.normal = oldNormal.take(k);
    history.twist = twist[k];
  }
  void takeForce(std::size_t k, ContactForce& out) const {
    out.force = force.take(k);
    out.couple = couple.take(k);
    out.normalForce = normalForce[k];
    out.sliding = sliding[k] != 0;
  }
  void takePull(std::size_t k, std::int32_t bodyA, std::int32_t bodyB, ContactPull& pull) const {
    pull.a = bodyA;
    pull.b = bodyB;
    pull.force = force.take(k);
    pull.torqueA = torqueA.take(k);
    pull.torqueB = torqueB.take(k);
  }
};

}  // namespace granular
