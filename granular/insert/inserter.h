// Pours particles: which particle comes next, when, and where.
//
// Particle number k is the same whatever happened before: its group, size, shape and orientation are drawn from
// (seed, k) alone. What the pouring remembers is therefore a handful of counters, saved in checkpoints.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "granular/insert/placement.h"
#include "granular/insert/size_distribution.h"

namespace granular {

/// One kind of particle to pour.
struct PourGroup {
  std::string name;
  std::int64_t count = 0;  ///< particles of it in all
  SizeDistribution size{SizeOptions{}};
  /// The particle's shape; size as drawn. Called once per particle; must depend on its arguments alone.
  std::function<std::shared_ptr<const Shape>(double size, Random& random)> make;
  /// Longest extent make() can return for this size, m.
  std::function<double(double size)> longestExtent;
};

struct PourOptions {
  enum class Kind : unsigned char { batches, rain, drop };
  enum class Turn : unsigned char { any, x, y, z, none };
  Kind kind = Kind::batches;
  std::int64_t minBatch = 20, maxBatch = 60;  ///< batches: particles in each, uniform between both (S section 7)
  double rate = 0;                            ///< rain and drop: particles per second
  // drop: one after the other, centres uniform in a box, wherever the bed is.
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< its corners, m
  Turn turn = Turn::any;  ///< orientation: uniform, or by a uniform angle about a world axis, or as the shape is
  /// Lowest plane above the bed's top where particles are put, m. Not given: the lowest free place of the column, which
  /// may lie in a hollow of the bed.
  std::optional<double> height;
  double speed = 0;      ///< downwards, m/s
  bool upright = false;  ///< body z axis along world z, random about it; else uniform orientations
  /// Particles reach no higher than this many of their longest extents above the bed's top (or the plane given).
  double reach = 3;
  int attempts = 50;    ///< columns tried for one particle before it is left to a later call
  double retry = 5e-3;  ///< and time until that call, s
};

/// Plain data: with the options, all there is to save.
struct PourState {
  std::int64_t placed = 0;     ///< particles inserted so far = number of the next
  std::int64_t batches = 0;    ///< batches begun
  std::int64_t batchLeft = 0;  ///< particles of the present batch not yet placed
  std::int64_t calls = 0;      ///< calls of insert() that tried to place something
  std::int64_t attempts = 0;   ///< columns tried
  std::int64_t postponed = 0;  ///< times a particle found no place and was left to a later call
  double nextTime = 0;         ///< no placement before, s
  std::int64_t refusals = 0;   ///< calls in a row that found no place below the ceiling although the bed was at rest
};

struct NewParticle {
  std::int64_t number = 0;  ///< 0, 1, 2, ... in the order of insertion
  std::int32_t group = 0;
  std::shared_ptr<const Shape> shape;
  Pose pose;
  Vec3 velocity = Vec3::Zero();  ///< m/s, world
};

class Inserter {
 public:
  /// Throws InputError if a particle is larger than the region is wide, naming particle, extent and width; if counts,
  /// rate or batch are out of range. walls are looked at during insert() and must outlive this.
  Inserter(const PourOptions& options, std::vector<PourGroup> groups, const Region& region,
           std::vector<const Wall*> walls, std::uint64_t seed);

  /// True if insert() would try to place something now. Cheap.
  bool isDue(double time, bool consolidated) const;

  /// Places what is due beside the particles that are there and returns it, in order of number. time: simulated, s;
  /// consolidated: what was placed before has come to rest. Where the region has a ceiling and the next particle finds
  /// no place below it on a bed at rest, several calls in a row, the region is full and the pouring done; so it is
  /// where the bed has grown into the place particles drop from.
  std::vector<NewParticle> insert(double time, bool consolidated, std::span<const PlacedShape> present);

  /// True once every particle is in, or the region is full.
  bool isDone() const { return progress.placed == total || isFull(); }
  bool isFull() const { return progress.refusals >= refusalsToEnd; }
  std::int64_t count() const { return total; }

  const PourState& state() const { return progress; }
  void setState(const PourState& saved) { progress = saved; }

  /// Group of particle `number`, and its shape: the same whenever it is asked for, so that a restart makes it again.
  std::int32_t groupOf(std::int64_t number) const { return order[static_cast<std::size_t>(number)]; }
  double sizeOf(std::int64_t number) const;
  std::shared_ptr<const Shape> makeShape(std::int64_t number) const;

 private:
  /// With 50 columns each: a place that a random column finds once in a hundred times is missed in 8 % of cases.
  static constexpr std::int64_t refusalsToEnd = 5;

  void checkOptions() const;
  void checkExtents();
  void beginBatch();
  std::int64_t countDue(double time) const;
  bool place(const Columns& columns, double bedTop, NewParticle& particle);
  bool dropOne(const Columns& columns, NewParticle& particle);

  PourOptions options;
  std::vector<PourGroup> groups;
  Region region;
  std::vector<const Wall*> walls;
  std::uint64_t seed;
  std::int64_t total = 0;
  std::vector<std::int32_t> order;  ///< group of each particle: every group's count, shuffled
  double largestRadius = 0;  ///< half the longest extent of any particle to come, m, with room for a lopsided one
  PourState progress;
};

}  // namespace granular
