// A tree of boxes, eight to a node side by side, over bodies that are split at medians: eight comparisons of a box with
// its eight go at once, and where a body lies in the tree follows from a number, so that nodes need no pointers. Its
// boxes are in single precision, rounded outwards; what overlaps in it is tested again against the boxes as given.
//
// Bodies that move take their boxes along. How they are split stays until the boxes of neighbours have grown too large
// together. Sizes that differ much lie in trees of their own: one large body would make the nodes of many small ones
// large.
#include <algorithm>
#include <cstring>
#include <limits>
#ifdef __AVX__
#include <immintrin.h>
#endif

#include "granular/core/room.h"
#include "granular/search/broad_phase.h"

namespace granular {
namespace {

constexpr std::size_t fan = 8;  // boxes of a node

/// Of the longest edge of a tree's boxes over the shortest.
constexpr double widestSizes = 4;
/// Growth of the boxes of eight bodies from which on all are split anew.
constexpr double looseSplit = 1.3;
/// Of all boxes, from which on those that changed are no longer listed, and those that came are split with the others.
constexpr double fewChanged = 0.125;
constexpr double fewLate = 64;

constexpr float infinitely = std::numeric_limits<float>::infinity();

typedef float Lanes __attribute__((vector_size(fan * sizeof(float))));
typedef std::int32_t LaneMask __attribute__((vector_size(fan * sizeof(std::int32_t))));

/// One bit for each lane that is true.
unsigned bitsOf(const LaneMask& mask) {
#ifdef __AVX__
  __m256 lanes;
  std::memcpy(&lanes, &mask, sizeof lanes);
  return static_cast<unsigned>(_mm256_movemask_ps(lanes));
#else
  unsigned bits = 0;
  for (std::size_t lane = 0; lane < fan; ++lane) bits |= static_cast<unsigned>(mask[lane] & 1) << lane;
  return bits;
#endif
}

/// The lowest lane that is a number.
float lowest(const Lanes& lanes) {
  Lanes x = lanes <= infinitely ? lanes : infinitely - Lanes{};
  const auto take = [&x](const Lanes& other) { x = other < x ? other : x; };
  take(__builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3));
  take(__builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5));
  take(__builtin_shufflevector(x, x, 1, 0, 3, 2, 5, 4, 7, 6));
  return x[0];
}

/// Calls visit(lane) for every bit that is set.
template <class Visit>
void visitBits(unsigned bits, const Visit& visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(__builtin_ctz(bits)));
}

/// x in single precision, rounded down; and up.
float atMost(double x) {
  constexpr float largest = std::numeric_limits<float>::max() / 2;
  if (x < -largest) return -infinitely;
  const float near = static_cast<float>(std::min<double>(x, largest));
  return near - (std::abs(near) * std::numeric_limits<float>::epsilon() + std::numeric_limits<float>::min());
}
float atLeast(double x) { return -atMost(-x); }

/// A box, m, from an origin of the tree's own.
struct LooseBox {
  float lo[3] = {infinitely, infinitely, infinitely};
  float hi[3] = {-infinitely, -infinitely, -infinitely};

  LooseBox() = default;
  LooseBox(const Aabb& box, const Vec3& origin) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = atMost(box.lo[k] - origin[k]);
      hi[k] = atLeast(box.hi[k] - origin[k]);
    }
  }
};

struct Node {
  Lanes lo[3], hi[3];

  /// Nothing overlaps a lane that is not yet set, not even boxes without end.
  Node() {
    for (auto* bounds : {&lo, &hi}) {
      for (Lanes& lanes : *bounds) lanes = std::numeric_limits<float>::quiet_NaN() - Lanes{};
    }
  }
  void set(std::size_t lane, const LooseBox& box) {
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k][lane] = box.lo[k];
      hi[k][lane] = box.hi[k];
    }
  }
  LooseBox at(std::size_t lane) const {
    LooseBox box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.lo[k] = lo[k][lane];
      box.hi[k] = hi[k][lane];
    }
    return box;
  }
  /// Around all lanes that are set.
  LooseBox hull() const {
    LooseBox box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.lo[k] = lowest(lo[k]);
      box.hi[k] = -lowest(-hi[k]);
    }
    return box;
  }
  /// The lanes that overlap this box.
  unsigned overlapping(const LooseBox& box) const {
    return bitsOf((lo[0] <= box.hi[0]) & (lo[1] <= box.hi[1]) & (lo[2] <= box.hi[2]) & (hi[0] >= box.lo[0]) &
                  (hi[1] >= box.lo[1]) & (hi[2] >= box.lo[2]));
  }
};

/// What a body is split by.
struct Centre {
  float x[3];
  std::int32_t body;
};

/// Puts bodies whose boxes are near side by side: into two halves along the longest side of the box of their centres,
/// and so on, down to the eight of a node. The first half is a power of two of full nodes, so that nodes of every level
/// begin at multiples of their size.
void split(Centre* begin, std::size_t count) {
  if (count <= fan) return;
  std::size_t first = fan;
  while (2 * first < count) first *= 2;
  float width = -1;
  int axis = 0;
  for (int k = 0; k < 3; ++k) {
    const auto along = [k](const Centre& a, const Centre& b) { return a.x[k] < b.x[k]; };
    const auto [low, high] = std::minmax_element(begin, begin + count, along);
    if (high->x[k] - low->x[k] > width) {
      width = high->x[k] - low->x[k];
      axis = k;
    }
  }
  std::nth_element(begin, begin + first, begin + count,
                   [axis](const Centre& a, const Centre& b) { return a.x[axis] < b.x[axis]; });
  split(begin, first);
  split(begin + first, count - first);
}

class BoxTree final : public BroadPhase {
 public:
  void place(std::size_t k, const Aabb& box) override {
    if (k == boxes.size()) return boxes.push_back(box);  // the trees take it in when they are asked
    boxes[k] = box;
    if (allChanged) return;
    allChanged = static_cast<double>(changed.size()) >= fewChanged * static_cast<double>(boxes.size());
    if (!allChanged) changed.push_back(static_cast<std::int32_t>(k));
  }

  void collect(std::vector<std::array<std::int32_t, 2>>& out) override {
    bringUpToDate();
    out.clear();
    Pairs pairs{boxes, out};
    for (std::size_t t = 0; t < trees.size(); ++t) {
      trees[t].meetWithin(pairs);
      for (std::size_t u = t + 1; u < trees.size(); ++u) {
        const bool fewer = trees[t].bodies.size() < trees[u].bodies.size();
        const Tree &asking = trees[fewer ? t : u], &asked = trees[fewer ? u : t];
        for (const std::int32_t k : asking.bodies) {
          if (k >= 0) asked.visit(looseBox(k), [&](std::int32_t l) { pairs.add(k, l); });
        }
      }
    }
  }

  void query(const Aabb& box, std::vector<std::int32_t>& out) override {
    bringUpToDate();
    out.clear();
    const LooseBox loose(box, origin);
    for (const Tree& tree : trees) {
      tree.visit(loose, [&](std::int32_t k) {
        if (boxes[static_cast<std::size_t>(k)].overlaps(box)) out.push_back(k);
      });
    }
  }

 private:
  /// Takes what overlaps in a tree, and keeps what does.
  struct Pairs {
    const std::vector<Aabb>& boxes;
    std::vector<std::array<std::int32_t, 2>>& out;
    void add(std::int32_t k, std::int32_t l) {
      if (boxes[static_cast<std::size_t>(k)].overlaps(boxes[static_cast<std::size_t>(l)]))
        out.push_back({std::min(k, l), std::max(k, l)});
    }
  };

  struct Tree {
    std::vector<std::int32_t> bodies;       ///< of the lanes of the lowest level; -1: none
    std::vector<std::vector<Node>> levels;  ///< lane c of a node is node 8 n + c of the level below; the last has one
    float splitEdges = 0;                   ///< of the lowest nodes, their sum when bodies were split

    /// Sets the boxes of all levels above the lowest one; returns the sum of the edges of that one's nodes.
    float hullAll() {
      float lowestEdges = 0;
      for (std::size_t level = 1; level < levels.size(); ++level) {
        const std::vector<Node>& below = levels[level - 1];
        for (std::size_t n = 0; n < below.size(); ++n) {
          const LooseBox hull = below[n].hull();
          levels[level][n / fan].set(n % fan, hull);
          for (int k = 0; level == 1 && k < 3; ++k) {
            const float edge = hull.hi[k] - hull.lo[k];
            if (std::isfinite(edge)) lowestEdges += edge;
          }
        }
      }
      return lowestEdges;
    }
    /// The same above one lane of the lowest.
    void hullAbove(std::size_t lane) {
      for (std::size_t level = 1; level < levels.size(); ++level) {
        lane /= fan;
        levels[level][lane / fan].set(lane % fan, levels[level - 1][lane].hull());
      }
    }

    /// Calls found(body) for what overlaps the box.
    template <class Found>
    void visit(const LooseBox& box, const Found& found) const {
      visit(levels.size() - 1, 0, box, found);
    }
    template <class Found>
    void visit(std::size_t level, std::size_t n, const LooseBox& box, const Found& found) const {
      visitBits(levels[level][n].overlapping(box), [&](std::size_t lane) {
        if (level == 0) return found(bodies[fan * n + lane]);
        visit(level - 1, fan * n + lane, box, found);
      });
    }

    void meetWithin(Pairs& pairs) const { meetWithin(levels.size() - 1, 0, pairs); }
    /// Pairs of bodies below one node.
    void meetWithin(std::size_t level, std::size_t n, Pairs& pairs) const {
      const Node& node = levels[level][n];
      for (std::size_t lane = 0; lane < fan; ++lane) {
        const LooseBox box = node.at(lane);
        const unsigned later = node.overlapping(box) & (~0u << (lane + 1));
        if (level > 0 && fan * n + lane < levels[level - 1].size()) meetWithin(level - 1, fan * n + lane, pairs);
        meetLanes(level, n, lane, n, later, pairs);
      }
    }
    /// Pairs of a body below this node with one below that; box: around that one.
    void meet(std::size_t level, std::size_t n, std::size_t other, const LooseBox& box, Pairs& pairs) const {
      visitBits(levels[level][n].overlapping(box), [&](std::size_t lane) {
        meetLanes(level, n, lane, other, levels[level][other].overlapping(levels[level][n].at(lane)), pairs);
      });
    }
    /// Pairs of a lane with lanes of another node.
    void meetLanes(std::size_t level, std::size_t n, std::size_t lane, std::size_t other, unsigned lanes,
                   Pairs& pairs) const {
      visitBits(lanes, [&](std::size_t of) {
        if (level == 0) return pairs.add(bodies[fan * n + lane], bodies[fan * other + of]);
        meet(level - 1, fan * n + lane, fan * other + of, levels[level][other].at(of), pairs);
      });
    }
  };

  LooseBox looseBox(std::int32_t k) const { return {boxes[static_cast<std::size_t>(k)], origin}; }

  /// After this the boxes of the trees hold those of all bodies.
  void bringUpToDate() {
    if (laneOf.size() != boxes.size()) addLate();
    if (allChanged) {
      const bool isLoose = std::any_of(trees.begin(), trees.end(),
                                       [this](Tree& tree) { return fit(tree) > looseSplit * tree.splitEdges; });
      if (isLoose) splitAll();
    } else {
      for (const std::int32_t k : changed) fit(k);
    }
    changed.clear();
    allChanged = false;
  }

  /// Sets the boxes of a tree; returns the sum of the edges of its lowest nodes.
  float fit(Tree& tree) const {
    for (std::size_t lane = 0; lane < tree.bodies.size(); ++lane) {
      const std::int32_t k = tree.bodies[lane];
      if (k >= 0) tree.levels[0][lane / fan].set(lane % fan, looseBox(k));
    }
    return tree.hullAll();
  }
  void fit(std::int32_t k) {
    std::size_t lane = laneOf[static_cast<std::size_t>(k)];
    auto tree = trees.begin();
    for (; lane >= tree->bodies.size(); ++tree) lane -= tree->bodies.size();
    tree->levels[0][lane / fan].set(lane % fan, looseBox(k));
    tree->hullAbove(lane);
  }

  /// Whoever came since all were split lies in trees apart, as long as they are few: bodies that are poured come one by
  /// one.
  void addLate() {
    const auto late = static_cast<double>(boxes.size() - early.bodies);
    if (late > fewLate + fewChanged * static_cast<double>(early.bodies)) return splitAll();
    trees.resize(early.trees);
    addTrees(early.bodies);
  }

  void splitAll() {
    origin = middleOfMost();
    trees.clear();
    addTrees(0);
    early = {boxes.size(), trees.size()};
  }

  /// The median of the boxes' centres, m: who flew away far does not matter.
  Vec3 middleOfMost() const {
    Vec3 middle = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> centres;
      for (const Aabb& box : boxes) {
        const double centre = 0.5 * (box.lo[axis] + box.hi[axis]);
        if (std::isfinite(centre)) centres.push_back(centre);
      }
      if (centres.empty()) continue;
      const auto median = centres.begin() + std::ssize(centres) / 2;
      std::nth_element(centres.begin(), median, centres.end());
      middle[axis] = *median;
    }
    return middle;
  }

  /// Of the bodies from `from` on.
  void addTrees(std::size_t from) {
    reserveClosely(laneOf, boxes.size());
    laneOf.resize(boxes.size());
    std::vector<Centre> centres;  // the bodies of a tree one behind the other
    std::vector<float> edges;     // of the bodies from the first one on
    for (std::size_t k = from; k < boxes.size(); ++k) {
      const LooseBox box(boxes[k], origin);
      Centre centre{{0, 0, 0}, static_cast<std::int32_t>(k)};
      float edge = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const float middle = 0.5f * (box.lo[axis] + box.hi[axis]);
        if (std::isfinite(middle)) centre.x[axis] = middle;
        edge = std::max(edge, box.hi[axis] - box.lo[axis]);
      }
      centres.push_back(centre);
      edges.push_back(edge);
    }
    const auto edgeOf = [&](const Centre& centre) { return edges[static_cast<std::size_t>(centre.body) - from]; };
    const auto [least, most] = std::minmax_element(edges.begin(), edges.end());
    if (*most > widestSizes * *least) {
      std::sort(centres.begin(), centres.end(),
                [&](const Centre& a, const Centre& b) { return edgeOf(a) < edgeOf(b); });
    }
    for (std::size_t first = 0; first < centres.size();) {
      const double limit = widestSizes * edgeOf(centres[first]);
      std::size_t last = centres.size();
      if (*most > limit) {
        const auto isLarger = [&](const Centre& centre) { return edgeOf(centre) > limit; };
        last = static_cast<std::size_t>(
            std::find_if(centres.begin() + static_cast<std::ptrdiff_t>(first) + 1, centres.end(), isLarger) -
            centres.begin());
      }
      addTree(centres.data() + first, last - first);
      first = last;
    }
  }

  void addTree(Centre* centres, std::size_t count) {
    split(centres, count);
    std::size_t before = 0;
    for (const Tree& tree : trees) before += tree.bodies.size();
    Tree& tree = trees.emplace_back();
    std::size_t nodes = (count + fan - 1) / fan;
    tree.bodies.assign(fan * nodes, -1);
    for (std::size_t lane = 0; lane < count; ++lane) {
      tree.bodies[lane] = centres[lane].body;
      laneOf[static_cast<std::size_t>(centres[lane].body)] = static_cast<std::uint32_t>(before + lane);
    }
    for (tree.levels.emplace_back(nodes); nodes > 1; tree.levels.emplace_back(nodes)) nodes = (nodes + fan - 1) / fan;
    tree.splitEdges = fit(tree);
  }

  struct Early {
    std::size_t bodies = 0, trees = 0;  // the first of all
  } early;                              // who were there when all were split
  std::vector<Tree> trees;              // of sizes that differ little
  std::vector<std::uint32_t> laneOf;    // of each body, counted through all trees
  Vec3 origin = Vec3::Zero();           // of the trees' boxes, m
  std::vector<std::int32_t> changed;    // bodies whose boxes the trees do not hold yet
  bool allChanged = false;              // too many of them to be listed
};

}  // namespace

std::unique_ptr<BroadPhase> makeBoxTree() { return std::make_unique<BoxTree>(); }

}  // namespace granular
