// Hertz's laws of several contacts at once, as linear_lanes.h does it for the linear one: every number is made by the
// operations of hertz.h in their order. Names and equations are those of hertz.h.
#pragma once

#include "granular/law/linear_lanes.h"

namespace granular {

/// stiffDepth.
inline Wide stiffDepth(const ContactLanes& s, std::size_t k) { return squareRoot(s.squaredDepth.load(k)); }

/// findHertzStiffness.
inline WideStiffness findHertzStiffness(const ContactLanes& s, std::size_t k) {
  const Wide circle = squareRoot(s.radius.load(k) * stiffDepth(s, k));
  const Wide inverse = s.a.inverseMass.load(k) + s.b.inverseMass.load(k);
  return {s.hertz.load(k) * circle, (2.0 / 3) * s.mindlin.load(k) * circle, s.dampingRateN.load(k) / inverse,
          s.dampingRateT.load(k) / inverse};
}

/// findMindlinStiffness.
inline WideStiffness findMindlinStiffness(const ContactLanes& s, std::size_t k) {
  constexpr double halfRootFive = 1.1180339887498949, rootFiveSixths = 0.91287092917527690;
  const Wide circle = squareRoot(s.radius.load(k) * stiffDepth(s, k));
  const Wide inverse = s.a.inverseMass.load(k) + s.b.inverseMass.load(k);
  const Wide normal = s.hertz.load(k) * circle, tangential = s.mindlin.load(k) * circle;
  return {normal, tangential, halfRootFive * s.dampingN.load(k) * squareRoot(normal / inverse),
          rootFiveSixths * s.pulledDamping.load(k) * squareRoot(tangential / inverse)};
}

/// shortenGrownSpring.
inline void shortenGrownSprings(const WideMotion& m, std::size_t k, ContactLanes& s) {
  const Triple<Wide> old = s.oldNormal.load(k), spring = s.spring.load(k);
  const Wide grown = m.normal.dot(m.slip), depth = stiffDepth(s, k);
  const Wide ratio = choose(depth > grown, squareRoot((depth - grown) / depth), Wide{});
  const Mask<Wide> shortens = both(grown > Wide{}, old.dot(old) > Wide{});
  s.spring.store(k, choose<Wide>(shortens, ratio * spring, spring));
  s.twist.store(k, choose(shortens, ratio * s.twist.load(k), s.twist.load(k)));
}

inline void applyHertzLawInLanes(const LawOptions& options, ContactLanes& s) {
  for (std::size_t k = 0; k < s.count; k += wideSize) {
    pressAndRub(options, WideMotion(s, k), findHertzStiffness(s, k), k, s);
  }
}

inline void applyHertzMindlinLawInLanes(const LawOptions& options, ContactLanes& s) {
  for (std::size_t k = 0; k < s.count; k += wideSize) {
    const WideMotion m(s, k);
    shortenGrownSprings(m, k, s);
    pressAndRub(options, m, findMindlinStiffness(s, k), k, s);
  }
}

}  // namespace granular
