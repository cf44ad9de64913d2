// Where a body lies, for one body or for many side by side (core/wide.h).
#pragma once

#include "granular/core/rows.h"

namespace granular {

/// A body's axes and centre, world, m.
template <class Real>
struct PlacedAxes {
  Triple<Real> column0, column1, column2, x;
  Triple<Real> rotate(const Triple<Real>& v) const { return v.x * column0 + v.y * column1 + v.z * column2; }
  Triple<Real> unrotate(const Triple<Real>& v) const { return {column0.dot(v), column1.dot(v), column2.dot(v)}; }
  Triple<Real> toWorld(const Triple<Real>& p) const { return rotate(p) + x; }
};

inline PlacedAxes<double> placeAxes(const Frame& frame) {
  return {toTriple(frame.R.col(0)), toTriple(frame.R.col(1)), toTriple(frame.R.col(2)), toTriple(frame.x)};
}

/// As many frames as a register has lanes.
inline PlacedAxes<Wide> loadAxes(const std::array<const Frame*, wideSize>& frames) {
  static_assert(sizeof(Frame) == 12 * sizeof(double));
  std::array<const double*, wideSize> begin, end;
  for (std::size_t k = 0; k < wideSize; ++k) {
    begin[k] = frames[k]->R.data();
    end[k] = begin[k] + 8;
  }
  std::array<Wide, 8> first;
  std::array<Wide, 4> last;
  loadRows(begin, first);
  loadRows(end, last);
  return {{first[0], first[1], first[2]},
          {first[3], first[4], first[5]},
          {first[6], first[7], last[0]},
          {last[1], last[2], last[3]}};
}

/// As many vectors.
inline Triple<Wide> loadVectors(const std::array<const Vec3*, wideSize>& vectors) {
  std::array<const double*, wideSize> rows;
  for (std::size_t k = 0; k < wideSize; ++k) rows[k] = vectors[k]->data();
  std::array<Wide, 3> v;
  loadRows(rows, v);
  return {v[0], v[1], v[2]};
}

/// A unit vector perpendicular to the unit vector n.
template <class Real>
Triple<Real> tangentOf(const Triple<Real>& n) {
  const Mask<Real> besideX = n.x * n.x < 0.36 + Real{};
  return unit(choose<Real>(besideX, Triple<Real>{Real{}, n.z, -n.y}, Triple<Real>{-n.z, Real{}, n.x}));
}

}  // namespace granular
