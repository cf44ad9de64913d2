#include "granular/insert/placement.h"

#include <algorithm>

namespace granular {
namespace {

constexpr int azimuthStarts = 16;
// The climb along support points ends by itself on a polyhedron; on smooth rims it converges quadratically.
constexpr int climbsAtMost = 50;
// Relative to the distance found: climbing further changes nothing.
constexpr double climbTolerance = 1e-12;
constexpr double stepOverInnerRadius = 0.25;
// How often a start that a wall forbids is raised by the bounding radius.
constexpr int risesAtMost = 64;
// Poses computed to touch stand off by this part of the bounding radius, far above the rounding of a coordinate.
constexpr double standOff = 1e-9;

/// The largest distance of the placed shape from a vertical axis. It is the largest support over all horizontal
/// directions, and climbing from a direction to that of its support point never loses height.
double largestReach(const Shape& shape, const Frame& frame, const Vec2& axis) {
  double largest = 0;
  for (int k = 0; k < azimuthStarts; ++k) {
    const double azimuth = 2 * pi * k / azimuthStarts;
    Vec3 d(std::cos(azimuth), std::sin(azimuth), 0);
    double reach = 0;
    for (int climb = 0; climb < climbsAtMost; ++climb) {
      const Vec3 point = frame.toWorld(shape.support(frame.unrotate(d)));
      const Vec2 from = point.head<2>() - axis;
      const double further = from.norm();
      if (further <= reach * (1 + climbTolerance)) break;
      reach = further;
      d.head<2>() = from / further;
    }
    largest = std::max(largest, reach);
  }
  return largest;
}

}  // namespace

double Region::width() const {
  if (kind == Kind::cylinder) return 2 * radius;
  const Vec2 size = hi - lo;
  const bool repeats = kind == Kind::periodic;
  return std::min(repeats && repeatX ? size.x() / 2 : size.x(), repeats && repeatY ? size.y() / 2 : size.y());
}

Vec2 Region::drawPoint(Random& random) const {
  if (kind != Kind::cylinder) {
    const double x = random.uniform(lo.x(), hi.x());
    return {x, random.uniform(lo.y(), hi.y())};
  }
  const double r = radius * std::sqrt(random.uniform());
  const double azimuth = random.uniform(0, 2 * pi);
  return axis + r * Vec2(std::cos(azimuth), std::sin(azimuth));
}

bool Region::holds(const Shape& shape, const Frame& frame) const {
  const Aabb box = shape.bounds(frame);
  if (box.lo.z() < floor) return false;
  if (kind == Kind::cylinder) {
    // The bounding sphere first, then the shape itself.
    const double offset = (frame.x.head<2>() - axis).norm();
    if (offset + shape.innerRadius() > radius) return false;
    if (offset + shape.boundingRadius() <= radius) return true;
    return largestReach(shape, frame, axis) <= radius;
  }
  const bool freeX = kind == Kind::periodic && repeatX, freeY = kind == Kind::periodic && repeatY;
  return (freeX || (box.lo.x() >= lo.x() && box.hi.x() <= hi.x())) &&
         (freeY || (box.lo.y() >= lo.y() && box.hi.y() <= hi.y()));
}

Vec3 Region::wrap(const Vec3& p) const {
  Vec3 wrapped = p;
  if (kind != Kind::periodic) return wrapped;
  const bool repeats[] = {repeatX, repeatY};
  for (int k = 0; k < 2; ++k) {
    const double length = hi[k] - lo[k];
    if (repeats[k]) wrapped[k] -= length * std::floor((wrapped[k] - lo[k]) / length);
  }
  return wrapped;
}

Columns::Columns(const Region& where, std::vector<const Wall*> around, double largestRadius)
    : region(where), walls(std::move(around)), cell(2 * largestRadius), highest(where.floor), reach(largestRadius) {}

std::int64_t Columns::cellOf(double x, double y) const {
  const auto i = static_cast<std::int64_t>(std::floor(x / cell));
  const auto j = static_cast<std::int64_t>(std::floor(y / cell));
  return i * (std::int64_t{1} << 32) + j;
}

void Columns::addOne(const Shape& shape, const Frame& frame) {
  cells[cellOf(frame.x.x(), frame.x.y())].push_back(static_cast<std::int32_t>(placed.size()));
  placed.push_back({&shape, frame});
}

void Columns::add(const Shape& shape, const Frame& frame) {
  highest = std::max(highest, shape.bounds(frame).hi.z());
  const Vec3 home = region.wrap(frame.x);

  // Images of a particle near a repeating side stand beyond the opposite one, where others may meet them.
  const bool periodic = region.kind == Region::Kind::periodic;
  const Vec2 size = periodic ? Vec2(region.hi - region.lo) : Vec2::Zero();  // an open region has none
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      if ((i != 0 && !(periodic && region.repeatX)) || (j != 0 && !(periodic && region.repeatY))) continue;
      const Vec3 x = home + Vec3(i * size.x(), j * size.y(), 0);
      const bool near = (i == 0 || (x.x() > region.lo.x() - 2 * reach && x.x() < region.hi.x() + 2 * reach)) &&
                        (j == 0 || (x.y() > region.lo.y() - 2 * reach && x.y() < region.hi.y() + 2 * reach));
      if (near) addOne(shape, Frame(frame.R, x));
    }
  }
}

std::vector<std::int32_t> Columns::findNear(const Vec3& centre, double radius) const {
  std::vector<std::int32_t> found;
  const double margin = radius + reach;
  // The cells are as wide as the largest particle: a margin spans at most one cell on either side, or two corners of
  // it.
  const auto first = [&](double v) { return std::floor((v - margin) / cell); };
  const auto last = [&](double v) { return std::floor((v + margin) / cell); };
  for (double i = first(centre.x()); i <= last(centre.x()); ++i) {
    for (double j = first(centre.y()); j <= last(centre.y()); ++j) {
      const auto it = cells.find(cellOf((i + 0.5) * cell, (j + 0.5) * cell));
      if (it == cells.end()) continue;
      for (const std::int32_t k : it->second) {
        const PlacedShape& other = placed[static_cast<std::size_t>(k)];
        const double contact = radius + other.shape->boundingRadius();
        if ((other.frame.x - centre).head<2>().squaredNorm() < contact * contact) found.push_back(k);
      }
    }
  }
  return found;
}

bool Columns::touchesWall(const Shape& shape, const Frame& frame) const {
  std::vector<WallTouch> touches;
  for (const Wall* wall : walls) {
    if (!wall->admits(frame.x)) return true;
    if (wall->clearance(frame.x, shape.boundingRadius()) >= 0) continue;
    touchWall(*wall, {PointRule::witness, 0}, shape, frame, touches);
    if (!touches.empty()) return true;
  }
  return false;
}

bool Columns::overlapsAny(const Shape& shape, const Frame& frame, const std::vector<std::int32_t>& candidates) const {
  for (const std::int32_t k : candidates) {
    const PlacedShape& other = placed[static_cast<std::size_t>(k)];
    const double contact = shape.boundingRadius() + other.shape->boundingRadius();
    if ((other.frame.x - frame.x).squaredNorm() >= contact * contact) continue;
    if (overlaps(shape, frame, *other.shape, other.frame)) return true;
  }
  return false;
}

bool Columns::isFree(const Shape& shape, const Frame& frame) const {
  const Frame home(frame.R, region.wrap(frame.x));
  return region.holds(shape, home) && !touchesWall(shape, home) &&
         !overlapsAny(shape, home, findNear(home.x, shape.boundingRadius()));
}

bool Columns::letDown(const Shape& shape, double lowest, Frame& frame) const {
  frame.x = region.wrap(frame.x);
  const std::vector<std::int32_t> near = findNear(frame.x, shape.boundingRadius());

  // Start where the bounding spheres just leave each other, but never below the lowest pose.
  const double depth = frame.x.z() - shape.bounds(frame).lo.z();
  const double hair = standOff * shape.boundingRadius();
  const double end = lowest + depth + hair;
  double start = end;
  for (const std::int32_t k : near) {
    const PlacedShape& other = placed[static_cast<std::size_t>(k)];
    const double contact = shape.boundingRadius() + other.shape->boundingRadius();
    const double aside = (other.frame.x - frame.x).head<2>().squaredNorm();
    start = std::max(start, other.frame.x.z() + std::sqrt(std::max(0.0, contact * contact - aside)) + hair);
  }
  const auto isFreeAt = [&](double z) {
    const Frame at(frame.R, {frame.x.x(), frame.x.y(), z});
    return region.holds(shape, at) && !touchesWall(shape, at) && !overlapsAny(shape, at, near);
  };
  // A sloping wall may stand in the way; higher up there may be room.
  if (!region.holds(shape, Frame(frame.R, {frame.x.x(), frame.x.y(), start}))) return false;
  for (int k = 0; k < risesAtMost && !isFreeAt(start); ++k) start += shape.boundingRadius();
  if (!isFreeAt(start)) return false;

  // Down to the first pose that is not free.
  const Clump* clump = asClump(shape);
  const double step = stepOverInnerRadius * (clump ? clump->smallestRadius() : shape.innerRadius());
  double z = start;
  while (z > end) {
    const double next = std::max(end, z - step);
    if (!isFreeAt(next)) break;
    z = next;
  }
  frame.x.z() = z;
  return true;
}

}  // namespace granular
