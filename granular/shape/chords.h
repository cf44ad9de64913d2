// Where a vertical line runs through a placed shape: the profile of a heap, and areas of sections, are made of these.
#pragma once

#include <vector>

#include "granular/shape/shape.h"

namespace granular {

/// A stretch of a vertical line, m.
struct Chord {
  double low, high;
};

/// Cuts placed shapes by vertical lines. Spheres, ellipsoids and the children of clumps exactly; other shapes by their
/// surface at `resolution` segments around a circle (polyhedra: exactly). Not thread-safe: it keeps the surfaces made.
class ChordFinder {
 public:
  explicit ChordFinder(int resolution = 48) : segments(resolution) {}

  /// Fills out with the stretches of the line (x, y) inside the shape, ascending and apart; none where it misses.
  void find(const Shape& shape, const Frame& frame, double x, double y, std::vector<Chord>& out);

  /// Area of the section of a placed shape with the plane y = `y`, m^2: by chords at `samples` places, close together
  /// at both ends, where they end as a root.
  double sectionArea(const Shape& shape, const Frame& frame, double y, int samples = 512);

 private:
  const TriangleMesh& surfaceOf(const Shape& shape);

  int segments;
  std::vector<std::pair<const Shape*, TriangleMesh>> surfaces;
};

}  // namespace granular
