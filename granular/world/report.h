// What a run tells about itself: the contact certificate, the deepest overlap, the time of each stage, and any trouble.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "granular/narrow/narrow.h"

namespace granular {

enum class Stage { walls, predict, search, contacts, points, laws, gather, advance, watch };
inline constexpr int stageCount = 9;
std::string_view stageName(Stage stage);

/// Something went wrong at run time: named, with the bodies and the time.
struct Trouble {
  enum class Kind { nonFinite, deepOverlap, tooFast, uncertified, escaped, energyGain };
  static constexpr std::size_t kinds = 6;
  Kind kind = Kind::nonFinite;
  double time = 0;          ///< s
  std::int64_t bodyA = -1;  ///< ids; -1: none
  std::int64_t bodyB = -1;
  std::string wall;  ///< name of the wall, if one is part of it
  double value = 0;  ///< overlap over size, speed in m/s, or energy in J
};
std::string describe(const Trouble& trouble);

struct Report {
  NarrowCounts narrow;                        ///< the contact certificate, summed over the run
  double deepestOverlap = 0;                  ///< over the smaller body's size, largest of the run
  double deepestTime = 0;                     ///< s
  std::int64_t deepestA = -1, deepestB = -1;  ///< ids
  std::uint64_t contactSteps = 0;             ///< contacts summed over steps
  std::uint64_t bodySteps = 0;                ///< moving bodies summed over steps
  std::array<double, stageCount> seconds{};   ///< of each stage, from a sample of the steps
  std::vector<Trouble> troubles;              ///< the first few of each kind
  std::array<std::uint64_t, Trouble::kinds> troubleCounts{};

  /// Counts a trouble, and keeps the first few of each kind.
  void add(const Trouble& trouble);
};

}  // namespace granular
