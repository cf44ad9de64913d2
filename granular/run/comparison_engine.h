// Engines that move a scene: the granular layer with each of its contact-point rules, and Bullet alone. A table of
// them, and the cases of a comparison: which scene, at which size, by which engine with which settings.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "granular/law/law.h"
#include "granular/point/contact_point.h"
#include "granular/run/comparison_scene.h"

namespace granular {

/// Settings of all engines; each reads its own.
struct EngineSettings {
  // granular
  RuleOptions rule;
  LawKind law = LawKind::linear;
  /// The mean body presses a contact that carries its weight in by this many units: k_n = m g/(softness a).
  double softness = 1e-5;
  double fraction = 0.5;  ///< of the bound on the time step
  // bullet
  double step = 1.0 / 240;  ///< s
  int iterations = 10;
  bool scaled = false;  ///< give Bullet lengths in units of a instead of metres
};

struct EngineRun {
  Recording recording;
  double step = 0;  ///< s
  std::int64_t steps = 0;
  double simulated = 0;           ///< s
  double processorTime = 0;       ///< of the run alone, s: of one thread, so that other work on the machine counts not
  std::uint64_t contacts = 0;     ///< contact points summed over steps
  std::uint64_t uncertified = 0;  ///< granular: answers used without certificate
  std::string trouble;            ///< granular: the first trouble named, if there was any
};

using EngineFunction = EngineRun (*)(const SceneSetup&, const EngineSettings&);
/// Throw InputError for settings that can't be used.
EngineRun runGranularScene(const SceneSetup& setup, const EngineSettings& settings);
EngineRun runBulletScene(const SceneSetup& setup, const EngineSettings& settings);

struct ComparisonEngine {
  std::string_view name;
  std::string_view what;
  EngineFunction run;
};
/// The table of engines.
std::span<const ComparisonEngine> comparisonEngines();

struct ComparisonCase {
  const ComparisonScene* scene;
  const ComparisonEngine* engine;
  double unit;  ///< a, m
  EngineSettings settings;

  /// "tower, bullet, a .003 m, dt .00416667 s, 10 iterations": the same case has the same key.
  std::string key() const;
};

/// What a comparison is made of; an empty list stands for all there is.
struct ComparisonChoice {
  std::vector<std::string> scenes, engines, rules;
  std::vector<double> units;       ///< m
  std::vector<double> softnesses;  ///< granular
  std::vector<double> steps;       ///< bullet, s
  std::vector<int> iterations;     ///< bullet
  double fraction = 0.5;           ///< granular
};
/// The cases, scene by scene. Throws InputError for an unknown name or a value out of range.
///
/// Without lists: Bullet at 1 m and 3 mm in metres, and at 3 mm in units of a, steps of 1/60, 1/240 and 1/1000 s, 10
/// and 50 iterations; every rule at 3 mm with softness 1e-4 and 1e-5, the rule patch at 1 m too.
std::vector<ComparisonCase> listCases(const ComparisonChoice& choice);

/// Runs it and judges it.
struct ComparisonResult {
  EngineRun run;
  Verdict verdict;
};
ComparisonResult runCase(const ComparisonCase& which);

}  // namespace granular
