#include "granular/narrow/round_features.h"

#include <algorithm>

#include "granular/narrow/gjk.h"
#include "granular/narrow/polyhedron_features.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"

namespace granular {
namespace {

/// A face is looked at when its normal lies within 1 degree of the last one, a side when its axis is that near to
/// perpendicular: only which test is tried hangs on it, each proves itself.
constexpr double alignedCosine = 0.9998, alignedSine = 0.0175;

/// A flat face across a direction, in the axes of its shape.
struct FlatFace {
  bool found = false;
  Vec3 normal = Vec3::UnitX();
  double offset = 0;  // normal . x on the face
  std::int32_t index = 0;
};

FlatFace findCap(const Vec3& n, double below, double above) {
  if (n.z() > alignedCosine && above > 0) return {true, Vec3::UnitZ(), above, 0};
  if (n.z() < -alignedCosine) return {true, -Vec3::UnitZ(), below, 0};
  return {};
}

FlatFace findPolygon(const PolyhedronTables& t, const Vec3& n) {
  const auto v = static_cast<std::size_t>(climbToSupport(t, n, 0));
  FlatFace face;
  double best = alignedCosine;
  for (auto k = static_cast<std::size_t>(t.vertexFaceBegin[v]); k < static_cast<std::size_t>(t.vertexFaceBegin[v + 1]);
       ++k) {
    const auto f = static_cast<std::size_t>(t.vertexFaces[k]);
    const double cosine = t.faceNormals[f].dot(n);
    if (cosine > best) {
      best = cosine;
      face = {true, t.faceNormals[f], t.faceOffsets[f], t.vertexFaces[k]};
    }
  }
  return face;
}

FlatFace findFlatFace(const Shape& shape, const Vec3& n) {
  switch (shape.kind()) {
    case ShapeKind::cylinder: {
      const double half = static_cast<const Cylinder&>(shape).halfHeight();
      return findCap(n, half, half);
    }
    case ShapeKind::cone:
      return findCap(n, -static_cast<const Cone&>(shape).baseZ(), 0);
    case ShapeKind::cuboid:
    case ShapeKind::polyhedron:
      return findPolygon(static_cast<const Polyhedron&>(shape).tables(), n);
    default:
      return {};
  }
}

/// Distance of a point above the face from its rim, positive inside.
double marginOn(const Shape& shape, const FlatFace& face, const Vec3& p) {
  switch (shape.kind()) {
    case ShapeKind::cylinder:
      return static_cast<const Cylinder&>(shape).radius() - std::sqrt(p.x() * p.x() + p.y() * p.y());
    case ShapeKind::cone:
      return static_cast<const Cone&>(shape).radius() - std::sqrt(p.x() * p.x() + p.y() * p.y());
    default:
      return faceMargin(static_cast<const Polyhedron&>(shape).tables(), face.index, p);
  }
}

/// A's flat face below B's deepest point, or B's below A's.
RoundFeature lookAtFlat(Difference& c, const Vec3& last, bool ofA) {
  const Frame& frame = c.frame();
  const Shape& shape = ofA ? c.shapeA() : c.shapeB();
  const FlatFace face = findFlatFace(shape, ofA ? last : Vec3(-frame.unrotate(last)));
  RoundFeature out;
  if (!face.found) return out;

  const Vec3 n = ofA ? face.normal : Vec3(-frame.rotate(face.normal));
  const SupportPoint deepest = c.support(n);
  const Vec3 p = ofA ? deepest.b : frame.toBody(deepest.a);
  const double depth = face.offset - face.normal.dot(p);
  out.margin = marginOn(shape, face, p);
  out.holds = out.margin > 0;
  const Vec3 onA = ofA ? Vec3(deepest.b + depth * n) : deepest.a;
  out.minimum = {n, depth, onA, onA - depth * n};
  return out;
}

/// A cylinder whose axis is perpendicular to the normal: half the axis' length, else a negative number.
double sideHalf(const Shape& shape, const Vec3& n) {
  if (shape.kind() != ShapeKind::cylinder || std::abs(n.z()) > alignedSine) return -1;
  return static_cast<const Cylinder&>(shape).halfHeight();
}

RoundFeature lookAtSides(Difference& c, const Vec3& last) {
  const double halfA = sideHalf(c.shapeA(), last), halfB = sideHalf(c.shapeB(), c.frame().unrotate(last));
  RoundFeature out;
  if (halfA < 0 && halfB < 0) return out;
  Difference core = c;
  double layer = 0;
  if (halfA >= 0) {
    core.reduceToAxisOfA(halfA);
    layer += static_cast<const Cylinder&>(c.shapeA()).radius();
  }
  if (halfB >= 0) {
    core.reduceToAxisOfB(halfB);
    layer += static_cast<const Cylinder&>(c.shapeB()).radius();
  }
  const Nearest nearest = findNearest(core, Vec3::Zero(), last, 1e-15);
  constexpr double leastGap = 1e-3;
  if (nearest.inside || !(nearest.gap > leastGap * layer)) return out;

  // The segment stands for the cylinder only between its ends.
  const double slack = 1e-9 * c.size();
  if (halfA >= 0 && std::abs(nearest.onA.z()) > halfA - slack) return out;
  if (halfB >= 0 && std::abs(c.frame().toBody(nearest.onB).z()) > halfB - slack) return out;
  const Vec3& n = nearest.direction;
  const double depth = layer - nearest.gap;
  const double radiusA = halfA >= 0 ? static_cast<const Cylinder&>(c.shapeA()).radius() : 0;
  const Vec3 onA = nearest.onA + radiusA * n;
  out.holds = true;
  out.minimum = {n, depth, onA, onA - depth * n};
  return out;
}

}  // namespace

RoundFeature findRoundFeature(Difference& c, const Vec3& last) {
  RoundFeature out = lookAtFlat(c, last, true);
  if (!out.holds) out = lookAtFlat(c, last, false);
  if (!out.holds) out = lookAtSides(c, last);
  return out;
}

}  // namespace granular
