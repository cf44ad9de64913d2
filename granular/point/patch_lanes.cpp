#include "granular/point/patch_lanes.h"

namespace granular {
namespace {

/// Where a stiff patch presses, and how deep it is (stiff_patch.cpp). The powers are those of the depth over the
/// overlap.
struct StiffPatch {
  Mask<Wide> good;
  Place centre;
  Wide depth, squaredDepth;
};
StiffPatch pressStiffPatch(const OverlapLanes& sums, const Wide& overlap, double p) {
  using Lanes = OverlapLanes;
  const Wide at = sums[Lanes::at], one = 1 + Wide{};
  const Wide u = sums[Lanes::above] / choose(at > 0, at, one);
  const Wide weight = (p + 1) * at - p * u * sums[Lanes::below];
  StiffPatch out;
  out.good = both(at > 0, weight > 0);
  const Wide perWeight = 1 / choose(out.good, weight, one);
  out.centre = {perWeight * ((p + 1) * sums[Lanes::atX] - p * u * sums[Lanes::belowX]),
                perWeight * ((p + 1) * sums[Lanes::atY] - p * u * sums[Lanes::belowY])};
  out.depth = smaller(Wide(overlap * u * weight / choose(out.good, at, one)), overlap);
  out.squaredDepth = overlap * u * overlap * u;
  return out;
}

}  // namespace

void store(const Fan& fan, OverlapLanes& sums) {
  const auto found = fan.sums();
  for (std::size_t n = 0; n < found.size(); ++n) storeWide(found[n], sums.moment[n]);
}
void storePowers(const Wide& area, const Wide& x, const Wide& y, int exponent, OverlapLanes& sums) {
  const auto found = powersOfTips(area, x, y, exponent);
  for (std::size_t n = 0; n < found.size(); ++n) storeWide(found[n], sums.power[n]);
}
void storeTips(const Fan& fan, int exponent, OverlapLanes& sums) {
  using Lanes = OverlapLanes;
  store(fan, sums);
  if (exponent > 0) storePowers(sums[Lanes::area], sums[Lanes::x], sums[Lanes::y], exponent, sums);
}

PressLanes findPress(const OverlapLanes& sums) {
  using Lanes = OverlapLanes;
  PressLanes out;
  const Wide area = sums[Lanes::area], volume = sums[Lanes::volume], one = 1 + Wide{};
  out.good = both(area > 0, volume > 0);
  out.perArea = 1 / choose(out.good, area, one);
  const Wide perVolume = 1 / choose(out.good, volume, one);
  out.centre = {out.perArea * sums[Lanes::x], out.perArea * sums[Lanes::y]};
  out.press = {perVolume * sums[Lanes::volumeX], perVolume * sums[Lanes::volumeY]};
  return out;
}

PatchLanes placePress(const LaneLook<Wide>& look, const PressLanes& found, const Wide& height, const OverlapLanes& sums,
                      const RuleOptions& rule) {
  using Lanes = OverlapLanes;
  const Place& centre = found.centre;
  Place press = found.press;
  PatchLanes out;
  out.good = found.good;
  out.area = sums[Lanes::area];
  out.xx = found.perArea * sums[Lanes::xx] - centre.x * centre.x;
  out.yy = found.perArea * sums[Lanes::yy] - centre.y * centre.y;
  out.xy = found.perArea * sums[Lanes::xy] - centre.x * centre.y;
  out.depth = look.depth;
  out.squaredDepth = look.depth * look.depth;
  if (rule.rule == PointRule::stiffPatch) {
    const StiffPatch stiff = pressStiffPatch(sums, look.depth, rule.sharpness);
    out.good = both(out.good, stiff.good);
    press = stiff.centre;
    out.depth = stiff.depth;
    out.squaredDepth = stiff.squaredDepth;
  }
  const auto lift = [&](const Place& p) { return look.middle + p.x * look.x + p.y * look.y + height * look.z; };
  out.point = lift(press);
  out.centre = rule.rule == PointRule::pressureCentroid ? out.point : lift(centre);
  if (rule.rule == PointRule::pressureCentroid) out.area = out.xx = out.yy = out.xy = Wide{};
  return out;
}

}  // namespace granular
