#include "granular/run/comparison_scene.h"

#include <array>
#include <cmath>

#include "granular/core/errors.h"
#include "granular/run/moving_scenes.h"
#include "granular/run/standing_scenes.h"

namespace granular {
namespace {

constexpr int towerCubes = 20, wallCourses = 8, voussoirs = 16, overhangBlocks = 6, dominoes = 15, pouredCubes = 300;
constexpr std::string_view shift = "largest shift of any point, over a; below .1";
constexpr std::string_view none = "none: only what happens";

/// One row per scene; a new scene is a row, a function that builds it and, if need be, one that judges it.
const std::array<ComparisonScene, 11> scenes = {{
    {"tower", "20 cubes stand where they were put",
     "statics: offsets of .01 a keep every centre of mass above well inside the face below", shift,
     [](double a) { return buildCubeTower(a, towerCubes); }, judgeStanding},
    {"brick_wall", "8 courses of running bond stand where they were put",
     "statics: each brick carries vertical forces only", shift, [](double a) { return buildBrickWall(a, wallCourses); },
     judgeStanding},
    {"arch_1.1", "a dry arch 1.1 times as thick as the thinnest stands",
     "limit analysis (Heyman 1966): a line of thrust fits inside", shift,
     [](double a) { return buildDryArch(a, voussoirs, 1.1); }, judgeStanding},
    {"arch_0.9", "a dry arch .9 times as thick as the thinnest falls",
     "limit analysis: no line of thrust fits inside (the circular limit is Milankovitch's .1075 radii)", none,
     [](double a) { return buildDryArch(a, voussoirs, 0.9); }, judgeFalling},
    {"overhang_0.98", "six blocks at .98 of the harmonic overhang stand",
     "statics: the centre of mass of the blocks above any edge is .02 a inside it", shift,
     [](double a) { return buildOverhang(a, overhangBlocks, 0.98); }, judgeStanding},
    {"overhang_1.02", "six blocks at 1.02 of the harmonic overhang fall",
     "statics: the centre of mass of the blocks above any edge is .02 a beyond it", none,
     [](double a) { return buildOverhang(a, overhangBlocks, 1.02); }, judgeFalling},
    {"corner_drop", "J = (1 + e) m_n v, 1/m_n = 1/m + |r x n|^2/I",
     "rigid impact without friction: momentum, angular momentum about the corner, energy",
     "speeds after the impact: root of the energy of their differences over the energy before; below .05",
     buildCornerDrop, judgeCornerDrop},
    {"tilted_0.98", "a block on a slope of .98 of the friction rests", "Coulomb", "largest shift, over a; below .01",
     [](double a) { return buildTiltedBlock(a, 0.98); }, judgeRestingBlock},
    {"tilted_1.02", "a block on a slope of 1.02 of the friction slides with g (sin - mu cos)", "Coulomb",
     "its acceleration; below .05", [](double a) { return buildTiltedBlock(a, 1.02); }, judgeSlidingBlock},
    {"dominoes", "the first turns about its foot until it meets the second; all fall, one after the other",
     "energy of the turning slab, integrated to the time",
     "time until the first has turned by .95 of the way to the second; below .05",
     [](double a) { return buildDominoes(a, dominoes); }, judgeDominoes},
    {"poured_cubes", "300 cubes come to rest inside the box and do not overlap",
     "rigid bodies don't penetrate; friction takes all energy",
     "deepest overlap at the end, over a; below .02, and at rest",
     [](double a) { return buildPouredCubes(a, pouredCubes); }, judgePouredCubes},
}};

}  // namespace

double SceneSetup::timeUnit() const { return std::sqrt(unit / gravity); }

double SceneSetup::mass(std::size_t body) const { return density * bodies[body].shape->massProperties().volume; }

std::span<const ComparisonScene> comparisonScenes() { return scenes; }

const ComparisonScene& comparisonSceneFromName(std::string_view name) {
  std::string known;
  for (const ComparisonScene& scene : scenes) {
    if (scene.name == name) return scene;
    known += (known.empty() ? "" : ", ") + std::string(scene.name);
  }
  throw InputError("scene \"" + std::string(name) + "\": known are " + known);
}

}  // namespace granular
