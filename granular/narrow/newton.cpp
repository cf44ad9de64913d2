#include "granular/narrow/newton.h"

#include <algorithm>

#include "granular/narrow/polyhedron_features.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"

namespace granular {
namespace {

/// Steps to convergence, and pieces tried, before the search is left to others.
constexpr int maxSteps = 8, maxPieces = 4;

/// Sine of the angle between two lines below which they have no common normal to speak of.
constexpr double leastSine = 1e-7;

struct Pieces {
  Piece a, b;
};

/// The two pieces along n, A's axes.
struct Look {
  PieceView a, b;
  Vec3 w;

  Look(const Pieces& pieces, const Frame& frame, const Vec3& n)
      : a(pieces.a, n), b(pieces.b, -frame.unrotate(n)), w(a.point - frame.toWorld(b.point)) {}
};

/// A tangent of the sphere in both bodies' axes.
struct Tangent {
  Vec3 inA, inB;
  Tangent(const Frame& frame, const Vec3& t) : inA(t), inB(frame.unrotate(t)) {}
};

double second(const Pieces& pieces, const Look& look, const Tangent& p, const Tangent& q) {
  return look.a.second(pieces.a, p.inA, q.inA) + look.b.second(pieces.b, p.inB, q.inB);
}

/// No line: Newton in the tangent plane.
bool solveFree(const Pieces& pieces, const Frame& frame, Vec3& n) {
  for (int k = 0; k < maxSteps; ++k) {
    const Look look(pieces, frame, n);
    const Vec3 u = perpendicular(n), v = n.cross(u);
    const Tangent tu(frame, u), tv(frame, v);
    const double depth = look.w.dot(n), gu = look.w.dot(u), gv = look.w.dot(v);
    const double uu = second(pieces, look, tu, tu) - depth, vv = second(pieces, look, tv, tv) - depth;
    const double uv = second(pieces, look, tu, tv);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 0) || !(uu > 0)) return false;
    const Vec3 step = ((uv * gv - vv * gu) / determinant) * u + ((uv * gu - uu * gv) / determinant) * v;
    const double length2 = step.squaredNorm();
    if (!(length2 < longestNewtonStep * longestNewtonStep)) return false;
    n = (n + step).normalized();
    if (length2 < lastNewtonStep * lastNewtonStep) return true;
  }
  return false;
}

/// Where a cap lies nearly flat on a line, its rim turns a quarter round while n tilts by their angle: no last normal
/// is near enough. With p the cap's normal laid across the line, t across both, n = p + s t and sigma the sine of the
/// angle, the rim adds R sqrt(s^2 + sigma^2) to h, the rest is -q s but for the depth's share; so s = sigma q /
/// sqrt(R^2 - q^2) at the minimum. n receives this direction where it is that near to the cap's normal.
void startOnFlatCap(const Pieces& pieces, const Frame& frame, const Vec3& axis, Vec3& n) {
  const bool rimOfA = pieces.a.name.kind == PieceName::rim;
  const Piece &rim = rimOfA ? pieces.a : pieces.b, &line = rimOfA ? pieces.b : pieces.a;
  if (rim.name.kind != PieceName::rim) return;
  Vec3 cap = rimOfA ? Vec3(Vec3::UnitZ()) : Vec3(frame.R.col(2));
  if (cap.dot(n) < 0) cap = -cap;
  const double sigma = cap.dot(axis);
  if (!(cap.dot(n) > 1 - 0.5 * flatCap * flatCap) || !(std::abs(sigma) < flatCap)) return;

  const Vec3 across = (cap - sigma * axis).normalized(), side = across.cross(axis);
  const Vec3 centre = rimOfA ? rim.first.middle : frame.toWorld(rim.first.middle);
  const Vec3 onLine = rimOfA ? frame.toWorld(line.first.middle) : line.first.middle;
  const double q = (rimOfA ? 1 : -1) * side.dot(onLine - centre), radius = rim.first.radius;
  if (!(std::abs(q) < radius)) return;
  n = (across + std::abs(sigma) * q / std::sqrt((radius - q) * (radius + q)) * side).normalized();
}

/// One line: Newton along the circle n . axis = level.
bool solveOnCircle(const Pieces& pieces, const Frame& frame, const Vec3& axis, double level, Vec3& n) {
  if (level == 0) startOnFlatCap(pieces, frame, axis, n);
  const double radius = std::sqrt(1 - level * level);
  Vec3 out = n - n.dot(axis) * axis;
  const double across = out.norm();
  if (!(std::abs(n.dot(axis) - level) < longestNewtonStep) || !(across > longestNewtonStep * radius)) return false;
  out *= radius / across;
  for (int k = 0; k < maxSteps; ++k) {
    n = level * axis + out;
    const Look look(pieces, frame, n);
    const Vec3 along = axis.cross(out);
    const Tangent t(frame, along);
    const double slope = look.w.dot(along);
    const double bend = second(pieces, look, t, t) - look.w.dot(out);
    if (!(bend > 0)) return false;
    const double turn = -slope / bend;
    if (!(std::abs(turn) < longestNewtonStep)) return false;
    out += turn * along;
    out *= radius / out.norm();
    n = level * axis + out;
    if (std::abs(turn) < lastNewtonStep) return true;
  }
  return false;
}

/// Two lines: where their circles meet next to n.
bool solveOnCircles(const Vec3& p, double levelP, const Vec3& q, double levelQ, Vec3& n) {
  const Vec3 across = p.cross(q);
  const double sine2 = across.squaredNorm();
  if (!(sine2 > leastSine * leastSine)) return false;
  Vec3 base = Vec3::Zero();
  if (levelP != 0 || levelQ != 0) {
    const double cosine = p.dot(q);
    base = ((levelP - cosine * levelQ) / sine2) * p + ((levelQ - cosine * levelP) / sine2) * q;
  }
  const double rest = (1 - base.squaredNorm()) / sine2;
  if (!(rest > 0)) return false;
  const Vec3 found = (base + (n.dot(across) < 0 ? -std::sqrt(rest) : std::sqrt(rest)) * across).normalized();
  if (!((found - n).squaredNorm() < longestNewtonStep * longestNewtonStep)) return false;
  n = found;
  return true;
}

bool solve(const Pieces& pieces, const Frame& frame, Vec3& n) {
  if (!pieces.a.bound && !pieces.b.bound) return solveFree(pieces, frame, n);
  if (!pieces.b.bound) return solveOnCircle(pieces, frame, pieces.a.axis, pieces.a.level, n);
  const Vec3 axisB = -frame.rotate(pieces.b.axis);
  if (!pieces.a.bound) return solveOnCircle(pieces, frame, axisB, pieces.b.level, n);
  return solveOnCircles(pieces.a.axis, pieces.a.level, axisB, pieces.b.level, n);
}

/// The origin's foot among the lines' points: fractions of each line from its first end, and what slope is left over.
struct Foot {
  double a = 0, b = 0;
  Vec3 left;
  double margin = 0;
};

/// lineA, lineB: the lines of C, projected across n; slope: that of their first ends.
Foot findFoot(const Pieces& pieces, const Vec3& slope, const Vec3& lineA, const Vec3& lineB) {
  Foot foot;
  const double aa = lineA.squaredNorm(), bb = lineB.squaredNorm();
  if (pieces.a.bound && pieces.b.bound) {
    const double ab = lineA.dot(lineB), area2 = aa * bb - ab * ab;
    const double ga = slope.dot(lineA), gb = slope.dot(lineB);
    foot.a = (gb * ab - ga * bb) / area2;
    foot.b = (ga * ab - gb * aa) / area2;
    const double insideA = std::min(foot.a, 1 - foot.a) / std::sqrt(bb);
    const double insideB = std::min(foot.b, 1 - foot.b) / std::sqrt(aa);
    foot.margin = std::min(insideA, insideB) * std::sqrt(area2);
  } else if (pieces.a.bound) {
    foot.a = -slope.dot(lineA) / aa;
  } else if (pieces.b.bound) {
    foot.b = -slope.dot(lineB) / bb;
  }
  foot.left = slope + foot.a * lineA + foot.b * lineB;
  return foot;
}

/// True if what is left of the slope is no more than rounding explains.
bool isStationary(const Pieces& pieces, const Look& look, const Frame& frame, const Vec3& left, double extent) {
  const double length = left.norm();
  if (length <= slopeOfRoundOff * extent) return true;
  const Tangent t(frame, left / length);
  const double bend = second(pieces, look, t, t);
  return bend < flattestPiece * extent && length <= slopeOfRoundOff * bend;
}

double outside(double fraction) { return std::max(-fraction, fraction - 1); }

/// Puts the end of a line in its place where the foot lies beyond it. True if one had to go.
bool leaveLine(const Difference& c, const Foot& foot, Pieces& pieces) {
  const double beyondA = outside(foot.a), beyondB = outside(foot.b);
  if (!(std::max(beyondA, beyondB) > 0)) return false;
  const bool ofA = beyondA >= beyondB;
  const Shape& shape = ofA ? c.shapeA() : c.shapeB();
  Piece& piece = ofA ? pieces.a : pieces.b;
  piece = makePiece(shape, endOf(shape, piece.name, (ofA ? foot.a : foot.b) > 1));
  return true;
}

/// Joins the piece that is beaten along n by the true support p to what beats it.
void joinLine(const Difference& c, const Look& look, const SupportPoint& p, const Vec3& n, Pieces& pieces) {
  const double beatenA = (p.a - look.a.point).dot(n), beatenB = (c.frame().toWorld(look.b.point) - p.b).dot(n);
  if (beatenA >= beatenB) {
    pieces.a = makePiece(c.shapeA(), joinPieces(c.shapeA(), pieces.a.name, p.vertexA));
  } else {
    pieces.b = makePiece(c.shapeB(), joinPieces(c.shapeB(), pieces.b.name, p.vertexB));
  }
}

/// The plane of a flat face, body axes, and the distance of a point above it from its rim, positive inside.
struct FlatFace {
  Vec3 normal;
  double offset;
};

FlatFace flatFaceOf(const Shape& shape, const PieceName& face) {
  const double sign = face.index ? -1 : 1;
  switch (shape.kind()) {
    case ShapeKind::cylinder:
      return {{0, 0, sign}, static_cast<const Cylinder&>(shape).halfHeight()};
    case ShapeKind::cone:
      return {{0, 0, -1}, -static_cast<const Cone&>(shape).baseZ()};
    default: {
      const PolyhedronTables& t = static_cast<const Polyhedron&>(shape).tables();
      return {t.faces[static_cast<std::size_t>(face.index)].normal,
              t.faces[static_cast<std::size_t>(face.index)].offset};
    }
  }
}

double marginOn(const Shape& shape, const PieceName& face, const Vec3& p) {
  const double across = std::sqrt(p.x() * p.x() + p.y() * p.y());
  switch (shape.kind()) {
    case ShapeKind::cylinder:
      return static_cast<const Cylinder&>(shape).radius() - across;
    case ShapeKind::cone:
      return static_cast<const Cone&>(shape).radius() - across;
    default:
      return faceMargin(static_cast<const Polyhedron&>(shape).tables(), face.index, p);
  }
}

}  // namespace

PieceMinimum checkFlatFace(Difference& c, const PieceName& name, bool ofA) {
  const Frame& frame = c.frame();
  const Shape& shape = ofA ? c.shapeA() : c.shapeB();
  const FlatFace face = flatFaceOf(shape, name);
  const Vec3 n = ofA ? face.normal : Vec3(-frame.rotate(face.normal));
  const SupportPoint deepest = c.support(n);
  const Vec3 p = ofA ? deepest.b : frame.toBody(deepest.a);
  const double depth = face.offset - face.normal.dot(p);

  PieceMinimum out;
  const std::int32_t vertex = ofA ? deepest.vertexB : deepest.vertexA;
  const Vec3 inwards = ofA ? Vec3(-frame.unrotate(n)) : n;
  const PieceName other =
      vertex >= 0 ? PieceName{PieceName::point, vertex} : namePiece(ofA ? c.shapeB() : c.shapeA(), inwards, 0);
  out.a = ofA ? name : other;
  out.b = ofA ? other : name;
  out.margin = marginOn(shape, name, p);
  out.holds = out.margin > 0;
  const Vec3 onA = ofA ? Vec3(deepest.b + depth * n) : deepest.a;
  out.minimum = {n, depth, onA, onA - depth * n};
  return out;
}

PieceMinimum findPieceMinimum(Difference& c, const PieceName& a, const PieceName& b, const Vec3& last) {
  PieceMinimum out;
  if (a.kind == PieceName::face || b.kind == PieceName::face) {
    const bool ofA = a.kind == PieceName::face;
    return checkFlatFace(c, ofA ? a : b, ofA);
  }

  const Frame& frame = c.frame();
  const double roundOff = 4 * std::numeric_limits<double>::epsilon() * c.extent();
  Pieces pieces{makePiece(c.shapeA(), a), makePiece(c.shapeB(), b)};
  Vec3 n = last;
  for (int attempt = 0; attempt < maxPieces; ++attempt) {
    if (pieces.a.name.kind == PieceName::unknown || pieces.b.name.kind == PieceName::unknown) return out;
    if (!solve(pieces, frame, n)) return out;

    // The lines' share of the slope.
    const Look look(pieces, frame, n);
    Vec3 lineA = Vec3::Zero(), lineB = Vec3::Zero();
    if (pieces.a.bound) lineA = secondEnd(pieces.a, look.a) - look.a.point;
    if (pieces.b.bound) lineB = frame.rotate(look.b.point - secondEnd(pieces.b, look.b));
    const double pieceDepth = look.w.dot(n);
    const Foot foot = findFoot(pieces, look.w - pieceDepth * n, lineA - lineA.dot(n) * n, lineB - lineB.dot(n) * n);
    if (leaveLine(c, foot, pieces)) continue;

    // Do the pieces support the bodies?
    const SupportPoint p = c.support(n);
    const double depth = p.w.dot(n);
    if (depth > pieceDepth + roundOff) {
      joinLine(c, look, p, n, pieces);
      continue;
    }
    if (!isStationary(pieces, look, frame, foot.left, c.extent())) return out;

    const Vec3 onA = look.a.point + foot.a * lineA;
    const Vec3 middle = 0.5 * (onA + frame.toWorld(look.b.point) - foot.b * lineB);
    out.holds = true;
    out.a = pieces.a.name;
    out.b = pieces.b.name;
    out.minimum = {n, depth, middle + 0.5 * depth * n, middle - 0.5 * depth * n};
    out.margin = foot.margin;
    return out;
  }
  return out;
}

}  // namespace granular
