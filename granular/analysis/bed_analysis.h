// The whole analysis of a packing in one call (S appendices A and B, and the contact network).
//
// Regions. Lengths are the mean longest extent of the particles. The core leaves out two lengths at the floor, the top
// and the side wall; it is empty (null) in a bed less than eight lengths high or a vessel too narrow to leave a quarter
// of a length. The near-wall region is the layer within one length of the side wall, over the heights of the core, or
// over the whole bed where the bed is too low. Every table and number carries its definition.
#pragma once

#include "granular/analysis/bed.h"
#include "granular/analysis/contact_network.h"
#include "granular/analysis/filling_height.h"
#include "granular/analysis/order.h"
#include "granular/analysis/pair_distribution.h"
#include "granular/analysis/solid_fraction.h"
#include "granular/analysis/table.h"
#include "granular/analysis/voxel_field.h"

namespace granular {

struct AnalysisOptions {
  double unitLength = 0;   ///< of dimensionless distances, m; 0: twice the mean radius of the sphere of equal volume
  double ringStep = 0.05;  ///< between circles and between discs' heights (doubled), in unit lengths
  double arcStep = 0.1;    ///< between points of a circle, in unit lengths
  double mostPoints =
      2e7;  ///< of the porosity sampling; the steps along arcs and heights grow where it would be exceeded
  ArcRule arcRule = ArcRule::spacing;
  double nearWallLengths = 1;  ///< thickness of the near-wall region, in longest lengths
  double coreLengths = 2;      ///< what the core leaves out at each side, in longest lengths
  double orderBin = 0.5;       ///< thickness of the annular bins of the order parameters, in unit lengths
  double alphaStep = 5;        ///< degrees
  double pairReach = 5;        ///< of the pair distribution, in unit lengths
  double pairBin = 0.05;       ///< its bins, in unit lengths
  double forceBin = 0.2;       ///< bins of the force distribution, in mean forces
  double voxel = 0;            ///< edge of the porosity field's voxels, m; 0: none
  int voxelSamples = 4;        ///< points per voxel and axis
};

struct BedAnalysis {
  double unitLength = 0;     ///< m
  double longestLength = 0;  ///< m
  FillingHeight filling;
  SolidFractions solid;
  ContactNetwork network;
  VoxelField voxels;  ///< empty unless asked for
  std::vector<Quantity> quantities;
  std::vector<Table> tables;
  std::vector<std::string> notes;  ///< what could not be measured, and why
};

/// Measures the bed. Depends on the arguments alone, for any number of threads. Throws InputError for an empty bed, bad
/// options or a vessel without room.
BedAnalysis analyseBed(const Bed& bed, const AnalysisOptions& options = {});

/// The named number; empty when null or unknown.
std::optional<double> findQuantity(const BedAnalysis& analysis, const std::string& name);
/// The named table, or null.
const Table* findTable(const BedAnalysis& analysis, const std::string& name);

}  // namespace granular
