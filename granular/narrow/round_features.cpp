#include "granular/narrow/round_features.h"

#include <algorithm>

#include "granular/narrow/gjk.h"
#include "granular/shape/cylinder.h"

namespace granular {
namespace {

/// A face is looked at when its normal lies within 1 degree of the last one, a side when its axis is that near to
/// perpendicular: only which test is tried hangs on it, each proves itself.
constexpr double alignedSine = 0.0175;

/// A's flat face below B's deepest point, or B's below A's.
PieceMinimum lookAtFlat(Difference& c, const Vec3& last, bool ofA) {
  const Vec3 n = ofA ? last : Vec3(-c.frame().unrotate(last));
  const PieceName face = namePiece(ofA ? c.shapeA() : c.shapeB(), n, alignedSine);
  if (face.kind != PieceName::face) return {};
  return checkFlatFace(c, face, ofA);
}

/// A cylinder whose axis is perpendicular to the normal: half the axis' length, else a negative number.
double sideHalf(const Shape& shape, const Vec3& n) {
  if (shape.kind() != ShapeKind::cylinder || std::abs(n.z()) > alignedSine) return -1;
  return static_cast<const Cylinder&>(shape).halfHeight();
}

PieceMinimum lookAtSides(Difference& c, const Vec3& last) {
  const double halfA = sideHalf(c.shapeA(), last), halfB = sideHalf(c.shapeB(), c.frame().unrotate(last));
  PieceMinimum out;
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

PieceMinimum findRoundFeature(Difference& c, const Vec3& last) {
  PieceMinimum out = lookAtFlat(c, last, true);
  if (!out.holds) out = lookAtFlat(c, last, false);
  if (!out.holds) out = lookAtSides(c, last);
  return out;
}

}  // namespace granular
