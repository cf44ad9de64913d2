// Scenes whose outcome theory tells, for a comparison of contacts: each is a row of one table, with a function that
// builds it and one that judges a recorded motion. Engines know nothing of the theory, scenes nothing of the engines.
//
// All lengths of a scene are multiples of its unit a, all times of sqrt(a/g): a scene is the same problem at every
// size.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "granular/shape/shape.h"

namespace granular {

struct SceneBody {
  std::shared_ptr<const Shape> shape;
  Pose pose;
  Vec3 velocity = Vec3::Zero();  ///< m/s
  Vec3 spin = Vec3::Zero();      ///< rad/s, world axes
  bool fixed = false;
};

struct ScenePlane {
  Vec3 point, normal;  ///< bodies live where normal . (x - point) > 0
};

struct SceneSetup {
  double unit = 1;        ///< a, m
  double gravity = 9.81;  ///< along -z, m/s^2
  double density = 2500;  ///< kg/m^3
  double friction = 0.5;
  double restitution = 0.3;
  std::vector<SceneBody> bodies;
  std::vector<ScenePlane> planes;
  double duration = 0;      ///< s
  double sampleEvery = 0;   ///< s
  int contactsPerBody = 2;  ///< at most, as the bound on the time step assumes

  double timeUnit() const;  ///< sqrt(a/g), s
  double mass(std::size_t body) const;
};

struct BodyMotion {
  Pose pose;
  Vec3 velocity = Vec3::Zero();  ///< m/s
  Vec3 spin = Vec3::Zero();      ///< rad/s, world axes
};

struct Snapshot {
  double time = 0;  ///< s
  std::vector<BodyMotion> bodies;
};

/// The first snapshot is the start. A motion that is no longer finite ends the recording with the last finite one.
struct Recording {
  std::vector<Snapshot> snapshots;
  bool finite = true;
};

struct Verdict {
  bool asTheory = false;
  std::optional<double>
      error;  ///< what the row's errorOf says; none: theory only says what happens, or nothing was seen
  std::string observed;
};

struct ComparisonScene {
  std::string_view name;
  std::string_view theory;   ///< what must happen
  std::string_view source;   ///< where that is known from
  std::string_view errorOf;  ///< what the error is, and the bound below which the motion counts as theory's
  std::function<SceneSetup(double unit)> build;
  std::function<Verdict(const SceneSetup&, const Recording&)> judge;
};

/// The table of scenes.
std::span<const ComparisonScene> comparisonScenes();
/// Throws InputError naming the known ones.
const ComparisonScene& comparisonSceneFromName(std::string_view name);

}  // namespace granular
