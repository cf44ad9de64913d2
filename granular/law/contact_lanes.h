// Contacts side by side, for laws that work on as many at once as a register holds (core/wide.h): what ContactMotion
// and its companions of law.h are for one contact, each quantity in a lane of its own. The lanes of a batch stay in the
// first cache.
#pragma once

#include "granular/body/body_rows.h"
#include "granular/core/rows.h"
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

    /// Bodies from lane k on, a register full, apart from their arms.
    void put(std::size_t k, const std::array<const MotionRow*, wideSize>& bodies) {
      std::array<const double*, wideSize> from;
      std::array<Wide, 7> now, half;
      for (std::size_t i = 0; i < wideSize; ++i) from[i] = bodies[i]->now();
      loadRows(from, now);
      for (std::size_t i = 0; i < wideSize; ++i) from[i] = bodies[i]->half();
      loadRows(from, half);
      v.store(k, {now[0], now[1], now[2]});
      w.store(k, {now[3], now[4], now[5]});
      radiusRatio.store(k, now[6]);
      vHalf.store(k, {half[0], half[1], half[2]});
      inverseMass.store(k, half[3]);
      spinHalf.store(k, {half[4], half[5], half[6]});
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

  /// elastic: lawReadsCurvature.
  void putConstants(std::size_t k, const LawConstants& c, bool tension, bool elastic) {
    stiffness[k] = c.parameters.stiffness;
    stiffnessRatio[k] = c.stiffnessRatio;
    dampingN[k] = c.dampingN[tension];
    dampingT[k] = c.dampingT;
    friction[k] = c.parameters.friction;
    if (!elastic) return;
    hertz[k] = c.hertz;
    mindlin[k] = c.mindlin;
    dampingRateN[k] = c.parameters.dampingRateN;
    dampingRateT[k] = c.parameters.dampingRateT;
    pulledDamping[k] = c.dampingN[1];
  }
  // Whole registers from lane k on, of as many histories and contacts as a register has lanes. What is taken
  // goes to the first `some` of them.
  void putHistories(std::size_t k, ContactHistory* const* histories) {
    std::array<const double*, wideSize> from;
    for (std::size_t i = 0; i < wideSize; ++i) from[i] = histories[i]->spring.data();
    std::array<Wide, 7> column;
    loadRows(from, column);
    spring.store(k, {column[0], column[1], column[2]});
    oldNormal.store(k, {column[3], column[4], column[5]});
    twist.store(k, column[6]);
  }
  void takeHistories(std::size_t k, std::size_t some, ContactHistory* const* histories) const {
    const Triple<Wide> s = spring.load(k), n = oldNormal.load(k);
    std::array<double*, wideSize> to;
    for (std::size_t i = 0; i < wideSize; ++i) to[i] = histories[i]->spring.data();
    storeRows<7>({s.x, s.y, s.z, n.x, n.y, n.z, twist.load(k)}, to, some);
  }
  void takeForces(std::size_t k, std::size_t some, Contact* const* contacts) const {
    const Triple<Wide> f = force.load(k), c = couple.load(k), onA = torqueA.load(k), onB = torqueB.load(k);
    std::array<double*, wideSize> to;
    for (std::size_t i = 0; i < wideSize; ++i) to[i] = contacts[i]->force.force.data();
    storeRows<7>({f.x, f.y, f.z, c.x, c.y, c.z, normalForce.load(k)}, to, some);
    for (std::size_t i = 0; i < wideSize; ++i) to[i] = contacts[i]->torqueA.data();
    storeRows<6>({onA.x, onA.y, onA.z, onB.x, onB.y, onB.z}, to, some);
    for (std::size_t i = 0; i < some; ++i) contacts[i]->force.sliding = sliding[k + i] != 0;
  }
  void takeForces(std::size_t k, std::size_t some, BriefContact* const* briefs) const {
    const Triple<Wide> f = force.load(k);
    std::array<double*, wideSize> to;
    for (std::size_t i = 0; i < wideSize; ++i) to[i] = briefs[i]->force.data();
    storeRows<4>({f.x, f.y, f.z, normalForce.load(k)}, to, some);
    for (std::size_t i = 0; i < some; ++i) briefs[i]->sliding = sliding[k + i] != 0;
  }
};

}  // namespace granular
