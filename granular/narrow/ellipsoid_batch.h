// Looks at pairs of ellipsoids whose Newton steps are taken side by side; the same bits as one by one.
#pragma once

#include <array>

#include "granular/narrow/ellipsoid_pair.h"

namespace granular {

class EllipsoidBatch {
 public:
  static constexpr std::size_t capacity = 32;  // its lanes stay in the first cache

  std::size_t size() const { return count; }
  bool isFull() const { return count == capacity; }
  /// Adds a look that was begun at two ellipsoids, none of them a sphere; answer(k) belongs to the k-th added. What it
  /// views must stay until run() has ended.
  void add(const EllipsoidLook& look, const PairView& view);
  /// Takes the steps of all looks added.
  void run();
  const EllipsoidLook& look(std::size_t k) const { return looks[k]; }
  NewtonAnswer<double> answer(std::size_t k) const {
    return {normal.at(k), onA.at(k), onB.at(k), depth[k], converged[k] != 0};
  }
  void clear() { count = 0; }

 private:
  using Lane = std::array<double, capacity>;
  using Lanes = TripleLanes<capacity>;

  std::size_t count = 0;
  std::array<EllipsoidLook, capacity> looks;
  // In: where frames and semi-axes lie, and numbers.
  std::array<const Frame*, capacity> frameA, frameB;
  std::array<const Vec3*, capacity> axesA, axesB;
  Lanes start;
  Lane ratio, roundOff;
  // Out.
  Lanes normal, onA, onB;
  Lane depth, converged;
};

}  // namespace granular
