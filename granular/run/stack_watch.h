// Watches a tower while it stands: samples, drift and tilt, the forces between its layers, and how its motion decays.
#pragma once

#include "granular/io/archive.h"
#include "granular/run/stack.h"

namespace granular {

class StackWatch {
 public:
  StackWatch(const StackSettings& settings, std::vector<Pose> placed);

  /// To be called often, with the same time between calls. energy: kinetic, J; speed: mean over the cuboids, m/s.
  void note(double energy, double speed) {
    energySum += energy;
    speedSum += speed;
    ++noted;
  }
  /// Ends an interval: writes a sample. layerForces: upward force on cuboid k from below, N.
  const StackSample& sample(double time, const std::vector<Pose>& poses, const std::vector<double>& layerForces);
  bool fallen() const { return result.fellAt >= 0; }
  /// Everything that samples tell.
  StackResult finish(double time);
  /// All that it knows just after a sample, when no interval is begun.
  void visitState(Archive& archive);

 private:
  struct LayerSample {
    double time;
    std::vector<double> force;
  };
  double worstInterlayer(double from) const;
  double energyTrend(double from) const;

  const StackSettings settings;
  std::vector<Pose> start;
  StackResult result;
  std::vector<LayerSample> layers;  ///< of the last tenth of a second
  double energySum = 0, speedSum = 0;
  std::int64_t noted = 0;
};

}  // namespace granular
