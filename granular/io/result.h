// result.json and CSV tables: what a run found, in SI units under stable names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "granular/analysis/bed.h"
#include "granular/analysis/table.h"
#include "granular/body/bodies.h"
#include "granular/narrow/narrow.h"

namespace granular {

/// What result.json holds. Empty optionals and numbers that are not finite become null.
struct RunResult {
  std::string name;     ///< of the scene
  std::string version;  ///< of the library
  std::string outcome;  ///< runEndName(): "rested", "not at rest in the time given", ...
  std::uint64_t seed = 0;
  int threads = 0;

  std::int64_t particles = 0, steps = 0;
  double dt = 0;             ///< s
  double simulated = 0;      ///< s
  double wall = 0;           ///< s, of the stepping and all that belongs to it
  double particleSteps = 0;  ///< sum over steps of the particles then moving

  std::optional<double> solidOverall, solidNearWall, solidCore;
  std::optional<double> fillingHeight;  ///< m
  std::optional<double> coordination;
  std::vector<std::pair<std::string, std::optional<double>>> headline;  ///< what a study is about, at the top level
  double maxOverlapOverSize = 0;  ///< ever, over the radius of the sphere of equal volume
  double kineticEnergy = 0;       ///< J
  std::string stateHash;          ///< hashState() of the bodies at the end

  std::int64_t contactsNow = 0;
  NarrowCounts contacts;                                   ///< the run's contact certificate
  std::optional<double> energyResidual;                    ///< relative; null without a ledger
  std::vector<std::pair<std::string, double>> energy;      ///< the ledger's entries, J; empty without one
  std::vector<std::pair<std::string, double>> stageTimes;  ///< s
  std::vector<std::pair<std::string, double>> more;        ///< further counters, by stable name
  std::vector<std::string> skipped;
  std::vector<std::string> notes;                           ///< troubles, and what could not be measured
  std::vector<Quantity> quantities;                         ///< of the analysis, with their definitions
  std::vector<std::pair<std::string, std::string>> tables;  ///< file and definition of each table written
};

/// The text of result.json.
std::string formatResult(const RunResult& result);
/// Throws InputError if the file can't be written; so do all below.
void writeResult(const std::filesystem::path& path, const RunResult& result);

/// CSV: the definition as a comment line, the columns, one line per row with all digits; NaN is an empty cell.
void writeTable(const std::filesystem::path& path, const Table& table);

/// Per particle: id, pose, velocities, mass, size, shape and material rows, contacts, state. `coordination`: contacts
/// per particle, or empty.
Table tabulateParticles(const Bodies& bodies, const std::vector<int>& coordination);
/// Per contact: ids (wall: -1), point, normal, force, overlap. ids: of the bed's particles.
Table tabulateContacts(const Bed& bed, const std::vector<std::int64_t>& ids);

}  // namespace granular
