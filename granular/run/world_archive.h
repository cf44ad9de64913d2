// The whole state of a run as an archive: what it needs to go on to the same bits.
#pragma once

#include "granular/energy/series.h"
#include "granular/insert/inserter.h"
#include "granular/io/archive.h"
#include "granular/io/vtk_writer.h"
#include "granular/world/world.h"

namespace granular {

struct RunProgress;
struct SceneSource;

/// Bodies, pairs with their caches and histories, the search's boxes, sleep, report. Shapes, materials, walls and
/// options come from the scene and must be there before loading.
void describe(Archive& archive, World& world);
/// From which everything else of a packing can be built.
void describe(Archive& archive, SceneSource& source);
void describe(Archive& archive, PourState& state);
void describe(Archive& archive, RunProgress& progress);
void describe(Archive& archive, EnergySeries& series);
void describe(Archive& archive, std::vector<FrameSeries::Entry>& frames);

}  // namespace granular
