// Clipping in the contact plane: convex polygons against half planes (Sutherland & Hodgman 1974), segments against both
// (Cyrus & Beck 1978). Comparisons are closed: what lies on a border is kept, so that coincident edges keep their area.
// No tolerance is needed: cutting is continuous, so round-off in a side moves the result by round-off.
#pragma once

#include <algorithm>

#include "granular/point/polygon.h"

namespace granular {

/// Left of the line from a to b, seen along its direction; not normalised.
inline Linear findLeftSide(const Vec2& a, const Vec2& b) {
  const Vec2 slope(a.y() - b.y(), b.x() - a.x());
  return {-slope.dot(a), slope};
}

/// Keeps the part of the polygon where side >= 0, in place; the new edge is called name.
inline void clipPolygon(const Linear& side, std::int32_t name, Polygon& polygon) {
  // Values at the corners first: mostly nothing is cut.
  std::array<double, Polygon::capacity> value;
  double least = infinity, most = -infinity;
  for (int k = 0; k < polygon.count; ++k) {
    const double each = side.at(polygon[k]);
    value[static_cast<std::size_t>(k)] = each;
    least = std::min(least, each);
    most = std::max(most, each);
  }
  if (least >= 0) return;
  if (most < 0) {
    polygon.count = 0;
    return;
  }

  // Corners that stay, and the crossings of the line.
  Polygon kept;
  for (int k = 0; k < polygon.count; ++k) {
    const int next = polygon.next(k);
    const double a = value[static_cast<std::size_t>(k)], b = value[static_cast<std::size_t>(next)];
    if (a >= 0) kept.push(polygon[k], polygon.edge(k));
    if ((a >= 0) == (b >= 0)) continue;
    kept.push(polygon[k] + (a / (a - b)) * (polygon[next] - polygon[k]), a >= 0 ? name : polygon.edge(k));
  }
  for (int k = 0; k < kept.count; ++k) {
    polygon.points[static_cast<std::size_t>(k)] = kept[k];
    polygon.edges[static_cast<std::size_t>(k)] = kept.edge(k);
  }
  polygon.count = kept.count;
}

/// Keeps the part of the polygon inside the other, in place, taking over its edges' names; empty (count 0) when they
/// don't meet.
inline void clipPolygon(const Polygon& other, Polygon& polygon) {
  for (int k = 0; k < other.count && polygon.count > 0; ++k) {
    clipPolygon(findLeftSide(other[k], other[other.next(k)]), other.edge(k), polygon);
  }
}

/// Keeps the part of the segment where side >= 0, in place; false when nothing is left.
inline bool clipSegment(const Linear& side, Segment& segment) {
  const double a = side.at(segment.from), b = side.at(segment.to);
  if (a < 0 && b < 0) return false;
  const Vec2 at = segment.from + (a / (a - b)) * (segment.to - segment.from);
  if (a < 0) segment.from = at;
  if (b < 0) segment.to = at;
  return true;
}

/// Keeps the part of the segment inside the polygon, in place; false when nothing is left.
inline bool clipSegment(const Polygon& polygon, Segment& segment) {
  for (int k = 0; k < polygon.count; ++k) {
    if (!clipSegment(findLeftSide(polygon[k], polygon[polygon.next(k)]), segment)) return false;
  }
  return true;
}

/// Keeps the part of the segment that runs beside the other within a lateral distance (m, > 0), in place; false when
/// nothing is left. Crossing segments keep the neighbourhood of their crossing, parallel ones all that they share.
inline bool clipSegment(const Segment& other, double lateral, Segment& segment) {
  const Vec2 along = other.to - other.from;
  const double length = along.norm();
  if (length == 0) return false;
  const Vec2 unit = along / length, left(-unit.y(), unit.x());
  const double start = unit.dot(other.from), middle = left.dot(other.from);
  return clipSegment({-start, unit}, segment) && clipSegment({start + length, -unit}, segment) &&
         clipSegment({lateral - middle, left}, segment) && clipSegment({lateral + middle, -left}, segment);
}

}  // namespace granular
