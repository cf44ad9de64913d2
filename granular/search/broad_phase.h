// The broad phase: which bounds overlap? Behind one interface: a tree of boxes, and every pair against every other as
// the oracle.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "granular/core/math.h"

namespace granular {

class BroadPhase {
 public:
  virtual ~BroadPhase() = default;
  /// Puts the bounds of proxy k (0, 1, 2, ...) at box, m; a new k must be the next number.
  virtual void place(std::size_t k, const Aabb& box) = 0;
  /// All pairs (k < l) whose boxes overlap, boundaries included, in no particular order. Exact: each pair is
  /// tested against the boxes as given.
  virtual void collect(std::vector<std::array<std::int32_t, 2>>& out) = 0;
  /// All k whose boxes overlap this one, in the same way.
  virtual void query(const Aabb& box, std::vector<std::int32_t>& out) = 0;
  /// The bounds of all proxies as given, m.
  const std::vector<Aabb>& bounds() const { return boxes; }

 protected:
  std::vector<Aabb> boxes;
};

std::unique_ptr<BroadPhase> makeBoxTree();
std::unique_ptr<BroadPhase> makeBruteForceBroadPhase();

}  // namespace granular
