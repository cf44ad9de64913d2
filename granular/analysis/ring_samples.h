// Arc sampling of the point porosity (S appendix A): the vessel is cut into discs at discrete heights, each disc into
// curves at increasing distance from the side wall (circles in a cylinder), each curve is sampled by points, and the
// arcs that lie inside particles are added up. Everything positional is then a weighted mean of the solid shares found
// here.
#pragma once

#include <vector>

#include "granular/analysis/cross_section.h"
#include "granular/analysis/occupancy.h"

namespace granular {

/// How the points of a curve become arcs.
enum class ArcRule {
  spacing,  ///< every inside point stands for one spacing: unbiased (default)
  paper,    ///< S fig. A.20: segments between neighbouring inside points; low by one spacing per arc
  refined,  ///< the ends of every arc are found by bisection, to 1/1024 of a spacing; arcs shorter than a spacing may
            ///< be missed
};

/// Sampling grid: heights from lo to hi, m, and the steps between discs, curves and points, m.
struct RingGrid {
  double lo = 0, hi = 0;
  double discStep = 0, ringStep = 0, arcStep = 0;
};

/// Solid share of every curve of every disc. Disc j stands for the slab zEdge(j) ... zEdge(j + 1) and is cut at its
/// middle; curve k for the ring between two distances from the wall, likewise.
struct RingSamples {
  double lo = 0, discStep = 0, ringStep = 0;
  std::size_t discs = 0, rings = 0;
  std::vector<double> share;     ///< [disc * rings + ring], 0 ... 1
  std::vector<double> ringArea;  ///< m^2; they add up to the section's area
  std::size_t points = 0;        ///< queries made

  double height(std::size_t disc) const { return lo + (static_cast<double>(disc) + 0.5) * discStep; }
  double distance(std::size_t ring) const { return (static_cast<double>(ring) + 0.5) * ringStep; }
  double at(std::size_t disc, std::size_t ring) const { return share[disc * rings + ring]; }

  /// Mean solid fraction of a disc over its rings, by area.
  double meanOfDisc(std::size_t disc) const;
  /// Mean solid fraction of a ring between two heights, m; discs cut by a limit count by their part.
  double meanOfRing(std::size_t ring, double from, double to) const;
  /// Mean solid fraction of the region between two heights and two distances from the wall, m. NaN for an empty region.
  double mean(double from, double to, double nearest, double furthest) const;
};

/// Samples the section. Deterministic for any number of threads. Throws InputError for a grid without extent.
RingSamples sampleRings(const Occupancy& occupancy, const CrossSection& section, const RingGrid& grid, ArcRule rule);

}  // namespace granular
