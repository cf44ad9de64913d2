// Volume, inertia and surface measures of a solid of unit density, and how they follow from a closed triangle mesh:
// the sum of the signed tetrahedra between a reference point and every triangle (divergence theorem), the mean over the
// surface in closed form per triangle. Principal axes are chosen so that a body given along its principal axes is not
// turned.
#pragma once

#include <array>
#include <span>

#include "granular/core/math.h"

namespace granular {

/// In body axes: origin at the centre of mass, axes along the principal axes. Density 1 kg/m^3: a body of density rho
/// has mass rho * volume and principal inertia rho * inertia.
struct MassProperties {
  double volume = 0;            ///< m^3
  double area = 0;              ///< m^2
  Vec3 inertia = Vec3::Zero();  ///< principal moments per density, m^5
  double meanSquareRadius =
      0;  ///< <r^2>: mean over the surface of the squared distance from the centre of mass, m^2 (S 13)
};

/// A solid's mass properties, and where its body frame lies in the coordinates it was given in.
struct SolidProperties {
  MassProperties principal;
  Vec3 centroid = Vec3::Zero();  ///< centre of mass, input coordinates, m
  Mat3 axes = Mat3::Identity();  ///< columns: principal axes in input coordinates, a proper rotation
  Mat3 inertia = Mat3::Zero();   ///< full tensor per density about the centroid along the input axes, m^5
  /// Body to input coordinates: input point = frame().toWorld(body point).
  Frame frame() const { return Frame(axes, centroid); }
};

/// Principal moments and axes of a symmetric tensor.
struct PrincipalAxes {
  Vec3 moments = Vec3::Zero();  ///< moments[k] belongs to column k of axes
  Mat3 axes = Mat3::Identity();
};

/// Diagonalises a symmetric inertia tensor. Of all right-handed orders and signs of the axes, the one nearest to the
/// identity; axes of equal moments (tolerance::equalMoments) are turned as little as possible. Deterministic.
PrincipalAxes principalAxes(const Mat3& inertia);

/// Volume enclosed by a closed mesh, m^3; negative when the triangles are clockwise seen from outside.
double signedVolume(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles);

/// Area of all triangles, m^2.
double surfaceArea(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles);

/// All mass properties of a closed mesh, triangles counter-clockwise seen from outside. Throws InputError unless the
/// volume is positive and finite.
SolidProperties solidProperties(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> triangles);

}  // namespace granular
