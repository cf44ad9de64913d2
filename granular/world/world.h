// The world: everything that a step reads and writes. No process-wide state; several worlds may live side by side.
#pragma once

#include <array>
#include <bitset>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "granular/body/bodies.h"
#include "granular/energy/ledger.h"
#include "granular/integrate/integrator.h"
#include "granular/law/materials.h"
#include "granular/narrow/narrow.h"
#include "granular/pair/contact.h"
#include "granular/pair/pair_list.h"
#include "granular/search/search.h"
#include "granular/skip/sleep.h"
#include "granular/wall/wall.h"
#include "granular/world/report.h"

namespace granular {

/// What a run may leave out; every switch changes speed, and the answers by no more than round-off.
struct Skips {
  bool search = true;       ///< broad phase only once a surface may have left its grown bounds
  bool separation = true;   ///< pairs proven apart by a gap are not looked at until it may be closed
  bool feature = true;      ///< the last contact feature is verified instead of searched
  bool orientation = true;  ///< nobody follows how balls lie: they spin all the same, and their q stays 1
  /// Bodies that meet nobody for a while are moved when they do: whoever reads bodies between steps calls land() first.
  bool flight = false;
};

struct WorldOptions {
  Vec3 gravity{0, 0, -9.81};  ///< m/s^2
  RuleOptions rule;
  LawKind law = LawKind::linear;
  LawOptions lawOptions;
  SchemeKind integrator = SchemeKind::seelen;
  Periods periods;
  double skin = 0.1;        ///< of the search, in equal-volume radii
  bool bruteForce = false;  ///< the oracle of the broad phase
  /// False: bodies whose neighbours lie far away in memory may be given other slots by a step (world/order.h); ids and
  /// motion stay what they are, but for round-off.
  bool keepSlots = true;
  bool noBatches = false;  ///< every body, pair and contact by itself: the oracle of what is worked on in batches
  Skips skips;
  SleepOptions sleep;
  double expectedOverlap = 0.02;  ///< largest, over the size: for the time step where stiffness grows with overlap
  double deepOverlap = 0.08;      ///< overlaps above this times the smaller size are reported as trouble
  double maxSpeed = 1e5;          ///< surface speeds above this are reported as trouble, m/s
  bool energy = false;            ///< keep the energy ledger
};

/// What predict found of the bodies it moved.
struct Predicted {
  double way = 0;            ///< bound on how far any point of their surfaces moved in the step, m
  bool withinLimit = false;  ///< no surface is faster than WorldOptions::maxSpeed
};

struct World {
  World(const WorldOptions& chosen, MaterialTable table);

  WorldOptions options;
  MaterialTable materials;
  ShapeTable shapes;
  Bodies bodies;
  std::vector<std::unique_ptr<Wall>> walls;
  std::size_t vesselWalls = 0;  ///< how many of them, from the first, no body may be behind

  double time = 0;         ///< of t_n, s
  std::int64_t steps = 0;  ///< taken so far
  double wallTravel = 0;   ///< bound on the way of any wall surface so far, m

  PairList pairs;
  Search search;
  std::uint64_t orderLookedAt = ~std::uint64_t{0};  ///< search.refreshes of the pairs whose bodies' order will do
  SleepState sleep;
  std::int64_t nextId = 0;

  static constexpr std::size_t chunkSize = 512;  ///< pairs
  /// Contacts of the present step, in chunks of consecutive pairs: each chunk is one thread's work, and the chunks do
  /// not depend on the number of threads. Bodies' chunks first, then the walls'.
  struct alignas(64) Chunk {  // no two share a line of the cache: threads write to them side by side
    /// Which of its active pairs need a look: those that touch, and those whose gap may have closed (due_pairs.cpp).
    struct Due {
      std::array<std::uint16_t, chunkSize> place;  ///< in the chunk, ascending
      std::size_t count = 0;
      std::bitset<chunkSize> apart;     ///< those (by their place in this list) that turned out to have no contact
      double quietUntil = infinity;     ///< the least quietWay of the others, m
      bool ofSpheres = false;           ///< makeSphereContacts makes their contacts
      std::vector<SpherePair> spheres;  ///< then one for each of the list, with its history
    } due;
    std::int32_t lowest = 0, highest = -1;  ///< slots of the bodies that are part of its pairs
    std::vector<Contact> contacts;
    /// Only balls or only ellipsoids meet here, and this makes their contacts in batches; null: stage by stage.
    void (*make)(double dt, std::size_t chunk, World& world) = nullptr;
    std::vector<BriefContact> briefs;                   ///< then these stand for contacts
    std::vector<std::array<std::int32_t, 2>> children;  ///< of briefs, as in Spot; empty where no clump is
    std::vector<SmoothTouch> touches;                   ///< of briefs, unless they are of balls
    /// Only cuboids or only polyhedra meet here, and this finds their contacts in batches; null: pair by pair.
    void (*find)(std::size_t chunk, World& world) = nullptr;
    std::size_t run = 0;             ///< of World::runs
    bool addsAtOnce = true;          ///< in the present step it is made by the thread of its run, in order
    std::vector<ContactPull> pulls;  ///< of contacts or of briefs: what could not be added at once
    NarrowCounts counts;
    double deepest = 0;                 ///< largest overlap over size in this chunk
    std::int32_t uncertifiedPair = -1;  ///< the first pair whose answer no bound could certify
    std::int32_t deepestContact = -1;   ///< index in contacts, or in briefs
    std::vector<WallTouch> wallTouches;
    std::array<double, 3> seconds{};       ///< spent on finding, placing and the law in the present step
    std::vector<ContactAccount> accounts;  ///< of the contacts; empty unless the energy ledger is kept
    LedgerSums booked;
    /// Remembers how deep the contact with this index is, if it is the deepest so far; size: what overlaps are relative
    /// to.
    void noteDepth(double overlap, double size, std::size_t index) {
      if (overlap <= deepest * size) return;
      deepest = overlap / size;
      deepestContact = static_cast<std::int32_t>(index);
    }
    /// The same for the last one of `contacts`.
    void noteDepth(double overlap, double size) { noteDepth(overlap, size, contacts.size() - 1); }
  };
  std::vector<Chunk> chunks;
  std::size_t wallChunkBegin = 0;

  /// The pairs a step looks at: those with a body that moves. Indices into the lists, in their order.
  std::vector<std::int32_t> activePairs, activeWallPairs;
  /// Which pairs each body is part of, ascending: for sleepers alone. Empty until somebody asks, and from the moment on
  /// at which the list changes.
  struct PairsOfBodies {
    std::vector<std::int32_t> begin;  ///< by slot, and the end: in `index`
    std::vector<std::int32_t> index;  ///< in PairList::pairs
  } pairsOfBodies;
  Predicted predicted;  ///< of the last step
  /// Bound on how far the two bodies of any pair moved towards each other since the contacts were laid out, m.
  double pairWay = 0;
  /// An active pair that isn't due needs no look while pairWay is below its number here, m: one number tells what
  /// isQuiet asks of both bodies. Infinite for others, and to the end of the last chunk.
  std::vector<double> quietWay;
  bool historiesFiled = true;          ///< none is with a chunk's due pairs (fileHistories)
  std::vector<std::int32_t> met;       ///< slots of the bodies that are part of active pairs
  std::vector<std::int32_t> gathered;  ///< slots whose forces a step sums: the moving, and sleepers near them
  /// Each thread makes the contacts of a run of chunks and adds what they do to their bodies at once, in the order of
  /// the contacts, but for bodies that an earlier run names as well: by slot, the first one that does. Empty if there
  /// is one run; runs = 0: to be laid out anew.
  std::vector<std::uint16_t> firstRun;
  std::size_t runs = 0;
  /// Sums of the contacts a body at rest has with others at rest, which keep their force; empty unless bodies sleep.
  std::vector<Vec3> heldForce, heldTorque;
  std::vector<double> load;  ///< weight plus half the sum of the contact forces of each moving body, N; for sleep alone
  bool anyClump = false;     ///< among the shapes
  bool layoutStale = false;  ///< bodies fell asleep or woke: lay out the contacts anew

  /// Bodies that meet nobody for a while (flight.cpp).
  struct Aloft {
    static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
    std::int64_t notBefore = never;  ///< steps from which on it is worthwhile to look for some
    std::int64_t since = 0;          ///< steps after which their state is that of the bodies that are stepped
    std::int64_t until = never;      ///< steps after which the first of them may meet somebody
    double dt = 0;                   ///< s
    std::uint64_t bodySteps = 0;     ///< saved so far
  } aloft;

  EnergyLedger ledger;                           ///< of t_{n+1/2} after a step; not begun unless the options ask for it
  std::vector<Vec3> velocityBefore, spinBefore;  ///< half-step velocities before the last kick, for the ledger
  std::vector<Vec3> wallForces;                  ///< on each wall, N, of the last step
  std::vector<double> wallStiffness;             ///< of the contacts of each wall that a servo presses, N/m
  Report report;

  /// Adds a body at time t_n; its half steps start with the next step. Returns its slot.
  std::size_t addBody(NewBody body);
  /// How the balls among the bodies turn: their spins need no scheme.
  Bodies::Turning turningOfBalls() const;
  /// Adds a shape; returns its index.
  std::int32_t addShape(std::shared_ptr<const Shape> shape);
  /// Removes the marked slots with their pairs. Sleepers that touched one of them wake; other contacts at rest stay,
  /// those of moving bodies are found again by the next step.
  void removeBodies(const std::vector<bool>& gone);
  /// Body order[k] moves to slot k with its pairs; bodies that it does not name are removed.
  void rearrange(const std::vector<std::int32_t>& order);

  /// Calls visit(const Contact&) for every contact of the last step in the order of the pairs, then for those held
  /// between bodies at rest.
  template <class Visitor>
  void visitContacts(Visitor&& visit) const {
    for (const Chunk& chunk : chunks) {
      for (const Contact& contact : chunk.contacts) {
        if (!contact.held) visit(contact);
      }
      for (std::size_t k = 0; k < chunk.briefs.size(); ++k) {
        if (!chunk.briefs[k].held) visit(describeBrief(chunk, k));
      }
    }
    // The lists may have changed since these were held.
    const auto visitNow = [&](Contact contact, std::size_t index) {
      contact.pair = static_cast<std::int32_t>(index);
      visit(contact);
    };
    for (std::size_t k = 0; k < pairs.pairs.size(); ++k) {
      pairs.memory.visitHeld(pairs.pairs[k], [&](const Contact& contact) { visitNow(contact, k); });
    }
    for (std::size_t k = 0; k < pairs.wallPairs.size(); ++k) {
      for (const Contact& contact : pairs.wallPairs[k].held) visitNow(contact, k);
    }
  }
  std::size_t contactCount() const;
  /// Slots of the bodies of contact k of a chunk, as in Contact.
  std::array<std::int32_t, 2> partiesOf(const Chunk& chunk, std::size_t k) const {
    if (chunk.briefs.empty()) return {chunk.contacts[k].a, chunk.contacts[k].b};
    const Pair& pair = pairs.pairs[static_cast<std::size_t>(chunk.briefs[k].pair)];
    return {pair.a, pair.b};
  }
  /// What a pair with one contact remembers; index: in pairs.
  const ContactHistory& historyOf(std::int32_t index) const;
  /// Contact k of those in short of a chunk, in full.
  Contact describeBrief(const Chunk& chunk, std::size_t k) const;
};

/// Kinetic energy of all bodies at t_n, J.
double kineticEnergy(const Bodies& bodies);

/// Brings bodies that fly to t_n (Skips::flight). Between steps; the motion is the same to the bit whoever asks for it
/// how often.
void land(World& world);

/// Wakes every sleeper.
void wakeAll(World& world);

/// One time step of dt seconds: from t_n to t_{n+1}.
void step(World& world, double dt);

/// Starts the half steps of the bodies from slot `first` on, from their state at t_n: for new bodies, and for all after
/// a change of dt. withContacts: from the forces of the contacts at t_n; otherwise from gravity alone. No time passes.
void startHalfSteps(World& world, double dt, std::size_t first, bool withContacts);

}  // namespace granular
