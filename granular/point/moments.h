// Integrals over a polygon in closed form: area, centroid, second moments, those of a linear depth on it, and those of
// powers of the depth.
#pragma once

#include "granular/point/depth_powers.h"
#include "granular/point/polygon.h"

namespace granular {

/// Integrals over an area of 1, x and x x^T about the origin of the plane (m^2, m^3, m^4), and of a depth d >= 0 with
/// them: d, d x, d^2 (m^3, m^4, m^4). Sums of areas are sums of these.
struct AreaMoments {
  double area = 0;
  Vec2 first = Vec2::Zero();
  double xx = 0, yy = 0, xy = 0;
  double volume = 0;
  Vec2 firstOfVolume = Vec2::Zero();
  double square = 0;
  DepthPowers powers;  ///< nothing unless asked for

  Vec2 centroid() const { return first / area; }
  Vec2 centroidOfVolume() const { return firstOfVolume / volume; }

  AreaMoments& operator+=(const AreaMoments& other) {
    area += other.area;
    first += other.first;
    xx += other.xx;
    yy += other.yy;
    xy += other.xy;
    volume += other.volume;
    firstOfVolume += other.firstOfVolume;
    square += other.square;
    powers += other.powers;
    return *this;
  }
};

/// The integrals over a convex polygon; all zero for fewer than three corners. Powers of the depth only if asked for.
inline AreaMoments integrate(const Polygon& polygon, const Linear& depth, const PowerChoice& power = {}) {
  AreaMoments m;
  if (polygon.count < 3) return m;

  // A fan of triangles about the first corner p: integrals about p, which small polygons far away need. Areas and
  // depths below 0 are round-off; without them all sums are of one sign, and a centroid stays inside whatever the
  // sliver.
  const Vec2 p = polygon[0];
  const double atCorner = std::max(depth.at(p), 0.0);
  Vec2 a = polygon[1] - p;
  double atA = std::max(depth.at(polygon[1]), 0.0);
  for (int k = 2; k < polygon.count; ++k) {
    const Vec2 b = polygon[k] - p, sum = a + b;
    const double atB = std::max(depth.at(polygon[k]), 0.0), depths = atCorner + atA + atB;
    const double twice = std::max(cross(a, b), 0.0);
    m.area += twice;
    m.first += twice * sum;
    m.xx += twice * (a.x() * a.x() + b.x() * b.x() + sum.x() * sum.x());
    m.yy += twice * (a.y() * a.y() + b.y() * b.y() + sum.y() * sum.y());
    m.xy += twice * (a.x() * a.y() + b.x() * b.y() + sum.x() * sum.y());
    m.volume += twice * depths;
    m.firstOfVolume += twice * ((depths + atA) * a + (depths + atB) * b);
    m.square += twice * (depths * depths + atCorner * atCorner + atA * atA + atB * atB);
    a = b;
    atA = atB;
  }
  m.area /= 2;
  m.first /= 6;
  m.xx /= 24;
  m.yy /= 24;
  m.xy /= 24;
  m.volume /= 6;
  m.firstOfVolume /= 24;
  m.square /= 24;
  if (power.exponent > 0) m.powers = integratePowers(polygon, depth, power);

  // From p to the origin.
  m.firstOfVolume += m.volume * p;
  m.xx += p.x() * (2 * m.first.x() + m.area * p.x());
  m.yy += p.y() * (2 * m.first.y() + m.area * p.y());
  m.xy += p.x() * m.first.y() + p.y() * m.first.x() + m.area * p.x() * p.y();
  m.first += m.area * p;
  return m;
}

/// The integrals over a strip of the given width (m, > 0) along a segment, its depth linear from the first end to the
/// last and constant across.
inline AreaMoments integrate(const Segment& segment, double width, double depthFrom, double depthTo,
                             const PowerChoice& power = {}) {
  const Vec2 along = segment.to - segment.from, middle = 0.5 * (segment.from + segment.to);
  const double length = along.norm(), mean = 0.5 * (depthFrom + depthTo);
  const Vec2 across = length > 0 ? Vec2(Vec2(-along.y(), along.x()) * (width / length)) : Vec2(0, width);
  AreaMoments m;
  m.area = length * width;
  m.first = m.area * middle;
  m.xx = m.area * (middle.x() * middle.x() + (along.x() * along.x() + across.x() * across.x()) / 12);
  m.yy = m.area * (middle.y() * middle.y() + (along.y() * along.y() + across.y() * across.y()) / 12);
  m.xy = m.area * (middle.x() * middle.y() + (along.x() * along.y() + across.x() * across.y()) / 12);
  m.volume = m.area * mean;
  m.firstOfVolume = m.area * (mean * middle + (depthTo - depthFrom) / 12 * along);
  m.square = m.area * (mean * mean + (depthTo - depthFrom) * (depthTo - depthFrom) / 12);
  if (power.exponent > 0) m.powers = integratePowers(segment, width, depthFrom, depthTo, power);
  return m;
}

}  // namespace granular
