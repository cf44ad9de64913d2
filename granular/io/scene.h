// A scene: everything a run is told, as plain data in SI units. Read from a TOML file by scene_file.h; the key table in
// scene_keys.cpp gives every key's unit, range and meaning. Defaults are those of S table 7 where it has them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "granular/core/math.h"
#include "granular/law/law.h"

namespace granular {

/// lo <= hi, in the unit of its key.
struct Interval {
  double lo = 0, hi = 0;
};

/// Axis along z through the origin, floor at z = 0.
struct VesselSettings {
  enum class Kind { cylinder, box, periodic, none };
  Kind kind = Kind::none;
  double radius = 0;         ///< cylinder, m
  Vec3 size = Vec3::Zero();  ///< box and periodic, m: x and y centred on the axis, z from the floor to the rim
  std::vector<std::string> periodic = {"x", "y"};  ///< periodic: directions that repeat; the others have walls
  std::optional<double> height;                    ///< cylinder: of the rim, m; not given: as high as the bed needs
  std::string material;                            ///< empty: the first material
};

/// A wall besides the vessel.
struct WallSettings {
  enum class Kind { plane, cylinder, mesh };
  std::string name;
  Kind kind = Kind::plane;
  Vec3 point =
      Vec3::Zero();  ///< plane: a point of it; cylinder: a point of its vertical axis; mesh: where its origin goes, m
  Vec3 normal = Vec3::UnitZ();  ///< plane: towards the granular side (any length)
  double radius = 0;            ///< cylinder, m
  std::filesystem::path file;   ///< mesh, absolute
  double unit = 1;              ///< mesh: m per unit of the file
  double scale = 1;             ///< mesh: further factor
  std::string material;         ///< empty: the first material

  // Motion: a path, a servo, or both.
  Vec3 velocity = Vec3::Zero();       ///< m/s
  Vec3 amplitude = Vec3::Zero();      ///< of a vibration, m
  double frequency = 0;               ///< of the vibration, 1/s
  double phase = 0;                   ///< of the vibration when it starts, rad
  Vec3 spin = Vec3::Zero();           ///< angular velocity, rad/s
  Vec3 axisPoint = Vec3::Zero();      ///< a point of the axis it turns about, m
  double start = 0, stop = infinity;  ///< of the path, s
  double force = 0;                   ///< that a servo presses with, N; 0: no servo
  Vec3 direction = Vec3::Zero();      ///< in which it presses (any length)
  double maxSpeed = 0.1;              ///< of the servo, m/s
  double response = 1e-3;             ///< of the servo, s
};

struct MaterialSettings {
  std::string name;
  double density = 2500;  ///< kg/m^3
  Elasticity elasticity;  ///< for Hertz's laws
};

/// Parameters of one pair of materials.
struct ContactSettings {
  std::vector<std::string> between;
  ContactParameters parameters;  ///< keys not given are those of contact_default
};

struct ModelSettings {
  enum class FrictionLimit { total, push };
  enum class ContactMass { reduced, local };
  std::string law = "linear";
  bool tension = true;                                 ///< keep the attractive end of a damped contact (S 10)
  FrictionLimit frictionLimit = FrictionLimit::total;  ///< Coulomb's limit from |F_n| (S 11) or max(F_n, 0)
  ContactMass contactMass = ContactMass::reduced;
  std::string pointRule = "stiff_patch";
  double slab = 0.01;           ///< feature slab of face_centroid, fraction of the overlap
  std::int64_t sharpness = 24;  ///< of stiff_patch: half the rocking stiffness of a face over an elastic foundation's
  std::string integrator = "seelen";
};

struct TimeSettings {
  std::optional<double> step;  ///< s; not given ("auto"): fraction of the stability bound
  double fraction = 0.5;       ///< of the stability bound
  std::int64_t contacts = 8;   ///< at once on a body, for the bound
  double overlap = 0.02;       ///< Hertz's laws: largest expected, fraction of the size, for the bound
  double maxTime = infinity;   ///< simulated, s: the run stops here with whatever it has
};

/// How the sizes of one group of particles vary.
struct SizeSettings {
  enum class Distribution { fixed, uniform, normal, lognormal, sieve };
  enum class By { number, mass };
  enum class As { multiplier, diameter };
  Distribution distribution = Distribution::fixed;
  By by = By::number;              ///< what the distribution counts
  As as = As::multiplier;          ///< factor on the group's shape, or diameter of the sphere of equal volume in m
  double value = 1;                ///< fixed
  double mean = 1, deviation = 0;  ///< normal and lognormal: mean and standard deviation of the size itself
  double min = 0, max = infinity;  ///< uniform: the ends; normal and lognormal: cut-offs
  std::vector<double> sizes;       ///< sieve: openings, ascending
  std::vector<double> passing;     ///< sieve: fraction finer than each opening, from 0 to 1; linear in between
};

struct ParticleSettings {
  enum class Shape { sphere, ellipsoid, cylinder, cone, cuboid, polyhedron, mesh, sand, woodchip, clump };
  enum class Construction { spheres, ellipsoid };
  enum class Mass { sum, smooth };
  enum class Template { sphere, ellipsoid };
  enum class Use { hull, exact, clump };
  std::string name;  ///< default: the shape's name
  Shape shape = Shape::sphere;
  double radius = 0;                ///< sphere, cylinder, cone (base), sand (template), m
  double height = 0;                ///< cylinder, cone, m
  Vec3 semiAxes = Vec3::Zero();     ///< ellipsoid, m
  Vec3 halfLengths = Vec3::Zero();  ///< cuboid, m
  std::vector<Vec3> vertices;       ///< polyhedron, m

  // clump
  Construction construction = Construction::spheres;  ///< as given, or on the axis of an ellipsoid
  std::vector<double> radii;                          ///< spheres, m
  std::vector<Vec3> centres;                          ///< spheres, m
  double halfLength = 0, halfWidth = 0;               ///< ellipsoid: semi-axes along and across, m
  std::int64_t spheres = 0;                           ///< ellipsoid, mesh as a clump: how many
  Mass mass = Mass::sum;                              ///< of the spheres together, or of the smooth body they stand for

  // mesh: each particle takes one of the files, drawn at random.
  std::vector<std::filesystem::path> files;  ///< absolute
  double unit = 1;                           ///< m per unit of the file
  std::optional<Interval>
      extent;  ///< scaled so that the longest extent falls uniformly in it, m; not given: as the file says
  std::int64_t maxVertices = 60;  ///< of the hull
  Use use = Use::hull;  ///< exact: all of the hull for contacts, mass of the mesh; clump: spheres fitted to the mesh;
                        ///< both need a closed mesh

  // sand: points spread on a template, their hull (S section 8).
  Template sandTemplate = Template::sphere;
  double aspect = 3;  ///< ellipsoid template: length over width
  Interval vertexCount{5, 20};
  double spread = 0.5;  ///< how far the points' repulsion is followed: 0 not at all, 1 to rest

  // woodchip: hull of four points on a circle at either end (S section 8).
  Interval length{5e-3, 7e-3}, thinRadius{0.4e-3, 0.7e-3}, thickRadius{1.0e-3, 1.3e-3};  ///< m

  std::int64_t variants = 0;  ///< mesh, sand, woodchip: different shapes drawn; 0: each particle its own
  std::int64_t count = 0;     ///< particles; 0: by share
  double share = 0;           ///< part of insertion.count, by number
  std::string material;       ///< empty: the first material
  std::vector<std::string> lockTranslation, lockRotation;  ///< world axes along and about which nothing moves
  SizeSettings size;

  int line = 0;  ///< of the group in the scene file, for messages
};

struct InsertionSettings {
  enum class Kind { batches, rain, drop, poses, bed };
  enum class Orientation { random, upright };
  enum class Turn { any, x, y, z, none };
  Kind kind = Kind::batches;
  std::int64_t count = 0;                       ///< in all groups together; 0: the groups' counts say it
  Interval batch{20, 60};                       ///< particles per batch (S table 7)
  double rate = 0;                              ///< rain and drop, 1/s
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< drop: corners of the box of the centres, m
  Turn turn = Turn::any;                        ///< drop: orientation
  std::optional<double> height;  ///< lowest insertion plane above the bed's top, m; not given: the lowest free place
  double speed = 0;              ///< downwards, m/s
  Orientation orientation = Orientation::random;
  double energy = 1e-2;        ///< batches: consolidated when kinetic energy per particle falls below this times m g d
  double time = 5e-3;          ///< ... and stays there so long, s
  double maxTime = 1;          ///< a batch not consolidated after this is counted and the next one follows, s
  std::filesystem::path file;  ///< poses: pose file; bed: output folder or checkpoint of an earlier run; absolute
  double maxOverlap = 0.01;    ///< poses, bed: deepest overlap accepted, fraction of the size
};

/// What happens to particles that have come to rest.
struct SettleSettings {
  enum class Kind { none, freeze, sleep };
  Kind kind = Kind::none;
  double energy = 1e-4;           ///< sleep: slow is an energy of the mean motion below this times m g d
  double balance = 0.1;           ///< sleep: taken out when the net force is below this times the load
  std::optional<double> time;     ///< sleep: for so long, s; auto: 50 shortest contact times
  double wake = 0.3;              ///< sleep: woken when the net force differs from that at sleep by this times the load
  std::optional<double> average;  ///< sleep: in the mean of so long, s; auto: 25 shortest contact times
};

/// When the run is over.
struct RestSettings {
  double energy = 1e-4;  ///< kinetic energy per particle below this times m g d
  double time = 0.02;    ///< for so long, s
  double maxTime = 5;    ///< waited for at most, s after the last particle
};

struct OutputSettings {
  std::optional<double> frames;          ///< simulated time between frames, s; not given: none but the last
  double checkpointEvery = 600;          ///< wall time, s
  double checkpointInterval = infinity;  ///< simulated time, s
  bool stl = true, glb = true;           ///< the final bed as surfaces
  double gap = 0;                        ///< stl, glb: each particle is scaled about its centre by 1 - gap
  bool picture = true, plots = true;
  bool particles = true, contacts = true;  ///< CSV tables
  bool energy = false;                     ///< keep the energy ledger
  std::int64_t resolution = 24;            ///< segments around a circle of a curved surface
};

/// Lengths are in units of the mean longest extent or, for the dimensionless profiles, of `unitLength`.
struct AnalysisSettings {
  std::optional<double>
      unitLength;          ///< of dimensionless distances, m; not given: mean diameter of the sphere of equal volume
  double nearWall = 1;     ///< thickness of the near-wall region, longest extents
  double core = 2;         ///< core: longest extents left out at floor, top and wall
  double ringStep = 0.05;  ///< radial and axial profile: distance of the sampled circles, unit lengths
  double arcStep = 0.1;    ///< and of the points on a circle, unit lengths
  double orderBin = 0.5;   ///< annular bins of the order parameters, unit lengths
  double alphaStep = pi / 36;   ///< step of alpha in S2 and S4 over alpha, rad
  double pairReach = 5;         ///< reach of the pair distribution, unit lengths
  double pairBin = 0.05;        ///< its bins, unit lengths
  double forceBin = 0.2;        ///< bins of the force distribution, mean forces
  std::optional<double> voxel;  ///< edge of the porosity field's voxels, m; not given: no field
};

/// When a run is in trouble, and what then.
struct LimitSettings {
  /// stop: with a checkpoint of the last good state; proceed: count and tell; smallerStep, remove: back to the last
  /// good state, and on from there with half the step, or without the body named.
  enum class Action { stop, proceed, smallerStep, remove };
  Action onTrouble = Action::stop;
  double maxOverlap = 0.2;     ///< fraction of the size
  double maxSpeed = 100;       ///< m/s
  double maxTravel = 0.5;      ///< of a surface in one step, fraction of the smallest size
  double maxGain = 0.1;        ///< energy from nothing, fraction of the kinetic energy and m g d of all bodies
  double wallTime = infinity;  ///< s: then a checkpoint is written and the run stops
};

struct Scene {
  std::string name;  ///< default: the file's stem
  std::uint64_t seed = 1;
  int threads = 0;            ///< 0: all cores
  Vec3 gravity{0, 0, -9.81};  ///< m/s^2
  VesselSettings vessel;
  std::vector<WallSettings> walls;
  std::vector<MaterialSettings> materials;  ///< never empty once read
  ContactParameters contactDefault;
  std::vector<ContactSettings> contacts;
  ModelSettings model;
  TimeSettings time;
  std::vector<ParticleSettings> particles;
  InsertionSettings insertion;
  SettleSettings settle;
  RestSettings rest;
  std::vector<std::string> skip = {"all"};  ///< "all", "none", or names of skipNames
  OutputSettings output;
  AnalysisSettings analysis;
  LimitSettings limits;

  std::filesystem::path file;  ///< where it was read from; relative paths in it start at its folder

  /// Row of materials; an empty name is the first. The reader has made sure that every name exists.
  int materialIndex(const std::string& material) const;
};

/// What a scene can skip, as `skip` and --skip name it.
inline constexpr std::string_view skipNames[] = {"broad_phase", "gjk",     "epa",  "orientation",
                                                 "flight",      "scatter", "sleep"};

}  // namespace granular
