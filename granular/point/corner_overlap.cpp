#include "granular/point/corner_overlap.h"

namespace granular {
namespace {

/// A face counts as level, and an edge too, below this slope: the normal of a contact is theirs to round-off.
constexpr double levelSlope = 1e-11;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// A corner of the fan and where its height has fallen to 0 on either side.
struct FanTriangle {
  Vec2 apex, from, to;  ///< counter-clockwise
};

class Fan {
 public:
  static constexpr int capacity = Feature::capacity;
  bool add(const Vec2& apex, const Vec2& from, const Vec2& to) {
    if (count == capacity) return false;
    triangles[static_cast<std::size_t>(count++)] = {apex, from, to};
    return true;
  }
  int size() const { return count; }
  const FanTriangle& operator[](int k) const { return triangles[static_cast<std::size_t>(k)]; }

  /// The integrals of a height that is `depth` at the apex and 0 at the rim.
  AreaMoments integrate(double depth, const PowerChoice& power) const {
    AreaMoments m;
    for (int k = 0; k < count; ++k) {
      const FanTriangle& t = (*this)[k];
      const double area = 0.5 * cross(t.from - t.apex, t.to - t.apex);
      if (!(area > 0)) continue;
      const Vec2 rim = t.from + t.to, sum = t.apex + rim;
      const double third = area / 3, twelfth = area / 12;
      m.area += area;
      m.first += third * sum;
      m.xx += twelfth * (t.apex.x() * t.apex.x() + t.from.x() * t.from.x() + t.to.x() * t.to.x() + sum.x() * sum.x());
      m.yy += twelfth * (t.apex.y() * t.apex.y() + t.from.y() * t.from.y() + t.to.y() * t.to.y() + sum.y() * sum.y());
      m.xy += twelfth * (t.apex.x() * t.apex.y() + t.from.x() * t.from.y() + t.to.x() * t.to.y() + sum.x() * sum.y());
      m.volume += third * depth;
      m.firstOfVolume += (twelfth * depth) * (2 * t.apex + rim);
      m.square += (0.5 * third) * depth * depth;
      if (power.exponent > 0) {
        addTip({t.apex, t.from, t.to}, std::max(depth / power.scale, 0.0), area, power.exponent, m.powers);
      }
    }
    return m;
  }

  /// The height at x over that at the apex.
  double share(const Vec2& x) const {
    double best = -infinity, found = 0;
    for (int k = 0; k < count; ++k) {
      const FanTriangle& t = (*this)[k];
      const double whole = cross(t.from - t.apex, t.to - t.apex);
      if (!(whole > 0)) continue;
      const double apex = cross(t.from - x, t.to - x) / whole;
      const double least = std::min({apex, cross(t.apex - x, t.from - x) / whole, cross(t.to - x, t.apex - x) / whole});
      if (least > best) {
        best = least;
        found = apex;
      }
    }
    return std::clamp(found, 0.0, 1.0);
  }

 private:
  std::array<FanTriangle, capacity> triangles;
  int count = 0;
};

bool isInside(const Polygon& polygon, const Vec2& x) {
  for (int k = 0; k < polygon.count; ++k) {
    if (cross(polygon[polygon.next(k)] - polygon[k], x - polygon[k]) < 0) return false;
  }
  return true;
}

/// Corner of `tip` in the level face of `seat`; the heights of the two differ by side times the depth.
bool measureTip(const SurfaceSide& tip, const SurfaceSide& seat, std::int32_t seatFace, double side,
                const PowerChoice& power, OverlapArea& out) {
  const Linear level = seat.findHeight(seatFace);
  if (level.slope.squaredNorm() > levelSlope * levelSlope) return false;
  const PolyhedronTables& tables = *tip.polyhedron();
  const std::int32_t v = tip.deepestVertex();
  const Vec3& vertex = tables.vertices[at(v)];
  const double depth = side * (tip.heightOf(vertex) - level.offset);
  if (!(depth > 0)) return false;
  const Vec2 apex = tip.projectPoint(vertex);
  /// Where the depth falls to 0 on the edge to another vertex.
  const auto findEnd = [&](const Vec3& far, Vec2& end) {
    const double there = side * (tip.heightOf(far) - level.offset);
    if (there > 0) return false;
    end = apex + depth / (depth - there) * (tip.projectPoint(far) - apex);
    return true;
  };

  Fan fan;
  const auto spokes = tables.spokesOf(tip.deepestVertex());
  for (std::size_t k = 0; k < spokes.size(); ++k) {
    if (!tip.isSeen(spokes[k].face)) continue;
    const Vec3& after = tables.vertices[at(spokes[k].vertex)];
    const Vec3& before = tables.vertices[at(spokes[k + 1 < spokes.size() ? k + 1 : 0].vertex)];
    Vec2 from, to;
    // Seen from below, counter-clockwise runs backwards.
    if (!findEnd(side > 0 ? after : before, from) || !findEnd(side > 0 ? before : after, to)) return false;
    if (!fan.add(apex, from, to)) return false;
  }
  if (fan.size() == 0) return false;

  Polygon rim;
  seat.projectFace(seatFace, rim);
  if (!isInside(rim, apex)) return false;
  for (int k = 0; k < fan.size(); ++k) {
    if (!isInside(rim, fan[k].from) || !isInside(rim, fan[k].to)) return false;
  }
  out.moments = fan.integrate(depth, power);
  if (!(out.moments.volume > 0)) return false;
  out.height = level.offset + 0.5 * side * depth * fan.share(out.moments.centroidOfVolume());
  return true;
}

/// The level edge that supports a body, in the contact plane: a point on it, its ends, and the faces left and right of
/// the way from one end to the other.
struct Ridge {
  Vec2 from, to;
  std::int32_t left, right;
  double height;
};

/// The edge as a ridge, if both its faces are seen.
bool showRidge(const SurfaceSide& body, double side, const PolyhedronTables::Edge& edge, Ridge& ridge) {
  if (!body.isSeen(edge.faceLeft) || !body.isSeen(edge.faceRight)) return false;
  const PolyhedronTables& tables = *body.polyhedron();
  const Vec3& from = tables.vertices[at(edge.a)];
  ridge.left = side > 0 ? edge.faceLeft : edge.faceRight;
  ridge.right = side > 0 ? edge.faceRight : edge.faceLeft;
  ridge.from = body.projectPoint(from);
  ridge.to = body.projectPoint(tables.vertices[at(edge.b)]);
  ridge.height = body.heightOf(from);
  return true;
}

/// The one level edge at the deepest vertex.
bool findRidge(const SurfaceSide& body, double side, Ridge& ridge) {
  const PolyhedronTables& tables = *body.polyhedron();
  const std::int32_t v = body.deepestVertex();
  const Vec3& vertex = tables.vertices[at(v)];
  const double height = body.heightOf(vertex);
  const auto spokes = tables.spokesOf(v);
  std::size_t level = spokes.size();
  for (std::size_t k = 0; k < spokes.size(); ++k) {
    const Vec3& far = tables.vertices[at(spokes[k].vertex)];
    if (std::abs(body.heightOf(far) - height) > levelSlope * (far - vertex).norm()) continue;
    if (level < spokes.size()) return false;
    level = k;
  }
  if (level == spokes.size()) return false;
  const std::int32_t right = spokes[level > 0 ? level - 1 : spokes.size() - 1].face;
  return showRidge(body, side, {v, spokes[level].vertex, spokes[level].face, right}, ridge);
}

/// The two points of a ridge where the other body's faces come to its height.
struct Stretch {
  Vec2 back, front;
};
bool findStretch(const Ridge& ridge, const Vec2& crossing, double depth, const Linear& behind, const Linear& ahead,
                 double side, Stretch& out) {
  const Vec2 along = ridge.to - ridge.from;
  const double square = along.squaredNorm();
  // The other surface recedes away from the crossing.
  const double fallAhead = -side * ahead.slope.dot(along), fallBehind = side * behind.slope.dot(along);
  if (!(fallAhead > 0) || !(fallBehind > 0)) return false;
  const double middle = (crossing - ridge.from).dot(along) / square;
  const double last = middle + depth / fallAhead, first = middle - depth / fallBehind;
  if (last > 1 || first < 0) return false;
  out = {ridge.from + first * along, ridge.from + last * along};
  return true;
}

/// Edge across edge.
bool measureCrossing(const SurfaceSide& a, const SurfaceSide& b, const Ridge& ridgeA, Ridge ridgeB,
                     const PowerChoice& power, OverlapArea& out) {
  const double depth = ridgeA.height - ridgeB.height;
  if (!(depth > 0)) return false;
  Vec2 alongA = ridgeA.to - ridgeA.from;
  double turn = cross(alongA, ridgeB.to - ridgeB.from);
  if (turn < 0) {
    // B runs from A's right to its left.
    std::swap(ridgeB.from, ridgeB.to);
    std::swap(ridgeB.left, ridgeB.right);
    turn = -turn;
  }
  const Vec2 alongB = ridgeB.to - ridgeB.from;
  if (!(turn > 1e-6 * alongA.norm() * alongB.norm())) return false;
  const Vec2 crossing = ridgeA.from + cross(ridgeB.from - ridgeA.from, alongB) / turn * alongA;

  // Ahead on A's edge lies what is right of B's, and left of A's what is ahead on B's.
  const Linear aLeft = a.findHeight(ridgeA.left), aRight = a.findHeight(ridgeA.right);
  const Linear bLeft = b.findHeight(ridgeB.left), bRight = b.findHeight(ridgeB.right);
  Stretch onA, onB;
  if (!findStretch(ridgeA, crossing, depth, bLeft, bRight, -1, onA)) return false;
  if (!findStretch(ridgeB, crossing, depth, aRight, aLeft, 1, onB)) return false;

  // Each quarter must lie in one face of either body.
  Polygon face;
  a.projectFace(ridgeA.left, face);
  if (!isInside(face, onB.front)) return false;
  a.projectFace(ridgeA.right, face);
  if (!isInside(face, onB.back)) return false;
  b.projectFace(ridgeB.left, face);
  if (!isInside(face, onA.back)) return false;
  b.projectFace(ridgeB.right, face);
  if (!isInside(face, onA.front)) return false;

  Fan fan;
  fan.add(crossing, onA.front, onB.front);
  fan.add(crossing, onB.front, onA.back);
  fan.add(crossing, onA.back, onB.back);
  fan.add(crossing, onB.back, onA.front);
  out.moments = fan.integrate(depth, power);
  if (!(out.moments.volume > 0)) return false;
  const Vec2 c = out.moments.centroidOfVolume();
  out.height = 0.5 * (std::min(aLeft.at(c), aRight.at(c)) + std::max(bLeft.at(c), bRight.at(c)));
  return true;
}

}  // namespace

bool measureCorner(const TouchingFeature& feature, const SurfaceSide& a, const SurfaceSide& b, double overlap,
                   double slack, const PowerChoice& power, OverlapArea& out) {
  if (!a.polyhedron() || !b.polyhedron() || !(overlap > 0)) return false;
  Ridge ridgeA, ridgeB;
  switch (feature.kind) {
    case TouchingFeature::faceOfA:
      return measureTip(b, a, feature.a, -1, power, out);
    case TouchingFeature::faceOfB:
      return measureTip(a, b, feature.b, 1, power, out);
    case TouchingFeature::edges:
      return showRidge(a, 1, a.polyhedron()->edges[at(feature.a)], ridgeA) &&
             showRidge(b, -1, b.polyhedron()->edges[at(feature.b)], ridgeB) &&
             measureCrossing(a, b, ridgeA, ridgeB, power, out);
    case TouchingFeature::unknown:
      break;
  }
  const std::int32_t faceA = a.findStartFace(slack), faceB = b.findStartFace(slack);
  if (faceB >= 0 && measureTip(a, b, faceB, 1, power, out)) return true;
  if (faceA >= 0 && measureTip(b, a, faceA, -1, power, out)) return true;
  return findRidge(a, 1, ridgeA) && findRidge(b, -1, ridgeB) && measureCrossing(a, b, ridgeA, ridgeB, power, out);
}

}  // namespace granular
