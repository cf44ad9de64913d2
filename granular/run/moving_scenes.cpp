#include "granular/run/moving_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "granular/core/random.h"
#include "granular/narrow/narrow.h"
#include "granular/run/standing_scenes.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

SceneSetup makeSetup(double unit, double durationInTimeUnits, double sampleInTimeUnits) {
  SceneSetup setup;
  setup.unit = unit;
  setup.duration = durationInTimeUnits * setup.timeUnit();
  setup.sampleEvery = sampleInTimeUnits * setup.timeUnit();
  return setup;
}

SceneBody makeBody(std::shared_ptr<const Shape> shape, const Pose& pose) {
  SceneBody body;
  body.shape = std::move(shape);
  body.pose = pose;
  return body;
}

Vec3 axisZ(const BodyMotion& body) { return body.pose.q * Vec3::UnitZ(); }

/// Translational and rotational kinetic energy of a body, J.
double kineticEnergyOf(const SceneSetup& setup, std::size_t k, const BodyMotion& motion) {
  const Vec3 inertia = setup.density * setup.bodies[k].shape->massProperties().inertia;
  const Vec3 spin = motion.pose.q.conjugate() * motion.spin;
  return 0.5 * (setup.mass(k) * motion.velocity.squaredNorm() + spin.dot(inertia.cwiseProduct(spin)));
}

// The drop onto a corner, in units of a and sqrt(a/g).
constexpr double dropHeight = 1, cornerOffset = 0.2;
const Vec3 cornerOfCube(-0.5, -0.5, -0.5);

/// The cube's orientation: the corner below the centre, then turned until it is cornerOffset off, about an axis that is
/// no axis of the cube.
Quat cornerPose() {
  const Quat upright = Quat::FromTwoVectors(cornerOfCube, -Vec3::UnitZ());
  const double lean = std::asin(cornerOffset / cornerOfCube.norm());
  return rotationFromVector(lean * Vec3(std::cos(0.4), std::sin(0.4), 0)) * upright;
}

// The slope.
constexpr double slidingTime = 20, blockHeight = 0.4;

Vec3 slopeNormal(const SceneSetup& setup) { return setup.planes.front().normal; }
/// Acceleration of the block down the slope, m/s^2.
double slidingAcceleration(const SceneSetup& setup) {
  const double cosine = slopeNormal(setup).z();
  return setup.gravity * (std::sqrt(1 - cosine * cosine) - setup.friction * cosine);
}

// The dominoes, in units of a.
constexpr double dominoHeight = 2, dominoThickness = 0.4, dominoSpacing = 1.2, dominoPush = 0.6;

/// Time in sqrt(a/g) in which the first domino turns about its foot by the angle: its energy gives the spin at each
/// angle, Simpson's rule the time.
double turningTime(double angle) {
  const double h = dominoHeight, d = dominoThickness;
  const auto slowness = [&](double theta) {
    const double gained = 3 / (h * h + d * d) * (h * (1 - std::cos(theta)) - d * std::sin(theta));
    return 1 / std::sqrt(dominoPush * dominoPush + gained);
  };
  const int parts = 1000;
  const double width = angle / parts;
  double sum = 0;
  for (int k = 0; k < parts; ++k) {
    sum += width / 6 * (slowness(k * width) + 4 * slowness((k + 0.5) * width) + slowness((k + 1) * width));
  }
  return sum;
}

/// Time at which a body's upright axis first leans by the angle from the vertical, s; infinity if it never does.
/// Linear between snapshots.
double leaningTime(const Recording& recording, std::size_t body, double angle) {
  double before = 0, timeBefore = 0;
  for (const Snapshot& now : recording.snapshots) {
    const double lean = std::acos(std::clamp(axisZ(now.bodies[body]).z(), -1.0, 1.0));
    if (lean >= angle) return timeBefore + (now.time - timeBefore) * (angle - before) / (lean - before);
    before = lean;
    timeBefore = now.time;
  }
  return infinity;
}

/// Deepest overlap of two bodies, or of a body and a plane, m.
double deepestOverlap(const SceneSetup& setup, const Snapshot& now) {
  double deepest = 0;
  const std::size_t count = setup.bodies.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Shape& a = *setup.bodies[i].shape;
    const Frame frame(now.bodies[i].pose);
    for (const ScenePlane& plane : setup.planes) {
      const Vec3 lowest = frame.toWorld(a.support(frame.unrotate(-plane.normal)));
      deepest = std::max(deepest, -plane.normal.dot(lowest - plane.point));
    }
    for (std::size_t j = i + 1; j < count; ++j) {
      const Shape& b = *setup.bodies[j].shape;
      const Frame other(now.bodies[j].pose);
      if ((frame.x - other.x).norm() > a.boundingRadius() + b.boundingRadius()) continue;
      double overlap = 0;
      if (overlaps(a, frame, b, other, &overlap)) deepest = std::max(deepest, overlap);
    }
  }
  return deepest;
}

}  // namespace

SceneSetup buildCornerDrop(double unit) {
  SceneSetup setup = makeSetup(unit, 3.2, 0.01);
  setup.friction = 0;
  setup.restitution = 1;
  setup.contactsPerBody = 1;
  setup.planes.push_back({Vec3::Zero(), Vec3::UnitZ()});
  const Quat q = cornerPose();
  const double height = dropHeight - (q * cornerOfCube).z();
  setup.bodies.push_back(
      makeBody(std::make_shared<Cuboid>(Vec3::Constant(0.5 * unit)), {unit * Vec3(0, 0, height), q}));
  return setup;
}

Verdict judgeCornerDrop(const SceneSetup& setup, const Recording& recording) {
  // Rigid impact of a mass 1 with the inertia 1/6.
  const Vec3 arm = cornerPose() * cornerOfCube;
  const double inertia = 1.0 / 6, before = std::sqrt(2 * dropHeight);
  const Vec3 lever = arm.cross(Vec3::UnitZ());
  const double impulse = (1 + setup.restitution) * before / (1 + lever.squaredNorm() / inertia);
  const Vec3 spin = impulse * lever / inertia;
  const double up = impulse - before;

  // After it gravity alone acts. No other corner is down before .25 sqrt(a/g) more; large steps are looked at later, as
  // the first that comes.
  Verdict verdict;
  const double unitOfTime = setup.timeUnit();
  for (const Snapshot& now : recording.snapshots) {
    const double since = now.time / unitOfTime - before;
    if (since < 0.2) continue;
    const Vec3 expected(0, 0, up - since);
    const Vec3 v = now.bodies[0].velocity * (unitOfTime / setup.unit), w = now.bodies[0].spin * unitOfTime;
    const double difference = (v - expected).squaredNorm() + inertia * (w - spin).squaredNorm();
    verdict.error = std::sqrt(difference) / before;
    const double height = now.bodies[0].pose.x.z() / setup.unit + arm.z();
    const double energy = 0.5 * (v.squaredNorm() + inertia * w.squaredNorm()) + height;
    verdict.observed = fmt::format("up {:.4f} of {:.4f}, spin {:.4f} of {:.4f}, energy {:.5f} of 1", v.z() + since, up,
                                   w.norm(), spin.norm(), energy / dropHeight);
    break;
  }
  verdict.asTheory = recording.finite && verdict.error && *verdict.error < 0.05;
  return verdict;
}

SceneSetup buildTiltedBlock(double unit, double fraction) {
  SceneSetup setup = makeSetup(unit, slidingTime, 0.05);
  const Quat slope = rotationFromVector(std::atan(fraction * setup.friction) * Vec3::UnitY());
  setup.contactsPerBody = 1;
  setup.planes.push_back({Vec3::Zero(), slope * Vec3::UnitZ()});
  const Quat askew = slope * rotationFromVector(0.5 * Vec3::UnitZ());
  setup.bodies.push_back(makeBody(std::make_shared<Cuboid>(0.5 * unit * Vec3(1, 1, blockHeight)),
                                  {0.5 * unit * blockHeight * (slope * Vec3::UnitZ()), askew}));
  return setup;
}

Verdict judgeRestingBlock(const SceneSetup& setup, const Recording& recording) {
  Verdict verdict = judgeStanding(setup, recording);
  verdict.asTheory = recording.finite && *verdict.error < 0.01;
  verdict.observed = verdict.asTheory ? "rests" : *verdict.error < 0.1 ? "creeps" : "slides";
  return verdict;
}

Verdict judgeSlidingBlock(const SceneSetup& setup, const Recording& recording) {
  // From the speeds after a quarter of the time and at its end: the block has settled by then.
  const auto& snapshots = recording.snapshots;
  const Vec3 down = (-Vec3::UnitZ() + slopeNormal(setup).z() * slopeNormal(setup)).normalized();
  const Snapshot& late = snapshots.back();
  const auto early = std::find_if(snapshots.begin(), snapshots.end(),
                                  [&](const Snapshot& now) { return now.time >= 0.25 * setup.duration; });
  Verdict verdict;
  if (!recording.finite || early == snapshots.end() || !(late.time > early->time)) {
    verdict.observed = "no motion to measure";
    return verdict;
  }
  const double measured = down.dot(late.bodies[0].velocity - early->bodies[0].velocity) / (late.time - early->time);
  const double expected = slidingAcceleration(setup);
  verdict.error = std::abs(measured / expected - 1);
  verdict.asTheory = *verdict.error < 0.05;
  verdict.observed =
      fmt::format("acceleration {:.6f} g of {:.6f} g", measured / setup.gravity, expected / setup.gravity);
  return verdict;
}

SceneSetup buildDominoes(double unit, int count) {
  SceneSetup setup = makeSetup(unit, 30, 0.02);
  setup.friction = 0.6;
  setup.restitution = 0.1;
  setup.contactsPerBody = 3;
  setup.planes.push_back({Vec3::Zero(), Vec3::UnitZ()});
  const Vec3 half = 0.5 * Vec3(dominoThickness, 1, dominoHeight);
  const auto slab = std::make_shared<Cuboid>(unit * half);
  for (int k = 0; k < count; ++k) {
    setup.bodies.push_back(makeBody(slab, {unit * Vec3(k * dominoSpacing, 0, half.z()), Quat::Identity()}));
  }
  // The first turns about the edge of its foot on the side of the second.
  SceneBody& first = setup.bodies.front();
  first.spin = Vec3(0, dominoPush / setup.timeUnit(), 0);
  first.velocity = first.spin.cross(unit * Vec3(-half.x(), 0, half.z()));
  return setup;
}

Verdict judgeDominoes(const SceneSetup& setup, const Recording& recording) {
  Verdict verdict;
  const double unitOfTime = setup.timeUnit();
  const double angle = 0.95 * std::asin((dominoSpacing - dominoThickness) / dominoHeight);
  const double expected = turningTime(angle), measured = leaningTime(recording, 0, angle) / unitOfTime;

  // Each begins to lean after the one before it, and ends far from upright.
  bool inOrder = true;
  std::size_t fallen = 0;
  double last = 0;
  std::vector<double> times;
  for (std::size_t k = 0; k < setup.bodies.size(); ++k) {
    const double time = leaningTime(recording, k, 0.05);
    inOrder = inOrder && time >= last;
    last = time;
    times.push_back(time);
    const double lean = std::acos(std::clamp(axisZ(recording.snapshots.back().bodies[k]).z(), -1.0, 1.0));
    if (lean > 0.5) ++fallen;
  }
  const std::size_t n = times.size();
  const double speed = 5 * dominoSpacing * unitOfTime / (times[n - 2] - times[n - 7]) / std::sqrt(dominoHeight);
  if (std::isfinite(measured)) verdict.error = std::abs(measured / expected - 1);
  verdict.asTheory = recording.finite && fallen == n && inOrder && verdict.error && *verdict.error < 0.05;
  verdict.observed = fmt::format("{} of {} fall{}", fallen, n, inOrder ? "" : ", not in order");
  if (std::isfinite(speed)) verdict.observed += fmt::format("; wave at {:.3f} sqrt(g h)", speed);
  return verdict;
}

SceneSetup buildPouredCubes(double unit, int count) {
  SceneSetup setup = makeSetup(unit, 40, 1);
  setup.contactsPerBody = 8;
  const int perRow = 5;
  // A cube fits into its cell of the lattice at any orientation.
  const double pitch = 1.75, width = perRow * pitch;
  setup.planes.push_back({Vec3::Zero(), Vec3::UnitZ()});
  for (const double sign : {-1.0, 1.0}) {
    setup.planes.push_back({unit * sign * Vec3(width / 2, 0, 0), -sign * Vec3::UnitX()});
    setup.planes.push_back({unit * sign * Vec3(0, width / 2, 0), -sign * Vec3::UnitY()});
  }
  const auto cube = std::make_shared<Cuboid>(Vec3::Constant(0.5 * unit));
  Random random(1);
  for (int k = 0; k < count; ++k) {
    const int layer = k / (perRow * perRow), row = k / perRow % perRow, column = k % perRow;
    const Vec3 x = pitch * Vec3(column + 0.5, row + 0.5, layer + 0.5) - Vec3(width / 2, width / 2, 0);
    setup.bodies.push_back(makeBody(cube, {unit * x, random.rotation()}));
  }
  return setup;
}

Verdict judgePouredCubes(const SceneSetup& setup, const Recording& recording) {
  Verdict verdict;
  const Snapshot& end = recording.snapshots.back();
  const std::size_t count = setup.bodies.size();
  std::size_t outside = 0;
  double energy = 0, height = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3& x = end.bodies[k].pose.x;
    const bool inside = std::all_of(setup.planes.begin(), setup.planes.end(),
                                    [&](const ScenePlane& plane) { return plane.normal.dot(x - plane.point) > 0; });
    if (!inside) ++outside;
    const double n = static_cast<double>(count);
    energy += kineticEnergyOf(setup, k, end.bodies[k]) / (setup.mass(k) * setup.gravity * setup.unit) / n;
    height += x.z() / setup.unit / n;
  }
  if (recording.finite) verdict.error = deepestOverlap(setup, end) / setup.unit;
  // A mean of 1e-5 m g a is what a fall through 1e-5 a gives.
  const bool atRest = energy < 1e-5;
  verdict.asTheory = atRest && outside == 0 && verdict.error && *verdict.error < 0.02;
  verdict.observed =
      fmt::format("{}, mean kinetic energy {:.1e} m g a; mean height {:.3f} a{}", atRest ? "at rest" : "still moving",
                  energy, height, outside > 0 ? fmt::format("; {} outside", outside) : "");
  return verdict;
}

}  // namespace granular
