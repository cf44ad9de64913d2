// An ellipsoid of revolution as a chain of spheres on its axis: the adaptive construction of M section 2 (M: Markauskas
// et al., Granular Matter 12, 107, 2010).
#pragma once

#include <vector>

#include "granular/shape/sphere_union.h"

namespace granular {

/// `count` spheres on the x axis about the origin, from -x to +x, in place of the ellipsoid of semi-axes a along x and
/// b < a across, m. Five or more lie inside and touch it from within; three (M's special case) are the ball of radius b
/// and two beside it that reach to the tips: they touch the ball in a point and stand out of the ellipsoid. Throws
/// InputError unless a > b > 0 are finite and count is odd and at least 3, and where neighbours would not overlap: then
/// the smallest count that works is named.
std::vector<ChildSphere> makeEllipsoidChain(double a, double b, int count);

/// The smallest odd count from 5 on whose neighbours overlap. a > b > 0.
int smallestChain(double a, double b);

/// A chain against the ellipsoid it stands for, each as a ratio chain / ellipsoid.
struct ChainQuality {
  double area = 0;                 ///< of the section through the axis (M 9, fig. 5a)
  double perimeter = 0;            ///< of that section (M fig. 5b)
  double volume = 0;               ///< M 10
  double areaFactor() const;       ///< sf_A of M 26
  double perimeterFactor() const;  ///< sf_P of M 27
};
/// chain: as makeEllipsoidChain gives it, neighbours touching or overlapping and nobody else.
ChainQuality measureChain(const std::vector<ChildSphere>& chain, double a, double b);

}  // namespace granular
