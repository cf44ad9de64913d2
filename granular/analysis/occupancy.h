// Point porosity (S eq. A.1): is a point inside a particle? A grid of cells over the bed lists, for each cell, the
// particles that may reach into it, so that a query tests two or three shapes whatever the size of the bed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "granular/analysis/bed.h"

namespace granular {

class Occupancy {
 public:
  /// Keeps pointers to the bed's shapes, which must outlive it; the frames are copied. Periodic vessels get the images
  /// of particles that cross a boundary.
  explicit Occupancy(const Bed& bed);

  /// Index of a particle that contains the point (surface included), -1 for a void. Thread-safe.
  std::int32_t find(const Vec3& p) const;
  bool contains(const Vec3& p) const { return find(p) >= 0; }

  /// Bounds of all particles, m (images not counted).
  const Aabb& bounds() const { return box; }

 private:
  /// A particle or one of its periodic images.
  struct Placement {
    Frame frame;
    double outerSquared, innerSquared;
    const Shape* shape;
    std::int32_t particle;
  };

  void place(const Bed& bed);
  void sizeCells(const Bed& bed);
  void fillCells(const Bed& bed);
  Vec3 wrap(const Vec3& p) const;
  /// True unless a box around the shape, aligned with its axes, stays clear of the cell's ball.
  bool reaches(const Placement& placement, const Vec3& halfExtent, const Vec3& cellCentre) const;

  Aabb box;   ///< of the particles
  Aabb grid;  ///< of the cells
  std::array<bool, 3> periodic{};
  Vec3 periodLo = Vec3::Zero(), period = Vec3::Zero();
  Vec3 inverseCell = Vec3::Zero(), cell = Vec3::Zero();
  std::array<std::int64_t, 3> cells{};
  std::vector<Placement> placements;
  std::vector<std::int64_t> cellBegin;  ///< CSR: cell -> placements
  std::vector<std::int32_t> cellItems;
};

}  // namespace granular
