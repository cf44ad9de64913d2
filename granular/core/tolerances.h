// Every tolerance of the project, with its unit and its reason.
#pragma once

namespace granular::tolerance {

/// Relative to the pair's size: two depths closer than this are a tie, and either normal is right. Double precision
/// leaves about 1e-15 of the size in a support difference; a few hundred operations may pile up.
inline constexpr double tie = 1e-12;

/// Relative to the pair's size: largest gap between the upper and the lower bound of a certified overlap.
inline constexpr double certificate = 1e-9;

/// Relative to the overlap: what is left between the bounds where a whole circle of directions has the same least depth
/// (tips or rims on a common axis). The lower bound is then a polytope of 256 corners in a cone, half of them spent on
/// the circle: 1 - cos(pi/128) = 3e-4. Any direction of the circle is right to this part of the force.
inline constexpr double coaxialCertificate = 4e-4;

/// Relative to the size: beyond this overlap bodies are around each other's centre, and no force law holds.
inline constexpr double deepOverlap = 0.25;

/// Relative to the overlap, beyond deepOverlap: nearly concentric bodies have the same depth all around, and a polytope
/// of 512 facets inscribed in a ball leaves 1 %.
inline constexpr double deepCertificate = 0.02;

/// Relative to the largest principal moment: moments closer than this are equal, and the principal axes stay as near to
/// the axes given as they can. Neglects products of inertia below this; rounding of a mesh's moments is about 1e-14.
inline constexpr double equalMoments = 1e-11;

/// Relative to the largest extent of a set of points: a set thinner than this is flat, a point that stands out of the
/// hull of the others by less is no vertex, and hull faces that are flat to this are made planar. Single-precision mesh
/// files round coordinates to 6e-8; a few such errors add up. (For a particle of 5 mm: 2 nm.)
inline constexpr double hullWidth = 4e-7;

/// Relative to the largest extent: how far a hull vertex may lie above the plane of a hull face. The normal of a face
/// of width w is known to eps/w, 5e-10 for the narrowest.
inline constexpr double hullConvexity = 2e-9;

/// Relative to the bounding radius: a point this far outside still counts as on the surface. Covers the rounding of a
/// support point (a few eps), nothing else.
inline constexpr double onSurface = 1e-14;

/// Relative to the hull's volume: a closed mesh that encloses less is folded paper. Single-precision coordinates leave
/// up to about 1e-7 in each direction.
inline constexpr double zeroVolume = 1e-6;

/// Relative to the largest coordinate: triangles of a wall mesh whose corners leave a plane by no more lie in one
/// facet. Files hold single precision, 6e-8 per coordinate; three corners and the tilt of the plane through them add up
/// to some 4e-7.
inline constexpr double coplanar = 1e-6;

/// Relative to the smaller body's size: the largest principal radius that two surfaces have together for Hertz's law.
/// Only where they follow each other it is more, and Hertz's contact would be wider than the bodies. An ellipsoid of
/// revolution on a plane reaches it at 1:1:1/32.
inline constexpr double flattest = 100;

}  // namespace granular::tolerance
