#include "granular/world/brief_batch.h"

#include <algorithm>

#include "granular/core/room.h"
#include "granular/narrow/ball_touch.h"
#include "granular/narrow/clump_pair.h"
#include "granular/point/witness.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

}  // namespace

void BriefBatch::begin(double dt, World& of) {
  world = &of;
  law = lawInLanes(of.options.law, of.options.lawOptions);
  manyMaterials = of.materials.count() > 1;
  contacts.count = 0;
  contacts.dt = dt;
  for (std::size_t k = 0; k < capacity; ++k) {
    contacts.share[k] = 1;
    contacts.area[k] = 0;
    if (!manyMaterials) putConstants(k, 0, 0);
  }
}

void BriefBatch::putConstants(std::size_t k, std::int32_t materialA, std::int32_t materialB) {
  const WorldOptions& options = world->options;
  contacts.putConstants(k, world->materials.constants(materialA, materialB), options.lawOptions.tension,
                        lawReadsCurvature(options.law));
}

/// Lane `to` becomes lane `from`.
void BriefBatch::move(std::size_t from, std::size_t to) {
  for (auto* column : {&pair, &a, &b, &childA, &childB}) (*column)[to] = (*column)[from];
  history[to] = history[from];
  for (auto* lanes : {&middle, &contacts.normal, &contacts.a.arm, &contacts.b.arm}) lanes->put(to, lanes->at(from));
  for (auto* lane : {&contacts.overlap, &contacts.squaredDepth, &contacts.radius}) (*lane)[to] = (*lane)[from];
}

void BriefBatch::dropApart(const ContactLanes::Lane& size, World::Chunk& chunk) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count(); ++k) {
    const double overlap = contacts.overlap[k];
    if (!(overlap > 0)) {
      chunk.due.apart.set(due[k]);
      continue;
    }
    if (kept != k) move(k, kept);
    const std::size_t place = chunk.briefs.size() + kept++;
    if (overlap > chunk.deepest * size[k]) chunk.noteDepth(overlap, size[k], place);
  }
  contacts.count = kept;
}

void BriefBatch::fillRegister() {
  const std::size_t last = count() - 1;
  for (std::size_t k = count(); k % wideSize != 0; ++k) {
    shift.put(k, shift.at(last));
    a[k] = a[last];
    b[k] = b[last];
    history[k] = history[last];
  }
}

void BriefBatch::press(World::Chunk& chunk) {
  if (count() == 0) return;
  fillRegister();
  load();
  law(world->options.lawOptions, contacts);
  store(chunk);
  addToBodies(chunk);
  contacts.count = 0;
}

/// What the law reads of the bodies and remembers of the contacts.
void BriefBatch::load() {
  for (std::size_t k = 0; k < count(); k += wideSize) {
    std::array<const MotionRow*, wideSize> rowsA, rowsB;
    for (std::size_t i = 0; i < wideSize; ++i) {
      rowsA[i] = &world->bodies.motion[at(a[k + i])];
      rowsB[i] = &world->bodies.motion[at(b[k + i])];
    }
    contacts.a.put(k, rowsA);
    contacts.b.put(k, rowsB);
    contacts.putHistories(k, &history[k]);
  }
  if (!manyMaterials) return;
  const std::vector<std::int32_t>& material = world->bodies.material;
  for (std::size_t k = 0; k < count(); ++k) putConstants(k, material[at(a[k])], material[at(b[k])]);
}

void BriefBatch::store(World::Chunk& chunk) const {
  const std::size_t before = chunk.briefs.size();
  resizeClosely(chunk.briefs, before + count());
  for (std::size_t k = 0; k < count(); k += wideSize) {
    const std::size_t some = std::min(wideSize, count() - k);
    std::array<BriefContact*, wideSize> briefs;
    for (std::size_t i = 0; i < wideSize; ++i) briefs[i] = &chunk.briefs[before + k + std::min(i, some - 1)];
    contacts.takeHistories(k, some, &history[k]);
    contacts.takeForces(k, some, briefs.data());
  }
  for (std::size_t k = 0; k < count(); ++k) {
    BriefContact& brief = chunk.briefs[before + k];
    brief.pair = pair[k];
    brief.held = false;
  }
  if (!world->anyClump || chunk.due.ofSpheres) return;
  resizeClosely(chunk.children, chunk.briefs.size());
  for (std::size_t k = 0; k < count(); ++k) chunk.children[before + k] = {childA[k], childB[k]};
}

void BriefBatch::addToBodies(World::Chunk& chunk) const {
  const auto pull = [this](std::size_t k) {
    return ContactPull{a[k], b[k], contacts.force.take(k), contacts.torqueA.take(k), contacts.torqueB.take(k)};
  };
  deliver(count(), pull, chunk, *world);
}

Contact World::describeBrief(const Chunk& chunk, std::size_t k) const {
  const BriefContact& brief = chunk.briefs[k];
  const Pair& pair = pairs.pairs[at(brief.pair)];
  Contact contact;
  contact.pair = brief.pair;
  contact.a = pair.a;
  contact.b = pair.b;
  const auto [childA, childB] = chunk.children.empty() ? std::array{-1, -1} : chunk.children[k];
  contact.spot = {0, childA, childB};
  contact.shift = options.periods.shift(pair.image);
  if (chunk.touches.empty()) {
    const PlacedBall ballA = placeBall(*bodies.shape[at(pair.a)], bodies.frameOf(at(pair.a)), childA);
    Frame frameB = bodies.frameOf(at(pair.b));
    frameB.x += contact.shift;
    const PlacedBall ballB = placeBall(*bodies.shape[at(pair.b)], frameB, childB);
    fillBallTouch(lookAtBalls(ballA.centre, ballA.radius, ballB.centre, ballB.radius), ballA.centre, ballA.radius,
                  contact.touch);
  } else {
    contact.touch.take(chunk.touches[k]);
  }
  placeWitness(contact.touch, contact.patch);
  contact.force = {brief.force, Vec3::Zero(), brief.normalForce, brief.sliding};
  contact.held = brief.held;
  contact.torqueA = (contact.patch.point - bodies.x(at(pair.a))).cross(brief.force);
  contact.torqueB = -(contact.patch.point - bodies.x(at(pair.b)) - contact.shift).cross(brief.force);
  return contact;
}

}  // namespace granular
