// Scenes of masonry: rigid bodies put together without motion, which stand or fall.
#pragma once

#include "granular/run/comparison_scene.h"

namespace granular {

/// Cubes on each other, each off the axis by up to .01 a.
SceneSetup buildCubeTower(double unit, int count);
/// Bricks of 2 a x a x .6 a in running bond, with open joints between the bricks of a course.
SceneSetup buildBrickWall(double unit, int courses);
/// A semicircle of voussoirs on the ground, centre line of radius 5 a, `fraction` times as thick as the thinnest that
/// stands.
SceneSetup buildDryArch(double unit, int voussoirs, double fraction);
/// Blocks over the edge of a table, each overhang `fraction` of the harmonic one.
SceneSetup buildOverhang(double unit, int blocks, double fraction);

/// Thickness over the radius of the centre line of the thinnest semicircular arch of an even number of equal voussoirs
/// that stands under its own weight, without tension or sliding in its joints. Tends to .1075 (Milankovitch 1907).
double thinnestArch(int voussoirs);

/// How far a point of a body may be at most from where it was put: way of the centre plus bounding radius times angle
/// turned, largest over the bodies, over a.
double largestShift(const SceneSetup& setup, const Snapshot& start, const Snapshot& now);
/// Stands: the largest shift of the whole recording is its error.
Verdict judgeStanding(const SceneSetup& setup, const Recording& recording);
/// Falls: it ends more than half a unit from where it was put.
Verdict judgeFalling(const SceneSetup& setup, const Recording& recording);

}  // namespace granular
