#include "granular/run/bed_of_world.h"

#include <algorithm>

#include "granular/narrow/clump_pair.h"

namespace granular {
namespace {

/// Contacts of pairs that both are frozen, by their geometry alone.
void addFrozenContacts(const World& world, Bed& bed) {
  // Without a history there is no manifold: its rule falls back on the deepest point.
  RuleOptions rule = world.options.rule;
  if (rule.rule == PointRule::manifold) rule.rule = PointRule::witness;
  Bodies awake = world.bodies;
  std::fill(awake.state.begin(), awake.state.end(), BodyState::moving);
  SearchOptions options;
  options.periods = world.options.periods;
  Search search(options);
  PairList list;
  search.refreshPairs(awake, 0, 0, list);
  const auto frozen = [&](std::int32_t i) {
    return world.bodies.state[static_cast<std::size_t>(i)] == BodyState::frozen;
  };
  std::vector<ChildTouch> together;
  for (const Pair& pair : list.pairs) {
    if (!frozen(pair.a) || !frozen(pair.b)) continue;
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    Frame frameB = awake.frameOf(b);
    frameB.x += options.periods.shift(pair.image);
    findTouches({*awake.shape[a], awake.frameOf(a), *awake.shape[b], frameB}, together);
    for (const auto& [children, touch] : together) {
      const PlacedChild childA = placeChild(*awake.shape[a], awake.frameOf(a), children.childA);
      const PlacedChild childB = placeChild(*awake.shape[b], frameB, children.childB);
      ContactPatch patch;
      placeContact(rule, *childA.shape, childA.frame, *childB.shape, childB.frame, touch, patch);
      bed.contacts.push_back({pair.a, pair.b, patch.point, touch.normal, Vec3::Zero(), touch.overlap});
    }
  }
  std::vector<WallTouch> touches;
  for (std::size_t i = 0; i < awake.size(); ++i) {
    if (!frozen(static_cast<std::int32_t>(i))) continue;
    for (const auto& wall : world.walls) {
      touches.clear();
      touchWall(*wall, ruleAtWalls(rule), *awake.shape[i], awake.frameOf(i), touches);
      for (const WallTouch& found : touches) {
        bed.contacts.push_back(
            {static_cast<std::int32_t>(i), -1, found.patch.point, found.normal, Vec3::Zero(), found.overlap});
      }
    }
  }
}

}  // namespace

Bed makeBed(const World& world, const Vessel& vessel) {
  Bed bed;
  bed.vessel = vessel;
  const Bodies& bodies = world.bodies;
  const Periods& periods = world.options.periods;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bed.shapes.push_back(bodies.shape[i]);
    bed.frames.push_back(bodies.frameOf(i));
    for (int k = 0; k < 3; ++k) {
      if (periods.length[k] <= 0) continue;
      double& x = bed.frames.back().x[k];
      x -= periods.length[k] * std::floor((x - periods.origin[k]) / periods.length[k]);
    }
  }
  world.visitContacts([&](const Contact& contact) {
    bed.contacts.push_back({contact.a, std::max(contact.b, -1), contact.patch.point, contact.touch.normal,
                            contact.force.force, contact.touch.overlap});
  });
  const bool anyFrozen = std::find(bodies.state.begin(), bodies.state.end(), BodyState::frozen) != bodies.state.end();
  if (anyFrozen) addFrozenContacts(world, bed);
  return bed;
}

}  // namespace granular
