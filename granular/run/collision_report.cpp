#include "granular/run/collision_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "granular/core/errors.h"

namespace granular {
namespace {

using Json = nlohmann::ordered_json;

Json describeRow(const CollisionRow& row) {
  const CollisionResult& r = row.result;
  const CollisionOptions& o = row.options;
  Json json;
  json["pair"] = fmt::format("{}-{}", row.pair.a, row.pair.b);
  json["law"] = std::string(lawName(o.law));
  json["rule"] = std::string(pointRuleName(o.rule.rule));
  json["slab"] = o.rule.slab;
  json["ensemble"] = std::string(o.ensemble.name);
  json["samples"] = o.samples;
  json["seed"] = o.seed;
  json["speed_m_per_s"] = o.speed;
  json["stiffness_n_per_m"] = o.stiffness;
  json["contact_time_s"] = r.contactTime;
  json["dt_s"] = r.dt;
  json["steps_per_contact"] = r.contactTime / r.dt;
  json["residual_spring_energy_percent"] = r.residual.mean;
  json["residual_spring_energy_error_percent"] = r.residual.error;
  json["residual_spring_energy_worst_percent"] = r.residual.worst;
  json["total_energy_error_percent"] = r.totalEnergy.mean;
  json["total_energy_error_worst_percent"] = r.totalEnergy.worst;
  json["kinetic_energy_loss_percent"] = r.kineticLoss.mean;
  json["kinetic_energy_loss_worst_percent"] = r.kineticLoss.worst;
  json["angular_momentum_error"] = r.angularMomentum.mean;
  json["angular_momentum_error_worst"] = r.angularMomentum.worst;
  json["stiff_limit_percent"] = r.stiffLimit.mean;
  json["stiff_limit_difference_percent"] = r.stiffDifference.mean;
  json["stiff_limit_difference_worst_percent"] = r.stiffDifference.worst;
  json["published_percent"] = row.pair.published;
  json["max_overlap_over_size"] = r.deepestOverlap;
  json["unfinished"] = r.unfinished;
  json["uncertified"] = r.uncertified;
  json["coarse"] = r.coarse;
  return json;
}

}  // namespace

CollisionPair findCollisionPair(std::string_view name) {
  std::string known;
  for (const CollisionPair& pair : collisionPairs()) {
    if (name == fmt::format("{}-{}", pair.a, pair.b) || name == fmt::format("{}-{}", pair.b, pair.a)) return pair;
    known += fmt::format("{}{}-{}", known.empty() ? "" : ", ", pair.a, pair.b);
  }
  throw InputError(fmt::format("pair \"{}\": unknown; there are {}", name, known));
}

std::string formatCollisionTable(const std::vector<CollisionRow>& rows) {
  std::string text =
      fmt::format("{:<24}{:<13}{:<18}{:<10}{:>6}{:>19}{:>8}{:>9}{:>19}{:>20}{:>6}\n", "pair", "law", "rule", "ensemble",
                  "t_c/dt", "residual %", "worst", "stiff", "total energy %", "angular momentum", "S %");
  for (const CollisionRow& row : rows) {
    const CollisionResult& r = row.result;
    text += fmt::format(
        "{:<24}{:<13}{:<18}{:<10}{:>6.4g}{:>10.4f} +- {:>5.3f}{:>8.2f}{:>9.3f}{:>10.4f} <{:>7.3f}"
        "{:>11.1e} <{:>7.1e}{:>6.2f}\n",
        fmt::format("{}-{}", row.pair.a, row.pair.b), lawName(row.options.law), pointRuleName(row.options.rule.rule),
        row.options.ensemble.name, r.contactTime / r.dt, r.residual.mean, r.residual.error, r.residual.worst,
        r.stiffLimit.mean, r.totalEnergy.mean, r.totalEnergy.worst, r.angularMomentum.mean, r.angularMomentum.worst,
        row.pair.published);
    if (r.unfinished > 0) text += fmt::format("  {} contacts did not end and are left out\n", r.unfinished);
    if (r.coarse > 0) text += fmt::format("  {} overlaps were certified coarsely\n", r.coarse);
    if (r.uncertified > 0) text += fmt::format("  {} uncertified overlaps were used\n", r.uncertified);
  }
  return text;
}

std::string formatCollisionJson(const std::vector<CollisionRow>& rows) {
  if (rows.size() == 1) return describeRow(rows[0]).dump(2) + '\n';
  Json json;
  json["rows"] = Json::array();
  for (const CollisionRow& row : rows) json["rows"].push_back(describeRow(row));
  return json.dump(2) + '\n';
}

std::string formatCollisionCsv(const std::vector<CollisionRow>& rows) {
  std::string text;
  for (const CollisionRow& row : rows) {
    const Json json = describeRow(row);
    std::vector<std::string> names, values;
    for (const auto& [key, value] : json.items()) {
      names.push_back(key);
      values.push_back(value.is_string() ? value.get<std::string>() : value.dump());
    }
    if (text.empty()) text = fmt::format("{}\n", fmt::join(names, ","));
    text += fmt::format("{}\n", fmt::join(values, ","));
  }
  return text;
}

}  // namespace granular
