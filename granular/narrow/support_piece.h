// The piece of a body's surface that supports it around a direction, by name: a point, the rim of a cap, a straight
// line that lies across the normal (an edge, a generator of a cylinder or a cone), an ellipsoid, a flat face. Along the
// directions that keep the piece in support its support function is smooth, with first and second derivatives in closed
// form; a line holds only directions on a circle, n . axis = level, where its two ends tie.
#pragma once

#include "granular/narrow/difference.h"

namespace granular {

/// Name of a piece: a kind and, by kind, the index of a vertex, an edge or a face, or 0 and 1 for the upper and the
/// lower cap (z of the body). `unknown`: a shape or a direction that has no piece here.
struct PieceName {
  enum Kind : std::int32_t { unknown, point, rim, quadric, edge, side, slope, face };
  std::int32_t kind = unknown;
  std::int32_t index = 0;

  bool operator==(const PieceName&) const = default;
};

/// A name as one number, 0 for unknown, for the pair's cache.
inline std::int32_t encode(const PieceName& name) { return name.kind << 24 | name.index; }
inline PieceName decodePiece(std::int32_t code) { return {code >> 24, code & 0xffffff}; }

/// The geometry of a piece other than a face, body axes, m.
struct Piece {
  /// An end of a line: a fixed point, or the point of a circle about z in the direction's azimuth.
  struct End {
    Vec3 middle = Vec3::Zero();
    double radius = 0;
  };
  PieceName name;
  bool bound = false;            ///< to n . axis = level
  Vec3 axis = Vec3::UnitZ();     ///< unit
  double level = 0;              ///< cosine
  End first, second;             ///< second: of lines only
  Vec3 semiAxes = Vec3::Zero();  ///< of an ellipsoid
};

/// A piece looked at along a direction, body axes.
struct PieceView {
  Vec3 point;                       ///< support point; of a line the first end
  double azimuthX, azimuthY, bend;  ///< of a circle: unit vector across z, radius over the direction's part across z
  double height;                    ///< of an ellipsoid: support function

  PieceView(const Piece& piece, const Vec3& n);
  /// Second derivative of the support function along p and q.
  double second(const Piece& piece, const Vec3& p, const Vec3& q) const;
};

/// The other end of a line along n.
Vec3 secondEnd(const Piece& piece, const PieceView& view);

/// Looks the geometry of a piece up. A name that the shape lacks gives `unknown`.
Piece makePiece(const Shape& shape, const PieceName& name);

/// The line between a piece that supports n and the vertex (of polyhedra) or the end that beats it there; unknown if
/// there is none.
PieceName joinPieces(const Shape& shape, const PieceName& present, std::int32_t vertex);

/// The end of a line, its first or its second, as a piece of its own.
PieceName endOf(const Shape& shape, const PieceName& line, bool second);

/// The k-th piece of a face's rim: the circle of a cap (k = 0), an edge of a polygon; unknown beyond the last.
PieceName rimOf(const Shape& shape, const PieceName& face, std::int32_t k);

/// A vertex of a polyhedron's piece, where a search of its support may begin; -1 for other shapes.
std::int32_t vertexOf(const Shape& shape, const PieceName& name);

/// The piece that supports the unit direction n: a face or a line where n is that near to one (radians).
PieceName namePiece(const Shape& shape, const Vec3& n, double nearness);

}  // namespace granular
