// Every pair against every other: slow, plainly right, and the oracle of the broad phase.
#include "granular/search/broad_phase.h"

namespace granular {
namespace {

class BruteForceBroadPhase final : public BroadPhase {
 public:
  void place(std::size_t k, const Aabb& box) override {
    if (k == boxes.size()) boxes.emplace_back();
    boxes[k] = box;
  }
  void collect(std::vector<std::array<std::int32_t, 2>>& out) override {
    out.clear();
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      for (std::size_t l = k + 1; l < boxes.size(); ++l) {
        if (boxes[k].overlaps(boxes[l])) out.push_back({static_cast<std::int32_t>(k), static_cast<std::int32_t>(l)});
      }
    }
  }
  void query(const Aabb& box, std::vector<std::int32_t>& out) override {
    out.clear();
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      if (boxes[k].overlaps(box)) out.push_back(static_cast<std::int32_t>(k));
    }
  }
};

}  // namespace

std::unique_ptr<BroadPhase> makeBruteForceBroadPhase() { return std::make_unique<BruteForceBroadPhase>(); }

}  // namespace granular
