// The linear law of several contacts at once, a contact in each lane of a register. Every number is made by the
// operations of linear.h in their order, so the answers are the same bits; where linear.h branches both ways are gone
// and one is chosen, but for what all contacts share (the options) and for patches, which many contacts lack together.
// Names and equations are those of linear.h.
#pragma once

#include "granular/law/contact_lanes.h"

namespace granular {

/// ContactMotion of the contacts in a register.
struct WideMotion {
  Triple<Wide> normal, velocity, slip, spin, meanSpin, turn;
  Wide overlap, share;
  double dt;

  WideMotion(const ContactLanes& s, std::size_t k) : normal(s.normal.load(k)), dt(s.dt) {
    const Triple<Wide> armA = s.a.arm.load(k), armB = s.b.arm.load(k);
    const Triple<Wide> wA = s.a.w.load(k), wB = s.b.w.load(k);
    const Triple<Wide> halfA = s.a.spinHalf.load(k), halfB = s.b.spinHalf.load(k);
    velocity = s.a.v.load(k) + wA.cross(armA) - (s.b.v.load(k) + wB.cross(armB));
    slip = dt * (s.a.vHalf.load(k) + halfA.cross(armA) - (s.b.vHalf.load(k) + halfB.cross(armB)));
    spin = wA - wB;
    meanSpin = 0.5 * (wA + wB);
    turn = dt * (halfA - halfB);
    overlap = s.overlap.load(k);
    share = s.share.load(k);
  }
};

/// ContactStiffness, without the share.
struct WideStiffness {
  Wide normal, tangential, dampingNormal, dampingTangential;
};

/// What findLinearStiffness reads.
struct StiffnessSource {
  Wide inverseMu, inverseMt, stiffness, stiffnessRatio, dampingN, dampingT;

  StiffnessSource(const ContactLanes& s, std::size_t k)
      : inverseMu(s.a.inverseMass.load(k) + s.b.inverseMass.load(k)),
        inverseMt(inverseMu + s.a.radiusRatio.load(k) + s.b.radiusRatio.load(k)),
        stiffness(s.stiffness.load(k)),
        stiffnessRatio(s.stiffnessRatio.load(k)),
        dampingN(s.dampingN.load(k)),
        dampingT(s.dampingT.load(k)) {}
  bool operator==(const StiffnessSource& o) const {
    return all(both(both(both(inverseMu == o.inverseMu, inverseMt == o.inverseMt),
                         both(stiffness == o.stiffness, stiffnessRatio == o.stiffnessRatio)),
                    both(dampingN == o.dampingN, dampingT == o.dampingT)));
  }
};

/// findLinearStiffness.
inline WideStiffness findLinearStiffness(const StiffnessSource& s) {
  const Wide product = 1 / (s.inverseMu * s.inverseMt);
  const Wide mu = s.inverseMt * product;
  WideStiffness given;
  given.normal = s.stiffness;
  const Wide root = squareRoot(given.normal * mu);
  given.tangential = given.normal * s.stiffnessRatio * s.inverseMu * s.inverseMu * product;
  given.dampingTangential = s.dampingT * root * s.inverseMu * s.inverseMu * product;
  given.dampingNormal = s.dampingN * root;
  return given;
}

/// A patch's normal force, and its couple about the contact point.
inline Wide pressPatch(const ContactLanes& s, std::size_t k, const WideMotion& m, const Wide& elastic,
                       const Wide& damping, bool tension, Triple<Wide>& couple) {
  const Triple<Wide>& n = m.normal;
  const Triple<Wide> u = s.u.load(k), v = n.cross(u);
  const Triple<Wide> g = n.cross(m.spin), centreArm = s.centreArm.load(k);
  const Wide uu = s.uu.load(k), vv = s.vv.load(k), uv = s.uv.load(k);
  const Wide gu = g.dot(u), gv = g.dot(v);
  const Wide cu = centreArm.dot(u), cv = centreArm.dot(v);

  // Trial: elastic force at the contact point, dashpot about the centre.
  const Wide approach = n.dot(m.velocity) + cu * gu + cv * gv;
  const Wide trial = elastic + damping * approach;
  const Wide mgu = s.rocking * (uu * gu + uv * gv), mgv = s.rocking * (uv * gu + vv * gv);
  const Wide trialU = damping * mgu - elastic * cu, trialV = damping * mgv - elastic * cv;

  // S.M^-1 S/rocking.
  const Wide det = uu * vv - uv * uv;
  const Wide quadratic = vv * cu * cu - 2 * uv * cu * cv + uu * cv * cv;
  const Wide offset = choose(quadratic < 8 * det, larger(quadratic / det, Wide{}), spread(8));
  const Wide square = damping * damping * (gu * mgu + gv * mgv) - 2 * damping * elastic * (gu * cu + gv * cv) +
                      elastic * elastic * offset / s.rocking;

  // Project those that lie outside.
  const Wide held = larger(trial, tension ? elastic : Wide{});
  const Wide slope = larger(spread(2), offset) / s.rocking;  // r^2
  const Mask<Wide> outside = square > slope * held * held;
  const Wide length = squareRoot(square), r = squareRoot(slope);
  const Wide projected = tension ? trial : larger(trial + r * length, Wide{}) / (1 + slope);
  const Wide push = choose(outside, projected, tension ? trial : held);
  const Wide scale = r * (tension ? held : projected) / length;

  // From the centre to the contact point.
  const Wide su = choose(outside, trialU * scale, trialU) + cu * push;
  const Wide sv = choose(outside, trialV * scale, trialV) + cv * push;
  couple = su * v - sv * u;
  return push;
}

/// The tangential springs in the new contact planes.
inline Triple<Wide> carrySpring(const Triple<Wide>& spring, const Triple<Wide>& old, const Triple<Wide>& normal,
                                const Wide& angle) {
  const Wide cosine = old.dot(normal), t = 0.5 * angle;
  const Wide inverse = 1 / ((1 + cosine) * (1 + t * t));
  const Triple<Wide> tilted = spring - (normal.dot(spring) * (1 + t * t) * inverse) * (old + normal);
  const Wide scale = (1 + cosine) * inverse;
  const Triple<Wide> carried = ((1 - t * t) * scale) * tilted + (2 * t * scale) * normal.cross(tilted);
  return choose<Wide>(cosine <= spread(-0.999), Triple<Wide>{}, carried);
}

/// The friction force on B, with its spring carried, stretched and held within Coulomb's limit.
inline Triple<Wide> rubTangentially(const WideMotion& m, const Wide& stiffness, const Wide& damping, const Wide& limit,
                                    bool alongVelocity, const Triple<Wide>& old, Triple<Wide>& spring,
                                    Mask<Wide>& slides) {
  // Carry the spring into the new plane and add what the contact point slipped during the step.
  const Triple<Wide>& n = m.normal;
  const Triple<Wide> moved = carrySpring(spring, old, n, n.dot(m.meanSpin) * m.dt) + m.slip;
  const Triple<Wide> stuck = moved - n.dot(moved) * n;
  const Triple<Wide> slide = m.velocity - n.dot(m.velocity) * n;

  // Stick, or slide: the spring and dashpot together are Coulomb's force; a dashpot that exceeds it alone leaves no
  // spring.
  const Triple<Wide> trial = stiffness * stuck + damping * slide;
  const Wide square = trial.dot(trial), slideSquare = slide.dot(slide), limitSquare = limit * limit;
  slides = square > limitSquare;
  if (!any(slides)) {
    spring = stuck;
    return trial;
  }
  Triple<Wide> bounded = (limit / squareRoot(square)) * trial;
  if (alongVelocity) {
    bounded = choose<Wide>(slideSquare > Wide{}, (limit / squareRoot(slideSquare)) * slide, bounded);
  }
  const Triple<Wide> reset = (1 / stiffness) * (bounded - damping * slide);
  const Mask<Wide> viscous = damping * damping * slideSquare >= limitSquare;
  spring = choose<Wide>(slides, choose<Wide>(viscous, Triple<Wide>{}, reset), stuck);
  return choose<Wide>(slides, bounded, trial);
}

/// slideTwist of linear.h.
inline Wide slideTwist(const Wide& limit, const Wide& stiffness, const Wide& damping, const Wide& rate, Wide& spring) {
  const Wide trial = stiffness * spring + damping * rate;
  const Mask<Wide> sticks = magnitude(trial) <= limit;
  const Wide bounded = copySign(limit, trial);
  const Wide reset = (bounded - damping * rate) / stiffness;
  spring = choose(sticks, spring, choose(magnitude(damping * rate) >= limit, Wide{}, reset));
  return -choose(sticks, trial, bounded);
}

/// Of patches: how they twist. rubs: which contacts have friction; the others keep no history.
inline void twistPatch(const WideMotion& m, const Wide& stiffness, const Wide& damping, const Wide& limit,
                       const Mask<Wide>& rubs, std::size_t k, ContactLanes& s, Triple<Wide>& couple) {
  constexpr double meanRadius = 0.37612638903183754;  // 2/3 / sqrt(pi)
  const Wide area = s.area.load(k), polar = s.uu.load(k) + s.vv.load(k);
  const Mask<Wide> twists = both(rubs, both(area > Wide{}, polar > Wide{}));
  Wide twist = s.twist.load(k) + m.normal.dot(m.turn);
  const Wide torque = slideTwist(limit * meanRadius * squareRoot(area), stiffness * polar, damping * polar,
                                 m.normal.dot(m.spin), twist);
  couple = choose<Wide>(twists, couple + torque * m.normal, couple);
  s.twist.store(k, choose(twists, twist, Wide{}));
}

/// pressAndRub of the contacts in a register.
inline void pressAndRub(const LawOptions& options, const WideMotion& m, const WideStiffness& given, std::size_t k,
                        ContactLanes& s) {
  const Triple<Wide>& n = m.normal;
  const Wide elastic = m.share * given.normal * m.overlap, damping = m.share * given.dampingNormal;
  const Wide stiffnessT = m.share * given.tangential, dampingT = m.share * given.dampingTangential;

  // Normal force, signed: > 0 pushes apart.
  Triple<Wide> couple{};
  Wide push = elastic + damping * n.dot(m.velocity);
  if (!options.tension) push = larger(push, Wide{});
  const Mask<Wide> hasArea = s.area.load(k) > Wide{};
  const bool anyArea = any(hasArea);
  if (anyArea) {
    Triple<Wide> ofPatch;
    push = choose(hasArea, pressPatch(s, k, m, elastic, damping, options.tension, ofPatch), push);
    couple = choose<Wide>(hasArea, ofPatch, couple);
  }

  // Friction, and a patch's friction against twisting. No friction, no history.
  const Wide friction = s.friction.load(k);
  const Mask<Wide> rubs = friction != Wide{};
  const Wide limit = friction * (options.frictionOfPush ? larger(push, Wide{}) : magnitude(push));
  Triple<Wide> spring = s.spring.load(k);
  Mask<Wide> slides;
  const Triple<Wide> drag =
      rubTangentially(m, stiffnessT, dampingT, limit, options.slideAlongVelocity, s.oldNormal.load(k), spring, slides);
  if (anyArea) {
    twistPatch(m, stiffnessT, dampingT, limit, rubs, k, s, couple);
  } else {
    s.twist.store(k, Wide{});
  }
  const Triple<Wide> along = -push * n;
  const Triple<Wide> force = choose<Wide>(rubs, along - drag, along);
  s.spring.store(k, choose<Wide>(rubs, spring, Triple<Wide>{}));
  s.oldNormal.store(k, choose<Wide>(rubs, n, Triple<Wide>{}));
  s.force.store(k, force);
  s.couple.store(k, couple);
  s.torqueA.store(k, s.a.arm.load(k).cross(force) + couple);
  s.torqueB.store(k, -1.0 * s.b.arm.load(k).cross(force) - couple);
  s.normalForce.store(k, push);
  s.sliding.store(k, choose(both(rubs, slides), spread(1), Wide{}));
}

/// The law of the contacts of a batch.
inline void applyLinearLawInLanes(const LawOptions& options, ContactLanes& s) {
  if (s.count == 0) return;
  StiffnessSource source(s, 0);
  WideStiffness given = findLinearStiffness(source);
  for (std::size_t k = 0; k < s.count; k += wideSize) {
    // In a bed of equal bodies one root and one quotient serve all.
    if (const StiffnessSource here(s, k); !(here == source)) {
      source = here;
      given = findLinearStiffness(source);
    }
    pressAndRub(options, WideMotion(s, k), given, k, s);
  }
}

}  // namespace granular
