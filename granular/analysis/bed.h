// A packing as the analysis sees it: placed shapes, contacts, and the vessel around them. Nothing of the simulation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "granular/shape/shape.h"

namespace granular {

struct BedContact {
  std::int32_t a = 0, b = -1;   ///< indices into particles; b = -1: a wall
  Vec3 point = Vec3::Zero();    ///< m
  Vec3 normal = Vec3::UnitZ();  ///< unit, from a to b
  Vec3 force = Vec3::Zero();    ///< on a, N
  double overlap = 0;           ///< m
};

/// What holds the bed. Axis along z; the floor at z = floor.
struct Vessel {
  enum class Kind { none, cylinder, box, periodic };
  Kind kind = Kind::none;
  Vec3 lo = Vec3::Zero(), hi = Vec3::Zero();  ///< box and periodic: bounds, m
  bool periodicX = true, periodicY = true;    ///< periodic: along these; walls at lo and hi along the other
  bool periodicHeight = false;                ///< periodic: along z too, without a floor
  /// Along which of x, y, z the bed repeats.
  std::array<bool, 3> repeats() const {
    if (kind != Kind::periodic) return {false, false, false};
    return {periodicX, periodicY, periodicHeight};
  }
  Vec2 axis = Vec2::Zero();  ///< cylinder
  double radius = 0;         ///< cylinder, m
  double floor = 0;          ///< m
};

struct Bed {
  std::vector<const Shape*> shapes;  ///< one per particle
  std::vector<Frame> frames;
  std::vector<BedContact> contacts;
  Vessel vessel;
  std::size_t size() const { return frames.size(); }
};

}  // namespace granular
