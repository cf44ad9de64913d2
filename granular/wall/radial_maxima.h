// Where an ellipse is furthest from the origin of its plane: the points at which a rim or the silhouette of an
// ellipsoid touches a vessel from inside.
//
// Ellipse y(t) = (c1 + s1 cos t, c2 + s2 sin t), s1 >= s2 >= 0, origin on the vessel's axis. With A = c1 s1, B = c2 s2,
// D = s1^2 - s2^2 half the derivative of |y|^2 is g(t) = -A sin t + B cos t - D sin t cos t.
//  * In the quadrant of the signs of A and B, g / (sin t cos t) falls strictly: one root, the largest distance.
//  * A second maximum exists exactly inside the evolute, |A|^(2/3) + |B|^(2/3) < |D|^(2/3), on the other side of the
//  minor
//    axis: the quadrant (-A, B), between the end of the major axis and tan^3 s = B/A; a minimum lies beyond that angle.
// So there are never more than two.
#pragma once

#include "granular/core/math.h"

namespace granular {

struct RadialMaxima {
  int count = 0;       ///< 1 or 2; the first is the furthest
  Vec2 angle[2];       ///< (cos t, sin t) of each
  double distance[2];  ///< |y| of each, m
  double between = 0;  ///< least |y| on the arc that joins the two; equal to distance[1] where the second is born, m
};

/// All local maxima of |y|. c1, c2: centre; s1 >= s2 >= 0: semi-axes, m.
RadialMaxima findRadialMaxima(double c1, double c2, double s1, double s2);

}  // namespace granular
