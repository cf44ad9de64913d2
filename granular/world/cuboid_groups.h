// Pairs of cuboids on their way into lanes: with each other and with flat walls.
#pragma once

#include "granular/point/cuboid_overlap.h"
#include "granular/world/lane_groups.h"

namespace granular {

using CuboidFaceGroup = LaneGroup<CuboidPair<Wide>, FaceLook<Wide>>;
using CuboidEdgeGroup = LaneGroup<CuboidPair<Wide>, EdgeLook<Wide>>;

}  // namespace granular
