// What is measured of a pile, and written.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "granular/analysis/contact_network.h"
#include "granular/analysis/pile.h"
#include "granular/io/output_file.h"
#include "granular/io/result.h"
#include "granular/run/bed_of_world.h"
#include "granular/run/packing_report.h"
#include "granular/run/pile.h"
#include "granular/shape/clump.h"

namespace granular {
namespace {

using Json = nlohmann::ordered_json;

/// A pile in the plane has its particles locked to it.
bool isPlane(const Scene& scene) { return !scene.particles[0].lockTranslation.empty(); }

/// Pairs that a step would look at, per particle, each of two particles having it: particles, or children of clumps,
/// with grown bounds that meet; of walls too.
double countPotentialContacts(const World& world) {
  const Bodies& bodies = world.bodies;
  double count = 0;
  for (const Pair& pair : world.pairs.pairs) {
    const bool clump = asClump(*bodies.shape[static_cast<std::size_t>(pair.a)]) != nullptr;
    const auto& memory = world.pairs.memory.clumps;
    const auto slot = static_cast<std::size_t>(pair.slot);
    count += 2 * (clump ? slot < memory.size() ? static_cast<double>(memory[slot].children.near.size()) : 0 : 1);
  }
  for (const WallPair& pair : world.pairs.wallPairs) {
    const bool clump = asClump(*bodies.shape[static_cast<std::size_t>(pair.body)]) != nullptr;
    count += clump ? static_cast<double>(pair.children.near.size()) : 1;
  }
  return bodies.size() > 0 ? count / static_cast<double>(bodies.size()) : 0;
}

Json numberOrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

/// Outlines for the picture, in the plane of x and z: discs of the children, or the ellipse.
Json outlinesOf(const Bed& bed) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < bed.size(); ++i) {
    const Frame& frame = bed.frames[i];
    Json row;
    if (const Clump* clump = asClump(*bed.shapes[i])) {
      for (const ChildSphere& child : clump->children()) {
        const Vec3 c = frame.toWorld(child.centre);
        row["discs"].push_back({c.x(), c.z(), child.radius});
      }
    } else {
      const Vec3 along = frame.R.col(0);
      row["ellipse"] = {frame.x.x(), frame.x.z(), std::atan2(along.z(), along.x())};
    }
    rows.push_back(row);
  }
  return rows;
}

void writePicture(const PileResult& result, const Bed& bed, const Scene& scene, const std::filesystem::path& out) {
  Json json;
  json["plane"] = isPlane(scene);
  const ParticleSettings& group = scene.particles[0];
  if (group.shape == ParticleSettings::Shape::ellipsoid) json["semi_axes_m"] = {group.semiAxes.x(), group.semiAxes.z()};
  json["repose_angle_deg"] = numberOrNull(result.angle);
  json["line"] = {
      {"from_m", numberOrNull(result.from)}, {"to_m", numberOrNull(result.to)}, {"top_m", numberOrNull(result.top)}};
  if (isPlane(scene)) json["particles"] = outlinesOf(bed);
  OutputFile file(out / "pile.json");
  file.write(json.dump() + '\n');
  file.finish();
}

Table tabulateSurface(const std::vector<SurfacePoint>& surface, bool plane) {
  Table table;
  table.name = "surface";
  table.definition = plane ? "Height of the highest particle above each place beside the wall"
                           : "Mean over sectors of the height of the highest particle at each distance from the axis";
  table.columns = {"distance_m", "height_m"};
  for (const SurfacePoint& p : surface) table.rows.push_back({p.distance, p.height});
  return table;
}

/// The particles that touch something: those on their way down are no part of the pile.
Bed keepStanding(const Bed& bed) {
  std::vector<bool> touches(bed.size(), false);
  for (const BedContact& contact : bed.contacts) {
    touches[static_cast<std::size_t>(contact.a)] = true;
    if (contact.b >= 0) touches[static_cast<std::size_t>(contact.b)] = true;
  }
  Bed standing;
  standing.vessel = bed.vessel;
  for (std::size_t i = 0; i < bed.size(); ++i) {
    if (!touches[i]) continue;
    standing.shapes.push_back(bed.shapes[i]);
    standing.frames.push_back(bed.frames[i]);
  }
  return standing;
}

/// Angle and line.
void measureSlope(const Bed& bed, const std::vector<SurfacePoint>& surface, PileResult& result) {
  double length = 0, height = 0;
  for (const SurfacePoint& p : surface) height = std::max(height, p.height);
  result.height = height;
  for (const Shape* shape : bed.shapes) length += shape->longestExtent() / static_cast<double>(bed.size());
  PileOptions ofBase;
  ofBase.ofBase = true;
  if (const std::optional<SlopeLine> line = fitSlope(surface, ofBase, length)) result.baseAngle = line->angle;
  const std::optional<SlopeLine> line = fitSlope(surface, {}, length);
  if (!line) return;
  result.angle = line->angle;
  result.angleError = line->standardError;
  result.from = line->from;
  result.to = line->to;
  result.top = line->top;
}

void measurePlane(const Bed& bed, const std::vector<SurfacePoint>& surface, const ParticleSettings& group,
                  PileResult& result) {
  const PlanePorosity porosity = measurePorosity(bed, surface);
  result.porosity = porosity.porosity;
  result.triangleAngle = std::atan2(*result.height * *result.height, 2 * porosity.pileArea) * 180 / pi;
  const bool ellipsoid = group.shape == ParticleSettings::Shape::ellipsoid;
  const double a = ellipsoid ? group.semiAxes.x() : group.halfLength;
  const double b = ellipsoid ? group.semiAxes.z() : group.halfWidth;
  result.porositySmooth = 1 - static_cast<double>(bed.size()) * pi * a * b / porosity.pileArea;
}

}  // namespace

PileResult writePileReport(const PackingRun& run, RunEnd end, int threads, const std::filesystem::path& out,
                           RunResult* told) {
  const Bed bed = makeBed(run.world(), run.vessel());
  const bool plane = isPlane(run.scene());
  const double spacing = defaultSpacing(bed);
  PileResult result;
  const Bed standing = keepStanding(bed);
  const std::vector<SurfacePoint> surface =
      plane ? sampleSide(standing, spacing) : sampleCone(standing, 4 * spacing, PileOptions{}.sectors);
  measureSlope(standing, surface, result);
  if (plane) measurePlane(standing, surface, run.scene().particles[0], result);
  const ContactNetwork network = analyseContacts(bed);
  result.coordinationParticles = network.coordination;
  result.coordinationSpheres = 2 * static_cast<double>(network.particleContacts) / static_cast<double>(bed.size());
  result.potentialContacts = countPotentialContacts(run.world());

  RunResult report = writeReport(run, end, threads, out);
  report.headline = {{"repose_angle_deg", result.angle},
                     {"repose_angle_error_deg", result.angleError},
                     {"base_angle_deg", result.baseAngle},
                     {"triangle_angle_deg", result.triangleAngle},
                     {"pile_height_m", result.height},
                     {"porosity", result.porosity},
                     {"porosity_smooth", result.porositySmooth},
                     {"coordination_particles", result.coordinationParticles},
                     {"coordination_spheres", result.coordinationSpheres},
                     {"potential_contacts_per_particle", result.potentialContacts}};
  report.more.emplace_back("particles_in_flight", static_cast<double>(bed.size() - standing.size()));
  const Table table = tabulateSurface(surface, plane);
  writeTable(out / "surface.csv", table);
  report.tables.emplace_back("surface.csv", table.definition);
  writePicture(result, bed, run.scene(), out);
  writeResult(out / "result.json", report);
  if (told) *told = std::move(report);
  return result;
}

std::string formatPile(const PileResult& r) {
  const auto show = [](const std::optional<double>& v, const char* unit) {
    return v ? fmt::format("{:.4g}{}", *v, unit) : std::string("-");
  };
  std::string text = fmt::format(
      "pile: repose angle {} (standard error {}), height {}, fitted from {} to {}; by the middle of its base {}\n",
      show(r.angle, " deg"), show(r.angleError, " deg"), show(r.height, " m"), show(r.from, " m"), show(r.to, " m"),
      show(r.baseAngle, " deg"));
  if (r.porosity)
    text += fmt::format(
        "slope of the triangle of its height and area {}; porosity in the plane {}, with smooth sections {}\n",
        show(r.triangleAngle, " deg"), show(r.porosity, ""), show(r.porositySmooth, ""));
  text += fmt::format("coordination: {:.3f} particles, {:.3f} contacts; potential contacts per particle {:.1f}\n",
                      r.coordinationParticles, r.coordinationSpheres, r.potentialContacts);
  return text;
}

}  // namespace granular
