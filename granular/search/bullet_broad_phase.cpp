// Bullet's bounding-volume tree. It holds boxes a little larger than those asked for, so that few
// leaves move; what overlaps in it depends on its history, and the exact test here makes the answer reproducible. Of
// Bullet's broad phase it is the tree alone: the cache of pairs beside it took three times as much memory.
#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "granular/search/broad_phase.h"

namespace granular {
namespace {

static_assert(sizeof(btScalar) == 8, "Bullet must be the double-precision build");

/// By which the tree's boxes are grown, over their length: a box that moves within costs nothing. Bullet's own margin
/// does not serve, because it is .05 for large and small bodies, in metres or millimetres.
constexpr double looseness = 0.02;

class BulletBroadPhase final : public BroadPhase {
 public:
  void place(std::size_t k, const Aabb& box) override {
    const bool known = k < boxes.size();
    if (known) {
      boxes[k] = box;
      if (leaves[k]->volume.Contain(volumeOf(box))) return;
    }
    btDbvtVolume loose = volumeOf(box.grown(looseness * (box.hi - box.lo).maxCoeff()));
    if (known) {
      tree.update(leaves[k], loose);
    } else {
      assert(k == boxes.size());
      boxes.push_back(box);
      leaves.push_back(tree.insert(loose, reinterpret_cast<void*>(k)));
      isChanged.push_back(false);
    }
    if (!isChanged[k]) changed.push_back(static_cast<std::int32_t>(k));
    isChanged[k] = true;
  }

  void clear() override {
    tree.clear();
    nearInTree.clear();
    boxes.clear();
    leaves.clear();
    changed.clear();
    isChanged.clear();
  }

  void collect(std::vector<std::array<std::int32_t, 2>>& out) override {
    tree.optimizeIncremental(static_cast<int>(changed.size() / 64) + 1);
    10 * changed.size() < leaves.size() ? findOfChanged() : findAll();
    for (const std::int32_t k : changed) isChanged[static_cast<std::size_t>(k)] = false;
    changed.clear();
    out.clear();
    for (const auto& [k, l] : nearInTree) {
      if (boxes[static_cast<std::size_t>(k)].overlaps(boxes[static_cast<std::size_t>(l)])) out.push_back({k, l});
    }
  }

  void query(const Aabb& box, std::vector<std::int32_t>& out) const override {
    out.clear();
    Visitor visitor([&](std::size_t k, std::size_t) {
      if (boxes[k].overlaps(box)) out.push_back(static_cast<std::int32_t>(k));
    });
    tree.collideTV(tree.m_root, volumeOf(box), visitor);
  }

 private:
  /// What overlaps in the tree: walks through it once, or asks it for the leaves that changed since the last time.
  void findAll() {
    nearInTree.clear();
    Visitor visitor([this](std::size_t k, std::size_t l) { addNear(k, l); });
    tree.collideTT(tree.m_root, tree.m_root, visitor);
  }
  void findOfChanged() {
    std::erase_if(nearInTree, [this](const std::array<std::int32_t, 2>& pair) {
      return isChanged[static_cast<std::size_t>(pair[0])] || isChanged[static_cast<std::size_t>(pair[1])];
    });
    for (const std::int32_t of : changed) {
      const auto k = static_cast<std::size_t>(of);
      Visitor visitor([this, k](std::size_t l, std::size_t) {
        if (l < k || (l > k && !isChanged[l])) addNear(k, l);  // of two that changed the later one tells
      });
      tree.collideTV(tree.m_root, leaves[k]->volume, visitor);
    }
  }
  void addNear(std::size_t k, std::size_t l) {
    nearInTree.push_back({static_cast<std::int32_t>(std::min(k, l)), static_cast<std::int32_t>(std::max(k, l))});
  }

  static std::size_t indexOf(const btDbvtNode* leaf) { return reinterpret_cast<std::size_t>(leaf->data); }
  /// Calls visit(k, l) for what overlaps in the tree; of a query l is of no meaning.
  template <class Visit>
  struct Visitor final : btDbvt::ICollide {
    explicit Visitor(Visit chosen) : visit(std::move(chosen)) {}
    void Process(const btDbvtNode* leaf) override { visit(indexOf(leaf), std::size_t{0}); }
    void Process(const btDbvtNode* one, const btDbvtNode* other) override { visit(indexOf(one), indexOf(other)); }
    Visit visit;
  };

  static btDbvtVolume volumeOf(const Aabb& box) {
    const auto point = [](const Vec3& p) { return btVector3(p.x(), p.y(), p.z()); };
    return btDbvtVolume::FromMM(point(box.lo), point(box.hi));
  }

  std::vector<btDbvtNode*> leaves;  // the tree's own
  btDbvt tree;
  std::vector<std::int32_t> changed;  // leaves, since the last time that pairs were collected
  std::vector<bool> isChanged;
  std::vector<std::array<std::int32_t, 2>> nearInTree;
};

}  // namespace

std::unique_ptr<BroadPhase> makeBulletBroadPhase() { return std::make_unique<BulletBroadPhase>(); }

}  // namespace granular
