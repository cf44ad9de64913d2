// Verlet lists: which pairs may touch before any surface has used up its share of the skin.
#pragma once

#include <memory>
#include <vector>

#include "granular/body/bodies.h"
#include "granular/pair/pair_list.h"
#include "granular/search/broad_phase.h"

namespace granular {

/// Periods of the domain along x, y, z, m; 0 where it is not periodic.
struct Periods {
  Vec3 length = Vec3::Zero();
  Vec3 origin = Vec3::Zero();
  bool any() const { return (length.array() > 0).any(); }
  /// How far the image lies from the stored position, m.
  Vec3 shift(const Image& image) const {
    if ((image[0] | image[1] | image[2]) == 0) return Vec3::Zero();  // nearly all
    return {image[0] * length.x(), image[1] * length.y(), image[2] * length.z()};
  }
};

struct SearchOptions {
  double skin = 0.1;        ///< bounds grow by this times the body's equal-volume radius, plus a share for speed
  double lookAhead = 30;    ///< and by the way a body makes in this many steps
  bool everyStep = false;   ///< search anew each step: the oracle of the skin
  bool bruteForce = false;  ///< every pair against every other: the oracle of the broad phase
  Periods periods;
};

/// Keeps the broad phase and the pair list up to date.
class Search {
 public:
  explicit Search(const SearchOptions& options) : settings(options) {}

  /// True if some surface may have left its grown bounds since the last refresh, or bodies came or went.
  bool isDue(const Bodies& bodies, double wallTravel) const;

  /// Brings the pairs of bodies up to date, at the cost of those that moved. Memory of surviving pairs is kept; pairs
  /// of two bodies that cannot move are left out.
  void refreshPairs(const Bodies& bodies, double dt, double wallTravel, PairList& list);

  /// The margin by which body i's bounds are grown, m; and what is left of it.
  double margin(std::size_t i) const { return margins[i]; }
  double marginLeft(const Bodies& bodies, std::size_t i, double wallTravel) const {
    return margins[i] - (bodies.travel[i] + wallTravel - travelAtPlace[i]);
  }

  /// Forgets the bounds: to be called when bodies were removed, reordered or moved by hand.
  void invalidate() { margins.clear(); }

  /// Calls visit(name, column) for what a checkpoint must hold: when the next refresh comes depends on it.
  template <class Visitor>
  void visitState(Visitor&& visit) {
    visit("margin", margins);
    visit("travel_at_place", travelAtPlace);
    visit("lowest", lowest);
    visit("highest", highest);
  }
  /// Before saving, and after loading: boxes to columns, and back into a new broad phase.
  void packBoxes();
  void restoreBoxes(const Bodies& bodies);

  std::uint64_t refreshes = 0;

 private:
  void makeBroadPhase();
  void placeBounds(const Bodies& bodies, double dt, double wallTravel);
  void findPairs(const Bodies& bodies);
  void findAtImages(const Bodies& bodies, std::size_t i);
  void addPair(const Bodies& bodies, std::int32_t a, std::int32_t b, const Image& imageOfBox);
  void mergePairs(const Bodies& bodies, PairList& list);

  SearchOptions settings;
  std::unique_ptr<BroadPhase> broadPhase;  // holds the grown bounds as placed
  std::vector<double> margins;             // by which they were grown
  std::vector<double> travelAtPlace;       // travel of the body (and the walls) when they were placed
  std::vector<Vec3> lowest, highest;       // boxes as columns, for a checkpoint
  std::vector<Image>
      wraps;  // periods that brought a body into the domain when its box was placed; empty where there are none
  double largestBox = 0;                // edge, m
  std::vector<std::uint8_t> couldMove;  // at the last refresh
  // Of the present refresh: whose pairs are looked for, the others keep theirs.
  std::vector<std::int32_t> moved;
  std::vector<bool> isMoved;
  bool allMoved = false;
  std::vector<std::array<std::int32_t, 2>> candidates;
  std::vector<std::int32_t> near;
  std::vector<Pair> found;
};

}  // namespace granular
