// Pairs that are hard for a narrow phase: plates, needles, slivers, near-degenerate and many-cornered hulls, from
// micrometres to kilometres and of sizes a hundredfold apart, in poses at random and exactly alike: aligned, edge along
// edge, corner on corner, concentric. Sample k of a seed is the same on every machine.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "granular/core/random.h"
#include "granular/narrow/narrow.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/shape_table.h"
#include "granular/shape/sphere.h"

namespace granular::stress {

enum class Setting {
  generic,        ///< any rotation, about the wanted depth
  deep,           ///< any rotation, up to concentric
  aligned,        ///< axes along axes, shifted by nothing, by something, or by whole half-lengths
  nearlyAligned,  ///< the same, off by down to round-off
  alongAnAxis,    ///< turned about one common axis: edges exactly parallel
  corners,        ///< a support point of one put exactly on one of the other
  concentric      ///< centres coincide
};
inline constexpr int settingCount = 7;
inline const char* nameOf(Setting setting) {
  constexpr const char* names[] = {"generic",       "deep",    "aligned",   "nearly aligned",
                                   "along an axis", "corners", "concentric"};
  return names[static_cast<int>(setting)];
}

struct PairSample {
  std::shared_ptr<const Shape> a, b;
  Pose poseA, poseB;
  Setting setting = Setting::generic;
  double size() const { return std::min(a->size(), b->size()); }
  double reach() const { return a->boundingRadius() + b->boundingRadius(); }
  std::string describe() const {
    return a->describe() + " and " + b->describe() + ", " + nameOf(setting) + ", distance over reach " +
           std::to_string((poseB.x - poseA.x).norm() / reach());
  }
};

/// The shapes of unit order, made once, and their copies at powers of ten, made when asked for.
class HardShapes {
 public:
  /// corners: of the largest hulls; 0 leaves them out.
  explicit HardShapes(int corners) {
    addRound();
    addCuboids();
    addSlivers();
    addHulls(corners);
  }

  std::size_t count() const { return units.size(); }
  std::shared_ptr<const Shape> get(std::size_t index, int exponent) {
    std::shared_ptr<const Shape>& shape = scaled[{index, exponent}];
    if (!shape) shape = scaledShape(*units[index], std::pow(10.0, exponent));
    return shape;
  }

 private:
  template <class Kind, class... Arguments>
  void add(const Arguments&... arguments) {
    units.push_back(std::make_shared<Kind>(arguments...));
  }

  void addRound() {
    add<Sphere>(.8);
    for (const double aspect : {.02, .5, 2., 50.}) {
      const double across = aspect > 1 ? 1 / aspect : 1, along = std::min(aspect, 1.);
      add<Ellipsoid>(Vec3(across, across, along));
      add<Cylinder>(across, 2 * along);
      add<Cone>(across, 2 * along);
    }
    add<Ellipsoid>(Vec3(1, .7, .4));
    add<Ellipsoid>(Vec3(1, .2, .02));
  }

  void addCuboids() {
    for (const Vec3& half : {Vec3(1, 1, 1), Vec3(.5, .8, 1.1), Vec3(1, 1, .02), Vec3(.02, .02, 1), Vec3(1, .2, .02)})
      add<Cuboid>(half);
  }

  /// Hulls with thin angles and with faces that are nearly one.
  void addSlivers() {
    const auto hull = [&](std::vector<Vec3> points) { units.push_back(std::make_shared<Polyhedron>(points)); };
    hull({Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)});
    // Four points nearly in a plane; a wedge with an edge of a hundredth of a radian; a lens of two pyramids.
    hull({Vec3(1, 0, 0), Vec3(-.5, .8, 0), Vec3(-.5, -.8, 0), Vec3(0, 0, 1e-3)});
    hull({Vec3(0, -1, 0), Vec3(0, 1, 0), Vec3(2, -1, .01), Vec3(2, 1, .01), Vec3(2, -1, -.01), Vec3(2, 1, -.01)});
    hull({Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, .02), Vec3(0, 0, -.02)});
    // A cube whose top rises by a few millionths of its side: four faces at that angle.
    std::vector<Vec3> cube{Vec3(0, 0, 1 + 4e-6)};
    for (int k = 0; k < 8; ++k) cube.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    hull(cube);
    // A prism of 24 sides with a sharp point.
    std::vector<Vec3> prism{Vec3(0, 0, 2)};
    for (int k = 0; k < 24; ++k) {
      const double azimuth = 2 * pi * k / 24;
      for (const double z : {-.5, .5}) prism.emplace_back(std::cos(azimuth), std::sin(azimuth), z);
    }
    hull(prism);
  }

  void addHulls(int corners) {
    Random random(99);
    const auto rock = [&](int points, const Vec3& stretch) {
      std::vector<Vec3> cloud;
      for (int k = 0; k < points; ++k) cloud.push_back(random.direction().cwiseProduct(stretch));
      units.push_back(std::make_shared<Polyhedron>(cloud));
    };
    rock(12, Vec3::Ones());
    rock(60, Vec3::Ones());
    rock(40, Vec3(.02, .02, 1));
    rock(40, Vec3(1, 1, .02));
    if (corners == 0) return;
    rock(corners, Vec3::Ones());
    rock(corners, Vec3(.3, .6, 1));
  }

  std::vector<std::shared_ptr<const Shape>> units;
  std::map<std::pair<std::size_t, int>, std::shared_ptr<const Shape>> scaled;
};

/// Moves B along the unit direction d until the pair's depth is about the one wanted (m), by secant steps: the depth
/// along the minimal normal falls by n.d per metre. Where B is put needs no precision, and no oracle.
inline void moveToDepth(PairSample& pair, const Vec3& d, double wanted) {
  for (int k = 0; k < 40; ++k) {
    const Frame frameA(pair.poseA), frameB(pair.poseB);
    WarmCache cache;
    NarrowCounts counts;
    Touch touch;
    const bool touches = findTouch(*pair.a, frameA, *pair.b, frameB, true, cache, counts, touch);
    const bool swapped = pair.a->kind() > pair.b->kind();
    const Vec3 apart = swapped ? Vec3(-frameB.rotate(cache.direction)) : frameA.rotate(cache.direction);
    const double off = (touches ? touch.overlap : -cache.budget) - wanted;
    if (std::abs(off) < 1e-3 * std::abs(wanted)) return;
    const double slope = (touches ? touch.normal : apart).dot(d);
    pair.poseB.x += (std::abs(slope) > 0.05 ? off / slope : off) * d;
  }
}

/// A pose of B in which its axes lie along A's, and the direction in which to move it.
inline Vec3 alignWithA(PairSample& pair, Random& random) {
  const int axis = static_cast<int>(random.below(3));
  const Vec3 d = Vec3::Unit(axis), side = Vec3::Unit((axis + 1) % 3), other = Vec3::Unit((axis + 2) % 3);
  // One of the 24 rotations of a cube, with entries that are exactly 0 and 1 but for the product's rounding.
  const Quat quarter(Eigen::AngleAxisd(pi / 2 * static_cast<double>(random.below(4)), d));
  const Quat over(Eigen::AngleAxisd(pi / 2 * static_cast<double>(random.below(4)), side));
  pair.poseB.q = random.below(2) ? Quat(over * quarter) : Quat::Identity();
  Vec3 shift = Vec3::Zero();
  const auto lengthAlong = [&](const Shape& shape, const Vec3& u) { return shape.support(u).dot(u); };
  switch (random.below(4)) {
    case 0:
      break;
    case 1:  // by a whole half-length: edges and corners come to lie on each other, or on the middle of a face
      shift = lengthAlong(*pair.a, side) * side;
      if (random.below(2)) shift += lengthAlong(*pair.b, pair.poseB.q.conjugate() * other) * other;
      break;
    case 2:  // by the sum of both: only the edges can touch
      shift = (lengthAlong(*pair.a, side) + lengthAlong(*pair.b, pair.poseB.q.conjugate() * -side)) * side;
      break;
    default:
      shift = pair.a->boundingRadius() * random.uniform(-1, 1) * side;
  }
  pair.poseB.x = shift;
  return d;
}

/// Turns and moves both bodies together: to a generic attitude, far from the origin, or not at all.
inline void carry(PairSample& pair, Random& random) {
  if (random.below(2)) return;
  const Quat turn = random.rotation();
  const Vec3 shift = pair.reach() * std::pow(10.0, random.uniform(-1, 2)) * random.direction();
  for (Pose* pose : {&pair.poseA, &pair.poseB}) {
    pose->x = turn * pose->x + shift;
    pose->q = turn * pose->q;
  }
}

/// Sample number k of a seed.
inline PairSample drawPair(HardShapes& shapes, std::uint64_t seed, std::uint64_t k) {
  Random random(seed * 0x9e3779b97f4a7c15ull + k);
  PairSample pair;
  // Sizes of 1 um to 1 km; half the pairs alike, the others up to a hundredfold apart.
  const int exponent = static_cast<int>(random.below(10)) - 6;
  const int step = random.below(2) ? 0 : static_cast<int>(random.below(5)) - 2;
  pair.a = shapes.get(random.below(shapes.count()), exponent);
  pair.b = shapes.get(random.below(shapes.count()), std::clamp(exponent + step, -6, 3));
  pair.setting = static_cast<Setting>(random.below(settingCount));

  // Half of them touch; overlaps and gaps spread evenly over decades.
  const double wanted = (random.below(2) ? 1 : -1) * pair.size() * std::pow(10.0, random.uniform(-6, -1));
  Vec3 d = random.direction();
  switch (pair.setting) {
    case Setting::generic:
    case Setting::deep:
      pair.poseB.q = random.rotation();
      break;
    case Setting::aligned:
      d = alignWithA(pair, random);
      break;
    case Setting::nearlyAligned:
      d = alignWithA(pair, random);
      pair.poseB.q = rotationFromVector(std::pow(10.0, random.uniform(-16, -2)) * random.direction()) * pair.poseB.q;
      break;
    case Setting::alongAnAxis:
      pair.poseB.q = Quat(Eigen::AngleAxisd(random.uniform(0, 2 * pi), Vec3::Unit(static_cast<int>(random.below(3)))));
      break;
    case Setting::corners: {
      pair.poseB.q = random.below(2) ? random.rotation() : Quat::Identity();
      const Vec3 onB = pair.poseB.q * pair.b->support(pair.poseB.q.conjugate() * -d);
      pair.poseB.x = pair.a->support(d) - onB;
      if (random.below(2)) pair.poseB.x -= wanted * d;
      carry(pair, random);
      return pair;
    }
    case Setting::concentric:
      if (random.below(2)) pair.poseB.q = random.rotation();
      if (random.below(2)) pair.poseB.x = std::pow(10.0, random.uniform(-16, -1)) * pair.size() * d;
      carry(pair, random);
      return pair;
  }
  pair.poseB.x += pair.reach() * d;
  moveToDepth(pair, d, wanted);
  if (pair.setting == Setting::deep) pair.poseB.x *= random.uniform();
  carry(pair, random);
  return pair;
}

}  // namespace granular::stress
