#include "granular/io/scene_keys.h"

#include <fmt/format.h>

#include "granular/integrate/integrator.h"
#include "granular/point/contact_point.h"

namespace granular {
namespace {

using D = Dimension;

constexpr Range anything{-infinity, infinity, true, true};
constexpr Range positive{0, infinity, true, true};
constexpr Range positiveOrInfinite{0, infinity, true, false};
constexpr Range notNegative{0, infinity, false, true};
constexpr Range fraction{0, 1};
constexpr Range sharpnesses{1, 1000};
constexpr Range assumedContacts{1, 1000};
constexpr Range positiveFraction{0, 1, true, false};
constexpr Range poissonRatios{-1, 0.5, true, false};
constexpr Range atLeastOne{1, infinity, false, true};

constexpr std::string_view vesselKinds[] = {"cylinder", "box", "periodic", "none"};
constexpr std::string_view directions[] = {"x", "y", "z"};
constexpr std::string_view wallKinds[] = {"plane", "cylinder", "mesh"};
constexpr std::string_view frictionLimits[] = {"total", "push"};
constexpr std::string_view contactMasses[] = {"reduced", "local"};
constexpr std::string_view springLaws = "linear|linear_local|tensor";
constexpr std::string_view elasticLaws = "hertz|hertz_mindlin";
constexpr std::string_view shapes[] = {"sphere",     "ellipsoid", "cylinder", "cone",     "cuboid",
                                       "polyhedron", "mesh",      "sand",     "woodchip", "clump"};
constexpr std::string_view constructions[] = {"spheres", "ellipsoid"};
constexpr std::string_view masses[] = {"union", "smooth"};
constexpr std::string_view templates[] = {"sphere", "ellipsoid"};
constexpr std::string_view uses[] = {"hull", "exact", "clump"};
constexpr std::string_view distributions[] = {"fixed", "uniform", "normal", "lognormal", "sieve"};
constexpr std::string_view bys[] = {"number", "mass"};
constexpr std::string_view sizeMeanings[] = {"multiplier", "diameter"};
constexpr std::string_view insertions[] = {"batches", "rain", "drop", "poses", "bed"};
constexpr std::string_view turns[] = {"any", "x", "y", "z", "none"};
constexpr std::string_view orientations[] = {"random", "upright"};
constexpr std::string_view settleKinds[] = {"none", "freeze", "sleep"};
constexpr std::string_view actions[] = {"stop", "continue", "smaller_step", "remove"};

/// A choice kept as text, because another room owns its table.
void readTextChoice(KeyVisitor& v, const Key& key, std::string& value, std::span<const std::string_view> names) {
  std::size_t index = 0;
  while (index < names.size() && names[index] != value) ++index;
  v.readChoice(key, index, names);
  value = names[index];
}

/// The law whose keys a law has: its own, if it is of the library.
std::string_view keysOfLaw(std::string_view law) {
  const LawKind kind = lawFromName(law);
  if (kind <= LawKind::hertzMindlin) return law;
  return lawReadsCurvature(kind) ? "hertz_mindlin" : "linear";
}

void visitVessel(KeyVisitor& v, VesselSettings& s) {
  v.readKind({"kind", "what holds the bed; axis along z, floor at z = 0", "", true}, s.kind, vesselKinds);
  v.readNumber({"radius", "inner radius", "cylinder", true}, s.radius, D::length, positive);
  v.readVector({"size",
                "inner lengths; x and y centred on the origin, z up from the floor: pouring ends where a particle "
                "would reach above",
                "box|periodic", true},
               s.size, D::length, positive);
  v.readNames({"periodic", "directions that repeat; the others have walls", "periodic"}, s.periodic, directions);
  v.readOptional(
      {"height",
       "of the rim above the floor: pouring ends where a particle would reach above; auto: as high as the bed needs",
       "cylinder"},
      s.height, D::length, positive);
  v.readText({"material", "of floor and sides; default: the first material", "cylinder|box|periodic"}, s.material);
}

void visitWallMotion(KeyVisitor& v, WallSettings& s) {
  v.readVector({"velocity", "of a steady motion"}, s.velocity, D::velocity, anything);
  v.readVector({"amplitude", "of a vibration, amplitude sin(phase + 2 pi frequency t)"}, s.amplitude, D::length,
               anything);
  v.readNumber({"frequency", "of the vibration"}, s.frequency, D::frequency, notNegative);
  v.readNumber({"phase", "of the vibration when the motion starts"}, s.phase, D::angle, anything);
  v.readVector({"spin", "angular velocity"}, s.spin, D::angularVelocity, anything);
  v.readVector({"axis_point", "a point of the axis of the spin, which goes along with velocity and vibration"},
               s.axisPoint, D::length, anything);
  v.readNumber({"start", "when velocity, vibration and spin begin"}, s.start, D::time, notNegative);
  v.readNumber({"stop", "when they end"}, s.stop, D::time, positiveOrInfinite);
  v.readNumber({"force", "that a servo holds against the particles; 0: no servo"}, s.force, D::force, notNegative);
  v.readVector({"direction", "in which the servo presses, of any length"}, s.direction, D::none, anything);
  v.readNumber({"max_speed", "of the servo"}, s.maxSpeed, D::velocity, positive);
  v.readNumber({"response", "time in which a force that is off decays"}, s.response, D::time, positive);
}

void visitWall(KeyVisitor& v, WallSettings& s) {
  v.readKind({"kind", "shape of the wall", "", true}, s.kind, wallKinds);
  v.readText({"name", "for messages and output; default: its kind"}, s.name);
  if (s.name.empty()) s.name = wallKinds[static_cast<std::size_t>(s.kind)];
  v.readVector({"point", "plane: a point of it; cylinder: a point of its vertical axis; mesh: where its origin goes"},
               s.point, D::length, anything);
  v.readVector({"normal", "towards the granular side, of any length", "plane", true}, s.normal, D::none, anything);
  v.readNumber({"radius", "particles are inside", "cylinder", true}, s.radius, D::length, positive);
  v.readFile({"file", "triangle mesh; particles are where its normals point", "mesh", true}, s.file);
  v.readUnit({"unit", "length of one unit of the file", "mesh", true}, s.unit);
  v.readNumber({"scale", "further factor on the mesh", "mesh"}, s.scale, D::none, positive);
  v.readText({"material", "default: the first material"}, s.material);
  visitWallMotion(v, s);
}

void visitContactParameters(KeyVisitor& v, std::string_view law, ContactParameters& p) {
  v.setKind(keysOfLaw(law));
  v.readNumber({"stiffness", "k_n, normal spring", springLaws}, p.stiffness, D::stiffness, positive);
  v.readNumber({"restitution", "e_n, of a head-on impact", "linear|linear_local|tensor|hertz_mindlin"}, p.restitution,
               D::none, positiveFraction);
  v.readNumber({"restitution_tangential", "e_t", springLaws}, p.restitutionT, D::none, positiveFraction);
  v.readNumber({"friction", "Coulomb's coefficient"}, p.friction, D::none, notNegative);
  v.readNumber({"damping_normal", "eta_n: dashpot over the reduced mass", "hertz"}, p.dampingRateN, D::frequency,
               notNegative);
  v.readNumber({"damping_tangential", "eta_t: the same across", "hertz"}, p.dampingRateT, D::frequency, notNegative);
}

void visitModel(KeyVisitor& v, ModelSettings& s) {
  readTextChoice(
      v,
      {"law",
       "contact law: springs and dashpots of S; the same from the contact's own masses; a stiffness matrix; Hertz's "
       "force with the damping of M; Hertz and Mindlin with a restitution"},
      s.law, lawNames());
  v.readBoolean({"tension", "keep the attractive end of a damped contact, so that e = e_n; false: cut at 0"},
                s.tension);
  v.readEnum({"friction_limit", "Coulomb's limit from the total normal force, or from its push alone"}, s.frictionLimit,
             frictionLimits);
  v.readEnum({"contact_mass", "mass behind the dashpot: reduced mass, or what the contact point feels"}, s.contactMass,
             contactMasses);
  readTextChoice(v, {"point_rule", "where the contact force acts"}, s.pointRule, pointRuleNames());
  v.readNumber({"slab", "face_centroid: thickness of the feature slab as a fraction of the overlap"}, s.slab, D::none,
               fraction);
  v.readInteger(
      {"sharpness",
       "stiff_patch: half the rocking stiffness of a face over that of an elastic foundation; 1: soft, towards "
       "infinity: all force at the deepest point"},
      s.sharpness, sharpnesses);
  readTextChoice(v, {"integrator", "time integration of the rotation"}, s.integrator, schemeNames());
}

void visitTime(KeyVisitor& v, std::string_view law, TimeSettings& s) {
  v.setKind(keysOfLaw(law));
  v.readOptional({"step", "time step; auto: fraction of the stability bound"}, s.step, D::time, positive);
  v.readNumber({"fraction", "of the stability bound, for step = auto"}, s.fraction, D::none, positiveFraction);
  v.readInteger({"contacts", "that a body is assumed to have at once, for the bound"}, s.contacts, assumedContacts);
  v.readNumber({"overlap", "largest expected, as a fraction of the size, for the bound", elasticLaws}, s.overlap,
               D::none, positiveFraction);
  v.readNumber({"max_time", "simulated time after which the run ends in any case"}, s.maxTime, D::time,
               positiveOrInfinite);
}

void visitSize(KeyVisitor& v, SizeSettings& s) {
  v.readKind({"distribution", "of the sizes"}, s.distribution, distributions);
  v.readEnum({"by", "the distribution counts particles, or weighs them"}, s.by, bys);
  v.readEnum({"as", "sizes are factors on the group's shape, or diameters of the sphere of equal volume"}, s.as,
             sizeMeanings);
  const D d = s.as == SizeSettings::As::diameter ? D::length : D::none;
  v.readNumber({"value", "the one size", "fixed"}, s.value, d, positive);
  v.readNumber({"mean", "of the sizes", "normal|lognormal", true}, s.mean, d, positive);
  v.readNumber({"deviation", "standard deviation of the sizes", "normal|lognormal", true}, s.deviation, d, notNegative);
  v.readNumber({"min", "smallest size; uniform: needed", "uniform|normal|lognormal"}, s.min, d, positive);
  v.readNumber({"max", "largest size; uniform: needed", "uniform|normal|lognormal"}, s.max, d, positive);
  v.readNumbers({"sizes", "sieve openings, ascending", "sieve", true}, s.sizes, d, positive);
  v.readNumbers({"passing", "fraction finer than each opening, from 0 to 1", "sieve", true}, s.passing, D::none,
                fraction);
}

void visitMadeUpKeys(KeyVisitor& v, ParticleSettings& s) {
  v.readFiles(
      {"files", "meshes (OBJ, STL, PLY, OFF, glTF); each particle is one of them, drawn at random", "mesh", true},
      s.files);
  v.readUnit({"unit", "length of one unit of the files", "mesh", true}, s.unit);
  Interval extent = s.extent.value_or(Interval{});
  v.readInterval(
      {"extent",
       "longest extent after scaling, one or [smallest, largest]; default: unscaled; not with size.as = \"diameter\"",
       "mesh"},
      extent, D::length, positive);
  if (extent.hi > 0) s.extent = extent;
  v.readInteger({"max_vertices", "vertex budget of the hull", "mesh"}, s.maxVertices, {4, 10000});
  v.readEnum(
      {"use",
       "hull: a solid hull of max_vertices; exact: all of the hull for contacts, volume and inertia of the mesh; "
       "clump: spheres fitted to the mesh, together of its volume; both need a closed mesh",
       "mesh"},
      s.use, uses);
  v.readEnum({"template", "surface the points are spread on", "sand"}, s.sandTemplate, templates);
  v.readNumber({"aspect", "of the ellipsoid template: length over width", "sand"}, s.aspect, D::none, positive);
  v.readInterval({"vertex_count", "number of points, drawn uniformly", "sand"}, s.vertexCount, D::none, {4, 1000});
  v.readNumber({"spread", "how far the points' repulsion is followed: 0 not at all, 1 to rest", "sand"}, s.spread,
               D::none, fraction);
  v.readInterval({"length", "distance of the two ends", "woodchip"}, s.length, D::length, positive);
  v.readInterval({"thin_radius", "circle of the four points at the thin end", "woodchip"}, s.thinRadius, D::length,
                 positive);
  v.readInterval({"thick_radius", "circle of the four points at the thick end", "woodchip"}, s.thickRadius, D::length,
                 positive);
  v.readInteger({"variants", "different shapes drawn for the group; 0: every particle its own", "mesh|sand|woodchip"},
                s.variants, notNegative);
}

void visitClumpKeys(KeyVisitor& v, ParticleSettings& s) {
  v.readEnum({"construction",
              "spheres: as given by radii and centres; ellipsoid: a chain of spheres on the axis of an ellipsoid of "
              "revolution",
              "clump"},
             s.construction, constructions);
  v.readNumbers({"radii", "construction = \"spheres\": of the spheres, which may overlap", "clump"}, s.radii, D::length,
                positive);
  v.readPoints({"centres", "construction = \"spheres\": x, y, z of each, about any origin", "clump"}, s.centres,
               D::length);
  v.readNumber({"half_length", "construction = \"ellipsoid\": semi-axis along the chain", "clump"}, s.halfLength,
               D::length, positive);
  v.readNumber({"half_width", "construction = \"ellipsoid\": semi-axis across", "clump"}, s.halfWidth, D::length,
               positive);
  v.readInteger(
      {"spheres", "how many: construction = \"ellipsoid\", an odd number; use = \"clump\", any", "clump|mesh"},
      s.spheres, {1, 100001});
  v.readEnum({"mass",
              "union: volume and inertia of the spheres together, overlaps counted once; smooth: of the ellipsoid they "
              "stand for",
              "clump"},
             s.mass, masses);
}

void visitParticles(KeyVisitor& v, ParticleSettings& s) {
  s.line = v.line();
  v.readKind({"shape", "of the group", "", true}, s.shape, shapes);
  v.readText({"name", "for messages and output; default: its shape"}, s.name);
  if (s.name.empty()) s.name = shapes[static_cast<std::size_t>(s.shape)];
  v.readInteger({"count", "particles of this group; either this or share"}, s.count, atLeastOne);
  v.readNumber({"share", "part of insertion.count, by number"}, s.share, D::none, positiveFraction);
  v.readText({"material", "default: the first material"}, s.material);
  v.readNames({"lock_translation", "world axes along which the particles do not move"}, s.lockTranslation, directions);
  v.readNames({"lock_rotation", "world axes about which the particles do not turn"}, s.lockRotation, directions);
  v.readNumber({"radius", "cone: of the base; sand: of the template, short half-width if an ellipsoid",
                "sphere|cylinder|cone|sand", true},
               s.radius, D::length, positive);
  v.readNumber({"height", "whole height", "cylinder|cone", true}, s.height, D::length, positive);
  v.readVector({"semi_axes", "half-widths along x, y, z", "ellipsoid", true}, s.semiAxes, D::length, positive);
  v.readVector({"half_lengths", "half-lengths along x, y, z", "cuboid", true}, s.halfLengths, D::length, positive);
  v.readPoints({"vertices", "points whose convex hull is the particle", "polyhedron", true}, s.vertices, D::length);
  visitClumpKeys(v, s);
  visitMadeUpKeys(v, s);
  v.readTable({"size", "distribution of sizes; default: all alike"}, [&] { visitSize(v, s.size); });
}

void visitInsertion(KeyVisitor& v, InsertionSettings& s) {
  v.readKind({"kind",
              "batches at random above the bed; rain at a rate; dropped one by one from one place; a file of poses; an "
              "earlier "
              "bed"},
             s.kind, insertions);
  v.readInteger({"count", "particles in all, shared among the groups by their share", "batches|rain|drop"}, s.count,
                atLeastOne);
  v.readInterval({"batch", "particles per batch, one number or [fewest, most]", "batches"}, s.batch, D::none,
                 atLeastOne);
  v.readNumber({"rate", "particles per second", "rain|drop", true}, s.rate, D::rate, positive);
  v.readVector(
      {"from", "lowest corner of the box in which the centres fall uniformly, wherever the bed is", "drop", true},
      s.from, D::length, anything);
  v.readVector({"to", "its highest corner", "drop", true}, s.to, D::length, anything);
  v.readEnum({"turn", "orientation: any, or turned about a world axis by any angle, or as the shape is", "drop"},
             s.turn, turns);
  v.readOptional(
      {"height", "lowest place of insertion above the bed's top; auto: the lowest free one, in hollows of the bed too",
       "batches|rain"},
      s.height, D::length, notNegative);
  v.readNumber({"speed", "downwards at insertion", "batches|rain|drop"}, s.speed, D::velocity, notNegative);
  v.readEnum({"orientation", "at insertion", "batches|rain"}, s.orientation, orientations);
  v.readNumber(
      {"energy", "a batch is consolidated when the kinetic energy per particle is below this times m g d", "batches"},
      s.energy, D::none, positive);
  v.readNumber({"time", "... for so long, and longer than the beginning of a fall is as slow", "batches"}, s.time,
               D::time, notNegative);
  v.readNumber({"max_time", "longest wait for a batch; then it is counted and the next one follows", "batches"},
               s.maxTime, D::time, positive);
  v.readFile({"file", "poses: lines x y z qw qx qy qz [group]; bed: output folder or checkpoint of an earlier run",
              "poses|bed", true},
             s.file);
  v.readNumber({"max_overlap", "deepest overlap accepted at the start, fraction of the size", "poses|bed"},
               s.maxOverlap, D::none, fraction);
}

void visitSettle(KeyVisitor& v, SettleSettings& s) {
  v.readKind({"kind", "none; freeze each batch once consolidated (S); sleep one by one, waking when disturbed"}, s.kind,
             settleKinds);
  v.readNumber({"energy", "slow is an energy of the mean motion below this times m g d", "sleep"}, s.energy, D::none,
               positive);
  v.readNumber(
      {"balance", "and a net force below this times the load, which is m g plus half the sum of the contact forces",
       "sleep"},
      s.balance, D::none, positive);
  v.readOptional({"time", "for so long; the motion is averaged over as long; auto: 50 shortest contact times", "sleep"},
                 s.time, D::time, notNegative);
  v.readNumber({"wake", "woken when the net force differs from that at sleep by this times the load at sleep", "sleep"},
               s.wake, D::none, positive);
  v.readOptional(
      {"average", "in the mean of so long; auto: 25 shortest contact times, in which an impact's waves pass", "sleep"},
      s.average, D::time, notNegative);
}

void visitRest(KeyVisitor& v, RestSettings& s) {
  v.readNumber({"energy", "at rest is a kinetic energy per particle below this times m g d"}, s.energy, D::none,
               positive);
  v.readNumber({"time", "for so long"}, s.time, D::time, notNegative);
  v.readNumber({"max_time", "longest wait for rest after the last particle"}, s.maxTime, D::time, notNegative);
}

void visitOutput(KeyVisitor& v, OutputSettings& s) {
  v.readOptional({"frames", "simulated time between frames; auto: the last frame only"}, s.frames, D::time, positive);
  v.readNumber({"checkpoint_every", "wall time between checkpoints"}, s.checkpointEvery, D::time, positiveOrInfinite);
  v.readNumber({"checkpoint_interval", "simulated time between checkpoints"}, s.checkpointInterval, D::time,
               positiveOrInfinite);
  v.readBoolean({"stl", "the final bed as binary STL"}, s.stl);
  v.readBoolean({"glb", "the final bed as binary glTF"}, s.glb);
  v.readNumber({"gap", "stl and glb: each particle is scaled about its centre by 1 - gap"}, s.gap, D::none, {0, 0.5});
  v.readBoolean({"picture", "a rendered picture of the bed"}, s.picture);
  v.readBoolean({"plots", "plots of the profiles"}, s.plots);
  v.readBoolean({"particles", "a table of all particles"}, s.particles);
  v.readBoolean({"contacts", "a table of all contacts, and the force network with every frame"}, s.contacts);
  v.readBoolean({"energy", "keep the energy ledger: where the energy went, now and in a table over time"}, s.energy);
  v.readInteger({"resolution", "segments around a circle of a curved surface"}, s.resolution, {6, 360});
}

void visitAnalysis(KeyVisitor& v, AnalysisSettings& s) {
  v.readOptional({"unit_length", "of dimensionless distances; auto: mean diameter of the sphere of equal volume"},
                 s.unitLength, D::length, positive);
  v.readNumber({"near_wall", "thickness of the near-wall region, in mean longest extents"}, s.nearWall, D::none,
               positive);
  v.readNumber({"core", "left out at floor, top and wall, in mean longest extents"}, s.core, D::none, notNegative);
  v.readNumber({"ring_step", "porosity profiles: distance of the sampled circles, in unit lengths"}, s.ringStep,
               D::none, positive);
  v.readNumber({"arc_step", "and of the points on a circle"}, s.arcStep, D::none, positive);
  v.readNumber({"order_bin", "annular bins of the order parameters, in unit lengths"}, s.orderBin, D::none, positive);
  v.readNumber({"alpha_step", "of S2 and S4 over alpha"}, s.alphaStep, D::angle, {0, pi / 2, true, false});
  v.readNumber({"pair_reach", "of the pair distribution, in unit lengths"}, s.pairReach, D::none, positive);
  v.readNumber({"pair_bin", "its bins, in unit lengths"}, s.pairBin, D::none, positive);
  v.readNumber({"force_bin", "bins of the force distribution, in mean forces"}, s.forceBin, D::none, positive);
  v.readOptional({"voxel", "edge of the porosity field's voxels; auto: no field"}, s.voxel, D::length, positive);
}

void visitLimits(KeyVisitor& v, LimitSettings& s) {
  v.readEnum({"on_trouble",
              "when a limit is passed: end with the last good state; count and go on; back to the last good "
              "state, and on from there with half the time step, or without the particle named"},
             s.onTrouble, actions);
  v.readNumber({"max_overlap", "fraction of the size"}, s.maxOverlap, D::none, positive);
  v.readNumber({"max_speed", "of any particle"}, s.maxSpeed, D::velocity, positive);
  v.readNumber({"max_travel", "of any surface in one step, fraction of the smallest size"}, s.maxTravel, D::none,
               positive);
  v.readNumber(
      {"max_gain", "energy from nothing within some contact times, fraction of the kinetic energy and m g d of all"},
      s.maxGain, D::none, positiveOrInfinite);
  v.readNumber({"wall_time", "then a checkpoint is written and the run stops"}, s.wallTime, D::time,
               positiveOrInfinite);
}

void visitGeneral(KeyVisitor& v, Scene& s) {
  v.readText({"name", "of the run; default: the file's name"}, s.name);
  auto seed = static_cast<std::int64_t>(s.seed);
  v.readInteger({"seed", "of all random numbers"}, seed, notNegative);
  s.seed = static_cast<std::uint64_t>(seed);
  std::int64_t threads = s.threads;
  v.readInteger({"threads", "0: all cores"}, threads, {0, 1024});
  s.threads = static_cast<int>(threads);
  v.readVector({"gravity", "acceleration"}, s.gravity, D::acceleration, anything);
  std::vector<std::string_view> skips = {"all", "none"};
  skips.insert(skips.end(), std::begin(skipNames), std::end(skipNames));
  v.readNames({"skip", "what a run may leave out; only sleep, where settle.kind asks for it, changes the result"},
              s.skip, skips);
}

void visitMaterials(KeyVisitor& v, Scene& s) {
  v.readTables(
      {"material", "materials; default: one, called default"}, [&](std::size_t n) { s.materials.resize(n); },
      [&](std::size_t k) {
        MaterialSettings& m = s.materials[k];
        v.setKind(keysOfLaw(s.model.law));
        v.readText({"name", "to be used by particles, walls and contacts", "", true}, m.name);
        v.readNumber({"density", "of the solid"}, m.density, D::density, positive);
        v.readNumber({"young_modulus", "inf: rigid, for walls", elasticLaws, true}, m.elasticity.young, D::pressure,
                     positiveOrInfinite);
        v.readNumber({"poisson_ratio", "of an incompressible solid: 0.5", elasticLaws, true}, m.elasticity.poisson,
                     D::none, poissonRatios);
      });
  v.readTable({"contact_default", "parameters of all contacts not named below"},
              [&] { visitContactParameters(v, s.model.law, s.contactDefault); });
  v.readTables(
      {"contact", "parameters between two materials; keys left out are those of contact_default"},
      [&](std::size_t n) {
        s.contacts.assign(n, {{}, s.contactDefault});
      },
      [&](std::size_t k) {
        v.readNames({"between", "two materials, or one with itself", "", true}, s.contacts[k].between, {});
        visitContactParameters(v, s.model.law, s.contacts[k].parameters);
      });
}

}  // namespace

bool KeyVisitor::applies(const Key& key) const {
  if (key.only.empty()) return true;
  for (std::size_t begin = 0; begin <= key.only.size();) {
    const std::size_t end = std::min(key.only.find('|', begin), key.only.size());
    if (key.only.substr(begin, end - begin) == kind) return true;
    begin = end + 1;
  }
  return false;
}

bool Range::holds(double value) const {
  return (loOpen ? value > lo : value >= lo) && (hiOpen ? value < hi : value <= hi);
}

std::string Range::describe(Dimension dimension) const {
  const std::string unit = dimension == Dimension::none ? "" : fmt::format(" {}", siUnit(dimension));
  if (lo == -infinity && hi == infinity) return "";
  if (hi == infinity) return fmt::format("{} {:g}{}", loOpen ? ">" : ">=", lo, unit);
  if (lo == -infinity) return fmt::format("{} {:g}{}", hiOpen ? "<" : "<=", hi, unit);
  if (!loOpen && !hiOpen) return fmt::format("{:g} to {:g}{}", lo, hi, unit);
  return fmt::format("{} {:g} and {} {:g}{}", loOpen ? ">" : ">=", lo, hiOpen ? "<" : "<=", hi, unit);
}

void visitScene(KeyVisitor& v, Scene& s) {
  visitGeneral(v, s);
  v.readTable({"vessel", "what holds the bed", "", true}, [&] { visitVessel(v, s.vessel); });
  v.readTables(
      {"wall", "further walls"}, [&](std::size_t n) { s.walls.resize(n); },
      [&](std::size_t k) { visitWall(v, s.walls[k]); });
  v.readTable({"model", "contact model"}, [&] { visitModel(v, s.model); });
  visitMaterials(v, s);
  v.readTable({"time", "time step and end"}, [&] { visitTime(v, s.model.law, s.time); });
  v.readTables(
      {"particles", "groups of particles", "", true}, [&](std::size_t n) { s.particles.resize(n); },
      [&](std::size_t k) { visitParticles(v, s.particles[k]); });
  v.readTable({"insertion", "how particles come in"}, [&] { visitInsertion(v, s.insertion); });
  v.readTable({"settle", "what becomes of particles at rest"}, [&] { visitSettle(v, s.settle); });
  v.readTable({"rest", "when the run is over"}, [&] { visitRest(v, s.rest); });
  v.readTable({"output", "what is written"}, [&] { visitOutput(v, s.output); });
  v.readTable({"analysis", "what is measured"}, [&] { visitAnalysis(v, s.analysis); });
  v.readTable({"limits", "when a run is in trouble"}, [&] { visitLimits(v, s.limits); });
}

}  // namespace granular
