// Pair distribution g(r) of the centres of mass, with the edges of a finite vessel accounted for.
//
// Domain D: where centres can be, i.e. the vessel's inside up to the filling height, moved inward by the mean inner
// radius of the particles (periodic axes: unbounded; no vessel: the bounds of the centres). With N centres in D,
// density rho = (N - 1)/|D|, g(r) = sum_i n_i(r) / (rho sum_i v_i(r)): n_i counts the centres of D in a shell about i,
// v_i is the volume of the part of that shell inside D. Independent uniform centres give exactly 1, whatever the shape
// of D. D is convex, so that a ray from i leaves it once and v_i is a mean over rays of exact radial integrals.
#pragma once

#include "granular/analysis/bed.h"
#include "granular/analysis/table.h"

namespace granular {

struct PairDistribution {
  double density = 0;       ///< (N - 1)/|D|, 1/m^3
  std::size_t centres = 0;  ///< N
  Table table;              ///< r, g, mean number of neighbours up to r (edges accounted for)
};

/// filling: height of the bed above the floor, m. reach and bin in m; the reach is cut at half the shortest period.
/// Fewer than two centres in the domain, or a domain without volume, give an empty table.
PairDistribution measurePairDistribution(const Bed& bed, double filling, double unit, double reach, double bin);

}  // namespace granular
