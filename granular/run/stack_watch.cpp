#include "granular/run/stack_watch.h"

#include <algorithm>
#include <cmath>

namespace granular {
namespace {

/// Over which energies and forces are averaged, s.
constexpr double window = 0.1;

}  // namespace

StackWatch::StackWatch(const StackSettings& chosen, std::vector<Pose> placed)
    : settings(chosen), start(std::move(placed)) {}

const StackSample& StackWatch::sample(double time, const std::vector<Pose>& poses,
                                      const std::vector<double>& layerForces) {
  StackSample s;
  s.time = time;
  s.kineticEnergy = noted > 0 ? energySum / static_cast<double>(noted) : 0;
  s.speed = noted > 0 ? speedSum / static_cast<double>(noted) : 0;
  energySum = speedSum = 0;
  noted = 0;

  bool fell = false;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const double side = 2 * halfLengths(settings, static_cast<int>(k)).x();
    const double drift = (poses[k].x - start[k].x).head<2>().norm() / side;
    const double cosine = (poses[k].q * Vec3::UnitZ()).dot(start[k].q * Vec3::UnitZ());
    const double tilt = std::atan2((poses[k].q * Vec3::UnitZ()).cross(start[k].q * Vec3::UnitZ()).norm(), cosine);
    fell = fell || !(drift < settings.fallenDrift && tilt < settings.fallenTilt);
    s.drift = std::max(s.drift, drift);
    s.tilt = std::max(s.tilt, tilt);
  }
  if (fell && !fallen()) result.fellAt = time;
  result.maxDrift = std::max(result.maxDrift, s.drift);
  result.maxTilt = std::max(result.maxTilt, s.tilt);

  layers.push_back({time, layerForces});
  const auto old = std::find_if(layers.begin(), layers.end(),
                                [time](const LayerSample& each) { return each.time > time - 1.5 * window; });
  layers.erase(layers.begin(), old);
  result.samples.push_back(s);
  return result.samples.back();
}

double StackWatch::worstInterlayer(double from) const {
  double worst = 0, weight = 0;
  for (int k = settings.count - 1; k >= 0; --k) {
    weight += massOf(settings, k) * settings.gravity;
    double sum = 0;
    int count = 0;
    for (const LayerSample& each : layers) {
      if (each.time < from) continue;
      sum += each.force[static_cast<std::size_t>(k)];
      ++count;
    }
    if (count > 0) worst = std::max(worst, std::abs(sum / count / weight - 1));
  }
  return worst;
}

double StackWatch::energyTrend(double from) const {
  // Least squares of ln E over the samples: each is a mean over an interval.
  double n = 0, st = 0, sy = 0, stt = 0, sty = 0;
  for (const StackSample& s : result.samples) {
    if (s.time < from || !(s.kineticEnergy > 0)) continue;
    const double t = s.time - from, y = std::log(s.kineticEnergy);
    n += 1;
    st += t;
    sy += y;
    stt += t * t;
    sty += t * y;
  }
  const double spread = n * stt - st * st;
  return n >= 3 && spread > 0 ? (n * sty - st * sy) / spread : 0;
}

StackResult StackWatch::finish(double time) {
  result.simulated = time;
  result.standing = !fallen();
  result.worstInterlayer = worstInterlayer(time - std::min(window, 0.1 * settings.time));
  result.energyTrend = energyTrend(2 * time / 3);
  double sum = 0;
  int count = 0;
  for (const StackSample& s : result.samples) {
    if (s.time <= time - std::min(window, 0.1 * settings.time)) continue;
    sum += s.kineticEnergy;
    ++count;
  }
  result.kineticEnergy = count > 0 ? sum / count : 0;
  return std::move(result);
}

}  // namespace granular
