// The narrow phase and the contact-point rules: pairs of hard shapes in any pose, judged as the stress tests judge
// them. Orientations are made of small whole numbers, so that parallel faces and edges come by themselves.
#include <cstdio>

#include "fuzz/fuzz_input.h"
#include "stress/pair_trial.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace granular;
  using namespace granular::stress;
  static HardShapes shapes(0);
  fuzz::Input input(data, size);
  PairSample pair;
  pair.a = shapes.get(input.take<std::uint8_t>() % shapes.count(), 0);
  pair.b = shapes.get(input.take<std::uint8_t>() % shapes.count(), input.take<std::int8_t>() % 3);

  const auto takeRotation = [&] {
    Quat q;
    for (double& part : q.coeffs()) part = input.take<std::int8_t>();
    return q.norm() > 0 ? q.normalized() : Quat::Identity();
  };
  pair.poseA.q = takeRotation();
  pair.poseB.q = takeRotation();
  Vec3 place;
  for (double& part : place) part = input.take<std::int16_t>() / 16384.0;  // up to twice the reach
  pair.poseB.x = pair.reach() * place;
  // Where they lie, or moved along that line to a depth from a tenth of a billionth of the size to a tenth.
  const auto depth = input.take<std::int8_t>();
  if (depth != 0 && place.norm() > 0) {
    const double wanted = std::copysign(pair.size() * std::pow(10.0, -1 - std::abs(depth) / 14.0), depth);
    moveToDepth(pair, place.normalized(), wanted);
  }
  if (!pair.poseB.x.allFinite() || pair.poseB.x.norm() > 100 * pair.reach()) return 0;

  const TrialOutcome out = tryPair(pair, 1, input.take<std::uint32_t>(), true);
  std::string fault = out.fault;
  for (std::size_t rule = 0; rule < out.ruleFaults.size() && fault.empty(); ++rule) {
    if (!out.ruleFaults[rule].empty())
      fault = std::string(pointRuleName(static_cast<PointRule>(rule))) + ": " + out.ruleFaults[rule];
  }
  if (!fault.empty()) {
    std::fprintf(stderr, "%s: %s\n", pair.describe().c_str(), fault.c_str());
    std::abort();
  }
  return 0;
}
