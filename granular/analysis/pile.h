// Piles: the slope of a heap by least squares through its middle (Markauskas et al. 2010, fig. 9b), and the porosity of
// a heap in a plane.
//
// The paper fits a line to the middle of the surface, without the tails near the top and the bottom, and relates the
// particles' section areas to "the total area of the pile"; where the middle begins and the pile ends it does not say.
// Here the surface is the height of the highest particle above each place, H its largest value, and the pile's area is
// that under the surface: whatever lies under a particle, and nothing else. The middle is the stretch from where the
// surface is last above `high` H to where it is first below `low` H; or, of the base from the wall to the first place
// with nothing above it, the stretch between the parts 1 - `high` and 1 - `low`. The former is the slope of the heap
// alone, the latter counts the layer of grains at its foot.
#pragma once

#include <optional>
#include <vector>

#include "granular/analysis/bed.h"

namespace granular {

struct PileOptions {
  double low = 0.2, high = 0.8;  ///< of the largest height, or of the base: the middle of the slope
  bool ofBase = false;
  double spacing = 0;  ///< of the sampled places, m; 0: a twentieth of the mean equal-volume radius
  int sectors = 72;    ///< of a cone
};

/// A place of the surface: distance from the side or the axis, and height there, m.
struct SurfacePoint {
  double distance, height;
};

/// height = top - slope distance, between two distances.
struct SlopeLine {
  double angle = 0;          ///< of repose, degrees
  double top = 0;            ///< at distance 0, m
  double from = 0, to = 0;   ///< the middle of the slope, m
  double height = 0;         ///< H, m
  double deviation = 0;      ///< of the surface from the line, root mean square, m
  double standardError = 0;  ///< of the angle from the scatter about the line, neighbours within a particle's length
                             ///< taken for one, degrees
};

/// The surface of a pile beside the plane x = 0, in the plane y = 0, from x = 0 to the last particle.
std::vector<SurfacePoint> sampleSide(const Bed& bed, double spacing);
/// The surface of a cone about the z axis: the mean over sectors of the height at each distance from it.
std::vector<SurfacePoint> sampleCone(const Bed& bed, double spacing, int sectors);

/// Least squares through the middle. Empty for fewer than three places in it. grain: a particle's length, m.
std::optional<SlopeLine> fitSlope(const std::vector<SurfacePoint>& surface, const PileOptions& options, double grain);

/// A pile in the plane y = 0 beside x = 0.
struct PlanePorosity {
  double pileArea = 0;     ///< under the surface, m^2
  double sectionArea = 0;  ///< of all particles' sections together, m^2: overlaps of neighbours count twice
  double porosity = 0;     ///< 1 - sectionArea/pileArea
};
PlanePorosity measurePorosity(const Bed& bed, const std::vector<SurfacePoint>& surface);

/// The spacing that PileOptions::spacing = 0 means, m.
double defaultSpacing(const Bed& bed);

}  // namespace granular
