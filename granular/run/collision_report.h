// Studies of binary collisions as text: a table for people, JSON under stable keys, CSV for plots.
#pragma once

#include <string>
#include <vector>

#include "granular/run/collision_study.h"

namespace granular {

/// One study of one pair.
struct CollisionRow {
  CollisionPair pair;
  CollisionOptions options;
  CollisionResult result;
};

/// "cube-sphere"; either order is the same pair. Throws InputError listing the pairs.
CollisionPair findCollisionPair(std::string_view name);

/// One line per row under a header.
std::string formatCollisionTable(const std::vector<CollisionRow>& rows);
/// One row: its keys at the top level. Several: under "rows".
std::string formatCollisionJson(const std::vector<CollisionRow>& rows);
std::string formatCollisionCsv(const std::vector<CollisionRow>& rows);

}  // namespace granular
