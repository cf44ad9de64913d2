#include "granular/run/scene_world.h"

#include <fmt/format.h>

#include <algorithm>

#include "granular/core/errors.h"
#include "granular/mesh/import.h"

namespace granular {
namespace {

bool repeats(const VesselSettings& vessel, const char* direction) {
  return vessel.kind == VesselSettings::Kind::periodic &&
         std::find(vessel.periodic.begin(), vessel.periodic.end(), direction) != vessel.periodic.end();
}

bool skips(const Scene& scene, std::string_view name) {
  const auto has = [&](std::string_view wanted) {
    return std::find(scene.skip.begin(), scene.skip.end(), wanted) != scene.skip.end();
  };
  return has("all") || has(name);
}

/// The parameters of a contact between two materials of the scene, given what is not elastic.
ContactParameters withElasticity(const Scene& scene, std::size_t i, std::size_t j, ContactParameters parameters) {
  if (!lawReadsCurvature(lawFromName(scene.model.law))) return parameters;
  Elasticity a = scene.materials[i].elasticity, b = scene.materials[j].elasticity;
  // Two rigid walls never meet; anything serves.
  if (std::isinf(a.young) && std::isinf(b.young)) a.young = b.young = 1;
  setElasticity(a, b, parameters);
  return parameters;
}

MaterialTable makeMaterials(const Scene& scene) {
  MaterialTable table;
  const std::size_t n = scene.materials.size();
  for (std::size_t i = 0; i < n; ++i)
    table.add(scene.materials[i].name, withElasticity(scene, i, i, scene.contactDefault));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i; j < n; ++j) {
      table.setPair(scene.materials[i].name, scene.materials[j].name,
                    withElasticity(scene, i, j, scene.contactDefault));
    }
  }
  for (const ContactSettings& contact : scene.contacts) {
    const auto i = static_cast<std::size_t>(scene.materialIndex(contact.between[0]));
    const auto j = static_cast<std::size_t>(scene.materialIndex(contact.between[1]));
    table.setPair(contact.between[0], contact.between[1], withElasticity(scene, i, j, contact.parameters));
  }
  return table;
}

bool sleeps(const Scene& scene) { return scene.settle.kind == SettleSettings::Kind::sleep && skips(scene, "sleep"); }

WorldOptions makeOptions(const Scene& scene) {
  WorldOptions options;
  options.gravity = scene.gravity;
  options.rule = {pointRuleFromName(scene.model.pointRule), scene.model.slab, static_cast<int>(scene.model.sharpness)};
  options.law = lawFromName(scene.model.law);
  options.lawOptions.tension = scene.model.tension;
  options.lawOptions.frictionOfPush = scene.model.frictionLimit == ModelSettings::FrictionLimit::push;
  options.lawOptions.localMass = scene.model.contactMass == ModelSettings::ContactMass::local;
  options.integrator = schemeFromName(scene.model.integrator);
  options.skips.search = skips(scene, "broad_phase");
  options.skips.separation = skips(scene, "gjk");
  options.skips.feature = skips(scene, "epa");
  options.skips.orientation = skips(scene, "orientation");
  options.skips.flight = skips(scene, "flight");
  options.keepSlots = !skips(scene, "scatter");
  options.sleep.on = sleeps(scene);
  require(!options.sleep.on || options.rule.rule != PointRule::manifold,
          scene.file.string() +
              ": settle.kind = \"sleep\" does not go with model.point_rule = \"manifold\", which keeps several "
              "contacts per pair: choose none or freeze, or another rule");
  options.sleep.energy = scene.settle.energy;
  options.sleep.balance = scene.settle.balance;
  options.sleep.wake = scene.settle.wake;
  options.expectedOverlap = scene.time.overlap;
  options.deepOverlap = scene.limits.maxOverlap;
  options.maxSpeed = scene.limits.maxSpeed;
  options.energy = scene.output.energy;
  for (int k = 0; k < 3; ++k) {
    const char* names[] = {"x", "y", "z"};
    if (!repeats(scene.vessel, names[k])) continue;
    options.periods.length[k] = scene.vessel.size[k];
    options.periods.origin[k] = k < 2 ? -0.5 * scene.vessel.size[k] : 0;
  }
  return options;
}

void addWall(std::unique_ptr<Wall> wall, const std::string& name, int material, World& world) {
  wall->name = name;
  wall->material = material;
  world.walls.push_back(std::move(wall));
}

void addVesselWalls(const Scene& scene, World& world) {
  const VesselSettings& vessel = scene.vessel;
  const int material = scene.materialIndex(vessel.material);
  using Kind = VesselSettings::Kind;
  if (vessel.kind == Kind::none) return;
  if (!repeats(vessel, "z")) addWall(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()), "floor", material, world);
  if (vessel.kind == Kind::cylinder) {
    addWall(makeCylinderWall(Vec2::Zero(), vessel.radius), "vessel", material, world);
    return;
  }
  const char* directions[] = {"x", "y"};
  for (int k = 0; k < 2; ++k) {
    if (repeats(vessel, directions[k])) continue;
    const Vec3 axis = k == 0 ? Vec3::UnitX() : Vec3::UnitY();
    const Vec3 far = 0.5 * vessel.size[k] * axis;
    addWall(makePlaneWall(-far, axis), fmt::format("-{}", directions[k]), material, world);
    addWall(makePlaneWall(far, -axis), fmt::format("+{}", directions[k]), material, world);
  }
}

WallPath pathOf(const WallSettings& s) {
  return {s.velocity, s.amplitude, s.frequency, s.phase, s.axisPoint, s.spin, s.start, s.stop};
}

WallServo servoOf(const WallSettings& s) {
  if (s.force == 0) return {};
  return {s.direction.normalized(), s.force, s.maxSpeed, s.response};
}

void addSceneWalls(const Scene& scene, World& world) {
  for (const WallSettings& settings : scene.walls) {
    std::unique_ptr<Wall> wall;
    switch (settings.kind) {
      case WallSettings::Kind::plane:
        wall = makePlaneWall(settings.point, settings.normal.normalized());
        break;
      case WallSettings::Kind::cylinder:
        wall = makeCylinderWall(settings.point.head<2>(), settings.radius);
        break;
      case WallSettings::Kind::mesh: {
        TriangleMesh mesh = importTriangles(settings.file.string(), "m", settings.unit * settings.scale);
        for (Vec3& vertex : mesh.vertices) vertex += settings.point;
        wall = makeMeshWall(mesh, settings.file.string());
        break;
      }
    }
    wall = makeMovingWall(std::move(wall), pathOf(settings), servoOf(settings));
    addWall(std::move(wall), settings.name, scene.materialIndex(settings.material), world);
  }
}

}  // namespace

std::unique_ptr<World> makeWorld(const Scene& scene) {
  auto world = std::make_unique<World>(makeOptions(scene), makeMaterials(scene));
  addVesselWalls(scene, *world);
  world->vesselWalls = world->walls.size();
  addSceneWalls(scene, *world);
  return world;
}

Region makeRegion(const Scene& scene) {
  Region region;
  const VesselSettings& vessel = scene.vessel;
  if (vessel.kind == VesselSettings::Kind::cylinder) {
    region.kind = Region::Kind::cylinder;
    region.radius = vessel.radius;
    region.ceiling = vessel.height.value_or(infinity);
    return region;
  }
  region.kind = vessel.kind == VesselSettings::Kind::periodic ? Region::Kind::periodic : Region::Kind::box;
  region.repeatX = repeats(vessel, "x");
  region.repeatY = repeats(vessel, "y");
  region.lo = -0.5 * vessel.size.head<2>();
  region.hi = 0.5 * vessel.size.head<2>();
  if (vessel.kind == VesselSettings::Kind::none) {
    // Dropped particles need no vessel: the walls hold them.
    region.lo.setConstant(-infinity);
    region.hi.setConstant(infinity);
    region.floor = -infinity;
  }
  if (vessel.kind != VesselSettings::Kind::none && !repeats(vessel, "z")) region.ceiling = vessel.size.z();
  return region;
}

Vessel makeVessel(const Scene& scene) {
  Vessel vessel;
  switch (scene.vessel.kind) {
    case VesselSettings::Kind::none:
      vessel.kind = Vessel::Kind::none;
      break;
    case VesselSettings::Kind::cylinder:
      vessel.kind = Vessel::Kind::cylinder;
      vessel.radius = scene.vessel.radius;
      break;
    case VesselSettings::Kind::box:
    case VesselSettings::Kind::periodic:
      vessel.kind = scene.vessel.kind == VesselSettings::Kind::box ? Vessel::Kind::box : Vessel::Kind::periodic;
      vessel.lo = Vec3(-0.5 * scene.vessel.size.x(), -0.5 * scene.vessel.size.y(), 0);
      vessel.hi = Vec3(0.5 * scene.vessel.size.x(), 0.5 * scene.vessel.size.y(), scene.vessel.size.z());
      vessel.periodicX = repeats(scene.vessel, "x");
      vessel.periodicY = repeats(scene.vessel, "y");
      vessel.periodicHeight = repeats(scene.vessel, "z");
      break;
  }
  return vessel;
}

namespace {

/// What bodies that meet nobody do where skips ask for flight (world/flight.cpp).
const char* describeFlight(const Scene& scene) {
  const auto moves = [](const WallSettings& wall) { return pathOf(wall).moves() || wall.force != 0; };
  if (sleeps(scene)) return "not with sleep, which counts every step";
  if (scene.output.energy) return "not with an energy ledger, which counts every step";
  if (std::any_of(scene.walls.begin(), scene.walls.end(), moves)) return "not where walls move";
  return "of bodies that meet nobody for 16 steps and more";
}

}  // namespace

std::string describeSkips(const Scene& scene) {
  std::vector<std::string> parts;
  const auto say = [&](std::string_view name, const char* reason) {
    parts.push_back(fmt::format("{}: {}", name, skips(scene, name) ? reason : "off"));
  };
  say("broad_phase", "until a surface has used up its skin");
  say("gjk", "while a proven gap is not used up");
  say("epa", "while the last feature is verified to be the answer");
  say("orientation", "of balls, which spin but keep q = 1");
  say("flight", describeFlight(scene));
  say("scatter", "of neighbours in memory, in beds beyond the caches");
  parts.push_back(scene.settle.kind != SettleSettings::Kind::sleep ? "sleep: not asked for"
                  : sleeps(scene)                                  ? "sleep: bodies at rest, until their force changes"
                                                                   : "sleep: off");
  return fmt::format("skips: {}", fmt::join(parts, "; "));
}

}  // namespace granular
