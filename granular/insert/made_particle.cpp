#include "granular/insert/made_particle.h"

#include <fmt/format.h>

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {
namespace {

// A hull thinner than this, relative to its size, is a flake: one in the plane of its points but for their round-off
// has 1e-15, S's thinnest shapes (aspect .25) have .4.
constexpr double thinnest = 0.05;
// Points closer than this, relative to the size, are one point with an edge too short to be touched by anything.
constexpr double closest = 0.01;
// Draws in a row before the options are held to be at fault: of sand fewer than one in a thousand fail, of woodchips
// one in fifteen.
constexpr int drawsAtMost = 1000;

/// Steps of the slide over the template. The fastest point moves by stepOverSpacing spacings, the others in proportion
/// to the force on them; the step is halved when it raises the energy. At rest below smallestStep.
constexpr double stepOverSpacing = 0.05;
constexpr double smallestStep = 1e-4;
constexpr int stepsAtMost = 2000;

/// The template x^2/a^2 + y^2/a^2 + z^2/c^2 = 1.
struct Spheroid {
  double a, c;

  Vec3 axes() const { return {a, a, c}; }
  /// Moves a point near the surface onto it, along the line through the centre.
  Vec3 project(const Vec3& p) const { return p / p.cwiseQuotient(axes()).norm(); }
  Vec3 normalAt(const Vec3& p) const { return p.cwiseQuotient(axes().cwiseProduct(axes())).normalized(); }
  /// Uniform over the area: a uniform direction stretched by the axes, kept in proportion to how much the area
  /// stretches.
  Vec3 drawPoint(Random& random) const {
    for (;;) {
      const Vec3 d = random.direction();
      if (random.uniform() * (1 / std::min(a, c)) < d.cwiseQuotient(axes()).norm()) return d.cwiseProduct(axes());
    }
  }
  double area() const {
    if (c == a) return 4 * pi * a * a;
    // Prolate spheroid; e its eccentricity.
    const double e = std::sqrt(1 - a * a / (c * c));
    return 2 * pi * a * a * (1 + c / (a * e) * std::asin(e));
  }
};

/// Unit charges on the surface: their Coulomb energy, and the force on each along the surface. Each pair is looked at
/// once. Distances of one row come first, in a loop the compiler can vectorise; they are half of the time it takes to
/// make a grain.
class Charges {
 public:
  explicit Charges(std::size_t count) : forces(count), x(count), y(count), z(count), distance(count), cube(count) {}

  void place(const Spheroid& body, const std::vector<Vec3>& points) {
    energy = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      x[i] = points[i].x();
      y[i] = points[i].y();
      z[i] = points[i].z();
      forces[i].setZero();
    }
    for (std::size_t i = 1; i < points.size(); ++i) {
      measureRow(i);
      for (std::size_t j = 0; j < i; ++j) {
        energy += 1 / distance[j];
        const Vec3 push = (points[i] - points[j]) / cube[j];
        forces[i] += push;
        forces[j] -= push;
      }
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 n = body.normalAt(points[i]);
      forces[i] -= n * n.dot(forces[i]);
    }
  }

  double energy = 0;
  std::vector<Vec3> forces;

 private:
  void measureRow(std::size_t i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double dx = x[i] - x[j], dy = y[i] - y[j], dz = z[i] - z[j];
      const double squared = dx * dx + dy * dy + dz * dz;
      distance[j] = std::sqrt(squared);
      cube[j] = squared * distance[j];
    }
  }

  std::vector<double> x, y, z, distance, cube;  // of the points; to the point of the row
};

/// Slides the points towards rest and returns every configuration on the way with the path length to it, in spacings.
struct Stage {
  std::vector<Vec3> points;
  double path;
};
std::vector<Stage> slideToRest(const Spheroid& body, std::vector<Vec3> points) {
  // Spacing of as many points spread evenly (hexagonally) over the area.
  const double spacing = std::sqrt(2 * body.area() / (std::sqrt(3.0) * double(points.size())));
  std::vector<Stage> stages{{points, 0}};
  double step = stepOverSpacing;
  Charges now(points.size()), after(points.size());
  now.place(body, points);
  std::vector<Vec3> moved(points.size());
  for (int k = 0; k < stepsAtMost && step > smallestStep; ++k) {
    double largest = 0;
    for (const Vec3& f : now.forces) largest = std::max(largest, f.norm());
    if (largest == 0) break;
    for (std::size_t i = 0; i < points.size(); ++i)
      moved[i] = body.project(points[i] + now.forces[i] * (step * spacing / largest));
    after.place(body, moved);
    if (after.energy >= now.energy) {
      step /= 2;
      continue;
    }
    std::swap(now, after);
    points = moved;
    stages.push_back({points, stages.back().path + step});
  }
  return stages;
}

/// Too flat, or with two corners that are nearly one?
bool isDegenerate(const Polyhedron& hull) {
  const PolyhedronTables& tables = hull.tables();
  const double size = hull.size();
  for (std::size_t i = 0; i < tables.vertices.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((tables.vertices[i] - tables.vertices[j]).norm() < closest * size) return true;
  for (std::size_t f = 0; f < tables.faces.size(); ++f) {
    const Vec3& n = tables.faces[f].normal;
    if (tables.faces[f].offset - hull.support(-n).dot(n) < thinnest * size) return true;
  }
  return false;
}

/// Draws points until their hull is a sound particle.
template <typename Draw>
std::unique_ptr<Polyhedron> drawSound(Draw draw, const char* what, std::uint64_t* redrawn) {
  for (int k = 0; k < drawsAtMost; ++k) {
    const std::vector<Vec3> points = draw();
    try {
      auto hull = std::make_unique<Polyhedron>(points);
      if (!isDegenerate(*hull)) return hull;
    } catch (const InputError&) {
      // In a plane: drawn again like any other flake.
    }
    if (redrawn) ++*redrawn;
  }
  throw InputError(fmt::format("{}: {} draws in a row were flat or had points that coincide", what, drawsAtMost));
}

void checkOptions(const SandOptions& o) {
  require(o.radius > 0 && std::isfinite(o.radius), fmt::format("sand: radius {} m is not positive", o.radius));
  require(o.aspect >= 1 && std::isfinite(o.aspect), fmt::format("sand: aspect {} is below 1", o.aspect));
  require(o.minPoints >= 4 && o.maxPoints >= o.minPoints,
          fmt::format("sand: {} to {} points; at least 4, in ascending order", o.minPoints, o.maxPoints));
  require(o.spread >= 0 && o.spread <= 1, fmt::format("sand: spread {} is not within 0 to 1", o.spread));
}

void checkRange(const char* what, double lo, double hi) {
  require(lo > 0 && hi >= lo && std::isfinite(hi),
          fmt::format("woodchip: {} {} to {} m; positive and ascending", what, lo, hi));
}

void checkOptions(const WoodchipOptions& o) {
  checkRange("length", o.minLength, o.maxLength);
  checkRange("thin radius", o.minThin, o.maxThin);
  checkRange("thick radius", o.minThick, o.maxThick);
}

}  // namespace

std::vector<Vec3> spreadPoints(const SandOptions& options, int count, Random& random) {
  const Spheroid body{options.radius, options.radius * options.aspect};
  std::vector<Vec3> points(static_cast<std::size_t>(count));
  for (Vec3& p : points) p = body.drawPoint(random);
  if (options.spread == 0) return points;

  // The last stage within the wanted part of the path.
  const std::vector<Stage> stages = slideToRest(body, std::move(points));
  const double wanted = options.spread * stages.back().path;
  std::size_t k = 0;
  while (k + 1 < stages.size() && stages[k + 1].path <= wanted) ++k;
  return stages[k].points;
}

std::unique_ptr<Polyhedron> makeSand(const SandOptions& options, Random& random, std::uint64_t* redrawn) {
  checkOptions(options);
  const auto choices = static_cast<std::uint64_t>(options.maxPoints - options.minPoints) + 1;
  const auto draw = [&] {
    return spreadPoints(options, options.minPoints + static_cast<int>(random.below(choices)), random);
  };
  return drawSound(draw, "sand", redrawn);
}

std::unique_ptr<Polyhedron> makeWoodchip(const WoodchipOptions& options, Random& random, std::uint64_t* redrawn) {
  checkOptions(options);
  const auto draw = [&] {
    const double half = random.uniform(options.minLength, options.maxLength) / 2;
    const double thin = random.uniform(options.minThin, options.maxThin);
    const double thick = random.uniform(options.minThick, options.maxThick);
    std::vector<Vec3> points;
    for (const auto& [radius, z] : {std::pair{thin, half}, std::pair{thick, -half}}) {
      for (int k = 0; k < 4; ++k) {
        const double azimuth = random.uniform(0, 2 * pi);
        points.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
      }
    }
    return points;
  };
  return drawSound(draw, "woodchip", redrawn);
}

double longestSand(const SandOptions& options) {
  checkOptions(options);
  return 2 * options.radius * options.aspect;
}

double longestWoodchip(const WoodchipOptions& options) {
  checkOptions(options);
  // From a point of one circle to the opposite one of the other, or across the wider circle.
  return std::max(std::hypot(options.maxLength, options.maxThin + options.maxThick),
                  2 * std::max(options.maxThin, options.maxThick));
}

}  // namespace granular
