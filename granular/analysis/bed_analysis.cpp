#include "granular/analysis/bed_analysis.h"

#include <algorithm>

#include "granular/analysis/reference_profile.h"
#include "granular/core/errors.h"

namespace granular {

namespace {

/// What all measurements share.
struct Setting {
  const Bed& bed;
  const AnalysisOptions& options;
  const Occupancy& occupancy;
  CrossSection section;
  double floor = 0, top = 0;  ///< between which the bed is sampled, m
  RingSamples samples;
  Regions regions;
};

void checkOptions(const AnalysisOptions& o) {
  const auto positive = [](double value, const char* name) {
    require(value > 0, std::string("analysis: ") + name + " must be > 0, not " + std::to_string(value));
  };
  positive(o.ringStep, "ringStep");
  positive(o.arcStep, "arcStep");
  positive(o.mostPoints, "mostPoints");
  positive(o.nearWallLengths, "nearWallLengths");
  positive(o.orderBin, "orderBin");
  positive(o.alphaStep, "alphaStep");
  positive(o.pairReach, "pairReach");
  positive(o.pairBin, "pairBin");
  positive(o.forceBin, "forceBin");
  require(o.unitLength >= 0 && o.voxel >= 0 && o.coreLengths >= 0, "analysis: lengths must not be negative");
}

/// Steps of the sampling; those along arcs and heights grow together when there would be too many points.
RingGrid chooseGrid(const Setting& s, double unit) {
  RingGrid grid;
  grid.lo = s.floor;
  grid.hi = s.top;
  grid.ringStep = s.options.ringStep * unit;
  grid.arcStep = s.options.arcStep * unit;
  grid.discStep = 2 * grid.ringStep;
  const double points = s.section.area() * (grid.hi - grid.lo) / (grid.ringStep * grid.arcStep * grid.discStep);
  const double growth = std::sqrt(std::max(1.0, points / s.options.mostPoints));
  grid.arcStep *= growth;
  grid.discStep *= growth;
  return grid;
}

/// Height of the bed: measured at its top, or the period.
FillingHeight findFilling(const Setting& s, double length) {
  const Vessel& vessel = s.bed.vessel;
  if (vessel.kind != Vessel::Kind::periodic || !vessel.periodicHeight)
    return measureFillingHeight(s.samples, length, s.occupancy.bounds().hi.z());
  FillingHeight filling;
  filling.equivalent = filling.halfFraction = filling.highestPoint = filling.bulkTo = s.top - s.floor;
  filling.bulkFraction = s.samples.mean(s.floor, s.top, 0, s.section.depth());
  return filling;
}

bool hasEqualSpheres(const Bed& bed) {
  double least = infinity, most = 0;
  for (const Shape* shape : bed.shapes) {
    if (shape->kind() != ShapeKind::sphere) return false;
    least = std::min(least, shape->size());
    most = std::max(most, shape->size());
  }
  return most <= 1.05 * least;
}

Table tabulateRadialPorosity(const Setting& s, const FillingHeight& filling, const std::optional<double>& core) {
  Table table{
      "radial_porosity",
      "Porosity against the distance from the side wall (S appendix A: arcs of curves at that distance, averaged over "
      "the heights): over the heights of the core, and from the floor to the filling height.",
      {"distance_m", "distance_unit_lengths", "porosity", "porosity_all_heights"},
      {}};
  const bool reference = hasEqualSpheres(s.bed) && s.bed.vessel.kind == Vessel::Kind::cylinder;
  if (reference) {
    table.columns.push_back("porosity_de_klerk");
    table.definition += " porosity_de_klerk: de Klerk (2003) with the porosity of the core, or 0.37 without one.";
  }
  for (std::size_t k = 0; k < s.samples.rings; ++k) {
    const double distance = s.samples.distance(k), z = distance / s.regions.unit;
    table.rows.push_back({distance, z, 1 - s.samples.meanOfRing(k, s.floor + s.regions.from, s.floor + s.regions.to),
                          1 - s.samples.meanOfRing(k, s.floor, s.floor + filling.equivalent)});
    if (reference) table.rows.back().push_back(evaluateDeKlerk(z, core ? 1 - *core : 0.37));
  }
  return table;
}

Table tabulateAxialPorosity(const Setting& s) {
  Table table{
      "axial_porosity",
      "Porosity of horizontal discs against the height above the floor: area mean over the section (no vessel: over "
      "the particles' bounds).",
      {"height_m", "height_unit_lengths", "porosity", "solid_fraction"},
      {}};
  for (std::size_t j = 0; j < s.samples.discs; ++j) {
    const double height = s.samples.height(j) - s.floor, solid = s.samples.meanOfDisc(j);
    table.rows.push_back({height, height / s.regions.unit, 1 - solid, solid});
  }
  return table;
}

void listPositions(const BedAnalysis& a, const Setting& s, std::vector<Quantity>& list) {
  const FillingHeight& f = a.filling;
  list.push_back({"particles", "1", "Number of particles.", static_cast<double>(s.bed.size())});
  list.push_back({"unit_length_m", "m",
                  "Unit of dimensionless distances; unless given: twice the mean radius of the sphere of equal volume.",
                  a.unitLength});
  list.push_back({"longest_length_m", "m", "Mean longest extent of the particles: the length regions are laid out in.",
                  a.longestLength});
  list.push_back({"filling_height_m", "m",
                  "Above the floor: height of the flat-topped bed of equal solid volume, z0 + (1/phi) times the "
                  "integral above z0 of the axial solid fraction; z0: middle of the bulk, phi: its solid fraction.",
                  f.equivalent});
  list.push_back(
      {"filling_height_half_m", "m",
       "Alternative: where the axial solid fraction, averaged over a longest length, falls below half of phi.",
       f.halfFraction});
  list.push_back({"filling_height_highest_m", "m", "Alternative: highest point of all particles.", f.highestPoint});
  list.push_back({"bulk_solid_fraction", "1",
                  "phi: axial solid fraction over the heights of the bulk (two longest lengths off floor and top, at "
                  "most a quarter of the height), weighted by cos^2 about its middle.",
                  f.bulkFraction});
  list.push_back({"solid_fraction_overall", "1",
                  "Volume of all particles / (section area times filling height) (S appendix A).", a.solid.overall});
  list.push_back(
      {"solid_fraction_below", "1",
       "Alternative: particle volume below the filling height (particles that cross it are cut) / the same volume.",
       a.solid.below});
  list.push_back(
      {"solid_fraction_sampled", "1",
       "Alternative: share of sampled points inside particles, floor to filling height (overlaps count once).",
       a.solid.sampled});
  list.push_back({"solid_fraction_near_wall", "1",
                  "Sampled, within near_wall_width_m of the side wall, heights region_from_m to region_to_m.",
                  a.solid.nearWall});
  list.push_back({"solid_fraction_core", "1",
                  "Sampled, further than core_margin_m from the side wall, heights region_from_m to region_to_m; null "
                  "in a bed below 8 longest lengths or a narrow vessel.",
                  a.solid.core});
  list.push_back({"region_from_m", "m", "Lower end of core and near-wall region, above the floor.", s.regions.from});
  list.push_back({"region_to_m", "m", "Upper end of core and near-wall region, above the floor.", s.regions.to});
  list.push_back({"near_wall_width_m", "m", "Thickness of the near-wall region.",
                  s.regions.walled ? std::optional<double>(s.regions.nearWall) : std::nullopt});
  list.push_back({"core_margin_m", "m", "Distance of the core from the side wall.",
                  s.regions.hasCore ? std::optional<double>(s.regions.core) : std::nullopt});
  list.push_back(
      {"sampled_points", "1", "Points at which the porosity was asked for.", static_cast<double>(s.samples.points)});
}

/// The vessel itself, so that what reads the results can draw it.
void listVessel(const Setting& s, std::vector<Quantity>& list) {
  const Vessel& vessel = s.bed.vessel;
  if (vessel.kind == Vessel::Kind::none) return;
  list.push_back(
      {"vessel_floor_m", "m", "Height of the vessel's floor (periodic in height: lower end of the period).", s.floor});
  if (vessel.kind == Vessel::Kind::cylinder) {
    list.push_back({"vessel_radius_m", "m", "Inner radius of the vessel.", vessel.radius});
    list.push_back({"vessel_axis_x_m", "m", "x of the vessel's axis.", vessel.axis.x()});
    list.push_back({"vessel_axis_y_m", "m", "y of the vessel's axis.", vessel.axis.y()});
    return;
  }
  const auto side = [&](std::size_t axis) { return std::string(vessel.repeats()[axis] ? "period." : "side wall."); };
  list.push_back({"vessel_lo_x_m", "m", "x of the lower " + side(0), vessel.lo.x()});
  list.push_back({"vessel_lo_y_m", "m", "y of the lower " + side(1), vessel.lo.y()});
  list.push_back({"vessel_hi_x_m", "m", "x of the upper " + side(0), vessel.hi.x()});
  list.push_back({"vessel_hi_y_m", "m", "y of the upper " + side(1), vessel.hi.y()});
}

/// Mean of neighbours over the particles whose centre lies in the core.
std::optional<double> averageCoreCoordination(const ContactNetwork& network, const std::vector<Director>& directors,
                                              const Regions& regions) {
  if (!regions.hasCore) return std::nullopt;
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < directors.size(); ++i) {
    const Director& d = directors[i];
    if (d.height < regions.from || d.height > regions.to || d.distance < regions.core) continue;
    sum += network.neighbours[i];
    n += 1;
  }
  return n > 0 ? std::optional<double>(sum / n) : std::nullopt;
}

void listContacts(const BedAnalysis& a, const std::optional<double>& core, std::vector<Quantity>& list) {
  const ContactNetwork& n = a.network;
  const auto count = [](std::size_t value) { return std::optional<double>(static_cast<double>(value)); };
  list.push_back({"coordination_number", "1",
                  "Mean number of touching particles over all particles (a pair counts once; walls are not counted).",
                  n.coordination});
  list.push_back(
      {"coordination_number_held", "1", "The same without rattlers and contacts with them.", n.coordinationHeld});
  list.push_back({"coordination_number_core", "1",
                  "Mean number of touching particles over the particles whose centre lies in the core.", core});
  list.push_back({"rattlers", "1",
                  "Particles with fewer than two touching bodies that are not rattlers themselves (each contact with a "
                  "wall counts as one).",
                  count(n.rattlers)});
  list.push_back({"particles_at_walls", "1", "Particles that touch a wall.", count(n.particlesAtWalls)});
  list.push_back({"contacts_particles", "1", "Contacts between particles.", count(n.particleContacts)});
  list.push_back({"contacts_walls", "1", "Contacts with walls (a flat face on a curved wall has several).",
                  count(n.wallContactCount)});
  list.push_back({"max_overlap_m", "m", "Largest overlap of all contacts.", n.largestOverlap});
  list.push_back({"max_overlap_over_size", "1",
                  "Largest overlap / size: radius of the sphere of equal volume, the smaller of the two bodies.",
                  n.largestRelativeOverlap});
  list.push_back({"mean_overlap_over_size", "1", "Mean of the same over all contacts.", n.meanRelativeOverlap});
  list.push_back({"mean_normal_force_n", "N", "Mean compressive normal force over contacts between particles.",
                  n.meanNormalForce});
  list.push_back(
      {"max_normal_force_n", "N", "Largest compressive normal force between particles.", n.largestNormalForce});
}

/// A mean that NaN marks as undefined.
std::optional<double> dropUndefined(double value) {
  return std::isnan(value) ? std::nullopt : std::optional<double>(value);
}

void measureOrders(const Setting& s, const std::vector<Director>& directors, BedAnalysis& a) {
  const double depth = s.section.depth(), bin = s.options.orderBin * a.unitLength;
  const auto radial = [](const Director& d) { return d.radial; };
  const auto vertical = [](const Director&) -> Vec3 { return Vec3::UnitZ(); };
  const auto all = [](const Director&) { return true; };
  const Order r = measureOrder(directors, radial, all), z = measureOrder(directors, vertical, all);
  a.quantities.push_back(
      {"order_s2_r", "1", "S2 of the directors against the radial direction, all particles.", dropUndefined(r.s2)});
  a.quantities.push_back(
      {"order_s4_r", "1", "S4 of the directors against the radial direction, all particles.", dropUndefined(r.s4)});
  a.quantities.push_back(
      {"order_s2_z", "1", "S2 of the directors against the vertical, all particles.", dropUndefined(z.s2)});
  a.quantities.push_back(
      {"order_s4_z", "1", "S4 of the directors against the vertical, all particles.", dropUndefined(z.s4)});
  a.quantities.push_back({"order_nematic", "1", "Largest eigenvalue of <3 u u^T - 1>/2 over all directors.",
                          dropUndefined(measureNematicOrder(directors))});
  if (z.count == 0) a.notes.push_back("Spheres have no director: no order parameters.");
  if (z.count == 0 || !s.section.walled()) return;
  a.tables.push_back(tabulateRadialOrder(directors, s.regions, depth, bin));
  a.tables.push_back(tabulateCumulativeOrder(directors, s.regions, depth, bin));
  a.tables.push_back(tabulatePlaneOrder(directors, s.regions, s.options.alphaStep));
}

}  // namespace

BedAnalysis analyseBed(const Bed& bed, const AnalysisOptions& options) {
  checkOptions(options);
  const Occupancy occupancy(bed);
  BedAnalysis a;
  for (const Shape* shape : bed.shapes) {
    a.unitLength += 2 * shape->size() / static_cast<double>(bed.size());
    a.longestLength += shape->longestExtent() / static_cast<double>(bed.size());
  }
  if (options.unitLength > 0) a.unitLength = options.unitLength;

  // Where the particles are.
  Setting s{bed, options, occupancy, CrossSection(bed.vessel, occupancy.bounds()), 0, 0, {}, {}};
  const bool loose = bed.vessel.kind == Vessel::Kind::none,
             stacked = bed.vessel.kind == Vessel::Kind::periodic && bed.vessel.periodicHeight;
  s.floor = loose ? occupancy.bounds().lo.z() : stacked ? bed.vessel.lo.z() : bed.vessel.floor;
  s.top = stacked ? bed.vessel.hi.z() : occupancy.bounds().hi.z();
  s.samples = sampleRings(occupancy, s.section, chooseGrid(s, a.unitLength), options.arcRule);
  a.filling = findFilling(s, a.longestLength);
  s.regions = layOutRegions(s.section, a.filling.equivalent, a.unitLength, a.longestLength, options.coreLengths,
                            options.nearWallLengths);
  a.notes = s.regions.notes;
  if (loose) {
    s.regions.hasCore = false;
    a.notes.push_back("No vessel: no solid fractions.");
  } else {
    a.solid = measureSolidFractions(bed, s.section, s.samples, a.filling, s.regions);
  }
  listPositions(a, s, a.quantities);
  listVessel(s, a.quantities);
  if (s.section.walled()) a.tables.push_back(tabulateRadialPorosity(s, a.filling, a.solid.core));
  a.tables.push_back(tabulateAxialPorosity(s));

  // How they lie, whom they touch, and how far apart they are.
  const std::vector<Director> directors = collectDirectors(bed, s.section, s.floor);
  measureOrders(s, directors, a);
  a.network = analyseContacts(bed);
  listContacts(a, averageCoreCoordination(a.network, directors, s.regions), a.quantities);
  a.tables.push_back(tabulateCoordination(a.network));
  a.tables.push_back(tabulateFabric(a.network));
  a.tables.push_back(tabulateForces(bed, options.forceBin));
  a.tables.push_back(measurePairDistribution(bed, a.filling.equivalent, a.unitLength, options.pairReach * a.unitLength,
                                             options.pairBin * a.unitLength)
                         .table);
  if (options.voxel > 0) a.voxels = measureVoxels(bed, occupancy, options.voxel, options.voxelSamples);
  return a;
}

std::optional<double> findQuantity(const BedAnalysis& analysis, const std::string& name) {
  for (const Quantity& quantity : analysis.quantities)
    if (quantity.name == name) return quantity.value;
  return std::nullopt;
}

const Table* findTable(const BedAnalysis& analysis, const std::string& name) {
  for (const Table& table : analysis.tables)
    if (table.name == name) return &table;
  return nullptr;
}

}  // namespace granular
