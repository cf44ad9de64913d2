#include "granular/run/packing_report.h"

#include <fmt/format.h>

#include <cmath>

#include "granular/io/mesh_export.h"
#include "granular/io/state_hash.h"
#include "granular/run/bed_of_world.h"
#include "granular/run/frames.h"
#include "granular/run/scene_world.h"

namespace granular {
namespace {

AnalysisOptions analysisOptionsOf(const AnalysisSettings& settings) {
  AnalysisOptions options;
  options.unitLength = settings.unitLength.value_or(0);
  options.nearWallLengths = settings.nearWall;
  options.coreLengths = settings.core;
  options.ringStep = settings.ringStep;
  options.arcStep = settings.arcStep;
  options.orderBin = settings.orderBin;
  options.alphaStep = settings.alphaStep * 180 / pi;
  options.pairReach = settings.pairReach;
  options.pairBin = settings.pairBin;
  options.forceBin = settings.forceBin;
  options.voxel = settings.voxel.value_or(0);
  return options;
}

/// What the run itself knows, without the analysis.
RunResult collectRun(const PackingRun& run, RunEnd end, int threads) {
  const World& world = run.world();
  const Report& report = world.report;
  RunResult result;
  result.name = run.scene().name;
  result.version = GRANULAR_VERSION;
  result.outcome = runEndName(end);
  result.seed = run.scene().seed;
  result.threads = threads;
  result.particles = static_cast<std::int64_t>(world.bodies.size());
  result.steps = world.steps;
  result.dt = run.timeStep();
  result.simulated = world.time;
  result.wall = run.progress().wall;
  result.particleSteps = static_cast<double>(report.bodySteps);
  result.maxOverlapOverSize = report.deepestOverlap;
  result.kineticEnergy = kineticEnergy(world.bodies);
  result.stateHash = hashState(world.bodies);
  result.contactsNow = static_cast<std::int64_t>(world.contactCount());
  result.contacts = report.narrow;
  if (world.ledger.begun) {
    result.energyResidual = world.ledger.relativeResidual();
    for (const auto& [name, value] : world.ledger.entries()) result.energy.emplace_back(name, value);
  }
  for (int k = 0; k < stageCount; ++k) {
    result.stageTimes.emplace_back(stageName(static_cast<Stage>(k)), report.seconds[static_cast<std::size_t>(k)]);
  }
  const Inserter& pour = run.inserter();
  const std::int64_t leftOut = pour.isFull() ? pour.count() - pour.state().placed : 0;
  if (leftOut > 0 && run.scene().insertion.kind == InsertionSettings::Kind::drop) {
    result.notes.push_back(fmt::format("The bed has grown into the place particles drop from: {} of {} are in.",
                                       pour.state().placed, pour.count()));
  } else if (leftOut > 0) {
    result.notes.push_back(
        fmt::format("The vessel is full: {} of {} particles are in; the next found no place below its rim at {:g} m.",
                    pour.state().placed, pour.count(), makeRegion(run.scene()).ceiling));
  }
  result.more = {{"step_bound_s", run.bound().bound},
                 {"step_bound_of_contacts_s", run.progress().smallestBound},
                 {"contact_time_s", run.bound().contactTime},
                 {"searches", static_cast<double>(world.search.refreshes)},
                 {"contact_steps", static_cast<double>(report.contactSteps)},
                 {"batches_not_consolidated", static_cast<double>(run.progress().lateBatches)},
                 {"insertions_postponed", static_cast<double>(run.inserter().state().postponed)},
                 {"particles_left_out", static_cast<double>(leftOut)},
                 {"particles_taken_out", static_cast<double>(run.progress().removed.size())},
                 {"bodies_fallen_asleep", static_cast<double>(world.sleep.fallen)},
                 {"bodies_woken", static_cast<double>(world.sleep.woken)},
                 {"energy_let_go_asleep_j", world.sleep.energyLetGo}};
  result.skipped = run.scene().skip;
  for (const std::string& answer : run.progress().answers) result.notes.push_back(answer);
  for (const Trouble& trouble : report.troubles) result.notes.push_back(describe(trouble));
  return result;
}

Table tabulateEnergy(const EnergySeries& series, const EnergyLedger& ledger) {
  Table table;
  table.name = "energy";
  table.definition =
      "The energy ledger over time, half a step after the positions: energies now, and heat and work since the run "
      "began. "
      "residual = kinetic + potential + springs + dashpots + friction + parted - wall work - contact-rule work - "
      "exchanged";
  table.columns = {"time_s"};
  for (const auto& entry : ledger.entries()) table.columns.emplace_back(entry.first);
  for (std::size_t k = 0; k < series.rows(); ++k) {
    const auto row = series.numbers.begin() + static_cast<std::ptrdiff_t>(k * series.columns);
    table.rows.emplace_back(row, row + static_cast<std::ptrdiff_t>(series.columns));
  }
  return table;
}

/// Tables of the analysis, of the particles and of the contacts; what was written goes into the result.
void writeTables(const PackingRun& run, const Bed& bed, const BedAnalysis& analysis, const std::filesystem::path& out,
                 RunResult& result) {
  const Bodies& bodies = run.world().bodies;
  std::vector<Table> tables = analysis.tables;
  std::vector<int> coordination(bodies.size(), 0);
  for (const BedContact& contact : bed.contacts) {
    ++coordination[static_cast<std::size_t>(contact.a)];
    if (contact.b >= 0) ++coordination[static_cast<std::size_t>(contact.b)];
  }
  if (run.scene().output.particles) tables.push_back(tabulateParticles(bodies, coordination));
  if (run.scene().output.contacts) tables.push_back(tabulateContacts(bed, bodies.id));
  if (run.scene().output.energy) tables.push_back(tabulateEnergy(run.energySeries(), run.world().ledger));
  for (const Table& table : tables) {
    writeTable(out / (table.name + ".csv"), table);
    result.tables.emplace_back(table.name + ".csv", table.definition);
  }
}

void writeSurfaces(const PackingRun& run, const Bed& bed, const BedAnalysis& analysis,
                   const std::filesystem::path& out) {
  const OutputSettings& output = run.scene().output;
  MeshExportOptions options;
  options.resolution = static_cast<int>(output.resolution);
  options.gap = output.gap;
  if (output.stl) exportBed(out / "bed.stl", bed.shapes, bed.frames, run.world().bodies.id, options);
  if (output.glb) exportBed(out / "bed.glb", bed.shapes, bed.frames, run.world().bodies.id, options);
  if (!analysis.voxels.empty()) writeVoxels(out / "porosity.vti", analysis.voxels);
}

}  // namespace

RunResult writeReport(const PackingRun& run, RunEnd end, int threads, const std::filesystem::path& out) {
  const World& world = run.world();
  RunResult result = collectRun(run, end, threads);
  const Bed bed = makeBed(world, run.vessel());
  const BedAnalysis analysis = analyseBed(bed, analysisOptionsOf(run.scene().analysis));
  result.solidOverall = findQuantity(analysis, "solid_fraction_overall");
  result.solidNearWall = findQuantity(analysis, "solid_fraction_near_wall");
  result.solidCore = findQuantity(analysis, "solid_fraction_core");
  result.fillingHeight = findQuantity(analysis, "filling_height_m");
  result.coordination = findQuantity(analysis, "coordination_number");
  result.quantities = analysis.quantities;
  result.notes.insert(result.notes.end(), analysis.notes.begin(), analysis.notes.end());
  writeTables(run, bed, analysis, out, result);

  FrameWriter frames(out, run.scene(), run.frameEntries());
  frames.write(world, run.progress().frames);
  writeSurfaces(run, bed, analysis, out);
  writeResult(out / "result.json", result);
  return result;
}

std::string formatSummary(const RunResult& result, const PackingRun& run) {
  const auto value = [](const std::optional<double>& v) { return v ? fmt::format("{:.4f}", *v) : std::string("-"); };
  const Report& report = run.world().report;
  std::string text = fmt::format("outcome: {} after {:.4g} s simulated, {} steps of {:.4g} s\n", result.outcome,
                                 result.simulated, result.steps, result.dt);
  text += fmt::format(
      "packing: {} particles, solid fraction overall {}, near wall {}, core {}; filling height {} m; coordination {}\n",
      result.particles, value(result.solidOverall), value(result.solidNearWall), value(result.solidCore),
      value(result.fillingHeight), value(result.coordination));
  text += fmt::format("contacts: {} now; largest overlap {:.3f} % of the size (bodies {} and {} at t = {:.4g} s)\n",
                      result.contactsNow, 100 * result.maxOverlapOverSize, report.deepestA, report.deepestB,
                      report.deepestTime);
  const NarrowCounts& c = result.contacts;
  text += fmt::format(
      "contact certificate: {} answers verified warm, {} full searches, {} cold, {} fallbacks, {} missed by "
      "Bullet, {} normal flips, {} certified coarsely, {} uncertified\n",
      c.warm, c.searches, c.cold, c.fallbacks, c.missed, c.normalFlips, c.coarse, c.uncertified);
  text += fmt::format("energy: kinetic {:.3g} J; ", result.kineticEnergy);
  const EnergyLedger& ledger = run.world().ledger;
  text += !ledger.begun
              ? std::string("ledger not kept\n")
              : fmt::format(
                    "heat of dashpots {:.3g}, of friction {:.3g}, left in parted springs {:.3g}; work of walls {:.3g}, "
                    "of the contact rule {:.3g} J; residual {:.1e} of all\n",
                    ledger.normalDashpots + ledger.tangentialDashpots, ledger.friction, ledger.parted, ledger.wall,
                    ledger.rule, ledger.relativeResidual());
  text += fmt::format(
      "speed: {:.4g} s wall, {:.3g} particle-steps/s, {:.3g} us per contact; step bound of the contacts met "
      "{:.3g} s\n",
      result.wall, result.particleSteps / result.wall,
      1e6 * result.wall / std::max(1.0, static_cast<double>(report.contactSteps)), run.progress().smallestBound);
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace granular
