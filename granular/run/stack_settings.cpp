#include "granular/run/stack_settings.h"

#include <cmath>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/point/rules.h"
#include "granular/run/stack_modes.h"

namespace granular {
namespace {

double factorOf(const StackSettings& settings, int k) {
  if (settings.sizes.empty()) return 1;
  return settings.sizes[static_cast<std::size_t>(k) % settings.sizes.size()];
}

/// Overlap of a face contact that carries `weight`, m.
double restingOverlap(const StackSettings& settings, int k, double weight) {
  const bool shares = settings.rule.rule == PointRule::foundation;
  return weight / (settings.contact.stiffness * (shares ? foundationShare(settings, k) : 1));
}

}  // namespace

Vec3 halfLengths(const StackSettings& settings, int k) {
  const double height = settings.height > 0 ? settings.height : settings.side;
  return 0.5 * factorOf(settings, k) * Vec3(settings.side, settings.side, height);
}

double massOf(const StackSettings& settings, int k) { return settings.density * 8 * halfLengths(settings, k).prod(); }

double foundationShare(const StackSettings& settings, int k) {
  const Vec3 upper = halfLengths(settings, k), lower = halfLengths(settings, k > 0 ? k - 1 : k);
  const double side = 2 * std::min(upper.x(), lower.x());
  const double volume = 8 * std::min(upper.prod(), lower.prod());
  return side * side / referenceArea(std::cbrt(0.75 * volume / pi));
}

std::vector<Pose> placeStack(const StackSettings& settings) {
  // Weight that each interface carries, from the top down.
  const auto count = static_cast<std::size_t>(settings.count);
  std::vector<double> load(count);
  double weight = 0;
  for (int k = settings.count - 1; k >= 0; --k) {
    weight += massOf(settings, k) * settings.gravity;
    load[static_cast<std::size_t>(k)] = weight;
  }

  SwayMode mode;
  if (settings.sway != 0) mode = findLowestSway(settings);
  Random random(settings.seed);
  const double p = settings.perturbation;
  std::vector<Pose> poses(count);
  double top = 0;
  for (int k = 0; k < settings.count; ++k) {
    const Vec3 half = halfLengths(settings, k);
    const double spacing = settings.start == StackSettings::Start::drop
                               ? settings.gap * settings.side
                               : -restingOverlap(settings, k, load[static_cast<std::size_t>(k)]);
    Pose& pose = poses[static_cast<std::size_t>(k)];
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    const Vec3 turn = Random::drawComponents([&] { return random.uniform(-1, 1); });
    pose.x = Vec3(p * settings.side * x, p * settings.side * y, top + spacing + half.z());
    pose.q = rotationFromVector(p * turn);
    if (settings.sway != 0) {
      const double off = settings.sway * settings.side;
      pose.x.x() += off * mode.way[static_cast<std::size_t>(k)];
      pose.q = rotationFromVector(Vec3(0, off * mode.tilt[static_cast<std::size_t>(k)], 0)) * pose.q;
    }
    top += spacing + 2 * half.z();
  }
  return poses;
}

void checkStack(const StackSettings& settings) {
  const auto positive = [](double value, const char* name) {
    require(std::isfinite(value) && value > 0, std::string(name) + " = " + std::to_string(value) + ": must be > 0");
  };
  require(settings.count >= 1 && settings.count <= 100000,
          "count = " + std::to_string(settings.count) + ": must be 1 to 100000");
  positive(settings.time, "time");
  positive(settings.side, "side");
  positive(settings.density, "density");
  positive(settings.gravity, "gravity");
  positive(settings.fraction, "fraction");
  positive(settings.sampleEvery, "sample interval");
  for (const double factor : settings.sizes) positive(factor, "size factor");
  require(settings.height >= 0, "height = " + std::to_string(settings.height) + ": must be >= 0");
  require(settings.step >= 0, "dt = " + std::to_string(settings.step) + ": must be >= 0");
  require(settings.gap >= 0, "gap = " + std::to_string(settings.gap) + ": must be >= 0");
  require(settings.perturbation >= 0 && settings.perturbation < 0.1,
          "perturbation = " + std::to_string(settings.perturbation) + ": must be in [0, 0.1)");
  require(std::abs(settings.sway) < 0.1, "sway = " + std::to_string(settings.sway) + ": must be in (-0.1, 0.1)");
  require(settings.rule.sharpness >= 1 && settings.rule.sharpness <= 1000,
          "sharpness = " + std::to_string(settings.rule.sharpness) + ": must be 1 to 1000");
  require(settings.rule.slab > 0 && settings.rule.slab <= 1,
          "slab = " + std::to_string(settings.rule.slab) + ": must be in (0, 1]");
}

}  // namespace granular
