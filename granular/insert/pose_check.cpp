#include "granular/insert/pose_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "granular/core/errors.h"

namespace granular {
namespace {

constexpr std::size_t overlapsNamed = 10;

/// One box of the broad phase: a particle, or the image of one.
struct Proxy {
  std::size_t particle;
  Vec3 shift;
};

/// Every particle's home box, and its images wherever they may meet another's home box.
std::vector<Proxy> placeProxies(std::span<const PlacedShape> particles, const Periods& periods,
                                BroadPhase& broadPhase) {
  std::vector<Proxy> proxies;
  const auto place = [&](std::size_t k, const Vec3& shift) {
    Aabb box = particles[k].shape->bounds(particles[k].frame);
    box.lo += shift;
    box.hi += shift;
    broadPhase.place(proxies.size(), box);
    proxies.push_back({k, shift});
  };

  // Into the first period.
  std::vector<Vec3> home(particles.size(), Vec3::Zero());
  double largest = 0;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Vec3& x = particles[k].frame.x;
    for (int d = 0; d < 3; ++d)
      if (periods.length[d] > 0)
        home[k][d] = -periods.length[d] * std::floor((x[d] - periods.origin[d]) / periods.length[d]);
    place(k, home[k]);
    largest = std::max(largest, particles[k].shape->boundingRadius());
  }
  if (!periods.any()) return proxies;

  // Images on the far side of each repeating boundary, as far as the largest pair can reach over it.
  std::vector<Vec3> shifts;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        const Vec3 shift = periods.length.cwiseProduct(Vec3(i, j, k));
        const bool repeats = (i == 0 || periods.length.x() > 0) && (j == 0 || periods.length.y() > 0) &&
                             (k == 0 || periods.length.z() > 0);
        if (repeats && !shift.isZero()) shifts.push_back(shift);
      }
  const Vec3 from = periods.origin.array() - 2 * largest;
  const Vec3 to = (periods.origin + periods.length).array() + 2 * largest;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    for (const Vec3& shift : shifts) {
      const Vec3 x = particles[k].frame.x + home[k] + shift;
      const auto inside = (x.array() > from.array() && x.array() < to.array()) || periods.length.array() == 0;
      if (inside.all()) place(k, home[k] + shift);
    }
  }
  return proxies;
}

}  // namespace

std::vector<PoseOverlap> findOverlaps(std::span<const PlacedShape> particles, std::span<const std::int64_t> ids,
                                      const Periods& periods, double allowed) {
  std::vector<PoseOverlap> deep;
  if (particles.empty()) return deep;
  const auto broadPhase = makeBoxTree();
  const std::vector<Proxy> proxies = placeProxies(particles, periods, *broadPhase);
  std::vector<std::array<std::int32_t, 2>> candidates;
  broadPhase->collect(candidates);

  // Two images meet as their originals do: the deepest meeting of each pair of particles is kept.
  std::map<std::pair<std::int64_t, std::int64_t>, PoseOverlap> found;
  for (const auto& [first, second] : candidates) {
    const Proxy& p = proxies[static_cast<std::size_t>(first)];
    const Proxy& q = proxies[static_cast<std::size_t>(second)];
    if (p.particle == q.particle) continue;
    const PlacedShape& a = particles[p.particle];
    const PlacedShape& b = particles[q.particle];
    double overlap = 0;
    const Frame frameA(a.frame.R, a.frame.x + p.shift), frameB(b.frame.R, b.frame.x + q.shift);
    if (!overlaps(*a.shape, frameA, *b.shape, frameB, &overlap)) continue;
    const double fraction = overlap / std::min(a.shape->size(), b.shape->size());
    if (fraction <= allowed) continue;
    const auto [least, most] = std::minmax(ids[p.particle], ids[q.particle]);
    PoseOverlap& entry = found[{least, most}];
    if (overlap > entry.overlap) entry = {least, most, overlap, fraction};
  }

  for (const auto& [key, entry] : found) deep.push_back(entry);
  std::stable_sort(deep.begin(), deep.end(),
                   [](const PoseOverlap& a, const PoseOverlap& b) { return a.fraction > b.fraction; });
  return deep;
}

void checkPoses(std::span<const PlacedShape> particles, std::span<const std::int64_t> ids, const Periods& periods,
                std::span<const Wall* const> walls, double allowed) {
  // Walls first: a particle outside is the plainer mistake.
  std::vector<WallTouch> touches;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const PlacedShape& particle = particles[k];
    for (const Wall* wall : walls) {
      require(wall->admits(particle.frame.x),
              fmt::format("particle {} ({}) at ({}, {}, {}) m lies behind the wall {} ({})", ids[k],
                          particle.shape->describe(), particle.frame.x.x(), particle.frame.x.y(), particle.frame.x.z(),
                          wall->name, wall->describe()));
      touches.clear();
      touchWall(*wall, {PointRule::witness, 0}, *particle.shape, particle.frame, touches);
      for (const WallTouch& touch : touches)
        require(touch.overlap <= allowed * particle.shape->size(),
                fmt::format("particle {} ({}) overlaps the wall {} by {:.3g} m, {:.3g} of its size; allowed is {:.3g}",
                            ids[k], particle.shape->describe(), wall->name, touch.overlap,
                            touch.overlap / particle.shape->size(), allowed));
    }
  }

  const std::vector<PoseOverlap> deep = findOverlaps(particles, ids, periods, allowed);
  if (deep.empty()) return;
  std::string message = fmt::format("{} {} overlapping by more than {:.3g} of the smaller size:", deep.size(),
                                    deep.size() == 1 ? "pair of particles is" : "pairs of particles are", allowed);
  for (std::size_t k = 0; k < std::min(overlapsNamed, deep.size()); ++k)
    message += fmt::format("{} {} and {} by {:.3g} m ({:.3g})", k == 0 ? "" : ",", deep[k].a, deep[k].b,
                           deep[k].overlap, deep[k].fraction);
  if (deep.size() > overlapsNamed) message += ", ...";
  throw InputError(message);
}

void checkBelow(double ceiling, std::span<const PlacedShape> particles, std::span<const std::int64_t> ids,
                double allowed) {
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Shape& shape = *particles[k].shape;
    const double top = shape.bounds(particles[k].frame).hi.z();
    require(top <= ceiling + allowed * shape.size(),
            fmt::format("particle {} ({}) reaches up to {:.4g} m, above the vessel's rim at {:.4g} m", ids[k],
                        shape.describe(), top, ceiling));
  }
}

}  // namespace granular
