// A tower's checkpoint: its settings, from which it is built again, the world, and what the watch has seen.
#include <fmt/format.h>

#include "granular/core/errors.h"
#include "granular/io/checkpoint.h"
#include "granular/run/stack_watch.h"
#include "granular/run/world_archive.h"

namespace granular {
namespace {

void visitContact(Archive& archive, ContactParameters& contact) {
  archive.visit("stiffness", contact.stiffness, {"N/m", ""});
  archive.visit("restitution", contact.restitution, {"", "normal"});
  archive.visit("restitution_t", contact.restitutionT, {"", "tangential"});
  archive.visit("friction", contact.friction);
  archive.visit("modulus", contact.modulus, {"Pa", "E*"});
  archive.visit("shear_modulus", contact.shearModulus, {"Pa", "G*"});
  archive.visit("damping_rate_n", contact.dampingRateN, {"1/s", ""});
  archive.visit("damping_rate_t", contact.dampingRateT, {"1/s", ""});
}

void visitModel(Archive& archive, StackSettings& settings) {
  archive.visitEnum("law", settings.law, LawKind::hertzMindlin);
  archive.visit("tension", settings.lawOptions.tension);
  archive.visit("friction_of_push", settings.lawOptions.frictionOfPush);
  archive.visit("local_mass", settings.lawOptions.localMass);
  archive.visit("slide_along_velocity", settings.lawOptions.slideAlongVelocity);
  archive.visitEnum("rule", settings.rule.rule, PointRule::foundation, {"", "contact-point rule"});
  archive.visit("slab", settings.rule.slab);
  archive.visit("sharpness", settings.rule.sharpness);
}

void visitSettings(Archive& archive, StackSettings& settings) {
  archive.visit("count", settings.count, {"", "cuboids"});
  archive.visit("time", settings.time, {"s", "asked for"});
  archive.visit("side", settings.side, {"m", ""});
  archive.visit("height", settings.height, {"m", "of a cuboid; 0: as the side"});
  archive.visit("sizes", settings.sizes, {"", "factors on side and height"});
  archive.visit("density", settings.density, {"kg/m^3", ""});
  archive.inGroup("contact", [&] { visitContact(archive, settings.contact); });
  archive.inGroup("model", [&] { visitModel(archive, settings); });
  archive.visit("gravity", settings.gravity, {"m/s^2", ""});
  archive.visit("step", settings.step, {"s", "asked for; 0: the fraction of the bound"});
  archive.visit("fraction", settings.fraction);
  archive.visit("perturbation", settings.perturbation);
  archive.visit("seed", settings.seed);
  archive.visit("sway", settings.sway);
  archive.visitEnum("start", settings.start, StackSettings::Start::drop);
  archive.visit("gap", settings.gap);
  archive.visit("skip", settings.skip);
  archive.visit("sample_every", settings.sampleEvery, {"s", ""});
  archive.visit("fallen_drift", settings.fallenDrift, {"", "over the side"});
  archive.visit("fallen_tilt", settings.fallenTilt, {"rad", ""});
}

}  // namespace

void StackWatch::visitState(Archive& archive) {
  archive.visit("fell_at", result.fellAt, {"s", "negative: it stands"});
  archive.visit("max_drift", result.maxDrift, {"", "over the side"});
  archive.visit("max_tilt", result.maxTilt, {"rad", ""});
  archive.inGroup("samples", [&] {
    archive.visitMember("time", result.samples, &StackSample::time, {"s", ""});
    archive.visitMember("kinetic_energy", result.samples, &StackSample::kineticEnergy, {"J", "mean of the interval"});
    archive.visitMember("speed", result.samples, &StackSample::speed, {"m/s", "mean of interval and cuboids"});
    archive.visitMember("drift", result.samples, &StackSample::drift, {"", "over the side"});
    archive.visitMember("tilt", result.samples, &StackSample::tilt, {"rad", ""});
  });
  // The forces between layers: a row of one number per cuboid for each time.
  archive.inGroup("layers", [&] {
    archive.visitMember("time", layers, &LayerSample::time, {"s", ""});
    std::vector<double> forces;
    for (const LayerSample& each : layers) forces.insert(forces.end(), each.force.begin(), each.force.end());
    archive.visit("force", forces, {"N", "upward on each cuboid from what is below it, time after time"});
    if (!archive.loading()) return;
    const auto count = static_cast<std::size_t>(settings.count);
    require(forces.size() == layers.size() * count, "checkpoint: layers/force has not one number per cuboid and time");
    for (std::size_t k = 0; k < layers.size(); ++k) {
      const auto begin = forces.begin() + static_cast<std::ptrdiff_t>(k * count);
      layers[k].force.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
    }
  });
}

void StackRun::visitState(Archive& archive) {
  archive.visit("time_step", dt, {"s", ""});
  archive.visit("wall", wall, {"s", "wall time"});
  archive.inGroup("watch", [&] { tower->visitState(archive); });
  archive.visitGroup("world", *world);
}

void StackRun::save(const std::filesystem::path& folder) {
  Archive archive;
  archive.inGroup("tower", [&] { visitSettings(archive, chosen); });
  visitState(archive);
  saveCheckpoint(folder, archive);
}

StackRun StackRun::resumed(const std::filesystem::path& folder, std::optional<double> time) {
  Archive archive = loadCheckpoint(folder);
  require(archive.has("tower"),
          fmt::format("{}: the checkpoint can't be used: it is not that of a tower", folder.string()));
  StackSettings settings;
  archive.inGroup("tower", [&] { visitSettings(archive, settings); });
  if (time) settings.time = *time;
  StackRun run(settings);
  run.visitState(archive);
  archive.requireAllRead();
  require(run.time() < settings.time, fmt::format("{}: time = {:g} s: the checkpoint is already at {:g} s",
                                                  folder.string(), settings.time, run.time()));
  return run;
}

}  // namespace granular
