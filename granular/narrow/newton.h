// Newton's method on the unit normal n, for a pair whose last normal is known. Each body is taken for the piece of its
// surface that supported it last (support_piece.h). While the two pieces stay in support, the depth h(n) = n . w has
// the gradient w = a - b, the difference of the support points, and on the unit sphere the slope P w, P = 1 - n n^T,
// and the Hessian P (H_A'' + H_B'') P - h. A line (edge, generator) keeps n on a circle n . c = level, where h has a
// kink: its minimum lies there if a point between the line's ends takes the slope across the circle away. So
//   * no line: Newton in the tangent plane; both points must bend enough (rim and rim, ellipsoid and anything);
//   * one line: Newton along the circle (rim, side or vertex against an edge or a side);
//   * two lines: the circles' intersection, closed form; C has a flat parallelogram there;
//   * a face: its normal, and the other body's deepest point.
// Two to three evaluations reach round-off. The answer is then checked by the true supports; where a line's end or
// another line takes over, the pieces are changed and the solution repeated (an active set method). What remains to be
// proven is that the minimum is the global one (global_proof.h).
#pragma once

#include "granular/narrow/descent.h"
#include "granular/narrow/support_piece.h"

namespace granular {

/// A step longer than this (radians) leaves the neighbourhood of the last normal.
inline constexpr double longestNewtonStep = 0.2;

/// A step shorter than this (radians) leaves an error of its square.
inline constexpr double lastNewtonStep = 1e-8;

/// How far rounding may leave the slope from 0, in units of the largest length that enters a support point; where the
/// surface is flat, its radius of curvature takes the place of that length.
inline constexpr double slopeOfRoundOff = 1e3 * 4 * std::numeric_limits<double>::epsilon();

/// The largest radius of curvature, in the same units, that does: the depth is then off by the slope's square over
/// twice the radius, which stays below round-off up to here.
inline constexpr double flattestPiece = 1e8;

/// A cap that lies this nearly flat (radians) on a line begins from a direction of its own.
inline constexpr double flatCap = 0.03;

/// A local minimum of the depth and the pieces that make it.
struct PieceMinimum {
  bool holds = false;
  PieceName a, b;
  LocalMinimum minimum;  ///< A's body axes
  double margin = 0;     ///< distance of the origin's foot from the rim of C's flat facet, m; 0 on curved ones
};

/// Looks for the minimum next to the direction `last` (unit, A's body axes) that the two pieces make, or the ones that
/// take over from them. Does not hold where any of this fails.
PieceMinimum findPieceMinimum(Difference& c, const PieceName& a, const PieceName& b, const Vec3& last);

/// A's flat face and B's deepest point above it, or B's face and A's.
PieceMinimum checkFlatFace(Difference& c, const PieceName& face, bool ofA);

}  // namespace granular
