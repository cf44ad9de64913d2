#include "granular/run/particle_groups.h"

#include <fmt/format.h>

#include <cmath>

#include "granular/core/errors.h"
#include "granular/insert/made_particle.h"
#include "granular/mesh/rock.h"
#include "granular/shape/clump.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/ellipsoid_chain.h"
#include "granular/shape/shape_table.h"

namespace granular {
namespace {

using ShapePointer = std::shared_ptr<const Shape>;
using Maker = std::function<ShapePointer(double size, Random& random)>;
using Extent = std::function<double(double size)>;

SizeOptions sizeOptionsOf(const SizeSettings& size) {
  SizeOptions options;
  switch (size.distribution) {
    case SizeSettings::Distribution::fixed:
      options.kind = SizeKind::fixed;
      break;
    case SizeSettings::Distribution::uniform:
      options.kind = SizeKind::uniform;
      break;
    case SizeSettings::Distribution::normal:
      options.kind = SizeKind::normal;
      break;
    case SizeSettings::Distribution::lognormal:
      options.kind = SizeKind::logNormal;
      break;
    case SizeSettings::Distribution::sieve:
      options.kind = SizeKind::sieve;
      break;
  }
  options.weight = size.by == SizeSettings::By::mass ? SizeWeight::mass : SizeWeight::number;
  options.value = size.value;
  options.mean = size.mean;
  options.deviation = size.deviation;
  options.min = size.min;
  options.max = size.max;
  options.sizes = size.sizes;
  options.passing = size.passing;
  return options;
}

ShapePointer makeClump(const ParticleSettings& group) {
  if (group.construction == ParticleSettings::Construction::ellipsoid) {
    const double a = group.halfLength, b = group.halfWidth;
    const std::vector<ChildSphere> chain = makeEllipsoidChain(a, b, static_cast<int>(group.spheres));
    if (group.mass == ParticleSettings::Mass::sum) return std::make_shared<Clump>(chain);
    return std::make_shared<Clump>(chain, Ellipsoid(Vec3(a, b, b)).massProperties());
  }
  std::vector<ChildSphere> spheres;
  for (std::size_t k = 0; k < group.radii.size(); ++k) spheres.push_back({group.centres[k], group.radii[k]});
  return std::make_shared<Clump>(spheres);
}

/// The group's shape at size 1, for the kinds that have one.
ShapePointer makeTemplate(const ParticleSettings& group) {
  using Kind = ParticleSettings::Shape;
  const auto row = [](std::string_view name, std::initializer_list<double> parameters) {
    return makeShape(name, std::span<const double>(parameters.begin(), parameters.size()));
  };
  switch (group.shape) {
    case Kind::sphere:
      return row("sphere", {group.radius});
    case Kind::ellipsoid:
      return row("ellipsoid", {group.semiAxes.x(), group.semiAxes.y(), group.semiAxes.z()});
    case Kind::cylinder:
      return row("cylinder", {group.radius, group.height});
    case Kind::cone:
      return row("cone", {group.radius, group.height});
    case Kind::cuboid:
      return row("cuboid", {group.halfLengths.x(), group.halfLengths.y(), group.halfLengths.z()});
    case Kind::polyhedron:
      return std::make_shared<Polyhedron>(group.vertices);
    case Kind::clump:
      return makeClump(group);
    default:
      return nullptr;
  }
}

/// The factor that brings a shape to the drawn size: a multiplier, or the diameter of the sphere of equal volume.
double factorOf(const SizeSettings& settings, double size, const Shape& shape) {
  return settings.as == SizeSettings::As::diameter ? size / (2 * shape.size()) : size;
}

/// Shapes of one template: equal sizes share one shape.
void useTemplate(const ParticleSettings& group, ShapePointer base, PourGroup& out) {
  const SizeSettings settings = group.size;
  if (settings.distribution == SizeSettings::Distribution::fixed) {
    const double factor = factorOf(settings, settings.value, *base);
    if (factor != 1) base = scaledShape(*base, factor);
    out.make = [base](double, Random&) { return base; };
    out.longestExtent = [base](double) { return base->longestExtent(); };
    return;
  }
  out.make = [base, settings](double size, Random&) { return scaledShape(*base, factorOf(settings, size, *base)); };
  out.longestExtent = [base, settings](double size) { return base->longestExtent() * factorOf(settings, size, *base); };
}

/// Shapes for the particles of a group: each its own, or one of `variants` drawn beforehand from their own stream.
template <class Make>
std::function<ShapePointer(Random&)> drawFrom(const ParticleSettings& group, std::uint64_t seed, Make make) {
  if (group.variants == 0) return make;
  std::vector<ShapePointer> variants;
  Random random(seed);
  for (std::int64_t k = 0; k < group.variants; ++k) variants.push_back(make(random));
  return [variants](Random& choice) { return variants[choice.below(variants.size())]; };
}

/// Brings every shape that is drawn to the drawn size.
Maker makeSized(const SizeSettings& settings, std::function<ShapePointer(Random&)> draw) {
  return [settings, draw = std::move(draw)](double size, Random& random) {
    ShapePointer shape = draw(random);
    const double factor = factorOf(settings, size, *shape);
    return factor == 1 ? shape : scaledShape(*shape, factor);
  };
}

/// Spheres in place of a closed mesh, together of its volume.
ShapePointer makeRockClump(const std::string& file, const RockOptions& options, int spheres) {
  SphereFitOptions fit;
  fit.count = spheres;
  return std::make_shared<Clump>(fitSpheres(loadRock(file, options), fit).spheres);
}

/// Rocks: every particle one of the files, chosen at random, its longest extent drawn uniformly.
void useMeshes(const ParticleSettings& group, std::uint64_t seed, PourGroup& out) {
  std::vector<ShapePointer> rocks;
  for (const auto& file : group.files) {
    RockOptions options;
    options.scale = group.unit;
    options.vertexBudget = static_cast<int>(group.maxVertices);
    options.use = group.use == ParticleSettings::Use::exact ? RockUse::exact : RockUse::hull;
    // Read at the middle of the extents: the importer then works at the size that is used.
    if (group.extent) options.longestExtent = 0.5 * (group.extent->lo + group.extent->hi);
    rocks.push_back(group.use == ParticleSettings::Use::clump
                        ? makeRockClump(file.string(), options, static_cast<int>(group.spheres))
                        : makeRock(file.string(), options));
  }
  const SizeSettings settings = group.size;
  const std::optional<Interval> extent = group.extent;
  const auto draw = [rocks, extent](Random& random) -> ShapePointer {
    const ShapePointer& rock = rocks[random.below(rocks.size())];
    const double factor = extent ? random.uniform(extent->lo, extent->hi) / rock->longestExtent() : 1;
    return factor == 1 ? rock : scaledShape(*rock, factor);
  };
  out.make = makeSized(settings, drawFrom(group, seed, draw));
  out.longestExtent = [rocks, settings, extent](double size) {
    double longest = 0;
    for (const ShapePointer& rock : rocks) {
      const double length = extent ? extent->hi : rock->longestExtent();
      longest = std::max(longest, length * factorOf(settings, size, *rock));
    }
    return longest;
  };
}

/// Made-up particles.
template <class Make>
void useMade(const ParticleSettings& group, double longest, std::uint64_t seed, Make make, PourGroup& out) {
  const SizeSettings settings = group.size;
  require(settings.as == SizeSettings::As::multiplier,
          "size.as = \"diameter\" is not available for made-up particles: give their size as a multiplier");
  out.longestExtent = [longest](double size) { return longest * size; };
  out.make = makeSized(settings, drawFrom(group, seed, make));
}

SandOptions sandOptionsOf(const ParticleSettings& group) {
  SandOptions options;
  options.radius = group.radius;
  options.aspect = group.sandTemplate == ParticleSettings::Template::ellipsoid ? group.aspect : 1;
  options.minPoints = static_cast<int>(group.vertexCount.lo);
  options.maxPoints = static_cast<int>(group.vertexCount.hi);
  options.spread = group.spread;
  return options;
}

WoodchipOptions woodchipOptionsOf(const ParticleSettings& group) {
  WoodchipOptions options;
  options.minLength = group.length.lo;
  options.maxLength = group.length.hi;
  options.minThin = group.thinRadius.lo;
  options.maxThin = group.thinRadius.hi;
  options.minThick = group.thickRadius.lo;
  options.maxThick = group.thickRadius.hi;
  return options;
}

/// Counts of all groups: their own, or by share of the whole; what rounding leaves over goes to the largest share.
std::vector<std::int64_t> countsOf(const Scene& scene) {
  const InsertionSettings::Kind kind = scene.insertion.kind;
  if (kind == InsertionSettings::Kind::poses || kind == InsertionSettings::Kind::bed) {
    return std::vector<std::int64_t>(scene.particles.size(), 0);  // a file says how many there are
  }
  std::vector<std::int64_t> counts;
  double shares = 0;
  std::int64_t given = 0;
  for (const ParticleSettings& group : scene.particles) {
    shares += group.count > 0 ? 0 : group.share;
    given += group.count;
  }
  const std::int64_t toShare = std::max<std::int64_t>(0, scene.insertion.count - given);
  if (shares == 0 && given == 0) return {scene.insertion.count};  // one group, the total given for all
  std::int64_t left = toShare;
  std::size_t largest = 0;
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    const ParticleSettings& group = scene.particles[k];
    std::int64_t count = group.count;
    if (count == 0 && shares > 0) {
      count = static_cast<std::int64_t>(std::floor(static_cast<double>(toShare) * group.share / shares));
      left -= count;
      if (group.share > scene.particles[largest].share || scene.particles[largest].count > 0) largest = k;
    }
    counts.push_back(count);
  }
  if (shares > 0) counts[largest] += left;
  return counts;
}

}  // namespace

std::vector<PourGroup> makePourGroups(const Scene& scene) {
  // Dropped particles say themselves where they fall.
  const bool pours =
      scene.insertion.kind == InsertionSettings::Kind::batches || scene.insertion.kind == InsertionSettings::Kind::rain;
  require(!pours || scene.vessel.kind != VesselSettings::Kind::none,
          scene.file.string() +
              ": vessel.kind = \"none\" leaves no place to pour into: give a vessel, drop the particles from a place, "
              "or give poses");
  const std::vector<std::int64_t> counts = countsOf(scene);
  std::vector<PourGroup> groups;
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    const ParticleSettings& settings = scene.particles[k];
    PourGroup group;
    group.name = settings.name;
    group.count = counts[k];
    group.size = SizeDistribution(sizeOptionsOf(settings.size));
    const std::uint64_t seed = scene.seed * 1000003 + k;
    try {
      switch (settings.shape) {
        case ParticleSettings::Shape::mesh:
          useMeshes(settings, seed, group);
          break;
        case ParticleSettings::Shape::sand: {
          const SandOptions options = sandOptionsOf(settings);
          useMade(
              settings, longestSand(options), seed,
              [options](Random& random) -> ShapePointer { return makeSand(options, random); }, group);
          break;
        }
        case ParticleSettings::Shape::woodchip: {
          const WoodchipOptions options = woodchipOptionsOf(settings);
          useMade(
              settings, longestWoodchip(options), seed,
              [options](Random& random) -> ShapePointer { return makeWoodchip(options, random); }, group);
          break;
        }
        default:
          useTemplate(settings, makeTemplate(settings), group);
          break;
      }
    } catch (const InputError& error) {
      throw InputError(
          fmt::format("{}:{}: particles '{}': {}", scene.file.string(), settings.line, settings.name, error.what()));
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace granular
