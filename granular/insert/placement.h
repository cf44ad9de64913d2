// Room for new particles: is a pose free, and what is the lowest free place in a column above the bed?
// A pose is free when the true shape (not its bounding sphere) lies inside the region, touches no wall and overlaps no
// particle. Bounding spheres answer first, the narrow phase what they leave open.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "granular/core/random.h"
#include "granular/narrow/narrow.h"
#include "granular/wall/wall.h"

namespace granular {

/// Where particles may be put. Axis along z; the floor at z = floor, no ceiling.
struct Region {
  enum class Kind : unsigned char { box, cylinder, periodic };
  Kind kind = Kind::box;
  Vec2 lo = Vec2::Zero(), hi = Vec2::Zero();  ///< box and periodic: bounds in x and y, m
  bool repeatX = true, repeatY = true;        ///< periodic: which of them repeat
  Vec2 axis = Vec2::Zero();                   ///< cylinder
  double radius = 0;                          ///< cylinder, m
  double floor = 0;                           ///< m

  /// Narrowest horizontal width, m; half of a repeating one, since a particle must not meet its own image.
  double width() const;
  /// A point of the region's cross-section, uniform over its area.
  Vec2 drawPoint(Random& random) const;
  /// True if the placed shape lies inside. Exact for flat sides; the round side is searched from sixteen azimuths.
  bool holds(const Shape& shape, const Frame& frame) const;
  /// The horizontal vector from a to b, by the nearest image.
  Vec3 nearest(const Vec3& from, const Vec3& to) const;
};

/// A particle that is there.
struct PlacedShape {
  const Shape* shape;
  Frame frame;
};

/// The particles of a region, found by column. Grows as particles are placed.
class Columns {
 public:
  /// Keeps references to walls, which may be empty. largestRadius: bounding radius of the largest particle that will be
  /// asked about or added, m.
  Columns(const Region& region, std::span<const Wall* const> walls, double largestRadius);

  void add(const Shape& shape, const Frame& frame);

  /// Top of the highest particle, or the floor, m.
  double top() const { return highest; }

  /// True if the placed shape lies in the region and overlaps nothing.
  bool isFree(const Shape& shape, const Frame& frame) const;

  /// Lets the shape down its column, from above everything, in steps of a quarter of its inner radius, to the last free
  /// pose above the first that is not, or to where its lowest point reaches `lowest` (m). Returns false if even the
  /// start is not free (it does not fit sideways). Sets frame.x.z().
  bool letDown(const Shape& shape, double lowest, Frame& frame) const;

  std::size_t size() const { return placed.size(); }

 private:
  /// Calls visit(index) for each particle whose column a circle may meet, until it returns false.
  template <typename Visit>
  bool visitNear(const Vec3& centre, double radius, Visit visit) const;
  std::int64_t cellOf(std::int64_t i, std::int64_t j) const;
  bool touchesWall(const Shape& shape, const Frame& frame) const;
  bool overlapsAny(const Shape& shape, const Frame& frame, std::span<const std::int32_t> candidates) const;

  Region region;
  std::span<const Wall* const> walls;
  double cell, highest, largest;
  std::int64_t cellsX = 0, cellsY = 0;  ///< repeating directions: cells around; else 0
  std::vector<PlacedShape> placed;
  std::unordered_map<std::int64_t, std::vector<std::int32_t>> cells;
};

}  // namespace granular
