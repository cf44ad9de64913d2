// Any two convex shapes. Warm: the last separating direction, or Newton's method on the normal between the pieces that
// touched last, or a descent from the last normal. Cold, by support functions alone: GJK for the separated, Bullet's
// GJK/EPA for the touching, both bounds for whatever it says, and a second route where it fails.
#include "granular/core/tolerances.h"
#include "granular/narrow/epa.h"
#include "granular/narrow/gjk.h"
#include "granular/narrow/global_proof.h"
#include "granular/narrow/kernels.h"
#include "granular/narrow/round_features.h"

namespace granular {
namespace {

/// How far Bullet's depth and direction may be off on polyhedra, relative to the pair's size: its polytope is exact
/// there but for its own tolerances.
constexpr double flatProposalError = 1e-6;

/// How far Bullet's depth may lie from the depth along its own normal, relative to the pair's size. On smooth shapes
/// its polytope ends with an error of this order, which the descent then removes; its false answers are off by far
/// more.
constexpr double proposalError = 1e-3;

/// How near (radians) a direction must be to a face or a line to be named after it: a descent leaves some 1e-8.
constexpr double namedNearness = 1e-5;

/// The same for a guess, such as the direction of a gap, which is only good to the precision asked for.
constexpr double guessNearness = 0.05;

/// The same for the last normal of a pair whose pieces have changed: only what is tried hangs on it.
constexpr double alignedNearness = 0.0175;

bool isLine(const PieceName& name) {
  return name.kind == PieceName::edge || name.kind == PieceName::side || name.kind == PieceName::slope;
}

/// Two lines along each other have no common normal: an end of one over the other line makes the minimum, and where
/// several do, the middle between the outermost of them is the place.
PieceMinimum findMinimumAlong(Difference& c, const PieceName& a, const PieceName& b, const Vec3& n) {
  const double roundOff = 4 * std::numeric_limits<double>::epsilon() * c.extent();
  PieceMinimum out;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  for (int k = 0; k < 4; ++k) {
    const PieceName nameA = k < 2 ? endOf(c.shapeA(), a, k == 1) : a;
    const PieceName nameB = k < 2 ? b : endOf(c.shapeB(), b, k == 3);
    const PieceMinimum found = findPieceMinimum(c, nameA, nameB, n);
    if (!found.holds || (out.holds && found.minimum.depth > out.minimum.depth + roundOff)) continue;
    if (!out.holds || found.minimum.depth < out.minimum.depth - roundOff) {
      out = found;
      from = to = found.minimum.onA;
    } else if ((found.minimum.onA - from).squaredNorm() > (to - from).squaredNorm()) {
      to = found.minimum.onA;
    }
  }
  const Vec3 aside = 0.5 * (from + to) - out.minimum.onA;
  out.minimum.onA += aside;
  out.minimum.onB += aside;
  return out;
}

/// The minimum that the two pieces make next to the direction n; where they are a face that does not hold, its rim, and
/// where they are lines along each other, their ends.
PieceMinimum findNamedMinimum(Difference& c, const PieceName& a, const PieceName& b, const Vec3& n) {
  PieceMinimum out = findPieceMinimum(c, a, b, n);
  for (std::int32_t k = 0; !out.holds; ++k) {
    const PieceName rimA = rimOf(c.shapeA(), a, k), rimB = rimOf(c.shapeB(), b, k);
    if (rimA.kind == PieceName::unknown && rimB.kind == PieceName::unknown) break;
    if (rimA.kind != PieceName::unknown) out = findPieceMinimum(c, rimA, b, n);
    if (!out.holds && rimB.kind != PieceName::unknown) out = findPieceMinimum(c, a, rimB, n);
  }
  if (!out.holds && isLine(a) && isLine(b)) out = findMinimumAlong(c, a, b, n);
  return out;
}

/// The local minimum next to a guess: of the pieces that support it there, else by descent.
LocalMinimum settle(Difference& c, const Vec3& n) {
  const PieceName a = namePiece(c.shapeA(), n, guessNearness);
  const PieceName b = namePiece(c.shapeB(), -c.frame().unrotate(n), guessNearness);
  const PieceMinimum found = findNamedMinimum(c, a, b, n);
  return found.holds && found.minimum.depth <= c.depth(n) ? found.minimum : descend(c, n);
}

/// Polishes the proposal if it is consistent with itself; otherwise there is none.
bool takeProposal(Difference& c, const PenetrationAnswer& proposal, LocalMinimum& best, double& proposed) {
  proposed = infinity;
  if (!proposal.penetrating) return false;
  // Either sign of the normal is taken: the depth tells them apart.
  const double along = c.depth(proposal.normal), against = c.depth(-proposal.normal);
  proposed = std::min(along, against);
  if (std::abs(proposed - proposal.overlap) > proposalError * c.size()) return false;
  best = settle(c, along <= against ? proposal.normal : -proposal.normal);
  return true;
}

/// Reports a minimum found by support functions, with the pieces that make it, for the next look. They give it to
/// round-off, which a search stops short of where surfaces are long or nearly parallel, and may prove a gap where it
/// saw an overlap. True if the two overlap.
bool reportNamed(const PairView& pair, Difference& c, const LocalMinimum& found, WarmCache& cache, NarrowCounts& counts,
                 Touch& touch) {
  const PieceName a = namePiece(pair.a, found.normal, namedNearness);
  const PieceName b = namePiece(pair.b, -c.frame().unrotate(found.normal), namedNearness);
  const PieceMinimum exact = findNamedMinimum(c, a, b, found.normal);
  const bool better = exact.holds && exact.minimum.depth <= found.depth;
  cache.featureA = encode(better ? exact.a : a);
  cache.featureB = encode(better ? exact.b : b);
  if (better && !(exact.minimum.depth > 0)) return reportApart(exact.minimum.normal, -exact.minimum.depth, cache);
  return reportTouch(pair, WarmCache::smooth, better ? exact.minimum : found, cache, counts, touch);
}

/// Reports a separation with the pieces that are nearest to each other, which make the gap the widest.
bool reportNamedApart(const PairView& pair, Difference& c, const Nearest& nearest, WarmCache& cache) {
  const PieceName a = namePiece(pair.a, nearest.direction, guessNearness);
  const PieceName b = namePiece(pair.b, -c.frame().unrotate(nearest.direction), guessNearness);
  const PieceMinimum exact = findNamedMinimum(c, a, b, nearest.direction);
  const bool wider = exact.holds && -exact.minimum.depth >= nearest.gap;
  cache.featureA = encode(wider ? exact.a : PieceName{});
  cache.featureB = encode(wider ? exact.b : PieceName{});
  if (!wider) return reportApart(nearest.direction, nearest.gap, cache);
  return reportApart(exact.minimum.normal, -exact.minimum.depth, cache);
}

/// With a shape that a ball rolls around inside, the overlap is the layers taken off less the distance of what is left:
/// one GJK distance, global by its own proof. False while the cores are so near that the direction would lose digits.
bool touchByCores(const PairView& pair, Difference& c, WarmCache& cache, NarrowCounts& counts, Touch& touch,
                  bool& touches) {
  const double layerA = rollingRadius(pair.a), layerB = rollingRadius(pair.b);
  if (!(layerA + layerB > 0)) return false;
  Difference core = c;
  core.erode(layerA, layerB);
  const Nearest nearest = findNearest(core, Vec3::Zero(), guessNormal(c, cache), 1e-15);
  constexpr double leastGap = 1e-3;
  if (nearest.inside || !(nearest.gap > leastGap * (layerA + layerB))) return false;

  ++(cache.kind == WarmCache::cold ? counts.cold : counts.warm);
  const double overlap = layerA + layerB - nearest.gap;
  const Vec3& n = nearest.direction;
  touches = overlap > 0;
  if (!touches) {
    reportApart(n, -overlap, cache);
    return true;
  }
  const Vec3 middle = 0.5 * (nearest.onA + layerA * n + nearest.onB - layerB * n);
  const LocalMinimum found{n, overlap, middle + 0.5 * overlap * n, middle - 0.5 * overlap * n};
  touches = reportNamed(pair, c, found, cache, counts, touch);
  return true;
}

/// True if what a search found is the minimum for all purposes of a warm answer: its points' offset, the slope of the
/// depth, takes no more off over the ten degrees that the proofs grant (global_proof.h) than these do.
bool isStationary(const LocalMinimum& found, double size) { return found.off <= 0.1 * found.depth + 1e-8 * size; }

/// The minimum that the last pieces make, if they still make one.
PieceMinimum findLastPieces(const PairView& pair, Difference& c, const WarmCache& cache) {
  if (cache.featureA == 0 || cache.featureB == 0) return {};
  const PieceName a = decodePiece(cache.featureA), b = decodePiece(cache.featureB);
  c.seed(vertexOf(pair.a, a), vertexOf(pair.b, b));
  return findPieceMinimum(c, a, b, cache.direction);
}

/// The minimum that the faces and lines across the last normal make, or what ends them.
PieceMinimum findAlignedPieces(Difference& c, const Vec3& last) {
  const PieceName a = namePiece(c.shapeA(), last, alignedNearness);
  const PieceName b = namePiece(c.shapeB(), -c.frame().unrotate(last), alignedNearness);
  return findNamedMinimum(c, a, b, last);
}

}  // namespace

void countProposal(Difference& c, const PenetrationAnswer& proposal, double least, NarrowCounts& counts) {
  if (!proposal.penetrating) {
    ++counts.missed;
    return;
  }
  const double along = std::min(c.depth(proposal.normal), c.depth(-proposal.normal));
  const double off = std::max(std::abs(along - proposal.overlap), along - least);
  if (off > flatProposalError * c.size()) ++counts.fallbacks;
}

namespace {

/// The best of the minima next to a net of directions, for bodies so deep in each other that minima are many and flat.
LocalMinimum settleFromEverywhere(Difference& c, const LocalMinimum& known) {
  LocalMinimum best = known;
  for (int k = 0; k < 27; ++k) {
    const int x = k % 3 - 1, y = k / 3 % 3 - 1, z = k / 9 - 1;
    const Vec3 d(x, y, z);
    if (d.squaredNorm() == 0) continue;
    // Axes and diagonals of A; axes of B.
    const bool axis = d.squaredNorm() == 1;
    for (int turned = 0; turned < 1 + axis; ++turned) {
      const Vec3 n = turned ? c.frame().rotate(d) : Vec3(d.normalized());
      const LocalMinimum found = settle(c, n);
      if (found.depth < best.depth) best = found;
    }
  }
  return best;
}

/// A lower bound where the polytope in C itself ran out of corners. A ball that rolls inside either shape is taken off:
/// what is left is small and far from round, and its least depth is C's less the ball's radius.
double boundByCores(Difference& c, const LocalMinimum& found, double tolerance, double reached) {
  const double layerA = rollingRadius(c.shapeA()), layerB = rollingRadius(c.shapeB()), layer = layerA + layerB;
  if (!(layer > 0 && layer < found.depth)) return reached;
  Difference core = c;
  core.erode(layerA, layerB);
  const DepthBounds bounds = boundOverlap(core, found.normal, found.depth - layer, tolerance);
  return std::max(reached, bounds.lower + layer);
}

/// The second tier of the certificate, see tolerances.h: as near as a polytope comes to bodies that are coaxial, or
/// around each other's centre.
bool meetsWhereMinimaAreMany(double depth, double lower, double size) {
  const bool deep = depth > tolerance::deepOverlap * size;
  return depth - lower <= (deep ? tolerance::deepCertificate : tolerance::coaxialCertificate) * depth;
}

/// The lower bound by a finer polytope, and by others that begin elsewhere: of bodies a hundredfold apart in size, one
/// that began across the contact may have facets so long and thin that round-off ends it.
double boundAgain(Difference& c, const LocalMinimum& found, double tolerance, double reached) {
  reached = std::max(reached, boundOverlapFinely(c, found.normal, found.depth, tolerance).lower);
  const Vec3 u = perpendicular(found.normal), v = found.normal.cross(u);
  for (int k = 0; k < 48 && !(found.depth - reached <= tolerance); ++k) {
    const double azimuth = 2.4 * k;  // the golden angle: no two alike
    const Vec3 start =
        (std::cos(azimuth) * u + std::sin(azimuth) * v + 0.25 * (k % 12 - 5) * found.normal).normalized();
    reached = std::max(reached, boundOverlap(c, start, found.depth, tolerance).lower);
  }
  return reached;
}

}  // namespace

SearchResult searchConvex(Difference& c, const Vec3& guess, const PenetrationAnswer* proposal, NarrowCounts& counts) {
  ++counts.searches;
  SearchResult out;
  const double tolerance = tolerance::certificate * c.size();

  // First route: the proposal, if any. Second: the descent from the guess.
  double proposed = infinity;
  const bool proposalStands = proposal && takeProposal(c, *proposal, out.minimum, proposed);
  if (!proposalStands) out.minimum = settle(c, guess);

  // Both bounds. A better direction than the one at hand is polished, and the bounds are drawn again around it.
  bool certified = false;
  bool replaced = false;
  double lower = 0;
  for (int round = 0; round < 4 && !certified && out.minimum.depth > 0; ++round) {
    const DepthBounds bounds = boundOverlap(c, out.minimum.normal, out.minimum.depth, tolerance);
    certified = bounds.met;
    lower = std::max(lower, bounds.lower);
    if (!(bounds.upper < out.minimum.depth)) break;
    const LocalMinimum polished = settle(c, bounds.normal);
    if (!(polished.depth < out.minimum.depth)) break;
    replaced = replaced || polished.depth < out.minimum.depth - tolerance;
    out.minimum = polished;
  }
  if (!certified && out.minimum.depth > 0) {
    const double before = out.minimum.depth;
    out.minimum = settleFromEverywhere(c, out.minimum);
    replaced = replaced || out.minimum.depth < before - tolerance;
    lower = boundByCores(c, out.minimum, tolerance, lower);
    if (!meetsWhereMinimaAreMany(out.minimum.depth, lower, c.size()))
      lower = boundAgain(c, out.minimum, tolerance, lower);
    certified = out.minimum.depth - lower <= tolerance;
  }
  out.apart = !(out.minimum.depth > 0);
  if (out.apart) return out;

  if (!certified) ++(meetsWhereMinimaAreMany(out.minimum.depth, lower, c.size()) ? counts.coarse : counts.uncertified);
  if (proposal && !proposal->penetrating) ++counts.missed;
  if (proposal && proposal->penetrating && (!proposalStands || replaced)) ++counts.fallbacks;
  return out;
}

bool touchConvex(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  Difference c(pair.a, pair.frameA, pair.b, pair.frameB);

  // Warm and apart: does the last direction still separate, or that between the nearest pieces?
  bool met = false;
  if (cache.kind == WarmCache::apart && !pair.searchAlways) {
    double depth = c.depth(cache.direction);
    if (!(depth < 0)) {
      const PieceMinimum nearby = findLastPieces(pair, c, cache);
      if (nearby.holds) {
        depth = nearby.minimum.depth;
        cache.direction = nearby.minimum.normal;
        cache.featureA = encode(nearby.a);
        cache.featureB = encode(nearby.b);
        met = !(depth < 0);
      }
    }
    if (depth < 0) {
      ++counts.warm;
      return reportApart(cache.direction, -depth, cache);
    }
  }

  // Warm and touching: the pieces that touched last.
  const bool warm = cache.touched && !pair.searchAlways;
  PieceMinimum nearby;
  if (warm) nearby = findLastPieces(pair, c, cache);
  // Or those next to the last normal: a body that rocks on a flat end leaves one edge of it for another.
  if (warm && !nearby.holds) nearby = findAlignedPieces(c, cache.direction);
  const bool byPieces = nearby.holds;

  // Or a face or a side next to the last normal.
  if (warm && !byPieces) nearby = findRoundFeature(c, cache.direction);

  // Rounded shapes: a distance between cores, warm or cold.
  bool touches = false;
  if (!nearby.holds && touchByCores(pair, c, cache, counts, touch, touches)) return touches;

  // Warm and touching: any minimum next to the last normal. It stands if nothing away from it can be shallower.
  if (warm) {
    if (!nearby.holds) nearby.minimum = settle(c, cache.direction);
    const LocalMinimum& local = nearby.minimum;
    const bool apart = !(local.depth > 0);
    if (apart || (isStationary(local, c.size()) && isGlobalMinimum(pair, c, local, nearby.margin, cache))) {
      ++counts.warm;
      if (!apart && !byPieces) return reportNamed(pair, c, local, cache, counts, touch);
      if (byPieces) {
        cache.featureA = encode(nearby.a);
        cache.featureB = encode(nearby.b);
      }
      if (apart) return reportApart(local.normal, -local.depth, cache);
      return reportTouch(pair, WarmCache::smooth, local, cache, counts, touch);
    }
  }

  // Cold: a separating direction ends it, unless the nearest pieces have just met.
  if (cache.kind == WarmCache::cold) ++counts.cold;
  const Vec3 guess = guessNormal(c, cache);
  if (!met) {
    const Nearest nearest = findNearest(c, Vec3::Zero(), guess, separationPrecision);
    if (nearest.gap > 0) return reportNamedApart(pair, c, nearest, cache);
  }

  // A contact is born with Bullet's answer; a running one is searched from its own normal.
  PenetrationAnswer proposal;
  if (!cache.touched) proposal = askBullet(c, guess);
  const SearchResult found = searchConvex(c, guess, cache.touched ? nullptr : &proposal, counts);
  if (found.apart) return reportApart(found.minimum.normal, -found.minimum.depth, cache);
  return reportNamed(pair, c, found.minimum, cache, counts, touch);
}

}  // namespace granular
