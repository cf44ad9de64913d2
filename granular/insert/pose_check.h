// Poses given by a user or taken from an earlier bed: do they overlap, or stick in a wall?
#pragma once

#include <span>

#include "granular/insert/placement.h"
#include "granular/search/search.h"

namespace granular {

struct PoseOverlap {
  std::int64_t a = 0, b = 0;  ///< ids, a < b
  double overlap = 0;         ///< m
  double fraction = 0;        ///< of the smaller particle's size
};

/// Every pair that overlaps by more than `allowed` of its smaller size (see Shape::size), deepest first. ids: one per
/// particle.
std::vector<PoseOverlap> findOverlaps(std::span<const PlacedShape> particles, std::span<const std::int64_t> ids,
                                      const Periods& periods, double allowed);

/// Throws InputError naming the ten deepest overlaps beyond `allowed`, by id and depth, and how many there are; or a
/// particle that pokes through a wall by more than `allowed` of its size, or lies behind one.
void checkPoses(std::span<const PlacedShape> particles, std::span<const std::int64_t> ids, const Periods& periods,
                std::span<const Wall* const> walls, double allowed);

/// Throws InputError naming the first particle that reaches above the ceiling (m) by more than `allowed` of its size.
void checkBelow(double ceiling, std::span<const PlacedShape> particles, std::span<const std::int64_t> ids,
                double allowed);

}  // namespace granular
