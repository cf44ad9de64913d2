#include "granular/io/scene_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace granular {
namespace {

using Report = std::function<void(const std::string& path, const std::string& message)>;

std::string listMaterials(const Scene& scene) {
  std::string text;
  for (const MaterialSettings& m : scene.materials) text += (text.empty() ? "" : ", ") + m.name;
  return text;
}

void checkMaterialName(const Scene& scene, const std::string& name, const std::string& path, const Report& report) {
  if (name.empty()) return;
  for (const MaterialSettings& m : scene.materials)
    if (m.name == name) return;
  report(path, fmt::format("no material is called \"{}\"; the scene has: {}", name, listMaterials(scene)));
}

void checkElasticity(const Scene& scene, const Report& report) {
  if (!lawReadsCurvature(lawFromName(scene.model.law))) return;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const MaterialSettings& m = scene.materials[i];
    if (m.elasticity.young == 0)
      report("model.law", fmt::format("\"{}\" needs young_modulus and poisson_ratio of the materials: give them in "
                                      "[[material]]",
                                      scene.model.law));
  }
  // Two rigid solids never meet only if there is one of them at most, and particles are of another.
  for (const ParticleSettings& p : scene.particles) {
    const auto index = static_cast<std::size_t>(scene.materialIndex(p.material));
    if (scene.materials[index].elasticity.young == infinity)
      report(fmt::format("material.{}.young_modulus", index), "is infinite: only walls can be rigid, not particles");
  }
}

void checkMaterials(const Scene& scene, const Report& report) {
  std::set<std::string> names;
  for (std::size_t k = 0; k < scene.materials.size(); ++k)
    if (!names.insert(scene.materials[k].name).second)
      report(fmt::format("material.{}.name", k), "two materials have this name");

  checkMaterialName(scene, scene.vessel.material, "vessel.material", report);
  for (std::size_t k = 0; k < scene.walls.size(); ++k)
    checkMaterialName(scene, scene.walls[k].material, fmt::format("wall.{}.material", k), report);
  for (std::size_t k = 0; k < scene.particles.size(); ++k)
    checkMaterialName(scene, scene.particles[k].material, fmt::format("particles.{}.material", k), report);

  std::set<std::pair<std::string, std::string>> pairs;
  for (std::size_t k = 0; k < scene.contacts.size(); ++k) {
    const std::string path = fmt::format("contact.{}.between", k);
    const std::vector<std::string>& between = scene.contacts[k].between;
    if (between.size() != 2) {
      report(path, "must name two materials (twice the same for contacts within one)");
      continue;
    }
    for (const std::string& name : between) checkMaterialName(scene, name, path, report);
    if (!pairs.insert(std::minmax(between[0], between[1])).second) report(path, "this pair was already given");
  }
}

void checkSize(const SizeSettings& size, bool hasExtent, const std::string& path, const Report& report) {
  using Distribution = SizeSettings::Distribution;
  if (size.distribution == Distribution::uniform && (size.min <= 0 || size.max == infinity))
    report(path, "distribution = \"uniform\" needs both min and max");
  if (size.distribution != Distribution::fixed && size.distribution != Distribution::sieve && size.min > size.max)
    report(path + ".min", fmt::format("min ({:g}) must not exceed max ({:g})", size.min, size.max));
  const bool bell = size.distribution == Distribution::normal || size.distribution == Distribution::lognormal;
  if (bell && (size.mean < size.min || size.mean > size.max))
    report(path + ".mean", fmt::format("the mean ({:g}) must lie between min and max", size.mean));
  if (size.distribution == Distribution::normal && size.min <= 0 && size.mean < 4 * size.deviation)
    report(path + ".min", "a normal distribution this wide needs a smallest size");
  if (size.as == SizeSettings::As::diameter && hasExtent)
    report(path + ".as", "\"diameter\" says how large the particles are, and so does their extent: give one of them");
  if (size.as == SizeSettings::As::diameter && size.distribution == Distribution::fixed && size.value == 1)
    report(path + ".value", "as = \"diameter\" needs the diameter as value");
  if (size.distribution != Distribution::sieve) return;

  // A sieve curve rises from 0 to 1 over ascending openings.
  if (size.sizes.size() != size.passing.size() || size.sizes.size() < 2) {
    report(path + ".passing", fmt::format("sizes ({}) and passing ({}) must have equally many entries, at least two",
                                          size.sizes.size(), size.passing.size()));
    return;
  }
  if (std::adjacent_find(size.sizes.begin(), size.sizes.end(), std::greater_equal<>()) != size.sizes.end())
    report(path + ".sizes", "the openings must ascend");
  if (!std::is_sorted(size.passing.begin(), size.passing.end()) || size.passing.front() != 0 ||
      size.passing.back() != 1)
    report(path + ".passing", "must rise from 0 at the smallest opening to 1 at the largest");
}

/// Radius of the ball about the centre that a particle as given needs, m; 0 where only its mesh could tell.
double closedFormReach(const ParticleSettings& p) {
  using Shape = ParticleSettings::Shape;
  switch (p.shape) {
    case Shape::sphere:
      return p.radius;
    case Shape::ellipsoid:
      return p.semiAxes.maxCoeff();
    case Shape::cylinder:
      return std::hypot(p.radius, p.height / 2);
    // from the centre of mass, a quarter of the height above the base, to the tip or the rim
    case Shape::cone:
      return std::max(0.75 * p.height, std::hypot(p.radius, p.height / 4));
    case Shape::cuboid:
      return p.halfLengths.norm();
    case Shape::sand:
      return p.radius * (p.sandTemplate == ParticleSettings::Template::ellipsoid ? std::max(1.0, p.aspect) : 1);
    case Shape::woodchip:
      return p.length.hi / 2;
    case Shape::mesh:
      return p.extent ? p.extent->hi / 2 : 0;
    case Shape::clump:
      return p.construction == ParticleSettings::Construction::ellipsoid ? std::max(p.halfLength, p.halfWidth) : 0;
    case Shape::polyhedron:
      return 0;
  }
  return 0;
}

void checkClump(const ParticleSettings& p, const std::string& path, const Report& report) {
  const bool chain = p.construction == ParticleSettings::Construction::ellipsoid;
  const auto need = [&](bool given, const char* key) {
    const char* construction = chain ? "ellipsoid" : "spheres";
    if (!given) report(path, fmt::format("construction = \"{}\" needs {}", construction, key));
  };
  const auto refuse = [&](bool given, const char* key) {
    const char* construction = chain ? "ellipsoid" : "spheres";
    if (given) report(path + "." + key, fmt::format("isn't used with construction = \"{}\"", construction));
  };
  const auto either = [&](bool wanted, bool given, const char* key) { wanted ? need(given, key) : refuse(given, key); };
  either(!chain, !p.radii.empty(), "radii");
  either(!chain, !p.centres.empty(), "centres");
  either(chain, p.halfLength > 0, "half_length");
  either(chain, p.halfWidth > 0, "half_width");
  either(chain, p.spheres > 0, "spheres");
  if (!chain && p.radii.size() != p.centres.size())
    report(path + ".centres",
           fmt::format("{} centres for {} radii: each sphere needs both", p.centres.size(), p.radii.size()));
  if (!chain) refuse(p.mass == ParticleSettings::Mass::smooth, "mass");
  if (chain && p.spheres > 0 && (p.spheres % 2 == 0 || p.spheres < 3))
    report(path + ".spheres",
           fmt::format("is {}; the chain on an ellipsoid's axis needs an odd number, at least 3", p.spheres));
  if (chain && p.halfLength > 0 && p.halfLength <= p.halfWidth)
    report(path + ".half_length", fmt::format("is {:g} m, half_width {:g} m: the ellipsoid must be longer than wide",
                                              p.halfLength, p.halfWidth));
}

void checkMesh(const ParticleSettings& p, const std::string& path, const Report& report) {
  if (p.files.empty()) report(path + ".files", "at least one file is needed");
  const bool clump = p.use == ParticleSettings::Use::clump;
  if (clump && p.spheres == 0) report(path, "use = \"clump\" needs spheres");
  if (!clump && p.spheres > 0) report(path + ".spheres", "isn't used without use = \"clump\"");
}

double vesselHalfWidth(const VesselSettings& vessel) {
  if (vessel.kind == VesselSettings::Kind::cylinder) return vessel.radius;
  if (vessel.kind == VesselSettings::Kind::none) return infinity;
  return std::min(vessel.size.x(), vessel.size.y()) / 2;
}

void checkParticles(const Scene& scene, const Report& report) {
  const double room = vesselHalfWidth(scene.vessel);
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    const ParticleSettings& p = scene.particles[k];
    const std::string path = fmt::format("particles.{}", k);
    checkSize(p.size, p.extent.has_value(), path + ".size", report);

    // A diameter given by the size table replaces the shape's own.
    const bool factor = p.size.as == SizeSettings::As::multiplier;
    const double reach =
        closedFormReach(p) * (factor && p.size.distribution == SizeSettings::Distribution::fixed ? p.size.value : 1);
    if (factor && reach > room)
      report(path,
             fmt::format("the particle is larger than the vessel: it reaches {:g} m from its centre, the vessel's half "
                         "width is {:g} m",
                         reach, room));
    if (p.shape == ParticleSettings::Shape::clump) checkClump(p, path, report);
    if (p.shape == ParticleSettings::Shape::polyhedron && p.vertices.size() < 4)
      report(path + ".vertices",
             fmt::format("a polyhedron needs at least 4 vertices, {} are given", p.vertices.size()));
    if (p.shape == ParticleSettings::Shape::mesh) checkMesh(p, path, report);
  }
}

void checkCounts(const Scene& scene, const Report& report) {
  const InsertionSettings::Kind kind = scene.insertion.kind;
  if (kind == InsertionSettings::Kind::poses || kind == InsertionSettings::Kind::bed) {
    for (std::size_t k = 0; k < scene.particles.size(); ++k)
      if (scene.particles[k].count > 0 || scene.particles[k].share > 0)
        report(fmt::format("particles.{}.{}", k, scene.particles[k].count > 0 ? "count" : "share"),
               "isn't used: insertion.file says how many particles there are");
    return;
  }
  // Every group has a count, or all share a total.
  double shares = 0;
  std::int64_t counted = 0;
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    const ParticleSettings& p = scene.particles[k];
    if ((p.count > 0) == (p.share > 0) && !(scene.particles.size() == 1 && scene.insertion.count > 0 && p.count == 0))
      report(fmt::format("particles.{}", k), "needs either count or share (with insertion.count), and not both");
    shares += p.share;
    counted += p.count;
  }
  if (shares > 0 && scene.insertion.count == 0)
    report("insertion.count", "is missing: shares of particles need the total");
  if (shares > 0 && counted == 0 && std::abs(shares - 1) > 1e-6)
    report("particles.0.share", fmt::format("the shares add up to {:g}; they must add up to 1", shares));
  if (scene.insertion.count > 0 && counted > 0 &&
      (shares > 0 ? counted >= scene.insertion.count : counted != scene.insertion.count))
    report("insertion.count",
           fmt::format("is {}, but the groups' counts add up to {}", scene.insertion.count, counted));
}

void checkWalls(const Scene& scene, const Report& report) {
  for (std::size_t k = 0; k < scene.walls.size(); ++k) {
    const WallSettings& w = scene.walls[k];
    const std::string path = fmt::format("wall.{}", k);
    if (w.kind == WallSettings::Kind::plane && w.normal.norm() == 0) report(path + ".normal", "must not be zero");
    const bool onPath = w.velocity.norm() + w.spin.norm() + w.frequency > 0;
    if (onPath && std::isinf(w.stop) && std::isinf(scene.time.maxTime))
      report(path + ".stop", "is never, and so the bed never rests: time.max_time must say when the run ends");
    if (w.stop <= w.start) report(path + ".stop", fmt::format("must be above start, {} s", w.start));
    if (w.frequency > 0 && w.amplitude.norm() == 0) report(path + ".amplitude", "must not be zero with a frequency");
    if (w.amplitude.norm() > 0 && w.frequency == 0) report(path + ".frequency", "must be above 0 with an amplitude");
    if (w.force > 0 && w.direction.norm() == 0) report(path + ".direction", "must not be zero with a force");
    if (w.direction.norm() > 0 && w.force == 0) report(path + ".force", "must be above 0 with a direction");
  }
}

}  // namespace

int Scene::materialIndex(const std::string& material) const {
  for (std::size_t k = 0; k < materials.size(); ++k)
    if (materials[k].name == material) return static_cast<int>(k);
  return 0;
}

void checkScene(const Scene& scene, const Report& report) {
  checkMaterials(scene, report);
  checkElasticity(scene, report);
  checkParticles(scene, report);
  checkCounts(scene, report);
  checkWalls(scene, report);
  const InsertionSettings& insertion = scene.insertion;
  if (insertion.kind == InsertionSettings::Kind::drop && (insertion.from.array() > insertion.to.array()).any())
    report("insertion.to", "must not be below insertion.from in any direction");
  if (scene.skip.size() > 1)
    for (const std::string& name : scene.skip)
      if (name == "all" || name == "none") report("skip", "\"" + name + "\" stands alone");
  if (scene.gravity.norm() == 0) report("gravity", "must not be zero: the bed would never settle");
  const bool restingWrong =
      scene.settle.kind == SettleSettings::Kind::freeze && scene.insertion.kind != InsertionSettings::Kind::batches;
  if (restingWrong) report("settle.kind", "\"freeze\" freezes batches: it needs insertion.kind = \"batches\"");
}

}  // namespace granular
