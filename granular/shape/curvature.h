// How strongly surfaces curve where they touch, for laws whose stiffness depends on it (Hertz).
//
// The curvature of a surface is the symmetric matrix S that maps a step along it to the turn of its outward normal; in
// the tangent plane its eigenvalues are the principal curvatures, positive where the body is round. For the
// ellipsoid x.D^-2 x = 1 with the outward unit normal n it is h D^-2 in that plane, h = |D n| the height of the
// plane. Two surfaces that touch part as 1/2 s.(S_A + S_B) s: the principal curvatures l1, l2 of the sum are
// Hertz's 2 A and 2 B, and the effective radius is R = 1/(2 sqrt(A B)) = 1/sqrt(l1 l2) (Markauskas et al. 2010, 19).
//
// Bodies with faces, edges or vertices have no such matrix everywhere, and a contact that went from face to edge would
// change its stiffness at a blow. Convention: cuboids, polyhedra, cylinders, cones and users' shapes count all over as
// the sphere of equal volume. Smooth bodies are exact, and walls are: flat, or hollow with the vessel's radius.
#pragma once

#include "granular/core/placed_axes.h"
#include "granular/shape/shape.h"

namespace granular {

/// The curvature in a tangent plane with unit axes u and v = n x u, 1/m; of one surface, or of many side by side
/// (core/wide.h).
template <class Real>
struct CurvatureIn {
  Real uu{}, vv{}, uv{};
  CurvatureIn operator+(const CurvatureIn& other) const { return {uu + other.uu, vv + other.vv, uv + other.uv}; }
};
using Curvature = CurvatureIn<double>;

/// An ellipsoid's, where its outward unit normal is n or -n; u: unit, perpendicular to n; body axes.
template <class Real>
CurvatureIn<Real> curvatureOfEllipsoid(const Triple<Real>& semiAxes, const Triple<Real>& n, const Triple<Real>& u) {
  const Real height = semiAxes.times(n).norm();
  const Triple<Real> inverse{1 / semiAxes.x, 1 / semiAxes.y, 1 / semiAxes.z};
  const Triple<Real> first = inverse.times(u), second = inverse.times(n.cross(u));
  return {height * first.dot(first), height * second.dot(second), height * first.dot(second)};
}

template <class Real>
struct PlacedEllipsoid {
  PlacedAxes<Real> axes;
  Triple<Real> semiAxes;
};

/// The sum of two ellipsoids' curvatures across the unit normal n, world axes.
template <class Real>
CurvatureIn<Real> curvatureBetween(const PlacedEllipsoid<Real>& a, const PlacedEllipsoid<Real>& b,
                                   const Triple<Real>& n) {
  const Triple<Real> u = tangentOf(n);
  return curvatureOfEllipsoid(a.semiAxes, a.axes.unrotate(n), a.axes.unrotate(u)) +
         curvatureOfEllipsoid(b.semiAxes, b.axes.unrotate(n), b.axes.unrotate(u));
}

/// True where both principal curvatures are at least 1/flattest, nearly always: then effectiveRadius is 1/sqrt of the
/// product, which is the determinant.
template <class Real>
Mask<Real> isRound(const CurvatureIn<Real>& sum, const Real& flattest) {
  const Real least = 1 / flattest, uu = sum.uu - least, vv = sum.vv - least;
  return both(uu > Real{}, uu * vv >= sum.uv * sum.uv);
}
template <class Real>
Real radiusOfRound(const CurvatureIn<Real>& sum) {
  return 1 / squareRoot(Real(sum.uu * sum.vv - sum.uv * sum.uv));
}

/// A ball's: the same in all directions.
inline Curvature ballCurvature(double radius) { return {1 / radius, 1 / radius, 0}; }

/// The curvature of a shape where its outward unit normal is n; u: unit, perpendicular to n; body axes. No clumps: ask
/// their children.
Curvature curvatureOf(const Shape& shape, const Vec3& n, const Vec3& u);

/// R of the sum of two curvatures, m. flattest: no principal radius of the sum counts as larger than this, m; a hollow
/// wall as round as the body, or rounder, would otherwise have none.
double effectiveRadius(const Curvature& sum, double flattest);

/// The largest effective radius of a shape on a plane, m; of a clump, of any child.
double largestRadius(const Shape& shape);

}  // namespace granular
