// Contacts of ellipsoids in batches, from the search for the normal to the law, without the machinery that other shapes
// need. In a bed nearly all pairs that are looked at touched in the last step: their normals are foreseen, found by
// Newton's steps (narrow/ellipsoid_newton.h) and proven side by side. Whatever is not, a birth, an end, a deep overlap,
// is looked at by the kernel for one pair.
//
// Every number is made by the operations of that kernel, placeContact and the law in their order: the answers are the
// same bits, which Ellipsoids.InBatchesHaveTheSameBitsAsOneByOne holds this file to.
#include "granular/core/room.h"
#include "granular/core/tolerances.h"
#include "granular/narrow/ellipsoid_pair.h"
#include "granular/shape/curvature.h"
#include "granular/shape/ellipsoid.h"
#include "granular/world/brief_batch.h"
#include "granular/world/contact_radius.h"
#include "granular/world/looks.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// One body of each pair of a register.
struct Party {
  PlacedAxes<Wide> axes;
  Triple<Wide> semiAxes;
  Wide ratio, leastCurvatureRadius, boundingRadius, size;

  Party(const Bodies& bodies, const std::int32_t* slots) {
    std::array<const Frame*, wideSize> frames;
    std::array<const double*, wideSize> rows;
    for (std::size_t k = 0; k < wideSize; ++k) {
      frames[k] = &bodies.frame[at(slots[k])];
      rows[k] = static_cast<const Ellipsoid&>(*bodies.shape[at(slots[k])]).row().data();
    }
    axes = loadAxes(frames);
    std::array<Wide, std::tuple_size_v<Ellipsoid::Row>> column;
    loadRows(rows, column);
    semiAxes = {column[0], column[1], column[2]};
    ratio = column[3];
    leastCurvatureRadius = column[4];
    boundingRadius = column[5];
    size = column[6];
  }
};

/// A batch of contacts, and what their places are made of.
struct EllipsoidBatch : BriefBatch {
  std::array<WarmCache*, capacity> cache;
  ContactLanes::Lane known;  // 1: looked at by itself, and where it touches, if it does, is here already
  ContactLanes::Lane smallerSize;

  void fillRegister() {
    BriefBatch::fillRegister();
    const std::size_t last = count() - 1;
    for (std::size_t k = count(); k % wideSize != 0; ++k) {
      cache[k] = cache[last];
      known[k] = 1;
    }
  }
};

/// Makes the contacts of a chunk.
class EllipsoidLooks {
 public:
  EllipsoidLooks(double dt, World& of, World::Chunk& into)
      : world(of), chunk(into), elastic(lawReadsCurvature(of.options.law)), batch(ownOfThread<EllipsoidBatch>()) {
    batch.begin(dt, of);
  }

  /// Looks at a pair, one of those that are due; position: among the active ones.
  void take(std::size_t position, std::size_t dueIndex) {
    const std::int32_t index = world.activePairs[position];
    const Pair& pair = world.pairs.pairs[at(index)];
    PairMemory& memory = world.pairs.memory;
    WarmCache& cache = memory.cache[at(pair.slot)];
    SmoothTouch touch;
    const bool foreseen = isForeseen(cache);
    if (foreseen) {
      if (at(pair.slot) < memory.held.size()) memory.held[at(pair.slot)].a = -1;
    } else if (!lookByItself(index, touch)) {
      chunk.due.apart.set(dueIndex);
      return;
    }
    const std::size_t k = batch.add({index, pair.a, pair.b, -1, -1}, memory.history[at(pair.slot)]);
    batch.due[k] = dueIndex;
    batch.cache[k] = &cache;
    batch.shift.put(k, world.options.periods.shift(pair.image));
    batch.known[k] = 0;
    if (!foreseen) tell(k, touch);
    if (batch.count() == BriefBatch::capacity) finish();
  }

  /// Finds where those that wait touch, and presses them.
  void finish() {
    if (batch.count() == 0) return;
    batch.fillRegister();
    for (std::size_t k = 0; k < batch.count(); k += wideSize) findRegister(k);
    batch.dropApart(batch.smallerSize, chunk);
    keepTouches();
    batch.press(chunk);
  }

 private:
  bool lookByItself(std::int32_t index, SmoothTouch& touch) {
    Look look;
    if (!beginLook(world, index, look)) return false;
    const Pair& pair = world.pairs.pairs[at(index)];
    const Bodies& bodies = world.bodies;
    const bool touching = noteUncertified(look, chunk, [&] {
      return findEllipsoidTouch(
          {*bodies.shape[at(pair.a)], bodies.frame[at(pair.a)], *bodies.shape[at(pair.b)], look.frameB, false},
          world.pairs.memory.cache[at(pair.slot)], chunk.counts, touch);
    });
    if (!touching) waitForGap(world, look);
    return touching;
  }

  /// What a look by itself found.
  void tell(std::size_t k, const SmoothTouch& touch) {
    batch.known[k] = 1;
    batch.contacts.normal.put(k, touch.normal);
    batch.contacts.overlap[k] = touch.overlap;
    batch.middle.put(k, touch.middle);
  }

  /// Where the contacts of the register from lane k on touch.
  void findRegister(std::size_t k) {
    const Party a(world.bodies, &batch.a[k]), b(world.bodies, &batch.b[k]);
    PlacedAxes<Wide> imageOfB = b.axes;
    imageOfB.x = imageOfB.x + batch.shift.load(k);
    const EllipsoidPair<Wide> pair(a.semiAxes, a.axes, b.semiAxes, imageOfB, larger(a.ratio, b.ratio),
                                   slopeRoundOff(a.boundingRadius, b.boundingRadius));
    const Triple<Wide> last = lastNormals(k);
    const NewtonAnswer<Wide> found = takeTwoSteps(pair, foreseeNormal(last, lastTurns(k)));

    const Wide proven = a.leastCurvatureRadius + b.leastCurvatureRadius;
    const Mask<Wide> open = batch.known.load(k) == Wide{};
    const Mask<Wide> stands = both(open, both(found.converged, both(found.depth > Wide{}, found.depth <= proven)));
    remember(k, stands, last, found.normal);
    BriefBatch::Where where{a.axes.rotate(found.normal), found.depth, a.axes.toWorld(0.5 * (found.onA + found.onB))};
    if (!all(stands)) {
      lookAgain(k, both(open, ~stands));
      where = {choose<Wide>(stands, where.normal, batch.contacts.normal.load(k)),
               choose(stands, where.overlap, batch.contacts.overlap.load(k)),
               choose<Wide>(stands, where.middle, batch.middle.load(k))};
    }
    batch.place(k, where, a.axes.x, b.axes.x);
    batch.smallerSize.store(k, smaller(a.size, b.size));
    if (elastic) putRadii(k, a, b, where.normal);
  }

  Triple<Wide> lastNormals(std::size_t k) const {
    std::array<const Vec3*, wideSize> normals;
    for (std::size_t i = 0; i < wideSize; ++i) normals[i] = &batch.cache[k + i]->direction;
    return loadVectors(normals);
  }
  Triple<Wide> lastTurns(std::size_t k) const {
    Triple<Wide> turns;
    for (std::size_t i = 0; i < wideSize; ++i) {
      const Triple<double> turn = lastTurn(*batch.cache[k + i]);
      turns.x[i] = turn.x;
      turns.y[i] = turn.y;
      turns.z[i] = turn.z;
    }
    return turns;
  }

  /// What the kernel for one pair writes of a touch, for the lanes that stand.
  void remember(std::size_t k, const Mask<Wide>& stands, const Triple<Wide>& last, const Triple<Wide>& normal) {
    const Mask<Wide> flipped = both(stands, last.dot(normal) < flipCosine + Wide{});
    const Triple<Wide> turn = normal - last;
    for (std::size_t i = 0; i < wideSize; ++i) {
      if (stands[i] == 0) continue;
      WarmCache& cache = *batch.cache[k + i];
      ++chunk.counts.warm;
      if (flipped[i] != 0) ++chunk.counts.normalFlips;
      rememberTurn({turn.x[i], turn.y[i], turn.z[i]}, cache);
      cache.direction = {normal.x[i], normal.y[i], normal.z[i]};
    }
  }

  /// By themselves, those of the register from lane k on.
  void lookAgain(std::size_t k, const Mask<Wide>& which) {
    for (std::size_t i = 0; i < wideSize; ++i) {
      if (which[i] == 0) continue;
      SmoothTouch touch;
      if (lookByItself(batch.pair[k + i], touch)) {
        tell(k + i, touch);
      } else {
        batch.contacts.overlap[k + i] = 0;
      }
    }
  }

  void putRadii(std::size_t k, const Party& a, const Party& b, const Triple<Wide>& normal) {
    const CurvatureIn<Wide> sum = curvatureBetween<Wide>({a.axes, a.semiAxes}, {b.axes, b.semiAxes}, normal);
    ContactLanes::Lane& radius = batch.contacts.radius;
    radius.store(k, radiusOfRound(sum));
    const Mask<Wide> round = isRound(sum, Wide(tolerance::flattest * smaller(a.size, b.size)));
    if (all(round)) return;
    for (std::size_t i = k; i < k + wideSize; ++i) {
      if (round[i - k] == 0)
        radius[i] = ellipsoidRadius(world.bodies, batch.a[i], batch.b[i], batch.contacts.normal.take(i));
    }
  }

  void keepTouches() {
    const std::size_t before = chunk.touches.size(), count = batch.count();
    resizeClosely(chunk.touches, before + count);
    for (std::size_t k = 0; k < count; k += wideSize) {
      const std::size_t some = std::min(wideSize, count - k);
      std::array<double*, wideSize> rows;
      for (std::size_t i = 0; i < wideSize; ++i)
        rows[i] = chunk.touches[before + k + std::min(i, some - 1)].normal.data();
      const Triple<Wide> n = batch.contacts.normal.load(k), middle = batch.middle.load(k);
      storeRows<7>({n.x, n.y, n.z, batch.contacts.overlap.load(k), middle.x, middle.y, middle.z}, rows, some);
    }
  }

  World& world;
  World::Chunk& chunk;
  const bool elastic;
  EllipsoidBatch& batch;
};

}  // namespace

void makeEllipsoidContacts(double dt, std::size_t c, World& world) {
  World::Chunk& chunk = startChunk(world, c);
  EllipsoidLooks looks(dt, world, chunk);
  const PairMemory& memory = world.pairs.memory;
  const auto fetch = [&](const Pair& pair) {
    __builtin_prefetch(&memory.cache[at(pair.slot)]);
    __builtin_prefetch(&memory.history[at(pair.slot)]);
  };
  takeDue(world, c, fetch, [&](std::size_t position, std::size_t k) { looks.take(position, k); });
  looks.finish();
}

}  // namespace granular
