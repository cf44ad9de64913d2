// (i) Invariances: the same scene in other units, turned, moved, renumbered, with other switches, must do the same.
#include <fmt/format.h>
#include <omp.h>

#include <cstring>

#include "granular/core/random.h"
#include "verification/record.h"
#include "verification/scenes.h"

namespace granular {
namespace {

/// How a scene is laid out. Lengths are multiplied by `scale`, density is that of the same mass, stiffness unchanged,
/// velocities times scale: then all times are the same.
struct Layout {
  double scale = 1;
  Quat turn = Quat::Identity();
  Vec3 shift = Vec3::Zero();
  bool reversed = false, distant = false, meshFloor = false;
  bool generic = false;               ///< cylinder and cone among the bodies
  Skips skips{.orientation = false};  ///< orientations are compared, those of spheres too
};

TriangleMesh makeSquare(double side) {
  TriangleMesh mesh;
  mesh.vertices = {{-side, -side, 0}, {side, -side, 0}, {side, side, 0}, {-side, side, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Six bodies of five kinds dropped on a floor; stiff enough to leave again within the run.
std::unique_ptr<World> makeDrop(const Layout& layout) {
  WorldOptions options = plainOptions();
  options.gravity = layout.turn * Vec3(0, 0, -9.81 * layout.scale);
  options.skips = layout.skips;
  auto world = makeWorld(options, {2e3, .7, .7, .4});
  if (layout.meshFloor) {
    world->walls.push_back(makeMeshWall(makeSquare(.05), "a square"));
  } else {
    world->walls.push_back(makePlaneWall(layout.shift, layout.turn * Vec3::UnitZ()));
  }
  const double r = 1.5e-3 * layout.scale;
  const auto third = layout.generic ? makeShape("cylinder", std::vector{r, 2 * r}) : cuboidOf({.6 * r, r, r});
  const auto fifth = layout.generic ? makeShape("cone", std::vector{r, 2 * r}) : sphereOf(.8 * r);
  const std::vector<std::shared_ptr<const Shape>> shapes = {
      sphereOf(r), cuboidOf({r, r, r}),          third, makeShape("ellipsoid", std::vector{r, r, 2 * r}),
      fifth,       cuboidOf({r, .7 * r, .5 * r})};
  const double density = 2500 / std::pow(layout.scale, 3);
  const auto put = [&](std::size_t k) {
    Random random(40 + k);
    const Vec3 x = layout.scale * Vec3(8e-4 * random.normal(), 8e-4 * random.normal(), 3e-3 + 4.2e-3 * k);
    const Quat q = random.rotation();
    const std::size_t i = place(*world, shapes[k], layout.turn * x + layout.shift, layout.turn * q, density);
    const Vec3 v(0, 0, -.3 * layout.scale), w(20 * random.normal(), 20 * random.normal(), 20 * random.normal());
    move(*world, i, layout.turn * v, layout.turn * w);
  };
  for (std::size_t k = 0; k < shapes.size(); ++k) put(layout.reversed ? shapes.size() - 1 - k : k);
  if (layout.distant) place(*world, shapes[0], layout.turn * Vec3(1, 0, 1) + layout.shift);
  return world;
}

constexpr double dt = 4e-6;

/// Positions over the scale and orientations after `steps`, in the layout's own axes and the first numbering.
std::vector<double> trace(const Layout& layout, int steps) {
  auto world = makeDrop(layout);
  startHalfSteps(*world, dt, 0, true);
  for (int n = 0; n < steps; ++n) step(*world, dt);
  EXPECT_GT(world->report.contactSteps, 100u);
  std::vector<double> state;
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t i = layout.reversed ? 5 - k : k;
    const Vec3 x = layout.turn.conjugate() * (world->bodies.x(i) - layout.shift) / layout.scale;
    Quat q = layout.turn.conjugate() * world->bodies.orientation(i);
    for (int c = 0; c < 3; ++c) state.push_back(x[c] / 1.5e-3);
    for (int c = 0; c < 3; ++c) state.push_back(std::copysign(1.0, q.w()) * q.vec()[c]);
  }
  return state;
}

double largestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

// Round-off of 1e-16 per step, in units of the size, over 3000 steps and grown by the collisions, each of which
// multiplies a deviation by about (way between collisions)/(radius of curvature): ten or so, six deep.
constexpr double grown = 1e-8;
constexpr int runLength = 5000;

TEST(Invariances, UnitsPlaceAxesAndNumbersDoNotMatter) {
  const std::vector<double> reference = trace({}, runLength);
  const auto compare = [&](const std::string& name, const Layout& layout, double limit, const char* why) {
    verifyBelow('i', name + ": largest deviation / size", limit, largestDifference(reference, trace(layout, runLength)),
                why);
  };
  Layout layout;
  for (const auto& [name, scale] : {std::pair{"lengths in mm instead of m", 1e3}, std::pair{"lengths in km", 1e-3}}) {
    layout = {};
    layout.scale = scale;
    compare(name, layout, grown, "round-off, grown by collisions");
  }
  layout = {};
  layout.turn = Quat(Eigen::AngleAxisd(1.1, Vec3(1, 2, -.5).normalized()));
  compare("scene turned", layout, grown, "round-off, grown by collisions");
  layout = {};
  layout.shift = Vec3(.3, -.2, .1);
  compare("scene moved by 200 sizes", layout, 300 * grown, "round-off of 200 sizes, grown by collisions");
  layout = {};
  layout.reversed = true;
  compare("bodies renumbered, A and B swapped", layout, grown, "round-off, grown by collisions");
  layout = {};
  layout.distant = true;
  compare("a distant body added", layout, 0, "same forces: same bits");
  layout = {};
  layout.skips = {false, false, false, false};
  compare("nothing skipped, no cache", layout, grown, "verified answers are those of the search to round-off");
  layout = {};
  layout.meshFloor = true;
  compare("floor as a mesh of two triangles", layout, 10 * grown,
          "same rebound; edges of round features are sampled alike");
}

TEST(Invariances, CylinderAndConeDeviateByMoreThanRoundOffButLittle) {
  // With cylinder and cone among the bodies the deviation is some 1e-6, not round-off. Their touches are searched to a
  // certificate of 1e-9 and no further, which may be why; that is not established. The limit guards what was measured.
  Layout layout;
  layout.generic = true;
  const std::vector<double> reference = trace(layout, runLength);
  layout.scale = 1e3;
  verifyBelow('i', "with cylinder and cone, lengths in mm: largest deviation / size", 1e-4,
              largestDifference(reference, trace(layout, runLength)), "not derived: a guard above what was measured");
  layout.scale = 1;
  layout.turn = Quat(Eigen::AngleAxisd(1.1, Vec3(1, 2, -.5).normalized()));
  verifyBelow('i', "with cylinder and cone, scene turned: largest deviation / size", 1e-4,
              largestDifference(reference, trace(layout, runLength)), "not derived: a guard above what was measured");
}

TEST(Invariances, ThreadsDoNotMatter) {
  std::vector<double> states[3];
  int k = 0;
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    states[k++] = trace({}, 1400);
  }
  omp_set_num_threads(1);
  verifyThat('i', "1, 2, 4 threads: same bits", states[0] == states[1] && states[0] == states[2], "design");
}

TEST(Invariances, MomentumIsConservedToRoundOff) {
  Layout layout;
  auto world = makeDrop(layout);
  world->walls.clear();
  world->options.gravity.setZero();
  move(*world, 5, {0, 0, -1});
  move(*world, 0, {0, 0, .5});
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < world->bodies.size(); ++i) sum += world->bodies.mass[i] * world->bodies.vHalf(i);
    return sum;
  };
  startHalfSteps(*world, dt, 0, true);
  const Vec3 before = momentum();
  for (int n = 0; n < runLength; ++n) step(*world, dt);
  EXPECT_GT(world->report.contactSteps, 100u);
  double scale = 0;
  for (std::size_t i = 0; i < world->bodies.size(); ++i) scale += world->bodies.mass[i] * .3;
  verifyBelow('i', "momentum of six colliding bodies: change / scale", 1e-12, (momentum() - before).norm() / scale,
              "opposite forces: round-off of 5000 steps");
}

}  // namespace
}  // namespace granular
