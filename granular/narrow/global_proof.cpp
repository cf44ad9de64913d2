#include "granular/narrow/global_proof.h"

#include <algorithm>

#include "granular/core/tolerances.h"
#include "granular/narrow/epa.h"
#include "granular/narrow/kept_proof.h"
#include "granular/narrow/polyhedron_features.h"
#include "granular/shape/ellipsoid.h"

namespace granular {
namespace {

/// A kept proof leaves out the cone of 8 degrees around its normal: it serves normals within driftCosine of it.
GrantedCone keptCone(const Vec3& axis) { return {axis, 0.99026806874157036, 0.13917310096006544}; }
GrantedCone grantedCone(const Vec3& axis) { return {axis, 0.98480775301220806, 0.17364817766693036}; }

/// A second ring of directions, 35 degrees from the normal, for the first may not reach beyond the equator.
constexpr double wideCosine = 0.81915204428899180, wideSine = 0.57357643635104610;

/// A point of C that supports a direction at some azimuth around the normal: its foot on the tangent plane, its height
/// above the origin there.
struct RingPoint {
  Vec2 azimuth;
  Vec2 foot;
  double height;
};

/// A ring of support points around a local minimum as a floor of the depth. Along n = cos t normal + sin t azimuth a
/// point has n . w = height cos t + foot . azimuth sin t: concave in t and in the azimuth while positive, so that over
/// a sector shared out between the two points at its sides it is least at the corners. From the ring's own angle to the
/// outer one (at most the equator) the floor holds; reach is the least foot . azimuth.
class Ring {
 public:
  Ring(Difference& difference, const LocalMinimum& minimum, double ringCosine, double ringSine, double outerCos,
       double outerSin)
      : c(difference),
        m(minimum),
        u(perpendicular(m.normal)),
        v(m.normal.cross(u)),
        cosine(ringCosine),
        sine(ringSine),
        outerCosine(outerCos),
        outerSine(outerSin) {
    constexpr double half = 0.70710678118654752;
    constexpr std::array<std::array<double, 2>, 8> azimuths{
        {{1, 0}, {half, half}, {0, 1}, {-half, half}, {-1, 0}, {-half, -half}, {0, -1}, {half, -half}}};
    const RingPoint first = look({1, 0});
    RingPoint from = first;
    for (std::size_t k = 1; k <= 8 && floor >= m.depth; ++k) {
      const RingPoint to = k < 8 ? look({azimuths[k][0], azimuths[k][1]}) : first;
      cover(from, to, 0);
      from = to;
    }
  }

  double floor = infinity, reach = infinity;

 private:
  RingPoint look(const Vec2& azimuth) {
    const Vec3 w = c.support(cosine * m.normal + sine * (azimuth.x() * u + azimuth.y() * v)).w;
    return {azimuth, {w.dot(u), w.dot(v)}, w.dot(m.normal)};
  }
  double along(const RingPoint& p, const Vec2& azimuth) const { return cosine * p.height + sine * p.foot.dot(azimuth); }

  /// The least of one point over a part of a sector that begins and ends at the azimuths given.
  void share(const RingPoint& p, const Vec2& begin, const Vec2& end, double& least, double& nearest) const {
    const double inner = std::min(p.foot.dot(begin), p.foot.dot(end));
    nearest = std::min(nearest, inner);
    least = std::min({least, cosine * p.height + sine * inner, outerCosine * p.height + outerSine * inner});
    if (!(inner > 0)) least = -infinity;
  }

  /// Floor over the sector between two points; split where most is to be gained.
  void cover(const RingPoint& from, const RingPoint& to, int level) {
    const double lead = std::max(0.0, along(from, from.azimuth) - along(to, from.azimuth));
    const double trail = std::max(0.0, along(to, to.azimuth) - along(from, to.azimuth));
    const double part = lead + trail > 0 ? lead / (lead + trail) : 0.5;
    const Vec2 border = ((1 - part) * from.azimuth + part * to.azimuth).normalized();
    double least = infinity, nearest = infinity;
    share(from, from.azimuth, border, least, nearest);
    share(to, border, to.azimuth, least, nearest);

    constexpr int deepest = 4;
    const double best = std::min(along(from, from.azimuth), along(to, to.azimuth));
    if (least < 0.5 * (m.depth + best) && best > m.depth && level < deepest) {
      const RingPoint between = look(border);
      cover(from, between, level + 1);
      if (floor >= m.depth) cover(between, to, level + 1);
      return;
    }
    floor = std::min(floor, least);
    reach = std::min(reach, nearest);
  }

  Difference& c;
  const LocalMinimum& m;
  Vec3 u, v;
  double cosine, sine, outerCosine, outerSine;
};

/// A floor of the depth outside the cone by one ring on it, or by a second one further out; beyond the equator, the
/// disk that the reach leaves and the ball of isGlobal hold it. Minus infinity where there is none above the depth.
double findFloorByRings(Difference& c, const LocalMinimum& m, const GrantedCone& cone) {
  const double inner = c.shapeA().innerRadius() + c.shapeB().innerRadius();
  const auto holdBeyond = [&](double floor, double reach) {
    for (const double tried : {floor, m.depth + 0.25 * (floor - m.depth), m.depth}) {
      if (isGlobal(m.normal, tried, reach, c.frame().x, inner)) return tried;
    }
    return -infinity;
  };
  const Ring near(c, m, cone.cosine, cone.sine, wideCosine, wideSine);
  if (!(near.floor >= m.depth)) return -infinity;
  const double floor = holdBeyond(std::min(near.floor, near.reach), near.reach);
  if (floor >= m.depth) return floor;

  const Ring wide(c, m, wideCosine, wideSine, 0, 1);
  if (!(wide.floor >= m.depth)) return -infinity;
  return holdBeyond(std::min(near.floor, wide.floor), wide.reach);
}

bool keptProofHolds(const KeptProof& proof, const Difference& c, const LocalMinimum& m) {
  if (!(proof.floor > m.depth)) return false;
  const Mat3& R = c.frame().R;
  const RelativePlace<double> now{toTriple(R.col(0)), toTriple(R.col(1)), toTriple(R.col(2)), toTriple(c.frame().x)};
  return keptProofHolds(loadProof(proof), now, toTriple(m.normal), m.depth, c.shapeB().boundingRadius(), c.extent());
}

void keepProof(const Difference& c, const LocalMinimum& m, double floor, KeptProof& proof) {
  Eigen::Map<Eigen::Matrix3f>(proof.turn.data()) = c.frame().R.cast<float>();
  Eigen::Map<Eigen::Vector3f>(proof.place.data()) = c.frame().x.cast<float>();
  Eigen::Map<Eigen::Vector3f>(proof.axis.data()) = m.normal.cast<float>();
  proof.floor = static_cast<float>(floor);
}

}  // namespace

double rollingRadius(const Shape& shape) {
  if (shape.kind() == ShapeKind::sphere) return shape.boundingRadius();
  if (shape.kind() != ShapeKind::ellipsoid) return 0;
  const Vec3& axes = static_cast<const Ellipsoid&>(shape).semiAxes();
  return axes.minCoeff() * axes.minCoeff() / axes.maxCoeff();
}

bool isGlobalMinimum(const PairView& pair, Difference& c, const LocalMinimum& m, double margin, WarmCache& cache) {
  // A ball that rolls inside either shape is tangent to C below any minimum, and holds the origin while its radius is
  // at least the overlap.
  if (m.depth <= rollingRadius(pair.a) + rollingRadius(pair.b)) return true;
  const double inner = pair.a.innerRadius() + pair.b.innerRadius();
  if (isGlobal(m.normal, m.depth, margin, c.frame().x, inner)) return true;

  if (keptProofHolds(cache.proof, c, m)) return true;
  const double floor = findFloorByRings(c, m, keptCone(m.normal));
  if (floor >= m.depth) {
    keepProof(c, m, floor, cache.proof);
    return true;
  }

  // The inscribed polytope, good for minima near the rim of a small facet or far from the line of centres.
  const GrantedCone cone = grantedCone(m.normal);
  const DepthBounds bounds = boundOverlap(c, m.normal, m.depth, 0, &cone);
  return bounds.met && bounds.upper >= m.depth - tolerance::certificate * c.size();
}

}  // namespace granular
