// The stages of a step. Each reads what the one before it wrote; tests and benchmarks may call them one by one.
#pragma once

#include <algorithm>

#include "granular/world/world.h"

namespace granular {

/// Below these a stage runs on one thread: waking the others would take longer than they save. Results are the same.
inline constexpr std::size_t chunksForThreads = 8;    ///< of World::chunkSize pairs
inline constexpr std::size_t bodiesForThreads = 512;  ///< that move
inline constexpr std::size_t pullsForThreads = 2048;  ///< left for gatherForces

/// From so many bodies on what a step reads and writes does not stay in a core's caches, and is asked for ahead.
inline constexpr std::size_t bodiesBeyondCaches = 4096;

/// Puts moving walls where they are at t_{n+1}.
void moveWalls(double dt, World& world);
/// Positions, orientations and predicted velocities at t_{n+1} of every moving body.
void predict(double dt, World& world);
/// The same for bodies alone.
Predicted predict(double dt, const WorldOptions& options, Bodies& bodies);
/// Brings the pairs up to date when some surface may have left its grown bounds.
void refreshPairs(double dt, World& world);
/// The contacts of all chunks, by the three stages below: chunk after chunk, so that what one stage reads is still near
/// when the next one reads it.
void makeContacts(double dt, World& world);
/// The three stages below at once for a chunk of spheres (sphere_contacts.cpp), of clumps and spheres
/// (ball_contacts.cpp) or of ellipsoids (ellipsoid_contacts.cpp), in batches; the same bits.
void makeSphereContacts(double dt, std::size_t c, World& world);
void makeBallContacts(double dt, std::size_t c, World& world);
void makeEllipsoidContacts(double dt, std::size_t c, World& world);
/// Which pairs of chunk c touch: normal and overlap of each contact.
void findContacts(std::size_t c, World& world);
/// The contact-point rule: where each contact of chunk c acts, and over what area.
void placeContactPoints(std::size_t c, World& world);
/// Force and couple of each contact of chunk c, and its history.
void applyForceLaws(double dt, std::size_t c, World& world);
/// Forces of the step: weights, and who adds what to them (World::firstRun).
void beginForces(World& world);
/// Adds what a contact does to those of its bodies that isOwn(slot) names.
template <class IsOwn>
void addPull(const ContactPull& pull, World& world, const IsOwn& isOwn) {
  Bodies& bodies = world.bodies;
  const bool loads = world.options.sleep.on;
  const double half = loads ? 0.5 * pull.force.norm() : 0;
  const auto counts = [&](std::int32_t body) {
    return body >= 0 && isOwn(body) && bodies.state[static_cast<std::size_t>(body)] != BodyState::frozen;
  };
  if (counts(pull.a)) {
    const auto a = static_cast<std::size_t>(pull.a);
    bodies.force[a] += pull.force;
    bodies.torque[a] += pull.torqueA;
    if (loads) world.load[a] += half;
  }
  if (counts(pull.b)) {
    const auto b = static_cast<std::size_t>(pull.b);
    bodies.force[b] -= pull.force;
    bodies.torque[b] += pull.torqueB;
    if (loads) world.load[b] += half;
  }
}
/// Adds what it may to the bodies, and leaves the rest to gatherForces: of a chunk that is not of the first run.
inline void share(ContactPull pull, World::Chunk& chunk, World& world) {
  constexpr std::int32_t nobody = -1;
  if (chunk.addsAtOnce) {
    const auto isOwn = [&](std::int32_t body) { return world.firstRun[static_cast<std::size_t>(body)] == chunk.run; };
    addPull(pull, world, isOwn);
    if (isOwn(pull.a)) pull.a = nobody;
    if (pull.b >= 0 && isOwn(pull.b)) pull.b = nobody;
    if (pull.a < 0 && pull.b < 0) return;
  }
  chunk.pulls.push_back(pull);
}
/// Delivers pullOf(k) of the next `count` contacts of a chunk to their bodies: at once, or later by gatherForces.
template <class PullOf>
void deliver(std::size_t count, const PullOf& pullOf, World::Chunk& chunk, World& world) {
  const bool first = chunk.addsAtOnce && chunk.run == 0;
  for (std::size_t k = 0; first && k < count; ++k) addPull(pullOf(k), world, [](std::int32_t) { return true; });
  for (std::size_t k = 0; !first && k < count; ++k) share(pullOf(k), chunk, world);
}
/// Ends the sums of forces and torques: those that were not added at once come after those that were, so that each
/// body's are summed in the order of its pairs, weight first.
void gatherForces(World& world);
/// Takes from the forces and torques of the bodies from slot `first` on what their locks forbid. Nothing unless a body
/// has locks.
void applyLocks(std::size_t first, Bodies& bodies);
/// Remembers the half-step velocities before the kick. Nothing unless the energy ledger is kept.
void rememberVelocities(World& world);
/// Half-step velocities and orientations from the forces at t_{n+1}.
void advance(double dt, const WorldOptions& options, Bodies& bodies);
/// Lands all before the first of those aloft may meet somebody in this step.
void landInTime(World& world);
/// In the middle of a step, after predict: brings bodies aloft to where predict brought the others.
void landPredicted(World& world);
/// Which bodies meet nobody for a while, and are not moved before they do (flight.cpp). Nothing unless skips ask for
/// it.
void letFly(double dt, World& world);
/// Lists whose forces a step sums.
void listGathered(World& world);
/// Books the work of the kick just done on the energy ledger. Nothing unless it is kept.
void keepLedger(double dt, World& world);
/// Bodies that have come to rest fall asleep; sleepers whose forces changed wake. Nothing unless the scene asks for it.
void letSleep(double dt, World& world);
/// Counts and names trouble: states that are not finite, deep overlaps.
void watch(World& world);

/// Names bodies whose centre is behind a wall of the vessel. Not part of a step: a run looks now and then.
void checkDomain(World& world);

/// Calls visit(slot) for the bodies of the pairs of chunk c, some of them several times.
template <class Visitor>
void visitBodiesOfChunk(std::size_t c, const World& world, const Visitor& visit) {
  const bool atWalls = c >= world.wallChunkBegin;
  const auto& active = atWalls ? world.activeWallPairs : world.activePairs;
  const std::size_t first = (atWalls ? c - world.wallChunkBegin : c) * World::chunkSize;
  const std::size_t last = std::min(first + World::chunkSize, active.size());
  for (std::size_t p = first; p < last; ++p) {
    const auto index = static_cast<std::size_t>(active[p]);
    if (atWalls) {
      visit(world.pairs.wallPairs[index].body);
      continue;
    }
    visit(world.pairs.pairs[index].a);
    visit(world.pairs.pairs[index].b);
  }
}

/// Empties chunk c, keeping its memory.
World::Chunk& startChunk(World& world, std::size_t c);

/// Lays out chunks for the present pairs, and what is listed of their bodies: after a refresh, and after loading a
/// checkpoint.
void layOutContacts(World& world);

/// Histories that chunks of spheres keep go to the memory of the pairs, which then has all; before pairs change, or
/// somebody reads them. And back to the chunks, before the next step.
void fileHistories(World& world);
void takeHistories(World& world);

/// Keeps a contact of two bodies at rest until one of them moves.
void holdContact(Contact& contact, World& world);

}  // namespace granular
