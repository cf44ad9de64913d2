#include "granular/world/world.h"

#include <algorithm>
#include <tuple>

#include "granular/core/errors.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

SearchOptions searchOptionsOf(const WorldOptions& options) {
  SearchOptions search;
  search.skin = options.skin;
  search.everyStep = !options.skips.search;
  search.bruteForce = options.bruteForce;
  search.periods = options.periods;
  return search;
}

/// What a law with Hertz's force needs.
void checkElasticLaw(const WorldOptions& options, const MaterialTable& materials) {
  if (!lawReadsCurvature(options.law)) return;
  const std::string law(lawName(options.law));
  for (int i = 0; i < materials.count(); ++i) {
    for (int j = i; j < materials.count(); ++j) {
      const ContactParameters& pair = materials.constants(i, j).parameters;
      require(pair.modulus > 0 && pair.shearModulus > 0, "law \"" + law + "\": materials \"" + materials.name(i) +
                                                             "\" and \"" + materials.name(j) +
                                                             "\" have no Young's modulus and Poisson's ratio");
    }
  }
  require(options.rule.rule != PointRule::foundation,
          "law \"" + law + "\" does not go with the contact-point rule \"" +
              std::string(pointRuleName(options.rule.rule)) +
              "\", whose depth is a mean over the overlap and not Hertz's: choose another");
}

}  // namespace

World::World(const WorldOptions& chosen, MaterialTable table)
    : options(chosen), materials(std::move(table)), search(searchOptionsOf(chosen)) {
  checkElasticLaw(options, materials);
  require(!options.energy || lawKeepsAccount(options.law),
          "law \"" + std::string(lawName(options.law)) +
              "\" keeps no account of its energy: give its row the function account (law/account.h), or leave "
              "output.energy off");
}

std::int32_t World::addShape(std::shared_ptr<const Shape> shape) {
  anyClump = anyClump || shape->kind() == ShapeKind::clump;
  shapes.push_back(std::move(shape));
  return static_cast<std::int32_t>(shapes.size()) - 1;
}

std::size_t World::addBody(NewBody body) {
  land(*this);
  body.id = nextId++;
  return bodies.add(body, *shapes[static_cast<std::size_t>(body.shapeIndex)], turningOfBalls());
}

Bodies::Turning World::turningOfBalls() const {
  // A scheme of the user's own turns all bodies.
  if (options.integrator != SchemeKind::seelen && options.integrator != SchemeKind::spiral)
    return Bodies::Turning::byScheme;
  return options.skips.orientation ? Bodies::Turning::ball : Bodies::Turning::ballWithOrientation;
}

namespace {

/// Wakes sleepers that touch a body that goes: what held them up may be gone.
void wakeNeighbours(const std::vector<bool>& gone, World& world) {
  std::vector<std::size_t> woken;
  const auto at = [](std::int32_t slot) { return static_cast<std::size_t>(slot); };
  world.visitContacts([&](const Contact& contact) {
    if (contact.b < 0 || gone[at(contact.a)] == gone[at(contact.b)]) return;
    woken.push_back(at(gone[at(contact.a)] ? contact.b : contact.a));
  });
  for (const std::size_t i : woken) {
    if (world.bodies.state[i] != BodyState::asleep) continue;
    world.bodies.release(i);
    world.sleep.startAwake(i);
    ++world.sleep.woken;
  }
}

}  // namespace

void World::removeBodies(const std::vector<bool>& gone) {
  land(*this);
  wakeNeighbours(gone, *this);
  std::vector<std::int32_t> kept;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i]) kept.push_back(static_cast<std::int32_t>(i));
  }
  rearrange(kept);
}

void World::rearrange(const std::vector<std::int32_t>& order) {
  const auto at = [](std::int32_t k) { return static_cast<std::size_t>(k); };
  fileHistories(*this);
  std::vector<std::int32_t> slotOf(bodies.size(), -1);  // -1: removed
  for (std::size_t k = 0; k < order.size(); ++k) slotOf[at(order[k])] = static_cast<std::int32_t>(k);

  std::vector<Pair> left;
  for (Pair pair : pairs.pairs) {
    pair.a = slotOf[at(pair.a)];
    pair.b = slotOf[at(pair.b)];
    if (pair.a >= 0 && pair.b >= 0) left.push_back(pair);
  }
  std::sort(left.begin(), left.end(), comesBefore);
  // The memory goes in the order of the pairs, as a step reads it.
  std::vector<std::int32_t> memoryOrder;
  for (Pair& pair : left) {
    memoryOrder.push_back(pair.slot);
    pair.slot = static_cast<std::int32_t>(memoryOrder.size()) - 1;
  }
  pairs.memory.rearrange(memoryOrder);
  for (const Pair& pair : left) {
    pairs.memory.visitHeld(pair, [&pair](Contact& held) {
      held.a = pair.a;
      held.b = pair.b;
    });
  }
  pairs.pairs.swap(left);
  pairsOfBodies = {};

  std::vector<WallPair> leftAtWalls;
  for (WallPair& pair : pairs.wallPairs) {
    pair.body = slotOf[at(pair.body)];
    if (pair.body < 0) continue;
    for (Contact& contact : pair.held) contact.a = pair.body;
    leftAtWalls.push_back(std::move(pair));
  }
  std::sort(leftAtWalls.begin(), leftAtWalls.end(),
            [](const WallPair& p, const WallPair& q) { return std::tie(p.body, p.wall) < std::tie(q.body, q.wall); });
  pairs.wallPairs.swap(leftAtWalls);

  if (options.sleep.on) sleep.resize(bodies.size());
  bodies.rearrange(order);
  sleep.rearrange(order);
  chunks.clear();  // the contacts of the last step name the old slots
  heldForce.clear();
  heldTorque.clear();
  search.invalidate();
  layoutStale = true;
}

std::size_t World::contactCount() const {
  std::size_t count = 0;
  visitContacts([&](const Contact&) { ++count; });
  return count;
}

double kineticEnergy(const Bodies& bodies) {
  double sum = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) sum += bodies.kineticEnergy(i);
  return sum;
}

}  // namespace granular
