#include "granular/run/world_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "granular/core/errors.h"
#include "granular/narrow/cache_check.h"
#include "granular/shape/clump.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

[[noreturn]] void refuse(const std::string& what) { throw InputError("checkpoint: world/" + what); }

void requireRows(const std::string& name, std::size_t found, std::size_t expected) {
  if (found != expected) refuse(fmt::format("{} has {} rows, {} are expected", name, found, expected));
}
void requireAtMost(const std::string& name, std::size_t found, std::size_t most) {
  if (found > most) refuse(fmt::format("{} has {} rows, at most {} are expected", name, found, most));
}
void requireIndex(const std::string& name, std::int64_t index, std::size_t count) {
  if (index < 0 || static_cast<std::size_t>(index) >= count)
    refuse(fmt::format("{} holds {}, must be 0 or more and below {}", name, index, count));
}

void checkBodies(World& world) {
  Bodies& bodies = world.bodies;
  const std::size_t n = bodies.size();
  const bool upright = bodies.q.empty() && bodies.qHalf.empty();
  bodies.visitState([&]<class Row>(const char* name, const std::vector<Row>& column) {
    if (std::is_same_v<Row, Quat> && upright) return;
    requireRows(std::string("bodies/") + name, column.size(), n);
  });
  for (std::size_t i = 0; i < n; ++i) {
    requireIndex("bodies/shape_index", bodies.shapeIndex[i], world.shapes.size());
    if (upright && world.shapes[static_cast<std::size_t>(bodies.shapeIndex[i])]->kind() != ShapeKind::sphere)
      refuse(fmt::format("bodies/q is empty, but body {} is no sphere", bodies.id[i]));
    requireIndex("bodies/material", bodies.material[i], static_cast<std::size_t>(world.materials.count()));
    requireIndex("bodies/state", static_cast<int>(bodies.state[i]), static_cast<std::size_t>(BodyState::asleep) + 1);
    requireIndex("bodies/id", bodies.id[i], static_cast<std::size_t>(std::max<std::int64_t>(world.nextId, 0)));
  }
  std::vector<std::int64_t> ids = bodies.id;
  std::sort(ids.begin(), ids.end());
  if (std::adjacent_find(ids.begin(), ids.end()) != ids.end()) refuse("bodies/id holds a number twice");
}

void checkSearch(World& world) {
  // Before a search that begins anew, as after a removal, margins are gone and the rest is not read.
  std::size_t margins = 0, corners = 0;
  world.search.visitState([&](const char* name, const auto& column) {
    const std::string_view which(name);
    if (which == "margin") margins = column.size();
    if (which == "lowest") corners = column.size();
    requireAtMost("search/margin", margins, world.bodies.size());
    if (margins > 0) requireRows("search/" + std::string(name), column.size(), margins);
    if (which == "highest") requireRows("search/highest", column.size(), corners);
  });
}

void checkSleep(World& world) {
  world.sleep.visitColumns([&](const char* name, const auto& column, const char*, const char*) {
    requireAtMost(std::string("sleep/") + name, column.size(), world.bodies.size());
    requireRows(std::string("sleep/") + name, column.size(), world.sleep.calm.size());
  });
}

/// How many children a body has; of what is no clump none.
std::size_t childCount(const World& world, std::int32_t slot) {
  const Clump* clump = asClump(*world.shapes[at(world.bodies.shapeIndex[at(slot)])]);
  return clump == nullptr ? 0 : clump->children().size();
}

/// A child of a clump, or -1 of a body that is none.
void checkChild(const std::string& name, std::int32_t child, std::size_t children) {
  if (children == 0 && child == -1) return;
  requireIndex(name, child, children);
}

void checkHeld(const std::string& name, const std::vector<Contact>& held, std::int32_t a, std::int32_t b) {
  for (const Contact& contact : held) {
    if (contact.a == a && contact.b == b) continue;
    refuse(fmt::format("{} holds a contact of the slots {} and {} in a pair of {} and {}", name, contact.a, contact.b,
                       a, b));
  }
}

void checkClumpMemory(const World& world, const Pair& pair, const ClumpMemory& memory) {
  const std::size_t ofA = childCount(world, pair.a), ofB = childCount(world, pair.b);
  const Shape& a = *world.shapes[at(world.bodies.shapeIndex[at(pair.a)])];
  const Shape& b = *world.shapes[at(world.bodies.shapeIndex[at(pair.b)])];
  // Balls against balls remember nothing.
  const bool balls = (ofA > 0 || a.kind() == ShapeKind::sphere) && (ofB > 0 || b.kind() == ShapeKind::sphere);
  if (!balls || !memory.caches.empty())
    requireRows("memory/clumps/caches", memory.caches.size(), memory.children.near.size());
  for (std::size_t k = 0; k < memory.children.near.size(); ++k) {
    const ChildPair& child = memory.children.near[k];
    checkChild("memory/clumps/children/a", child.childA, ofA);
    checkChild("memory/clumps/children/b", child.childB, ofB);
    if (memory.caches.empty()) continue;
    const Shape& childA = ofA > 0 ? static_cast<const Clump&>(a).childShape(child.childA) : a;
    const Shape& childB = ofB > 0 ? static_cast<const Clump&>(b).childShape(child.childB) : b;
    if (!cacheFits(memory.caches[k], childA, childB)) refuse("memory/clumps/caches names a feature that is not there");
  }
  checkHeld("memory/clumps/held", memory.held, pair.a, pair.b);
}

/// What a pair remembers under its slot.
void checkMemory(const World& world, const Pair& pair) {
  const PairMemory& memory = world.pairs.memory;
  const std::size_t slot = at(pair.slot);
  if (slot < memory.held.size() && memory.held[slot].a >= 0)
    checkHeld("memory/held", {memory.held[slot]}, pair.a, pair.b);
  if (slot < memory.manifolds.size()) requireIndex("memory/manifolds/points", memory.manifolds[slot].manifold.count, 5);
  if (childCount(world, pair.a) > 0 || childCount(world, pair.b) > 0) {
    if (slot < memory.clumps.size()) checkClumpMemory(world, pair, memory.clumps[slot]);
    return;
  }
  const Shape& a = *world.shapes[at(world.bodies.shapeIndex[at(pair.a)])];
  const Shape& b = *world.shapes[at(world.bodies.shapeIndex[at(pair.b)])];
  if (slot < memory.cache.size() && !cacheFits(memory.cache[slot], a, b))
    refuse("memory names a feature that a shape lacks");
}

void checkPairs(const World& world) {
  const PairMemory& memory = world.pairs.memory;
  const std::size_t slots = memory.size(), n = world.bodies.size();
  requireAtMost("memory/kind", memory.cache.size(), slots);
  requireAtMost("memory/springs", memory.energy.size(), slots);
  requireAtMost("memory/held", memory.held.size(), slots);
  requireAtMost("memory/manifolds", memory.manifolds.size(), slots);
  requireAtMost("memory/clumps", memory.clumps.size(), slots);

  // Every slot is one pair's, or free, or neither, but not twice.
  std::vector<bool> taken(slots, false);
  const auto take = [&](const char* name, std::int32_t slot) {
    requireIndex(name, slot, slots);
    if (taken[at(slot)]) refuse(fmt::format("{} holds {} twice", name, slot));
    taken[at(slot)] = true;
  };
  for (const std::int32_t slot : memory.free) take("memory/free", slot);
  const Pair* before = nullptr;
  for (const Pair& pair : world.pairs.pairs) {
    requireIndex("pairs/a", pair.a, n);
    requireIndex("pairs/b", pair.b, n);
    take("pairs/slot", pair.slot);
    if (world.bodies.id[at(pair.a)] >= world.bodies.id[at(pair.b)] || (before && !comesBefore(*before, pair)))
      refuse("pairs are not in the order of their keys");
    checkMemory(world, pair);
    before = &pair;
  }
}

void checkWallPairs(const World& world) {
  const WallPair* before = nullptr;
  for (const WallPair& pair : world.pairs.wallPairs) {
    requireIndex("wall_pairs/body", pair.body, world.bodies.size());
    requireIndex("wall_pairs/wall", pair.wall, world.walls.size());
    const auto keyOf = [&](const WallPair& p) { return std::tuple(p.body, p.wall); };
    if (before && keyOf(*before) >= keyOf(pair)) refuse("wall_pairs are not in the order of their keys");
    for (const ChildPair& child : pair.children.near)
      checkChild("wall_pairs/children/a", child.childA, childCount(world, pair.body));
    checkHeld("wall_pairs/held", pair.held, pair.body, -1 - pair.wall);
    before = &pair;
  }
}

}  // namespace

void checkLoaded(World& world) {
  if (world.steps < 0) refuse(fmt::format("steps holds {}, must be 0 or more", world.steps));
  checkBodies(world);
  checkSearch(world);
  checkSleep(world);
  checkPairs(world);
  checkWallPairs(world);
  requireAtMost("walls/force", world.wallForces.size(), world.walls.size());
  requireRows("walls/stiffness", world.wallStiffness.size(), world.wallForces.size());
}

}  // namespace granular
