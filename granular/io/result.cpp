#include "granular/io/result.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>

#include "granular/core/instruction_set.h"
#include "granular/io/output_file.h"

namespace granular {
namespace {

using Json = nlohmann::ordered_json;

Json number(std::optional<double> value) { return value && std::isfinite(*value) ? Json(*value) : Json(nullptr); }

template <class Pairs>
Json object(const Pairs& pairs) {
  Json json = Json::object();
  for (const auto& [name, value] : pairs) json[name] = value;
  return json;
}

}  // namespace

std::string formatResult(const RunResult& r) {
  Json json;
  json["name"] = r.name;
  json["version"] = r.version;
  json["outcome"] = r.outcome;
  json["seed"] = r.seed;
  json["threads"] = r.threads;
  json["particles"] = r.particles;
  json["steps"] = r.steps;
  json["dt_s"] = number(r.dt);
  json["simulated_s"] = number(r.simulated);
  json["wall_s"] = number(r.wall);
  json["particle_steps_per_s"] = number(r.particleSteps / r.wall);
  json["solid_fraction"] = {
      {"overall", number(r.solidOverall)}, {"near_wall", number(r.solidNearWall)}, {"core", number(r.solidCore)}};
  json["filling_height_m"] = number(r.fillingHeight);
  json["coordination_number"] = number(r.coordination);
  for (const auto& [name, value] : r.headline) json[name] = number(value);
  json["max_overlap_over_size"] = number(r.maxOverlapOverSize);
  json["kinetic_energy_j"] = number(r.kineticEnergy);
  json["state_hash"] = r.stateHash;
  json["contacts"] = {{"now", r.contactsNow},
                      {"uncertified", r.contacts.uncertified},
                      {"coarse", r.contacts.coarse},
                      {"fallbacks", r.contacts.fallbacks},
                      {"normal_flips", r.contacts.normalFlips},
                      {"missed", r.contacts.missed},
                      {"cold", r.contacts.cold},
                      {"searches", r.contacts.searches},
                      {"warm", r.contacts.warm}};
  json["energy"] = object(r.energy);
  json["energy"]["residual_relative"] = number(r.energyResidual);
  json["stage_s"] = object(r.stageTimes);
  json["counters"] = object(r.more);
  json["skipped"] = r.skipped;
  json["instruction_set"] = instructionSet();
  json["notes"] = r.notes;
  Json quantities = Json::object();
  for (const Quantity& q : r.quantities)
    quantities[q.name] = {{"value", number(q.value)}, {"unit", q.unit}, {"definition", q.definition}};
  json["quantities"] = quantities;
  json["tables"] = object(r.tables);
  // Names from a scene may hold bytes that are no UTF-8; they are replaced rather than refused at the end of a run.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void writeResult(const std::filesystem::path& path, const RunResult& result) {
  OutputFile file(path);
  file.write(formatResult(result));
  file.finish();
}

void writeTable(const std::filesystem::path& path, const Table& table) {
  OutputFile file(path);
  file.write(fmt::format("# {}\n{}\n", table.definition, fmt::join(table.columns, ",")));
  std::string line;
  for (const std::vector<double>& row : table.rows) {
    assert(row.size() == table.columns.size());
    line.clear();
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k > 0) line += ',';
      if (!std::isnan(row[k])) fmt::format_to(std::back_inserter(line), "{}", row[k]);
    }
    line += '\n';
    file.write(line);
  }
  file.finish();
}

Table tabulateParticles(const Bodies& b, const std::vector<int>& coordination) {
  Table table;
  table.name = "particles";
  table.definition =
      "One row per particle; centre of mass, orientation body to world, velocities in world axes; size: radius of the "
      "sphere "
      "of equal volume; state: 0 moving, 1 frozen, 2 asleep";
  table.columns = {"id",      "x_m",        "y_m",        "z_m",        "qw",           "qx",           "qy",
                   "qz",      "vx_m_per_s", "vy_m_per_s", "vz_m_per_s", "wx_rad_per_s", "wy_rad_per_s", "wz_rad_per_s",
                   "mass_kg", "size_m",     "shape",      "material",   "contacts",     "state"};
  const double nan = std::nan("");
  for (const std::int32_t slot : b.slotsById()) {
    const auto k = static_cast<std::size_t>(slot);
    table.rows.push_back({static_cast<double>(b.id[k]),
                          b.x(k).x(),
                          b.x(k).y(),
                          b.x(k).z(),
                          b.orientation(k).w(),
                          b.orientation(k).x(),
                          b.orientation(k).y(),
                          b.orientation(k).z(),
                          b.v(k).x(),
                          b.v(k).y(),
                          b.v(k).z(),
                          b.w(k).x(),
                          b.w(k).y(),
                          b.w(k).z(),
                          b.mass[k],
                          b.shape[k]->size(),
                          static_cast<double>(b.shapeIndex[k]),
                          static_cast<double>(b.material[k]),
                          coordination.empty() ? nan : static_cast<double>(coordination[k]),
                          static_cast<double>(b.state[k])});
  }
  return table;
}

Table tabulateContacts(const Bed& bed, const std::vector<std::int64_t>& ids) {
  Table table;
  table.name = "contacts";
  table.definition = "One row per contact; b = -1: a wall; normal: unit, from a to b; force: on a";
  table.columns = {"a", "b", "x_m", "y_m", "z_m", "nx", "ny", "nz", "force_x_N", "force_y_N", "force_z_N", "overlap_m"};
  const auto idOf = [&](std::int32_t index) {
    return index < 0 ? -1.0 : static_cast<double>(ids[static_cast<std::size_t>(index)]);
  };
  for (const BedContact& c : bed.contacts)
    table.rows.push_back({idOf(c.a), idOf(c.b), c.point.x(), c.point.y(), c.point.z(), c.normal.x(), c.normal.y(),
                          c.normal.z(), c.force.x(), c.force.y(), c.force.z(), c.overlap});
  return table;
}

}  // namespace granular
