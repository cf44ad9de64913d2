#include "granular/run/comparison_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "granular/core/errors.h"
#include "granular/io/output_file.h"

namespace granular {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

void writeText(const fs::path& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.finish();
}

/// A key as a file name.
std::string fileName(const std::string& key) {
  std::string name;
  for (const char c : key) {
    if (c == ',') continue;
    name += c == ' ' ? '_' : c;
  }
  name += ".csv";
  return name;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json rowOf(const ComparisonCase& which, const ComparisonResult& result) {
  const bool bullet = which.engine->run == runBulletScene;
  const EngineRun& run = result.run;
  const EngineSettings& settings = which.settings;
  const Json null(nullptr);
  Json row;
  row["key"] = which.key();
  row["scene"] = which.scene->name;
  row["engine"] = which.engine->name;
  row["rule"] = bullet ? "bullet" : std::string(pointRuleName(settings.rule.rule));
  row["unit_m"] = which.unit;
  row["scaled"] = bullet ? Json(settings.scaled) : null;
  row["iterations"] = bullet ? Json(settings.iterations) : null;
  row["softness"] = bullet ? null : Json(settings.softness);
  row["fraction_of_bound"] = bullet ? null : Json(settings.fraction);
  row["dt_s"] = run.step;
  row["as_theory"] = result.verdict.asTheory;
  row["error"] = result.verdict.error ? number(*result.verdict.error) : null;
  row["observed"] = result.verdict.observed;
  row["simulated_s"] = run.simulated;
  row["steps"] = run.steps;
  row["run_s"] = run.processorTime;
  row["run_s_per_simulated_s"] = run.simulated > 0 ? number(run.processorTime / run.simulated) : null;
  row["ns_per_contact"] = run.contacts > 0 ? number(1e9 * run.processorTime / static_cast<double>(run.contacts)) : null;
  row["uncertified"] = bullet ? null : Json(run.uncertified);
  row["trouble"] = run.trouble;
  row["state"] = fmt::format("states/{}", fileName(which.key()));
  return row;
}

std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const std::string text = value.get<std::string>();
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  quoted += '"';
  return quoted;
}

std::string toCsv(const Json& rows) {
  std::string text;
  for (const Json& row : rows) {
    std::vector<std::string> names, cells;
    for (const auto& [name, value] : row.items()) {
      names.push_back(name);
      cells.push_back(cell(value));
    }
    if (text.empty()) text = fmt::format("{}\n", fmt::join(names, ","));
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

Json scenesToJson() {
  Json list = Json::array();
  for (const ComparisonScene& scene : comparisonScenes()) {
    list.push_back(
        {{"name", scene.name}, {"theory", scene.theory}, {"source", scene.source}, {"error", scene.errorOf}});
  }
  return list;
}

/// Corners of every body at the end, in units of the scene: body, fixed, x, y, z.
std::string stateToCsv(const ComparisonCase& which, const Recording& recording) {
  const SceneSetup setup = which.scene->build(which.unit);
  const Snapshot& end = recording.snapshots.back();
  std::string text = "body,fixed,x,y,z\n";
  for (std::size_t k = 0; k < setup.bodies.size(); ++k) {
    const Frame frame(end.bodies[k].pose);
    for (const Vec3& corner : setup.bodies[k].shape->surface(16).vertices) {
      const Vec3 p = frame.toWorld(corner) / setup.unit;
      text += fmt::format("{},{},{:.6g},{:.6g},{:.6g}\n", k, setup.bodies[k].fixed ? 1 : 0, p.x(), p.y(), p.z());
    }
  }
  return text;
}

}  // namespace

struct ComparisonTable::Rows {
  Json list = Json::array();

  auto find(const std::string& key) {
    return std::find_if(list.begin(), list.end(), [&](const Json& row) { return row.at("key") == key; });
  }
};

ComparisonTable::ComparisonTable(fs::path where) : folder(std::move(where)), rows(std::make_unique<Rows>()) {
  prepareOutputFolder(folder);
  prepareOutputFolder(folder / "states");
  const fs::path path = folder / "contacts.json";
  if (!fs::exists(path)) return;
  try {
    std::ifstream file(path);
    rows->list = Json::parse(file).at("rows");
    for (const Json& row : rows->list) static_cast<void>(row.at("key").get<std::string>());
  } catch (const Json::exception& error) {
    throw InputError(path.string() + " is no table of this comparison: " + error.what());
  }
}

ComparisonTable::~ComparisonTable() = default;

bool ComparisonTable::has(const ComparisonCase& which) const { return rows->find(which.key()) != rows->list.end(); }

std::size_t ComparisonTable::size() const { return rows->list.size(); }

void ComparisonTable::add(const ComparisonCase& which, const ComparisonResult& result) {
  const Json row = rowOf(which, result);
  const auto old = rows->find(which.key());
  if (old != rows->list.end()) {
    *old = row;
  } else {
    rows->list.push_back(row);
  }
  // The row comes last: a case without its state is run again.
  writeText(folder / row.at("state").get<std::string>(), stateToCsv(which, result.run.recording));
  const Json whole = {{"version", GRANULAR_VERSION}, {"scenes", scenesToJson()}, {"rows", rows->list}};
  writeText(folder / "contacts.csv", toCsv(rows->list));
  writeText(folder / "contacts.json", whole.dump(1) + "\n");
}

std::string describeResult(const ComparisonCase& which, const ComparisonResult& result) {
  const Verdict& verdict = result.verdict;
  const std::string error = verdict.error ? fmt::format(", error {:.2e}", *verdict.error) : "";
  return fmt::format("{:<3} {}: {}{}; {:.3g} s per simulated second", verdict.asTheory ? "yes" : "no", which.key(),
                     verdict.observed, error, result.run.processorTime / result.run.simulated);
}

std::string describeScenes() {
  std::string text;
  for (const ComparisonScene& scene : comparisonScenes()) {
    text +=
        fmt::format("{}\n  {}\n  known from: {}\n  error: {}\n", scene.name, scene.theory, scene.source, scene.errorOf);
  }
  return text;
}

}  // namespace granular
