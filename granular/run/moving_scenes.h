// Scenes of motion: an impact, friction, dominoes, and a box that is filled.
#pragma once

#include "granular/run/comparison_scene.h"

namespace granular {

/// A cube falls by a onto its lowest corner, which is .2 a off the line below its centre; no friction, e = 1.
SceneSetup buildCornerDrop(double unit);
Verdict judgeCornerDrop(const SceneSetup& setup, const Recording& recording);

/// A flat block on a slope whose tangent is `fraction` of the friction, its edges askew to the line of fall.
SceneSetup buildTiltedBlock(double unit, double fraction);
Verdict judgeRestingBlock(const SceneSetup& setup, const Recording& recording);
Verdict judgeSlidingBlock(const SceneSetup& setup, const Recording& recording);

/// Slabs of .4 a x a x 2 a, 1.2 a apart; the first is pushed.
SceneSetup buildDominoes(double unit, int count);
Verdict judgeDominoes(const SceneSetup& setup, const Recording& recording);

/// Cubes at random orientations let fall from a loose lattice into a box of 8.75 a x 8.75 a.
SceneSetup buildPouredCubes(double unit, int count);
Verdict judgePouredCubes(const SceneSetup& setup, const Recording& recording);

}  // namespace granular
