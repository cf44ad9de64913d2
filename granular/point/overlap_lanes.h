// Integrals over the overlaps of many contacts side by side, one per lane: AreaMoments and DepthPowers of fans of
// triangles. All triangles of an overlap share its deepest place, the origin, where the depth is the overlap; all sums
// are of one sign, so that no digit is lost.
#pragma once

#include <array>

#include "granular/core/wide.h"

namespace granular {

/// A place in the contact plane, relative to the deepest one, m.
struct Place {
  Wide x{}, y{};

  Place operator+(const Place& o) const { return {x + o.x, y + o.y}; }
  Place operator-(const Place& o) const { return {x - o.x, y - o.y}; }
};
inline Place operator*(const Wide& s, const Place& p) { return {s * p.x, s * p.y}; }
inline Wide cross(const Place& a, const Place& b) { return a.x * b.y - a.y * b.x; }
inline Place choose(const Mask<Wide>& first, const Place& a, const Place& b) {
  return {choose(first, a.x, b.x), choose(first, a.y, b.y)};
}

/// As AreaMoments without `square`, and DepthPowers over the overlap, of wideSize contacts.
struct alignas(64) OverlapLanes {
  enum Moment : std::size_t { area, x, y, xx, xy, yy, volume, volumeX, volumeY, moments };
  enum Power : std::size_t { below, at, above, belowX, belowY, atX, atY, powers };
  double moment[moments][wideSize];
  double power[powers][wideSize];  ///< only if asked for

  Wide operator[](Moment which) const { return loadWide(moment[which]); }
  Wide operator[](Power which) const { return loadWide(power[which]); }
};

/// Where a lane's integrals are added up.
struct OverlapLane {
  OverlapLanes* sums;
  std::size_t lane;
};

/// Triangles waiting for the powers of their depth to be integrated.
class PowerTriangles {
 public:
  /// exponent: as in PowerChoice; 0: none are asked for, and nothing is added.
  explicit PowerTriangles(int exponent) : power(exponent) {}
  bool isWanted() const { return power > 0; }
  int exponent() const { return power; }

  /// A triangle: the origin, p, q; the depths at p and q over that at the origin; twice the area.
  struct Triangle {
    double px, py, qx, qy, depthP, depthQ, twice;
  };
  void add(const Triangle& triangle, const OverlapLane& whose);
  /// No call of add() until then integrates: `many` more triangles, at most `capacity`, are only put by.
  void makeRoom(std::size_t many) {
    if (count + many > capacity) integrate();
  }
  /// Adds them to their contacts, in the order in which they were added: what a contact gets does not depend on others.
  void integrate();

 private:
  static constexpr std::size_t capacity = 128;
  using Lane = double[capacity];
  int power;
  std::size_t count = 0;
  alignas(64) Lane px, py, qx, qy, depthP, depthQ, area;
  std::array<OverlapLane, capacity> target;
};

/// Sums of triangles with a corner at the origin, as integrate(Polygon, Linear) adds them up.
class Fan {
 public:
  /// p to q runs round the origin, either way. Depths at the origin, p and q, m.
  void add(const Place& p, const Place& q, const Wide& depth, const Wide& depthP, const Wide& depthQ,
           const Mask<Wide>& chosen) {
    const Wide twice = choose(chosen, magnitude(cross(p, q)), Wide{});
    const Place sum = p + q;
    const Wide depths = depth + depthP + depthQ;
    area += twice;
    x += twice * sum.x;
    y += twice * sum.y;
    xx += twice * (p.x * p.x + q.x * q.x + sum.x * sum.x);
    xy += twice * (p.x * p.y + q.x * q.y + sum.x * sum.y);
    yy += twice * (p.y * p.y + q.y * q.y + sum.y * sum.y);
    volume += twice * depths;
    volumeX += twice * ((depths + depthP) * p.x + (depths + depthQ) * q.x);
    volumeY += twice * ((depths + depthP) * p.y + (depths + depthQ) * q.y);
  }

  std::array<Wide, OverlapLanes::moments> sums() const {
    constexpr double half = 1.0 / 2, sixth = 1.0 / 6, last = 1.0 / 24;
    return {half * area, sixth * x,      sixth * y,      last * xx,     last * xy,
            last * yy,   sixth * volume, last * volumeX, last * volumeY};
  }

 private:
  Wide area{}, x{}, y{}, xx{}, xy{}, yy{}, volume{}, volumeX{}, volumeY{};
};

/// The powers of tips, triangles whose depth falls to 0 at both other corners: there they follow from the area and its
/// first moments (addTip).
inline std::array<Wide, OverlapLanes::powers> powersOfTips(const Wide& area, const Wide& x, const Wide& y,
                                                           int exponent) {
  const auto mean = [](double n) { return 2 / ((n + 1) * (n + 2)); };
  const auto first = [&](double n) { return 3 * mean(n) / (n + 3); };  // x, y: a third of the area times p + q
  return {mean(exponent - 1) * area, mean(exponent) * area, mean(exponent + 1) * area, first(exponent - 1) * x,
          first(exponent - 1) * y,   first(exponent) * x,   first(exponent) * y};
}

}  // namespace granular
