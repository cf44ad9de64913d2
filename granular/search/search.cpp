#include "granular/search/search.h"

#include <algorithm>
#include <cassert>
#include <tuple>

#include "granular/core/room.h"

namespace granular {
namespace {

/// Of all bodies, from which on every pair is looked for anew: walking through the tree once is then less work.
constexpr double fewMoved = 0.1;

bool canMove(const Bodies& bodies, std::size_t i) { return bodies.state[i] != BodyState::frozen; }

/// True if balls, grown as their boxes are, are too far apart to meet: half of the boxes that overlap are of such.
/// shift: of the second one, m.
bool areBallsApart(const Aabb& one, const Aabb& other, const Vec3& shift) {
  constexpr double roundOff = 1e-9;  // of a box in the length of balls, however far from the origin
  const Vec3 between = 0.5 * (other.lo + other.hi - one.lo - one.hi) + shift;
  const double reach = 0.5 * (1 + roundOff) * (one.hi.x() - one.lo.x() + other.hi.x() - other.lo.x());
  return between.squaredNorm() > reach * reach;
}

}  // namespace

bool Search::isDue(const Bodies& bodies, double wallTravel) const {
  if (settings.everyStep || margins.size() != bodies.size()) return true;
  const auto isUsedUp = [&](std::size_t i) { return marginLeft(bodies, i, wallTravel) < 0; };
  // A body that does not move can only be left by a wall that does.
  if (wallTravel == 0) {
    const std::vector<std::int32_t>& moving = bodies.movingSlots();
    return std::any_of(moving.begin(), moving.end(),
                       [&](std::int32_t i) { return isUsedUp(static_cast<std::size_t>(i)); });
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (isUsedUp(i)) return true;
  }
  return false;
}

void Search::refreshPairs(const Bodies& bodies, double dt, double wallTravel, PairList& list) {
  ++refreshes;
  placeBounds(bodies, dt, wallTravel);
  findPairs(bodies);
  mergePairs(bodies, list);
}

void Search::makeBroadPhase() { broadPhase = settings.bruteForce ? makeBruteForceBroadPhase() : makeBoxTree(); }

void Search::packBoxes() {
  lowest.clear();
  highest.clear();
  if (!broadPhase) return;  // nothing was searched for yet
  for (const Aabb& box : broadPhase->bounds()) {
    lowest.push_back(box.lo);
    highest.push_back(box.hi);
  }
}

void Search::restoreBoxes(const Bodies& bodies) {
  const std::size_t n = margins.size();  // none if the next search begins anew: then boxes are of bodies of before
  if (settings.periods.any()) wraps.assign(n, Image{0, 0, 0});
  couldMove.assign(n, 0);  // whoever can is looked at by the next refresh
  makeBroadPhase();
  for (std::size_t i = 0; i < n; ++i) {
    const Aabb box{lowest[i], highest[i]};
    for (int k = 0; k < 3; ++k) {
      const double period = settings.periods.length[k];
      if (period <= 0) continue;
      const double middle = 0.5 * (box.lo[k] + box.hi[k]);
      wraps[i][static_cast<std::size_t>(k)] = static_cast<std::int32_t>(std::round((middle - bodies.x(i)[k]) / period));
    }
    broadPhase->place(i, box);
  }
}

void Search::placeBounds(const Bodies& bodies, double dt, double wallTravel) {
  const std::size_t n = bodies.size();
  // Starting over: bodies were removed.
  const bool anew = !broadPhase || margins.size() > n || margins.empty();
  if (anew) {
    makeBroadPhase();
    margins.clear();
  }
  const std::size_t known = margins.size();
  margins.resize(n);
  travelAtPlace.resize(n);
  couldMove.resize(n);
  if (settings.periods.any()) wraps.resize(n);
  moved.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const bool thawed = canMove(bodies, i) && !couldMove[i];
    couldMove[i] = canMove(bodies, i);
    // Bodies that have used less than half of their margin keep their box.
    const double used = bodies.travel[i] + wallTravel - (i < known ? travelAtPlace[i] : 0);
    const bool stays = i < known && used <= 0.5 * margins[i] && !settings.everyStep;
    if (!stays || thawed) moved.push_back(static_cast<std::int32_t>(i));
    if (stays) continue;
    const double turning = bodies.isBall(i) ? 0 : bodies.boundingRadius(i) * bodies.wHalf[i].norm();
    const double speed = bodies.vHalf(i).norm() + turning;
    margins[i] = settings.skin * bodies.shape[i]->size() + settings.lookAhead * dt * speed;
    travelAtPlace[i] = bodies.travel[i] + wallTravel;
    Aabb box = bodies.shape[i]->bounds(bodies.frameOf(i)).grown(margins[i]);
    for (int k = 0; k < 3; ++k) {
      const double period = settings.periods.length[k];
      if (period <= 0) continue;
      const double wrap = -std::floor((bodies.x(i)[k] - settings.periods.origin[k]) / period);
      wraps[i][static_cast<std::size_t>(k)] = static_cast<std::int32_t>(wrap);
      box.lo[k] += wrap * period;
      box.hi[k] += wrap * period;
    }
    broadPhase->place(i, box);
  }
  allMoved = static_cast<double>(moved.size()) >= fewMoved * static_cast<double>(n);
  isMoved.assign(n, allMoved);
  for (const std::int32_t i : moved) isMoved[static_cast<std::size_t>(i)] = true;
}

/// All pairs in which somebody moved, each once, in the order of the list.
void Search::findPairs(const Bodies& bodies) {
  found.clear();
  const Image same{0, 0, 0};
  if (allMoved) {
    broadPhase->collect(candidates);
    for (const auto& [k, l] : candidates) addPair(bodies, k, l, same);
  } else {
    for (const std::int32_t i : moved) {
      broadPhase->query(broadPhase->bounds()[static_cast<std::size_t>(i)], near);
      for (const std::int32_t j : near) {
        if (j != i) addPair(bodies, j, i, same);
      }
    }
  }
  if (settings.periods.any()) {
    largestBox = 0;
    for (const Aabb& box : broadPhase->bounds()) largestBox = std::max(largestBox, (box.hi - box.lo).maxCoeff());
    if (allMoved) {
      for (std::size_t i = 0; i < bodies.size(); ++i) findAtImages(bodies, i);
    } else {
      for (const std::int32_t i : moved) findAtImages(bodies, static_cast<std::size_t>(i));
    }
  }
  std::sort(found.begin(), found.end(), [](const Pair& p, const Pair& q) { return comesBefore(p, q); });
  const auto isSame = [](const Pair& p, const Pair& q) { return !comesBefore(p, q) && !comesBefore(q, p); };
  found.erase(std::unique(found.begin(), found.end(), isSame), found.end());  // where both moved
}

/// Pairs of images of body i with bodies in the domain: images towards one half of the directions if all bodies are
/// asked, so that every neighbouring pair of images occurs exactly once.
void Search::findAtImages(const Bodies& bodies, std::size_t i) {
  const Periods& periods = settings.periods;
  const Vec3 end = periods.origin + periods.length;
  for (int n = allMoved ? 14 : 0; n < 27; ++n) {
    if (n == 13) continue;
    const Image image{static_cast<std::int32_t>(n / 9 - 1), static_cast<std::int32_t>(n / 3 % 3 - 1),
                      static_cast<std::int32_t>(n % 3 - 1)};
    Aabb box = broadPhase->bounds()[i];
    bool isNear = true;
    for (int k = 0; k < 3 && isNear; ++k) {
      const int steps = image[static_cast<std::size_t>(k)];
      if (steps == 0) continue;
      const double period = periods.length[k];
      box.lo[k] += steps * period;
      box.hi[k] += steps * period;
      // An image can only meet bodies whose centre is inside the domain.
      isNear = period > 0 && box.lo[k] <= end[k] + largestBox && box.hi[k] >= periods.origin[k] - largestBox;
    }
    if (!isNear) continue;
    broadPhase->query(box, near);
    // A body that meets itself is longer than half a period: refused at the start.
    for (const std::int32_t j : near) {
      if (j != static_cast<std::int32_t>(i)) addPair(bodies, j, static_cast<std::int32_t>(i), image);
    }
  }
}

/// Lower id first. imageOfBox: of B's box against the one that was placed.
void Search::addPair(const Bodies& bodies, std::int32_t a, std::int32_t b, const Image& imageOfBox) {
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  if (!canMove(bodies, i) && !canMove(bodies, j)) return;
  if (bodies.isBall(i) && bodies.isBall(j) &&
      areBallsApart(broadPhase->bounds()[i], broadPhase->bounds()[j], settings.periods.shift(imageOfBox)))
    return;
  Pair pair{a, b, -1, imageOfBox, -infinity};
  if (!wraps.empty()) {
    for (std::size_t k = 0; k < 3; ++k) pair.image[k] += wraps[j][k] - wraps[i][k];
  }
  if (bodies.id[i] > bodies.id[j]) {
    std::swap(pair.a, pair.b);
    for (auto& steps : pair.image) steps = -steps;
  }
  found.push_back(pair);
}

/// Pairs that were found take the place of all those in which somebody moved.
void Search::mergePairs(const Bodies& bodies, PairList& list) {
  const auto isPast = [&](const Pair& pair) {
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    return isMoved[a] || isMoved[b] || (!canMove(bodies, a) && !canMove(bodies, b));
  };
  const auto stay = allMoved ? 0 : list.pairs.size() - std::count_if(list.pairs.begin(), list.pairs.end(), isPast);
  std::vector<Pair> merged;
  merged.reserve(stay + found.size());
  // Both lists are in the order of their keys: one pass carries the memory over.
  std::size_t old = 0;
  const auto leaveOld = [&] {
    const Pair& pair = list.pairs[old++];
    isPast(pair) ? list.memory.give(pair.slot) : merged.push_back(pair);
  };
  for (Pair& pair : found) {
    while (old < list.pairs.size() && comesBefore(list.pairs[old], pair)) leaveOld();
    if (old < list.pairs.size() && !comesBefore(pair, list.pairs[old])) {
      pair.slot = list.pairs[old].slot;
      pair.quietUntil = list.pairs[old].quietUntil;
      ++old;
    } else {
      pair.slot = list.memory.take();
    }
    merged.push_back(pair);
  }
  while (old < list.pairs.size()) leaveOld();
  list.pairs.swap(merged);
  if (allMoved) {  // as large as the list, and not needed until the next search
    discard(found);
    discard(candidates);
    discard(moved);
  }
}

}  // namespace granular
