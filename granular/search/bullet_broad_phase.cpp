// Bullet's bounding-volume tree in scaled units. It holds boxes a little larger than those asked for, so that few
// leaves move; what overlaps in it depends on its history, and the exact test here makes the answer reproducible. Of
// Bullet's broad phase it is the tree alone: the cache of pairs beside it took three times as much memory.
#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <cassert>
#include <utility>

#include "granular/search/broad_phase.h"

namespace granular {
namespace {

static_assert(sizeof(btScalar) == 8, "Bullet must be the double-precision build");

/// By which the tree's boxes are grown, over their length: a box that moves within costs nothing. Bullet's own margin
/// does not serve, because it is the same for large and small bodies.
constexpr double looseness = 0.02;

class BulletBroadPhase final : public BroadPhase {
 public:
  explicit BulletBroadPhase(double unitLength) : scale(1 / unitLength) {}

  void place(std::size_t k, const Aabb& box) override {
    const bool known = k < boxes.size();
    if (known) {
      boxes[k] = box;
      if (leaves[k]->volume.Contain(scaled(box))) return;
    }
    btDbvtVolume loose = scaled(box.grown(looseness * (box.hi - box.lo).maxCoeff()));
    if (known) return tree.update(leaves[k], loose);
    assert(k == boxes.size());
    boxes.push_back(box);
    leaves.push_back(tree.insert(loose, reinterpret_cast<void*>(k)));
  }

  void clear() override {
    tree.clear();
    boxes.clear();
    leaves.clear();
  }

  void collect(std::vector<std::array<std::int32_t, 2>>& out) override {
    out.clear();
    tree.optimizeIncremental(static_cast<int>(leaves.size() / 64) + 1);
    Visitor visitor([&](std::size_t k, std::size_t l) {
      if (k > l) std::swap(k, l);
      if (boxes[k].overlaps(boxes[l])) out.push_back({static_cast<std::int32_t>(k), static_cast<std::int32_t>(l)});
    });
    tree.collideTT(tree.m_root, tree.m_root, visitor);
  }

  void query(const Aabb& box, std::vector<std::int32_t>& out) const override {
    out.clear();
    Visitor visitor([&](std::size_t k, std::size_t) {
      if (boxes[k].overlaps(box)) out.push_back(static_cast<std::int32_t>(k));
    });
    tree.collideTV(tree.m_root, scaled(box), visitor);
  }

 private:
  static std::size_t indexOf(const btDbvtNode* leaf) { return reinterpret_cast<std::size_t>(leaf->data); }
  /// Calls visit(k, l) for what overlaps in the tree; of a query l is of no meaning.
  template <class Visit>
  struct Visitor final : btDbvt::ICollide {
    explicit Visitor(Visit chosen) : visit(std::move(chosen)) {}
    void Process(const btDbvtNode* leaf) override { visit(indexOf(leaf), std::size_t{0}); }
    void Process(const btDbvtNode* one, const btDbvtNode* other) override { visit(indexOf(one), indexOf(other)); }
    Visit visit;
  };

  /// Scaling keeps the order of numbers: boxes that overlap still do.
  btDbvtVolume scaled(const Aabb& box) const {
    const auto point = [this](const Vec3& p) { return btVector3(p.x() * scale, p.y() * scale, p.z() * scale); };
    return btDbvtVolume::FromMM(point(box.lo), point(box.hi));
  }

  double scale;
  std::vector<Aabb> boxes;
  std::vector<btDbvtNode*> leaves;  // the tree's own
  btDbvt tree;
};

}  // namespace

std::unique_ptr<BroadPhase> makeBulletBroadPhase(double unit) { return std::make_unique<BulletBroadPhase>(unit); }

}  // namespace granular
