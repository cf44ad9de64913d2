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

/// Where particles may be put. Axis along z; the floor at z = floor.
struct Region {
  enum class Kind : unsigned char { box, cylinder, periodic };
  Kind kind = Kind::box;
  Vec2 lo = Vec2::Zero(), hi = Vec2::Zero();  ///< box and periodic: bounds in x and y, m
  bool repeatX = true, repeatY = true;        ///< periodic: which of them repeat
  Vec2 axis = Vec2::Zero();                   ///< cylinder
  double radius = 0;                          ///< cylinder, m
  double floor = 0;                           ///< m
  double ceiling = infinity;                  ///< no particle is put where it reaches higher, m

  /// Narrowest horizontal width, m; half of a repeating one, since a particle must not meet its own image.
  double width() const;
  /// A point of the region's cross-section, uniform over its area.
  Vec2 drawPoint(Random& random) const;
  /// True if the placed shape lies inside. Exact for flat sides; the round side is searched from sixteen azimuths.
  bool holds(const Shape& shape, const Frame& frame) const;
  /// The image of a point that lies in the region, where it repeats.
  Vec3 wrap(const Vec3& p) const;
};

/// A particle that is there.
struct PlacedShape {
  const Shape* shape;
  Frame frame;
};

/// The particles of a region, found by column. Grows as particles are placed.
class Columns {
 public:
  /// walls may be empty and must outlive this. largestRadius: bounding radius of the largest particle that will be
  /// added or asked about, m.
  Columns(const Region& region, std::vector<const Wall*> walls, double largestRadius);

  void add(const Shape& shape, const Frame& frame);

  /// Top of the highest particle, or the floor, m.
  double top() const { return highest; }

  /// True if the placed shape lies in the region, touches no wall and overlaps nothing. Where the region repeats, the
  /// position may be any image.
  bool isFree(const Shape& shape, const Frame& frame) const;

  /// Lets the shape down its column, from above everything and in steps of a quarter of its inner radius, to the last
  /// free pose before the first that is not, or to where its lowest point is at `lowest` (m). Sets frame.x.z(); false
  /// if the start is not free: the shape does not fit sideways.
  bool letDown(const Shape& shape, double lowest, Frame& frame) const;

 private:
  std::vector<std::int32_t> findNear(const Vec3& centre, double radius) const;
  void addOne(const Shape& shape, const Frame& frame);
  bool touchesWall(const Shape& shape, const Frame& frame) const;
  bool overlapsAny(const Shape& shape, const Frame& frame, const std::vector<std::int32_t>& candidates) const;
  std::int64_t cellOf(double x, double y) const;

  Region region;
  std::vector<const Wall*> walls;
  double cell, highest;
  double reach;                     ///< bounding radius of the largest particle, m
  std::vector<PlacedShape> placed;  ///< and their images near repeating sides
  std::unordered_map<std::int64_t, std::vector<std::int32_t>> cells;
};

}  // namespace granular
