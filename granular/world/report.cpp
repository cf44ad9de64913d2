#include "granular/world/report.h"

#include <fmt/format.h>

namespace granular {

std::string_view stageName(Stage stage) {
  constexpr std::array<std::string_view, stageCount> names{"walls", "predict", "search",  "contacts", "points",
                                                           "laws",  "gather",  "advance", "watch"};
  return names[static_cast<std::size_t>(stage)];
}

void Report::add(const Trouble& trouble) {
  constexpr std::uint64_t namedPerKind = 20;
  std::uint64_t& count = troubleCounts[static_cast<std::size_t>(trouble.kind)];
  if (count++ < namedPerKind) troubles.push_back(trouble);
}

std::string describe(const Trouble& trouble) {
  const std::string who = trouble.bodyB >= 0     ? fmt::format("bodies {} and {}", trouble.bodyA, trouble.bodyB)
                          : trouble.wall.empty() ? fmt::format("body {}", trouble.bodyA)
                                                 : fmt::format("body {} and wall '{}'", trouble.bodyA, trouble.wall);
  switch (trouble.kind) {
    case Trouble::Kind::nonFinite:
      return fmt::format("t = {:.6g} s: {}: position or velocity is not a finite number", trouble.time, who);
    case Trouble::Kind::deepOverlap:
      return fmt::format("t = {:.6g} s: {}: overlap is {:.1f} % of the size", trouble.time, who, 100 * trouble.value);
    case Trouble::Kind::tooFast:
      return fmt::format("t = {:.6g} s: {}: speed {:.4g} m/s is more than the time step resolves", trouble.time, who,
                         trouble.value);
    case Trouble::Kind::uncertified:
      return fmt::format("t = {:.6g} s: {}: an overlap was used that no bound could certify", trouble.time, who);
    case Trouble::Kind::escaped:
      return fmt::format("t = {:.6g} s: {}: left the domain", trouble.time, who);
    case Trouble::Kind::energyGain:
      return fmt::format("t = {:.6g} s: {:.4g} J of kinetic and potential energy have come from nothing", trouble.time,
                         trouble.value);
  }
  return {};
}

}  // namespace granular
