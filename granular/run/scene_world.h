// From a scene to a world: materials, walls, options, the region particles are poured into.
#pragma once

#include <memory>

#include "granular/analysis/bed.h"
#include "granular/insert/placement.h"
#include "granular/io/scene.h"
#include "granular/world/world.h"

namespace granular {

/// An empty world with the scene's materials and walls. Throws InputError for what only shows here: a wall mesh that
/// can't be used, an unknown rule or law.
std::unique_ptr<World> makeWorld(const Scene& scene);

/// Where particles may be put: the inside of the vessel; empty without one.
Region makeRegion(const Scene& scene);

/// The vessel as the analysis sees it.
Vessel makeVessel(const Scene& scene);

/// One line: what this scene skips, and why it may.
std::string describeSkips(const Scene& scene);

}  // namespace granular
