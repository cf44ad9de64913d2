// Scenes for measuring whole steps, made from a seed alone: dense beds of one family of shapes on a floor, periodic
// across; a hundred spheres above a bed that sleeps; spheres in free fall; spheres that run out of a hopper; packed
// cubes from a file of poses.
//
// A dense bed takes no pouring. Bodies are put on a lattice at the solid fraction of a bed, turned at random, so that
// neighbours overlap; overdamped motion drives the overlaps out, and a hundredfold weight that is then taken off again
// settles what is left. A large bed is a small one repeated: its motion starts periodic, but nothing knows that.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "granular/world/world.h"

namespace granular::benchmarks {

struct BedSettings {
  std::string scene = "spheres";
  int count = 1000;  ///< bodies wanted; beds that repeat a patch round it to a multiple of the patches
  std::uint64_t seed = 1;
  bool shuffled = false;  ///< dense beds: in an order at random, as bodies that were poured lie
  WorldOptions options;   ///< of the world to be timed; its periods and sleep are the scene's
};

/// Names of the scenes that makeBed knows.
std::vector<std::string> bedScenes();

/// The scene at rest or, for free_fall and hopper, at its start. Throws InputError for an unknown scene or a count
/// below 1.
std::unique_ptr<World> makeBed(const BedSettings& settings);

/// Packed cubes in an open box from a file: a comment line, "# count base side", then x y z qw qx qy qz per line (m).
/// Throws InputError if it can't be read.
std::unique_ptr<World> loadCubes(const std::string& file, const WorldOptions& options);

}  // namespace granular::benchmarks
