#include "granular/insert/inserter.h"

#include <fmt/format.h>

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {
namespace {

/// What a stream of random numbers is for.
enum class Use : std::uint64_t { order, size, shape, pose, batch };

/// splitmix64's finaliser: every bit of the input reaches every bit of the output.
std::uint64_t scramble(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

/// A stream of its own for each seed, use and pair of numbers.
Random makeStream(std::uint64_t seed, Use use, std::int64_t number = 0, std::int64_t round = 0) {
  std::uint64_t z = scramble(seed + 0x9e3779b97f4a7c15ull);
  for (const std::uint64_t word :
       {static_cast<std::uint64_t>(use), static_cast<std::uint64_t>(number), static_cast<std::uint64_t>(round)})
    z = scramble(z ^ scramble(word + 0x9e3779b97f4a7c15ull));
  return Random(z);
}

/// A centre of mass may lie three quarters of the longest extent from the furthest point (a cone's: of its height).
constexpr double lopsided = 0.75;

}  // namespace

Inserter::Inserter(const PourOptions& pour, std::vector<PourGroup> groupList, const Region& where,
                   std::vector<const Wall*> around, std::uint64_t seedOfRun)
    : options(pour), groups(std::move(groupList)), region(where), walls(std::move(around)), seed(seedOfRun) {
  checkOptions();

  // Every particle of every group, shuffled (Fisher and Yates).
  for (std::size_t g = 0; g < groups.size(); ++g)
    order.insert(order.end(), static_cast<std::size_t>(groups[g].count), static_cast<std::int32_t>(g));
  total = static_cast<std::int64_t>(order.size());
  Random random = makeStream(seed, Use::order);
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
  checkExtents();
}

void Inserter::checkOptions() const {
  require(options.minBatch >= 1 && options.maxBatch >= options.minBatch,
          fmt::format("insertion: batches of {} to {} particles; at least 1, ascending", options.minBatch,
                      options.maxBatch));
  require(options.kind == PourOptions::Kind::batches || (options.rate > 0 && std::isfinite(options.rate)),
          fmt::format("insertion: rate {} 1/s is not positive", options.rate));
  require((options.from.array() <= options.to.array()).all() && options.from.allFinite() && options.to.allFinite(),
          "insertion: the corners of the box to drop from must be finite and in order");
  require(options.speed >= 0 && std::isfinite(options.speed),
          fmt::format("insertion: speed {} m/s is negative", options.speed));
  require(options.reach > 0 && options.attempts >= 1 && options.retry >= 0,
          fmt::format("insertion: reach {}, attempts {}, retry {} s are out of range", options.reach, options.attempts,
                      options.retry));
  for (const PourGroup& group : groups) {
    require(group.count >= 0, fmt::format("particles {}: count {} is negative", group.name, group.count));
    require(group.make && group.longestExtent, fmt::format("particles {}: nothing makes their shape", group.name));
  }
}

void Inserter::checkExtents() {
  const double width = region.width();
  for (std::int64_t number = 0; number < total; ++number) {
    const PourGroup& group = groups[static_cast<std::size_t>(groupOf(number))];
    const double size = sizeOf(number);
    const double extent = group.longestExtent(size);
    require(extent > 0 && extent <= width,
            fmt::format("particle {} ({}, size {}) is larger than the vessel: its longest extent is {} m, the vessel's "
                        "narrowest width {} m{}",
                        number, group.name, size, extent, width,
                        region.kind == Region::Kind::periodic ? " (half of a repeating one)" : ""));
    largestRadius = std::max(largestRadius, lopsided * extent);
  }
}

double Inserter::sizeOf(std::int64_t number) const {
  Random random = makeStream(seed, Use::size, number);
  return groups[static_cast<std::size_t>(groupOf(number))].size.draw(random);
}

std::shared_ptr<const Shape> Inserter::makeShape(std::int64_t number) const {
  Random random = makeStream(seed, Use::shape, number);
  return groups[static_cast<std::size_t>(groupOf(number))].make(sizeOf(number), random);
}

std::int64_t Inserter::countDue(double time) const {
  if (options.kind == PourOptions::Kind::batches) return progress.batchLeft;
  const auto byNow = static_cast<std::int64_t>(std::min(double(total), std::floor(options.rate * time) + 1));
  return std::max<std::int64_t>(0, byNow - progress.placed);
}

bool Inserter::isDue(double time, bool consolidated) const {
  if (isDone() || time < progress.nextTime) return false;
  return countDue(time) > 0 || (options.kind == PourOptions::Kind::batches && consolidated);
}

void Inserter::beginBatch() {
  Random random = makeStream(seed, Use::batch, progress.batches);
  const auto choices = static_cast<std::uint64_t>(options.maxBatch - options.minBatch + 1);
  const std::int64_t wanted = options.minBatch + static_cast<std::int64_t>(random.below(choices));
  progress.batchLeft = std::min(wanted, total - progress.placed);
  ++progress.batches;
}

bool Inserter::place(const Columns& columns, double bedTop, NewParticle& particle) {
  const Shape& shape = *particle.shape;
  Random random = makeStream(seed, Use::pose, particle.number, progress.calls);
  const double plane = bedTop + options.height.value_or(0);
  const double lowest = options.height ? plane : region.floor;
  const double ceiling = std::min(plane + options.reach * shape.longestExtent(), region.ceiling);
  for (int attempt = 0; attempt < options.attempts; ++attempt) {
    ++progress.attempts;
    // A new orientation with each column: long particles fit near a wall only when they lie along it.
    const Quat q = options.upright ? rotationFromVector({0, 0, random.uniform(0, 2 * pi)}) : random.rotation();
    const Vec2 xy = region.drawPoint(random);
    Frame frame(Pose{{xy.x(), xy.y(), lowest}, q});
    if (!columns.letDown(shape, lowest, frame) || shape.bounds(frame).hi.z() > ceiling) continue;
    particle.pose = {frame.x, q};
    particle.velocity = {0, 0, -options.speed};
    return true;
  }
  return false;
}

bool Inserter::dropOne(const Columns& columns, NewParticle& particle) {
  Random random = makeStream(seed, Use::pose, particle.number, progress.calls);
  for (int attempt = 0; attempt < options.attempts; ++attempt) {
    ++progress.attempts;
    Quat q = Quat::Identity();
    if (options.turn == PourOptions::Turn::any) {
      q = random.rotation();
    } else if (options.turn != PourOptions::Turn::none) {
      Vec3 about = Vec3::Zero();
      about[static_cast<int>(options.turn) - static_cast<int>(PourOptions::Turn::x)] = random.uniform(-pi, pi);
      q = rotationFromVector(about);
    }
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = random.uniform(options.from[k], options.to[k]);
    if (!columns.isFree(*particle.shape, Frame(Pose{x, q}))) continue;
    particle.pose = {x, q};
    particle.velocity = {0, 0, -options.speed};
    return true;
  }
  return false;
}

std::vector<NewParticle> Inserter::insert(double time, bool consolidated, std::span<const PlacedShape> present) {
  std::vector<NewParticle> fresh;
  if (!isDue(time, consolidated)) return fresh;
  if (options.kind == PourOptions::Kind::batches && progress.batchLeft == 0) beginBatch();
  ++progress.calls;

  // Those that are there, and room for the largest to come.
  double radius = largestRadius;
  for (const PlacedShape& other : present) radius = std::max(radius, other.shape->boundingRadius());
  Columns columns(region, walls, radius);
  for (const PlacedShape& other : present) columns.add(*other.shape, other.frame);
  const double bedTop = columns.top();

  // One after the other; the first that finds no place is left, with those behind it, to a later call.
  for (std::int64_t due = countDue(time); due > 0; --due) {
    NewParticle particle;
    particle.number = progress.placed;
    particle.group = groupOf(particle.number);
    particle.shape = makeShape(particle.number);
    const bool drops = options.kind == PourOptions::Kind::drop;
    if (!(drops ? dropOne(columns, particle) : place(columns, bedTop, particle))) {
      ++progress.postponed;
      progress.nextTime = time + options.retry;
      // A bed at rest that leaves no place leaves none for ever: below a ceiling, or where particles drop from.
      if (consolidated && fresh.empty() && (drops || region.ceiling < infinity)) ++progress.refusals;
      break;
    }
    progress.refusals = 0;
    columns.add(*particle.shape, Frame(particle.pose));
    ++progress.placed;
    if (options.kind == PourOptions::Kind::batches) --progress.batchLeft;
    fresh.push_back(std::move(particle));
  }
  return fresh;
}

}  // namespace granular
