#include "granular/run/stack_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace granular {

std::string describeSample(const StackSample& s) {
  return fmt::format("t = {:.3f} s, kinetic energy {:.2e} J, drift {:.1e} sides, tilt {:.1e} rad", s.time,
                     s.kineticEnergy, s.drift, s.tilt);
}

std::string describeStack(const StackSettings& settings, const std::string& engine, const StackResult& r) {
  std::string text = fmt::format("stack: {} cuboids, {}, dt {:.3g} s, k_n {:.3g} N/m: ", settings.count,
                                 engine == "bullet" ? "Bullet's own contacts" : pointRuleName(settings.rule.rule),
                                 r.step, settings.contact.stiffness);
  text +=
      r.standing ? fmt::format("stands after {:.4g} s\n", r.simulated) : fmt::format("fell at {:.4g} s\n", r.fellAt);
  text += fmt::format("largest drift {:.3g} sides, largest tilt {:.3g} rad\n", r.maxDrift, r.maxTilt);
  text += fmt::format(
      "kinetic energy {:.3g} J over the last tenth of a second, changing by {:+.3g} /s (of its logarithm)\n",
      r.kineticEnergy, r.energyTrend);
  text += fmt::format("forces between layers: within {:.2g} of the weight above\n", r.worstInterlayer);
  text += fmt::format("speed: {:.1f} s wall, {} steps, {:.0f} ns per contact; {} uncertified contacts\n", r.wallTime,
                      r.steps, r.nsPerContact, r.uncertified);
  return text;
}

std::string stackToJson(const StackSettings& s, const std::string& engine, const StackResult& r) {
  nlohmann::ordered_json json;
  json["engine"] = engine;
  json["count"] = s.count;
  json["rule"] = engine == "bullet" ? "bullet" : std::string(pointRuleName(s.rule.rule));
  json["slab"] = s.rule.slab;
  json["sharpness"] = s.rule.sharpness;
  json["law"] = std::string(lawName(s.law));
  json["stiffness_n_per_m"] = s.contact.stiffness;
  json["restitution"] = s.contact.restitution;
  json["friction"] = s.contact.friction;
  json["side_m"] = s.side;
  json["perturbation"] = s.perturbation;
  json["start"] = s.start == StackSettings::Start::drop ? "drop" : "equilibrium";
  json["seed"] = s.seed;
  json["dt_s"] = r.step;
  json["steps"] = r.steps;
  json["simulated_s"] = r.simulated;
  json["standing"] = r.standing;
  if (r.standing) {
    json["fell_at_s"] = nullptr;
  } else {
    json["fell_at_s"] = r.fellAt;
  }
  json["max_drift_over_side"] = r.maxDrift;
  json["max_tilt_rad"] = r.maxTilt;
  json["kinetic_energy_j"] = r.kineticEnergy;
  json["kinetic_energy_trend_per_s"] = r.energyTrend;
  json["worst_interlayer_error"] = r.worstInterlayer;
  json["max_overlap_over_size"] = r.deepestOverlap;
  json["uncertified"] = r.uncertified;
  json["wall_s"] = r.wallTime;
  json["ns_per_contact"] = r.nsPerContact;
  json["version"] = GRANULAR_VERSION;
  return json.dump(2) + "\n";
}

std::string samplesToCsv(const StackResult& result) {
  std::string text = "time_s,kinetic_energy_j,mean_speed_m_per_s,drift_over_side,tilt_rad\n";
  for (const StackSample& s : result.samples) {
    text += fmt::format("{:.9g},{:.6g},{:.6g},{:.6g},{:.6g}\n", s.time, s.kineticEnergy, s.speed, s.drift, s.tilt);
  }
  return text;
}

std::string posesToCsv(const StackSettings& settings, const StackResult& result) {
  std::string text = "half_x_m,half_y_m,half_z_m,x_m,y_m,z_m,qw,qx,qy,qz\n";
  for (std::size_t k = 0; k < result.poses.size(); ++k) {
    const Vec3 half = halfLengths(settings, static_cast<int>(k));
    const Pose& p = result.poses[k];
    text += fmt::format("{:.9g},{:.9g},{:.9g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", half.x(),
                        half.y(), half.z(), p.x.x(), p.x.y(), p.x.z(), p.q.w(), p.q.x(), p.q.y(), p.q.z());
  }
  return text;
}

}  // namespace granular
