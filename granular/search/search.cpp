#include "granular/search/search.h"

#include <algorithm>
#include <cassert>
#include <tuple>

namespace granular {
namespace {

bool canMove(const Bodies& bodies, std::size_t i) { return bodies.state[i] != BodyState::frozen; }

}  // namespace

bool Search::isDue(const Bodies& bodies, double wallTravel) const {
  if (settings.everyStep || margins.size() != bodies.size()) return true;
  const auto isUsedUp = [&](std::size_t i) { return bodies.travel[i] + wallTravel - travelAtPlace[i] > margins[i]; };
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
  if (settings.periods.any()) placeGhosts(bodies);
  broadPhase->collect(candidates);
  mergePairs(bodies, list);
}

void Search::makeBroadPhase(const Bodies& bodies) {
  double size = 0;
  for (const Shape* shape : bodies.shape) size = std::max(size, shape->size());
  // A large body measures a hundred units, so that the tree's absolute margin is small beside it.
  broadPhase = settings.bruteForce ? makeBruteForceBroadPhase() : makeBulletBroadPhase(size > 0 ? size / 100 : 1);
}

void Search::packBoxes() {
  lowest.clear();
  highest.clear();
  for (const Aabb& box : boxes) {
    lowest.push_back(box.lo);
    highest.push_back(box.hi);
  }
}

void Search::restoreBoxes(const Bodies& bodies) {
  boxes.resize(lowest.size());
  makeBroadPhase(bodies);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].lo = lowest[i];
    boxes[i].hi = highest[i];
    broadPhase->place(i, boxes[i]);
  }
}

void Search::placeBounds(const Bodies& bodies, double dt, double wallTravel) {
  const std::size_t n = bodies.size();
  // Starting over: bodies were removed, or a periodic domain makes its ghosts anew.
  const bool anew = !broadPhase || margins.size() > n || margins.empty() || settings.periods.any();
  if (anew) {
    makeBroadPhase(bodies);
    margins.clear();
  }
  const std::size_t known = margins.size();
  boxes.resize(n);
  margins.resize(n);
  travelAtPlace.resize(n);
  wraps.assign(n, Image{0, 0, 0});
  for (std::size_t i = 0; i < n; ++i) {
    // Bodies that have used less than half of their margin keep their box.
    const double used = bodies.travel[i] + wallTravel - (i < known ? travelAtPlace[i] : 0);
    if (i < known && used <= 0.5 * margins[i] && !settings.everyStep) continue;
    const double turning = bodies.isBall(i) ? 0 : bodies.boundingRadius[i] * bodies.wHalf[i].norm();
    const double speed = bodies.vHalf[i].norm() + turning;
    margins[i] = settings.skin * bodies.shape[i]->size() + settings.lookAhead * dt * speed;
    travelAtPlace[i] = bodies.travel[i] + wallTravel;
    boxes[i] = bodies.shape[i]->bounds(bodies.frame[i]).grown(margins[i]);
    if (settings.periods.any()) {
      for (int k = 0; k < 3; ++k) {
        const double period = settings.periods.length[k];
        if (period <= 0) continue;
        const double wrap = -std::floor((bodies.x[i][k] - settings.periods.origin[k]) / period);
        wraps[i][static_cast<std::size_t>(k)] = static_cast<std::int32_t>(wrap);
        boxes[i].lo[k] += wrap * period;
        boxes[i].hi[k] += wrap * period;
      }
    }
    broadPhase->place(i, boxes[i]);
  }
}

void Search::placeGhosts(const Bodies& bodies) {
  // Images towards one half of the directions: every neighbouring pair of images then occurs exactly once.
  ghosts.clear();
  const Periods& periods = settings.periods;
  const Vec3 end = periods.origin + periods.length;
  double reach = 0;
  for (const Aabb& box : boxes) reach = std::max(reach, (box.hi - box.lo).maxCoeff());
  std::size_t proxy = bodies.size();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (int n = 14; n < 27; ++n) {
      const Image image{static_cast<std::int32_t>(n / 9 - 1), static_cast<std::int32_t>(n / 3 % 3 - 1),
                        static_cast<std::int32_t>(n % 3 - 1)};
      Aabb box = boxes[i];
      bool near = true;
      for (int k = 0; k < 3 && near; ++k) {
        const int steps = image[static_cast<std::size_t>(k)];
        if (steps == 0) continue;
        const double period = periods.length[k];
        box.lo[k] += steps * period;
        box.hi[k] += steps * period;
        // A ghost can only meet bodies whose centre is inside the domain.
        near = period > 0 && box.lo[k] <= end[k] + reach && box.hi[k] >= periods.origin[k] - reach;
      }
      if (!near) continue;
      ghosts.push_back({static_cast<std::int32_t>(i), image});
      broadPhase->place(proxy++, box);
    }
  }
}

void Search::mergePairs(const Bodies& bodies, PairList& list) {
  // Candidates become pairs, lower id first.
  const auto n = static_cast<std::int32_t>(bodies.size());
  found.clear();
  if (candidates.size() > found.capacity()) found.reserve(candidates.size() + candidates.size() / 8);
  for (const auto& [k, l] : candidates) {
    if (k >= n) continue;  // ghost against ghost: their bodies meet elsewhere
    Pair pair{k, l, -1, Image{0, 0, 0}, -infinity};
    if (settings.periods.any()) {
      Image ghost{0, 0, 0};
      if (l >= n) {
        ghost = ghosts[static_cast<std::size_t>(l - n)].image;
        pair.b = ghosts[static_cast<std::size_t>(l - n)].body;
      }
      const Image& wrapA = wraps[static_cast<std::size_t>(pair.a)];
      const Image& wrapB = wraps[static_cast<std::size_t>(pair.b)];
      for (std::size_t m = 0; m < 3; ++m) pair.image[m] = static_cast<std::int32_t>(ghost[m] + wrapB[m] - wrapA[m]);
      if (pair.a == pair.b) continue;  // longer than half a period: refused at the start
    }
    if (!canMove(bodies, static_cast<std::size_t>(pair.a)) && !canMove(bodies, static_cast<std::size_t>(pair.b)))
      continue;
    if (bodies.id[static_cast<std::size_t>(pair.a)] > bodies.id[static_cast<std::size_t>(pair.b)]) {
      std::swap(pair.a, pair.b);
      for (auto& steps : pair.image) steps = static_cast<std::int32_t>(-steps);
    }
    found.push_back(pair);
  }
  std::sort(found.begin(), found.end(), comesBefore);

  // Old and new lists are both in key order: one pass carries the memory over.
  std::size_t old = 0;
  for (Pair& pair : found) {
    while (old < list.pairs.size() && comesBefore(list.pairs[old], pair)) list.memory.give(list.pairs[old++].slot);
    if (old < list.pairs.size() && !comesBefore(pair, list.pairs[old])) {
      pair.slot = list.pairs[old].slot;
      pair.quietUntil = list.pairs[old].quietUntil;
      ++old;
    } else {
      pair.slot = list.memory.take();
    }
  }
  while (old < list.pairs.size()) list.memory.give(list.pairs[old++].slot);
  list.pairs.swap(found);
  found = {};  // as large as the list, and not needed until the next search
}

}  // namespace granular
