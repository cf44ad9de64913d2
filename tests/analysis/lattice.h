// Beds with known answers: lattices of equal particles, their contacts, and a few helpers.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "granular/analysis/bed.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace granular::test {

/// A bed that owns its shape.
struct OwnedBed {
  std::shared_ptr<const Shape> shape;
  Bed bed;

  void add(const Vec3& x, const Mat3& R = Mat3::Identity()) {
    bed.shapes.push_back(shape.get());
    bed.frames.emplace_back(R, x);
  }
};

inline Vessel makeBox(const Vec3& hi, Vessel::Kind kind = Vessel::Kind::box) {
  Vessel vessel;
  vessel.kind = kind;
  vessel.hi = hi;
  return vessel;
}

/// The particle repeated on a lattice of n cells with the given centres per cell of edge a; box from the origin.
inline OwnedBed makeLattice(std::shared_ptr<const Shape> shape, const std::array<int, 3>& n, double a,
                            const std::vector<Vec3>& basis) {
  OwnedBed owned{std::move(shape), {}};
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        for (const Vec3& b : basis) owned.add(a * (Vec3(x, y, z) + b));
  owned.bed.vessel = makeBox(a * Vec3(n[0], n[1], n[2]));
  return owned;
}

inline const std::vector<Vec3> simpleCubic = {Vec3(0.5, 0.5, 0.5)};
inline const std::vector<Vec3> faceCentred = {Vec3(0.25, 0.25, 0.25), Vec3(0.75, 0.75, 0.25), Vec3(0.75, 0.25, 0.75),
                                              Vec3(0.25, 0.75, 0.75)};

/// Spheres of diameter 1 that touch on a simple cubic lattice.
inline OwnedBed makeCubicSpheres(const std::array<int, 3>& n) {
  return makeLattice(std::make_shared<Sphere>(0.5), n, 1, simpleCubic);
}
/// Cubes of edge 1 that fill their box.
inline OwnedBed makeCubes(const std::array<int, 3>& n) {
  return makeLattice(std::make_shared<Cuboid>(Vec3::Constant(0.5)), n, 1, simpleCubic);
}

/// Makes the box periodic in all directions.
inline void makePeriodic(Bed& bed) {
  bed.vessel.kind = Vessel::Kind::periodic;
  bed.vessel.periodicHeight = true;
}

/// Contacts of unit force between all centres closer than reach, through periodic boundaries where there are any.
inline void touchNeighbours(Bed& bed, double reach) {
  const Vec3 period = bed.vessel.hi - bed.vessel.lo;
  for (std::size_t i = 0; i < bed.size(); ++i)
    for (std::size_t j = i + 1; j < bed.size(); ++j) {
      Vec3 d = bed.frames[j].x - bed.frames[i].x;
      if (bed.vessel.kind == Vessel::Kind::periodic)
        d -= period.cwiseProduct((d.cwiseQuotient(period)).array().round().matrix());
      if (d.norm() > reach) continue;
      BedContact contact;
      contact.a = static_cast<std::int32_t>(i);
      contact.b = static_cast<std::int32_t>(j);
      contact.normal = d.normalized();
      contact.force = -contact.normal;
      contact.overlap = 1e-3;
      bed.contacts.push_back(contact);
    }
}

}  // namespace granular::test
