#include "granular/run/comparison_engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "granular/core/errors.h"

namespace granular {
namespace {

const std::array<ComparisonEngine, 2> engines = {
    {{"bullet", "btDiscreteDynamicsWorld: persistent manifolds, sequential impulses", runBulletScene},
     {"granular", "the granular layer", runGranularScene}}};

constexpr std::array allRules = {PointRule::witness,          PointRule::manifold, PointRule::faceCentroid,
                                 PointRule::pressureCentroid, PointRule::patch,    PointRule::foundation,
                                 PointRule::stiffPatch};

constexpr double millimetres = 3e-3, metre = 1;

template <class T>
std::vector<T> orDefault(const std::vector<T>& given, std::vector<T> standard) {
  return given.empty() ? standard : given;
}

void requirePositive(const std::vector<double>& values, const char* name) {
  for (const double value : values) {
    require(std::isfinite(value) && value > 0, fmt::format("{} = {}: must be > 0", name, value));
  }
}

bool has(const std::vector<std::string>& names, std::string_view name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

void checkChoice(const ComparisonChoice& choice) {
  for (const std::string& name : choice.scenes) comparisonSceneFromName(name);
  for (const std::string& name : choice.rules) pointRuleFromName(name);
  for (const std::string& name : choice.engines) {
    require(std::any_of(engines.begin(), engines.end(), [&](const auto& engine) { return engine.name == name; }),
            "engine \"" + name + "\": known are bullet, granular");
  }
  requirePositive(choice.units, "unit");
  requirePositive(choice.softnesses, "softness");
  requirePositive(choice.steps, "dt");
  requirePositive({choice.fraction}, "fraction");
  for (const double softness : choice.softnesses) {
    require(softness < 0.01, fmt::format("softness = {}: must be < 0.01", softness));
  }
  require(choice.fraction <= 1, fmt::format("fraction = {}: must be at most 1", choice.fraction));
  for (const int count : choice.iterations) {
    require(count >= 1 && count <= 10000, fmt::format("iterations = {}: must be 1 to 10000", count));
  }
}

void listBullet(const ComparisonChoice& choice, ComparisonCase each, std::vector<ComparisonCase>& out) {
  for (const double unit : orDefault(choice.units, {metre, millimetres})) {
    each.unit = unit;
    // At 1 m both units of length are the same.
    for (const bool scaled : {false, true}) {
      if (scaled && unit == metre) continue;
      each.settings.scaled = scaled;
      for (const int iterations : orDefault(choice.iterations, {10, 50})) {
        each.settings.iterations = iterations;
        for (const double step : orDefault(choice.steps, {1.0 / 60, 1.0 / 240, 1.0 / 1000})) {
          each.settings.step = step;
          out.push_back(each);
        }
      }
    }
  }
}

void listGranular(const ComparisonChoice& choice, ComparisonCase each, std::vector<ComparisonCase>& out) {
  each.settings.fraction = choice.fraction;
  for (const PointRule rule : allRules) {
    if (!has(choice.rules, pointRuleName(rule))) continue;
    each.settings.rule.rule = rule;
    // The same numbers come out at every size: one rule shows it.
    std::vector<double> units = {millimetres};
    if (rule == PointRule::patch) units.push_back(metre);
    for (const double unit : orDefault(choice.units, units)) {
      each.unit = unit;
      for (const double softness : orDefault(choice.softnesses, {1e-4, 1e-5})) {
        each.settings.softness = softness;
        out.push_back(each);
      }
    }
  }
}

}  // namespace

std::span<const ComparisonEngine> comparisonEngines() { return engines; }

std::string ComparisonCase::key() const {
  const std::string at = fmt::format("{}, {}, a {:g} m", scene->name, engine->name, unit);
  if (engine->run == runBulletScene) {
    return at + fmt::format("{}, dt {:.6g} s, {} iterations", settings.scaled ? " as 1 unit" : "", settings.step,
                            settings.iterations);
  }
  return at + fmt::format(", {}, softness {:g}, {:g} of the bound", pointRuleName(settings.rule.rule),
                          settings.softness, settings.fraction);
}

std::vector<ComparisonCase> listCases(const ComparisonChoice& choice) {
  checkChoice(choice);
  std::vector<ComparisonCase> out;
  for (const ComparisonScene& scene : comparisonScenes()) {
    if (!has(choice.scenes, scene.name)) continue;
    for (const ComparisonEngine& engine : engines) {
      if (!has(choice.engines, engine.name)) continue;
      const ComparisonCase each{&scene, &engine, metre, {}};
      engine.run == runBulletScene ? listBullet(choice, each, out) : listGranular(choice, each, out);
    }
  }
  return out;
}

ComparisonResult runCase(const ComparisonCase& which) {
  const SceneSetup setup = which.scene->build(which.unit);
  ComparisonResult result;
  result.run = which.engine->run(setup, which.settings);
  result.verdict = which.scene->judge(setup, result.run.recording);
  return result;
}

}  // namespace granular
