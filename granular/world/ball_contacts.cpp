// Contacts of spheres in batches: found, placed and pressed without the machinery that other shapes need. A chunk's
// touching pairs are laid out side by side, each quantity in a lane of its own, and the linear law runs over the lanes
// without a branch, so that the compiler works on as many contacts at once as the instruction set allows.
//
// Every number is made by the operations of lookAtPair, placeContact and applyLinearLaw in their order (a dot product
// is (x + y) + z, as Eigen adds it): the answers are the same bits, which Balls.InBatchesHaveTheSameBitsAsOneByOne
// holds this file to.
#include <algorithm>
#include <array>

#include "granular/core/wide.h"
#include "granular/law/linear.h"
#include "granular/narrow/ball_touch.h"
#include "granular/point/witness.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// How many contacts are worked on together: their lanes stay in the first cache.
constexpr std::size_t batchSize = 32;
using Lane = double[batchSize];  // not std::array, whose accessors hide it from g++'s vectoriser
struct Lanes {
  Lane x, y, z;
};

using V = Triple<double>;  // a vector of one contact, in registers
V load(const Lanes& lanes, std::size_t k) { return {lanes.x[k], lanes.y[k], lanes.z[k]}; }
void store(const V& v, std::size_t k, Lanes& lanes) {
  lanes.x[k] = v.x;
  lanes.y[k] = v.y;
  lanes.z[k] = v.z;
}
void put(const Vec3& v, std::size_t k, Lanes& lanes) { store(toTriple(v), k, lanes); }
Vec3 take(const Lanes& lanes, std::size_t k) { return {lanes.x[k], lanes.y[k], lanes.z[k]}; }

/// One body of each contact.
struct Side {
  Lanes x, v, w, vHalf, spinHalf;
};

/// A batch of touching pairs.
struct alignas(64) Batch {
  std::size_t count = 0;
  std::array<std::int32_t, batchSize> pair, a, b, slot;
  // In.
  Side sideA, sideB;
  Lanes shift, between;  // of B's image; from A's centre to B's
  Lane distance, radiusA, radii;
  Lane stiffnessN, stiffnessT, dampingN, dampingT, friction;
  Lanes spring, oldNormal;
  // Out: the history goes on in spring, normal.
  Lanes normal, force, torqueA, torqueB;
  Lane overlap, push, sliding;
};

/// What all contacts of a call share. The options of the law are numbers here, since a choice between lanes by a flag
/// that is the same for all of them keeps g++ 12 from making vectors.
struct Shared {
  double dt;
  double leastPush;   ///< -infinity with tension, else 0
  double pullFactor;  ///< Coulomb's limit is mu max(push, pullFactor push): -1 for |push|, 0 for the push alone
};

/// The law of one contact of the batch; without a branch. alongVelocity: LawOptions::slideAlongVelocity.
template <bool alongVelocity>
[[gnu::always_inline]] inline void pressAndRubBall(const Shared& shared, std::size_t k, Batch& s) {
  // Two balls (narrow/ball_touch.h).
  const double distance = s.distance[k], inside = s.radii[k] - distance;
  const V between = load(s.between, k);
  const bool apart = distance > 0;
  const double divisor = apart ? distance : 1;
  const V n = {apart ? between.x / divisor : 1, apart ? between.y / divisor : 0, apart ? between.z / divisor : 0};
  const V centreA = load(s.sideA.x, k);
  const V middle = centreA + (s.radiusA[k] - 0.5 * inside) * n;
  const V onA = middle + (0.5 * inside) * n, onB = middle - (0.5 * inside) * n;
  const V point = 0.5 * (onA + onB);
  const V armA = point - centreA, armB = point - load(s.sideB.x, k) - load(s.shift, k);

  // How they move.
  const V wA = load(s.sideA.w, k), wB = load(s.sideB.w, k);
  const V velocity = load(s.sideA.v, k) + wA.cross(armA) - (load(s.sideB.v, k) + wB.cross(armB));
  const V slip = shared.dt * (load(s.sideA.vHalf, k) + load(s.sideA.spinHalf, k).cross(armA) -
                              (load(s.sideB.vHalf, k) + load(s.sideB.spinHalf, k).cross(armB)));
  const V meanSpin = 0.5 * (wA + wB);

  // The normal force.
  const double approach = n.dot(velocity);
  const double push = std::max(s.stiffnessN[k] * inside + s.dampingN[k] * approach, shared.leastPush);

  // The spring: carried into the new plane (carrySpring), stretched by the slip.
  const V old = load(s.oldNormal, k), spring0 = load(s.spring, k);
  const double cosine = old.dot(n), t = 0.5 * (n.dot(meanSpin) * shared.dt);
  const bool sameContact = !(cosine <= -0.999);
  const double inverse = 1 / ((1 + (sameContact ? cosine : 0)) * (1 + t * t));
  const V tilted = spring0 - (n.dot(spring0) * (1 + t * t) * inverse) * (old + n);
  const double scale = (1 + cosine) * inverse;
  V carried = ((1 - t * t) * scale) * tilted + (2 * t * scale) * n.cross(tilted);
  carried = {sameContact ? carried.x : 0, sameContact ? carried.y : 0, sameContact ? carried.z : 0};
  V spring = carried + slip;
  spring = spring - n.dot(spring) * n;
  const V slide = velocity - approach * n;

  // Coulomb's limit.
  const double limit = s.friction[k] * std::max(push, shared.pullFactor * push);
  const V trial = s.stiffnessT[k] * spring + s.dampingT[k] * slide;
  const double square = trial.dot(trial), slideSquare = slide.dot(slide);
  const bool slides = square > limit * limit;
  const bool byVelocity = alongVelocity && slideSquare > 0;
  const double length = std::sqrt(byVelocity ? slideSquare : square);
  const double factor = limit / (slides ? length : 1);
  const V bounded = {factor * (byVelocity ? slide.x : trial.x), factor * (byVelocity ? slide.y : trial.y),
                     factor * (byVelocity ? slide.z : trial.z)};
  const bool viscous = s.dampingT[k] * s.dampingT[k] * slideSquare >= limit * limit;
  const double softness = 1 / s.stiffnessT[k];
  const V reset = softness * (bounded - s.dampingT[k] * slide);
  const V kept = {slides ? (viscous ? 0 : reset.x) : spring.x, slides ? (viscous ? 0 : reset.y) : spring.y,
                  slides ? (viscous ? 0 : reset.z) : spring.z};
  const V drag = {slides ? bounded.x : trial.x, slides ? bounded.y : trial.y, slides ? bounded.z : trial.z};

  // Without friction there is neither drag nor history.
  const bool rubs = s.friction[k] != 0;
  const V along = -push * n;
  const V rubbed = along - drag;
  const V force = {rubs ? rubbed.x : along.x, rubs ? rubbed.y : along.y, rubs ? rubbed.z : along.z};
  store({rubs ? kept.x : 0, rubs ? kept.y : 0, rubs ? kept.z : 0}, k, s.spring);
  store({rubs ? n.x : 0, rubs ? n.y : 0, rubs ? n.z : 0}, k, s.oldNormal);
  store(n, k, s.normal);
  store(force, k, s.force);
  store(armA.cross(force), k, s.torqueA);
  store(-1.0 * armB.cross(force), k, s.torqueB);
  s.overlap[k] = inside;
  s.push[k] = push;
  s.sliding[k] = rubs && slides ? 1 : 0;
}

/// The coefficients of a pair of bodies; spheres of one size and material share them, so that the last ones serve
/// again.
class StiffnessMemory {
 public:
  const ContactStiffness& find(const LawConstants& constants, const LawOptions& options, const Bodies& bodies,
                               std::size_t a, std::size_t b) {
    const std::array<double, 4> asked = {bodies.inverseMass[a], bodies.inverseMass[b], bodies.radiusRatio[a],
                                         bodies.radiusRatio[b]};
    if (&constants == known && asked == masses) return stiffness;
    known = &constants;
    masses = asked;
    ContactBody bodyA, bodyB;
    bodyA.inverseMass = asked[0];
    bodyA.radiusRatio = asked[2];
    bodyB.inverseMass = asked[1];
    bodyB.radiusRatio = asked[3];
    stiffness = findLinearStiffness(constants, options, bodyA, bodyB, Vec3::UnitX());
    return stiffness;
  }

 private:
  const LawConstants* known = nullptr;
  std::array<double, 4> masses{};
  ContactStiffness stiffness;
};

void loadSide(const Bodies& bodies, std::size_t i, std::size_t k, Side& side) {
  put(bodies.x[i], k, side.x);
  put(bodies.v[i], k, side.v);
  put(bodies.w[i], k, side.w);
  put(bodies.vHalf[i], k, side.vHalf);
  put(bodies.spinHalf[i], k, side.spinHalf);
}

/// What the law reads of every contact of the batch.
void loadBatch(const World& world, StiffnessMemory& memory, Batch& batch) {
  const Bodies& bodies = world.bodies;
  for (std::size_t k = 0; k < batch.count; ++k) {
    const std::size_t a = at(batch.a[k]), b = at(batch.b[k]);
    loadSide(bodies, a, k, batch.sideA);
    loadSide(bodies, b, k, batch.sideB);
    const LawConstants& constants = world.materials.constants(bodies.material[a], bodies.material[b]);
    const ContactStiffness& stiffness = memory.find(constants, world.options.lawOptions, bodies, a, b);
    batch.stiffnessN[k] = stiffness.normal;
    batch.stiffnessT[k] = stiffness.tangential;
    batch.dampingN[k] = stiffness.dampingNormal;
    batch.dampingT[k] = stiffness.dampingTangential;
    batch.friction[k] = constants.parameters.friction;
    const ContactHistory& history = world.pairs.memory.history[at(batch.slot[k])];
    put(history.spring, k, batch.spring);
    put(history.normal, k, batch.oldNormal);
  }
}

/// Answers into the chunk, histories into the pairs' memory.
void storeBatch(const Batch& batch, World& world, World::Chunk& chunk) {
  for (std::size_t k = 0; k < batch.count; ++k) {
    ContactHistory& history = world.pairs.memory.history[at(batch.slot[k])];
    history.spring = take(batch.spring, k);
    history.normal = take(batch.oldNormal, k);
    history.twist = 0;
    chunk.balls.push_back(
        {batch.pair[k], batch.sliding[k] != 0, false, take(batch.normal, k), batch.overlap[k], batch.push[k]});
    chunk.pulls.push_back(
        {batch.a[k], batch.b[k], take(batch.force, k), take(batch.torqueA, k), take(batch.torqueB, k)});
  }
}

template <bool alongVelocity>
void pressAndRub(const Shared& given, Batch& batch) {
  const Shared shared = given;
  const std::size_t count = batch.count;
#pragma omp simd
  for (std::size_t k = 0; k < count; ++k) pressAndRubBall<alongVelocity>(shared, k, batch);
}

void runBatch(const Shared& shared, StiffnessMemory& memory, Batch& batch, World& world, World::Chunk& chunk) {
  loadBatch(world, memory, batch);
  world.options.lawOptions.slideAlongVelocity ? pressAndRub<true>(shared, batch) : pressAndRub<false>(shared, batch);
  storeBatch(batch, world, chunk);
  batch.count = 0;
}

/// Looks at one pair; adds it to the batch if it touches.
void lookAtBallPair(World& world, std::int32_t index, World::Chunk& chunk, Batch& batch) {
  const Bodies& bodies = world.bodies;
  Pair& pair = world.pairs.pairs[at(index)];
  const std::size_t a = at(pair.a), b = at(pair.b), slot = at(pair.slot);
  std::vector<Contact>& held = world.pairs.memory.held;
  if (slot < held.size()) held[slot].a = -1;
  const double travel = bodies.travel[a] + bodies.travel[b];
  if (world.options.skips.separation && travel < pair.quietUntil) return;

  ++chunk.counts.warm;
  const Vec3 shift = world.options.periods.shift(pair.image);
  const Vec3 between = (bodies.x[b] + shift) - bodies.x[a];
  const double distance = between.norm();
  const double radiusA = bodies.boundingRadius[a], radiusB = bodies.boundingRadius[b];
  const double overlap = radiusA + radiusB - distance;
  if (!(overlap > 0)) {
    pair.quietUntil = travel + std::max(0.0, -overlap);
    world.pairs.memory.history[slot] = ContactHistory{};
    return;
  }
  const std::size_t k = batch.count++;
  batch.pair[k] = index;
  batch.a[k] = pair.a;
  batch.b[k] = pair.b;
  batch.slot[k] = pair.slot;
  put(shift, k, batch.shift);
  put(between, k, batch.between);
  batch.distance[k] = distance;
  batch.radiusA[k] = radiusA;
  batch.radii[k] = radiusA + radiusB;
  const double size = std::min(radiusA, radiusB);
  if (overlap > chunk.deepest * size) {
    chunk.deepest = overlap / size;
    chunk.deepestContact = static_cast<std::int32_t>(chunk.balls.size() + k);
  }
}

}  // namespace

void makeBallContacts(double dt, std::size_t c, World& world) {
  World::Chunk& chunk = world.chunks[c];
  startChunk(chunk);
  const LawOptions& options = world.options.lawOptions;
  const Shared shared{dt, options.tension ? -infinity : 0, options.frictionOfPush ? 0.0 : -1.0};
  StiffnessMemory memory;
  Batch batch;
  const std::size_t first = c * World::chunkSize;
  const std::size_t last = std::min(first + World::chunkSize, world.activePairs.size());
  for (std::size_t p = first; p < last; ++p) {
    const auto before = static_cast<std::int32_t>(chunk.balls.size() + batch.count);
    lookAtBallPair(world, world.activePairs[p], chunk, batch);
    const auto after = static_cast<std::int32_t>(chunk.balls.size() + batch.count);
    world.contactsOfPair[p] = {before, after - before};
    if (batch.count == batchSize) runBatch(shared, memory, batch, world, chunk);
  }
  runBatch(shared, memory, batch, world, chunk);
}

Contact World::describeBall(const Chunk& chunk, std::size_t k) const {
  const BallContact& ball = chunk.balls[k];
  const ContactPull& pull = chunk.pulls[k];
  const std::size_t a = at(pull.a);
  Contact contact;
  contact.pair = ball.pair;
  contact.a = pull.a;
  contact.b = pull.b;
  contact.shift = options.periods.shift(pairs.pairs[at(ball.pair)].image);
  fillBallTouch({ball.normal, ball.overlap}, bodies.x[a], bodies.boundingRadius[a], contact.touch);
  placeWitness(contact.touch, contact.patch);
  contact.force = {pull.force, Vec3::Zero(), ball.normalForce, ball.sliding};
  contact.held = ball.held;
  contact.torqueA = pull.torqueA;
  contact.torqueB = pull.torqueB;
  return contact;
}

}  // namespace granular
