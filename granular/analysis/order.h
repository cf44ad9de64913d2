// Orientational order (S appendix B): how the particles' directors lie to the side wall and to the vertical.
// S2 = <3 c^2 - 1>/2 and S4 = <35 c^4 - 30 c^2 + 3>/8 with c = director . axis: 1 and 1 for parallel, -1/2 and 3/8 for
// perpendicular, 0 and 0 for isotropic directors.
#pragma once

#include <functional>

#include "granular/analysis/solid_fraction.h"
#include "granular/analysis/table.h"

namespace granular {

/// A particle as the order parameters see it.
struct Director {
  Vec3 direction;   ///< unit, world axes; its sign has no meaning; zero for a sphere, which has none
  Vec3 radial;      ///< unit, towards the side wall; zero on the axis or without a wall
  Vec3 tangential;  ///< unit, azimuthal: vertical x radial
  double distance;  ///< of the centre from the side wall, m
  double height;    ///< of the centre above the floor, m
};

/// Mean and standard error (as if independent) of S2 and S4; NaN for no particles.
struct Order {
  std::size_t count = 0;
  double s2 = 0, s4 = 0;
  double s2Error = 0, s4Error = 0;
};

/// One per particle, in order.
std::vector<Director> collectDirectors(const Bed& bed, const CrossSection& section, double floor);

/// Order of the directors against an axis of their own, over those that keep() accepts. Directors whose axis is zero
/// are left out.
Order measureOrder(const std::vector<Director>& directors, const std::function<Vec3(const Director&)>& axis,
                   const std::function<bool(const Director&)>& keep);

/// Largest eigenvalue of Q = <3 u u^T - 1>/2 over all directors: the nematic order about whatever axis is common; NaN
/// without directors.
double measureNematicOrder(const std::vector<Director>& directors);

/// S2_r, S4_r and S2_z per annular bin (S eq. B.1), over all particles; bins of the given thickness, m.
Table tabulateRadialOrder(const std::vector<Director>& directors, const Regions& regions, double depth, double bin);
/// The same for all particles from the side wall to a distance from it.
Table tabulateCumulativeOrder(const std::vector<Director>& directors, const Regions& regions, double depth, double bin);
/// S2_alpha, S4_alpha (S eq. B.2) for alpha of 0 to 90 degrees from azimuthal to vertical: near the wall, core, all.
Table tabulatePlaneOrder(const std::vector<Director>& directors, const Regions& regions, double stepDegrees);

}  // namespace granular
