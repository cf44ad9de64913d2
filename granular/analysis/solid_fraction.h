// Solid fractions of a bed by region (S appendix A, figure 12).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "granular/analysis/filling_height.h"

namespace granular {

/// Between which heights (m above the floor) and distances from the side wall (m) each region lies.
struct Regions {
  double unit = 0, length = 0;     ///< unit length; longest length, m
  double from = 0, to = 0;         ///< heights of core and near-wall region
  double nearWall = 0;             ///< the near-wall region ends here
  double core = 0;                 ///< the core begins here
  bool hasCore = false;            ///< false: bed too low or vessel too narrow
  bool walled = false;             ///< false: no side wall, no near-wall region
  std::vector<std::string> notes;  ///< why something is missing
};

/// Lays the regions out for a bed of the given height: margins of coreLengths, a near-wall layer of nearWallLengths.
Regions layOutRegions(const CrossSection& section, double height, double unit, double length, double coreLengths,
                      double nearWallLengths);

struct SolidFractions {
  std::optional<double> overall;  ///< volume of all particles / section area times filling height (S appendix A)
  std::optional<double>
      below;  ///< solid volume below the filling height (particles that cross it cut) / the same volume
  std::optional<double>
      sampled;  ///< mean of the point sampling from the floor to the filling height (overlaps counted once)
  std::optional<double> nearWall;  ///< of the near-wall region
  std::optional<double> core;      ///< of the core
};

/// Volume of the particles below a height in world coordinates, m^3; those that cross it are cut by a grid of points.
double measureVolumeBelow(const Bed& bed, double height);

SolidFractions measureSolidFractions(const Bed& bed, const CrossSection& section, const RingSamples& samples,
                                     const FillingHeight& filling, const Regions& regions);

}  // namespace granular
