#include "granular/run/standing_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

SceneSetup makeSetup(double unit, double durationInTimeUnits) {
  SceneSetup setup;
  setup.unit = unit;
  setup.duration = durationInTimeUnits * setup.timeUnit();
  setup.sampleEvery = 0.05 * setup.timeUnit();
  return setup;
}

SceneBody makeBody(std::shared_ptr<const Shape> shape, const Vec3& x) {
  SceneBody body;
  body.shape = std::move(shape);
  body.pose.x = x;
  return body;
}

/// Section of the arch: where its joints are and what its voussoirs weigh, for a centre line of radius 1.
struct ArchHalf {
  double inner, outer, angle;  ///< radii; angle between joints, rad
  double weight, centre;       ///< of a voussoir, any unit; distance of its centre of mass
  int count;

  ArchHalf(int voussoirs, double thickness)
      : inner(1 - thickness / 2), outer(1 + thickness / 2), angle(pi / voussoirs), count(voussoirs / 2) {
    // Two triangles from the centre of the arch, the smaller one taken away.
    weight = outer * outer - inner * inner;
    centre = 2.0 / 3 * (std::pow(outer, 3) - std::pow(inner, 3)) / weight * std::cos(angle / 2);
  }

  /// How far inside its joints the thrust can be kept that has the horizontal part H: the room left for its moment
  /// about the middle.
  double room(double thrust) const {
    // From the crown to joint j, moments about a point (x, y) of the joint: K - H y - S x + M, K = H times the thrust's
    // height at the crown, S and M the weights so far and their moments. Not negative at the inner end of the joint,
    // not positive at the outer.
    double least = -infinity, most = infinity, sum = 0, moment = 0;
    for (int j = 0; j <= count; ++j) {
      const double sine = std::sin(j * angle), cosine = std::cos(j * angle);
      least = std::max(least, inner * (thrust * cosine + sum * sine) - moment);
      most = std::min(most, outer * (thrust * cosine + sum * sine) - moment);
      sum += weight;
      moment += weight * centre * std::sin((j + 0.5) * angle);
    }
    return most - least;
  }

  bool stands() const {
    // The room is a concave function of the thrust: narrow down its maximum.
    double lo = 0, hi = 10 * count * weight;
    for (int k = 0; k < 100; ++k) {
      const double left = lo + (hi - lo) / 3, right = hi - (hi - lo) / 3;
      (room(left) < room(right) ? lo : hi) = room(left) < room(right) ? left : right;
    }
    return room(0.5 * (lo + hi)) >= 0;
  }
};

}  // namespace

double thinnestArch(int voussoirs) {
  double falls = 0, stands = 1;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (falls + stands);
    (ArchHalf(voussoirs, middle).stands() ? stands : falls) = middle;
  }
  return stands;
}

SceneSetup buildCubeTower(double unit, int count) {
  SceneSetup setup = makeSetup(unit, 60);
  setup.planes.push_back({Vec3::Zero(), Vec3::UnitZ()});
  const auto cube = std::make_shared<Cuboid>(Vec3::Constant(0.5 * unit));
  Random random(1);
  for (int k = 0; k < count; ++k) {
    const double x = random.uniform(-0.01, 0.01), y = random.uniform(-0.01, 0.01);
    setup.bodies.push_back(makeBody(cube, unit * Vec3(x, y, k + 0.5)));
  }
  return setup;
}

SceneSetup buildBrickWall(double unit, int courses) {
  SceneSetup setup = makeSetup(unit, 40);
  setup.contactsPerBody = 4;
  setup.planes.push_back({Vec3::Zero(), Vec3::UnitZ()});
  const double height = 0.6, joint = 0.02;
  const int perCourse = 4;
  // Every second course begins and ends with a half brick, cut so that both ends of the wall are plumb.
  const double half = 0.5 * (2 - joint);
  const auto whole = std::make_shared<Cuboid>(0.5 * unit * Vec3(2, 1, height));
  const auto cut = std::make_shared<Cuboid>(0.5 * unit * Vec3(half, 1, height));
  for (int course = 0; course < courses; ++course) {
    const bool bonded = course % 2 == 1;
    const int bricks = perCourse + (bonded ? 1 : 0);
    double left = 0;
    for (int k = 0; k < bricks; ++k) {
      const bool end = bonded && (k == 0 || k == perCourse);
      const double length = end ? half : 2;
      setup.bodies.push_back(makeBody(end ? cut : whole, unit * Vec3(left + length / 2, 0, (course + 0.5) * height)));
      left += length + joint;
    }
  }
  return setup;
}

SceneSetup buildDryArch(double unit, int voussoirs, double fraction) {
  SceneSetup setup = makeSetup(unit, 40);
  setup.friction = 0.8;
  setup.planes.push_back({Vec3::Zero(), Vec3::UnitZ()});
  const double radius = 5 * unit, thickness = fraction * thinnestArch(voussoirs) * radius, angle = pi / voussoirs;

  // The voussoir at the crown of an arch about the origin, then turned to its place.
  std::vector<Vec3> corners;
  for (const double r : {radius - thickness / 2, radius + thickness / 2}) {
    for (const double side : {-0.5, 0.5}) {
      for (const double depth : {-0.5, 0.5}) {
        corners.emplace_back(r * std::sin(side * angle), depth * unit, r * std::cos(side * angle));
      }
    }
  }
  Frame frame;
  const auto voussoir = std::make_shared<Polyhedron>(corners, &frame);
  for (int k = 0; k < voussoirs; ++k) {
    const Quat turn = rotationFromVector(Vec3(0, (k + 0.5) * angle - pi / 2, 0));
    SceneBody body = makeBody(voussoir, turn * frame.x);
    body.pose.q = turn * Quat(frame.R);
    setup.bodies.push_back(body);
  }
  return setup;
}

SceneSetup buildOverhang(double unit, int blocks, double fraction) {
  SceneSetup setup = makeSetup(unit, 30);
  const double length = 2, height = 0.5;
  // The table ends at x = 0; the ground is there for what falls.
  setup.planes.push_back({unit * Vec3(0, 0, -4), Vec3::UnitZ()});
  SceneBody table = makeBody(std::make_shared<Cuboid>(unit * Vec3(2, 1, 0.25)), unit * Vec3(-2, 0, -0.25));
  table.fixed = true;
  setup.bodies.push_back(table);
  const auto block = std::make_shared<Cuboid>(0.5 * unit * Vec3(length, 1, height));
  double end = 0;
  for (int k = blocks; k >= 1; --k) {
    end += fraction * length / (2 * k);
    setup.bodies.push_back(makeBody(block, unit * Vec3(end - length / 2, 0, (blocks - k + 0.5) * height)));
  }
  return setup;
}

double largestShift(const SceneSetup& setup, const Snapshot& start, const Snapshot& now) {
  double largest = 0;
  for (std::size_t k = 0; k < setup.bodies.size(); ++k) {
    const Pose &was = start.bodies[k].pose, &is = now.bodies[k].pose;
    const double shift = (is.x - was.x).norm() + setup.bodies[k].shape->boundingRadius() * is.q.angularDistance(was.q);
    largest = std::max(largest, shift / setup.unit);
  }
  return largest;
}

Verdict judgeStanding(const SceneSetup& setup, const Recording& recording) {
  Verdict verdict;
  double largest = 0;
  for (const Snapshot& now : recording.snapshots) {
    largest = std::max(largest, largestShift(setup, recording.snapshots.front(), now));
  }
  verdict.error = largest;
  verdict.asTheory = recording.finite && largest < 0.1;
  verdict.observed = verdict.asTheory ? "stands" : largest < 0.5 ? "gives way" : "falls";
  return verdict;
}

Verdict judgeFalling(const SceneSetup& setup, const Recording& recording) {
  Verdict verdict;
  verdict.asTheory =
      recording.finite && largestShift(setup, recording.snapshots.front(), recording.snapshots.back()) > 0.5;
  verdict.observed = "stands";
  for (const Snapshot& now : recording.snapshots) {
    if (largestShift(setup, recording.snapshots.front(), now) < 0.5) continue;
    verdict.observed = fmt::format("falls after {:.3g} sqrt(a/g)", now.time / setup.timeUnit());
    break;
  }
  return verdict;
}

}  // namespace granular
