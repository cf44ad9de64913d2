// Bullet's broad phase in scaled units. Its tree keeps boxes enlarged by an absolute margin and its pair cache forgets
// slowly, so the set it returns is a superset that depends on history; the exact test here makes it reproducible.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <cassert>

#include "granular/search/broad_phase.h"

namespace granular {
namespace {

static_assert(sizeof(btScalar) == 8, "Bullet must be the double-precision build");

/// By which the tree's boxes are grown, over their length: a box that moves within costs nothing. Bullet's own margin
/// does not serve, because it is the same for large and small bodies.
constexpr double looseness = 0.02;

bool contains(const Aabb& outer, const Aabb& inner) {
  return (outer.lo.array() <= inner.lo.array()).all() && (inner.hi.array() <= outer.hi.array()).all();
}

class BulletBroadPhase final : public BroadPhase {
 public:
  explicit BulletBroadPhase(double unitLength) : scale(1 / unitLength) {}
  ~BulletBroadPhase() override { clear(); }

  void place(std::size_t k, const Aabb& box) override {
    const bool known = k < boxes.size();
    if (known) {
      boxes[k] = box;
      if (contains(inTree[k], box)) return;
    }
    const Aabb loose = box.grown(looseness * (box.hi - box.lo).maxCoeff());
    const btVector3 lo = scaled(loose.lo);
    const btVector3 hi = scaled(loose.hi);
    if (known) {
      inTree[k] = loose;
      tree->setAabb(proxies[k], lo, hi, nullptr);
      return;
    }
    assert(k == boxes.size());
    boxes.push_back(box);
    inTree.push_back(loose);
    // Any shape type does: the tree reads only the box. The index travels in the group's stead, as the user pointer.
    proxies.push_back(tree->createProxy(lo, hi, 0, reinterpret_cast<void*>(k), 1, 1, nullptr));
  }

  void clear() override {
    // The tree asks the cache to forget each proxy's pairs, for which it would walk through all of them.
    btNullPairCache nothing;
    tree->m_paircache = &nothing;
    for (btBroadphaseProxy* proxy : proxies) tree->destroyProxy(proxy, nullptr);
    boxes.clear();
    inTree.clear();
    proxies.clear();
    cache = std::make_unique<btHashedOverlappingPairCache>();
    tree = std::make_unique<btDbvtBroadphase>(cache.get());
  }

  void collect(std::vector<std::array<std::int32_t, 2>>& out) override {
    out.clear();
    tree->calculateOverlappingPairs(nullptr);
    const btBroadphasePairArray& found = cache->getOverlappingPairArray();
    for (int n = 0; n < found.size(); ++n) {
      std::size_t k = reinterpret_cast<std::size_t>(found[n].m_pProxy0->m_clientObject);
      std::size_t l = reinterpret_cast<std::size_t>(found[n].m_pProxy1->m_clientObject);
      if (k > l) std::swap(k, l);
      if (boxes[k].overlaps(boxes[l])) out.push_back({static_cast<std::int32_t>(k), static_cast<std::int32_t>(l)});
    }
  }

 private:
  btVector3 scaled(const Vec3& p) const { return {p.x() * scale, p.y() * scale, p.z() * scale}; }

  double scale;
  std::vector<Aabb> boxes;
  std::vector<Aabb> inTree;                 // loose boxes around them, which the tree holds until they are left
  std::vector<btBroadphaseProxy*> proxies;  // freed by destroyProxy alone
  std::unique_ptr<btHashedOverlappingPairCache> cache = std::make_unique<btHashedOverlappingPairCache>();
  std::unique_ptr<btDbvtBroadphase> tree = std::make_unique<btDbvtBroadphase>(cache.get());
};

}  // namespace

std::unique_ptr<BroadPhase> makeBulletBroadPhase(double unit) { return std::make_unique<BulletBroadPhase>(unit); }

}  // namespace granular
