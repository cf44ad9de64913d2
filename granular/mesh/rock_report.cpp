// The rock report as text and as JSON.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "granular/mesh/rock.h"
#include "granular/mesh/sphere_fit.h"

namespace granular {
namespace {

using Json = nlohmann::ordered_json;

// The counts of defects: key, meaning, what was done about them.
struct DefectRow {
  const char* key;
  const char* meaning;
  const char* done;
  std::int64_t MeshDefects::*count;
};

constexpr std::array<DefectRow, 14> defectRows = {{
    {"non_finite_vertices", "vertices that are NaN or infinite", "refused", &MeshDefects::nonFiniteVertices},
    {"unreferenced_vertices", "unreferenced vertices", "dropped", &MeshDefects::unreferencedVertices},
    {"duplicate_vertices", "duplicate vertices", "welded", &MeshDefects::duplicateVertices},
    {"degenerate_triangles", "degenerate triangles", "dropped", &MeshDefects::degenerateTriangles},
    {"zero_area_kept", "triangles without area that hold the surface together", "kept", &MeshDefects::zeroAreaKept},
    {"duplicate_triangles", "duplicate triangles", "dropped", &MeshDefects::duplicateTriangles},
    {"slivers", "slivers (altitude below 1/100 of the longest edge)", "kept", &MeshDefects::slivers},
    {"open_edges", "open edges", "found", &MeshDefects::openEdges},
    {"non_manifold_edges", "non-manifold edges", "found", &MeshDefects::nonManifoldEdges},
    {"fin_triangles", "triangles of fins on non-manifold edges", "dropped", &MeshDefects::finTriangles},
    {"flipped_triangles", "flipped triangles", "turned", &MeshDefects::flippedTriangles},
    {"unorientable_edges", "unorientable edges", "found", &MeshDefects::unorientableEdges},
    {"dropped_parts", "separate smaller parts", "dropped", &MeshDefects::droppedParts},
    {"dropped_triangles", "triangles of those parts", "dropped", &MeshDefects::droppedTriangles},
}};

const char* useName(RockUse use) { return use == RockUse::hull ? "hull" : "exact"; }

// In percent; rounding of an exact zero prints as a plain one.
double percent(double fraction) { return std::abs(fraction) < 1e-9 ? 0 : 100 * fraction; }

std::string describeBody(const RockReport& r) {
  std::string out;
  if (r.use == RockUse::exact) {
    out = fmt::format("body       exact: mass properties of the mesh; contacts see its hull of {} vertices\n",
                      r.bodyVertices);
  } else if (r.reduced) {
    out = fmt::format("body       hull reduced from {} to {} vertices: volume {:+.3f} %", r.hullVertices,
                      r.bodyVertices, percent(r.volumeError));
    if (r.reductionScale != 1) {
      out += fmt::format(" ({:+.3f} % before it was scaled by {:.5f})", 100 * (r.subsetVolume / r.hullVolume - 1),
                         r.reductionScale);
    }
    out += fmt::format(
        "\n           symmetric difference {:.3f} % of the hull; hull stands out by at most {}, reduced hull by {}\n",
        100 * r.symmetricDifference, describeLength(r.outside), describeLength(r.inside));
  } else {
    out = fmt::format("body       hull, all {} vertices\n", r.bodyVertices);
  }
  out += fmt::format("           volume {:.6g} m^3 (mass and solid fraction use it), area {:.6g} m^2\n", r.body.volume,
                     r.body.area);
  out += fmt::format("           principal inertia per density {:.6g}, {:.6g}, {:.6g} m^5; <r^2> {:.6g} m^2\n",
                     r.body.inertia.x(), r.body.inertia.y(), r.body.inertia.z(), r.body.meanSquareRadius);
  out += fmt::format("           longest extent {}, equal-volume diameter {}\n", describeLength(r.longestExtent),
                     describeLength(r.equalVolumeDiameter));
  return out;
}

Json defectsToJson(const RockReport& report) {
  Json defects;
  for (const DefectRow& row : defectRows) defects[row.key] = report.defects.*row.count;
  defects["inside_out"] = report.defects.insideOut;
  defects["parts"] = report.defects.parts;
  defects["euler"] = report.defects.euler;
  defects["weld_distance_file_units"] = report.defects.weldDistance;
  return defects;
}

}  // namespace

std::string formatReport(const RockReport& r) {
  std::string out = fmt::format("rock       {} ({}, {} bytes), 1 file unit = {:.6g} m\n", r.path, r.format, r.bytes,
                                r.metresPerFileUnit);
  out += fmt::format("read       {} vertices, {} triangles", r.verticesRead, r.trianglesRead);
  if (r.otherPrimitives > 0) out += fmt::format(", {} points or lines (left out)", r.otherPrimitives);
  out += '\n';
  // Only what was found; a clean mesh says so.
  bool clean = !r.defects.insideOut;
  for (const DefectRow& row : defectRows) {
    const std::int64_t count = r.defects.*row.count;
    clean = clean && count == 0;
    if (count != 0) out += fmt::format("defect     {:>6} {}: {}\n", count, row.meaning, row.done);
  }
  if (r.defects.insideOut) out += "defect     the whole surface was inside out: turned\n";
  if (clean) out += "defect     none\n";
  out += fmt::format("mesh       {} vertices, {} triangles, {}, Euler number {}", r.vertices, r.triangles,
                     r.kept.closed ? "closed" : "open", r.kept.euler);
  if (r.kept.closed) out += fmt::format(", {} handles", r.kept.handles);
  out +=
      fmt::format("\n           volume {}{:.6g} m^3, area {:.6g} m^2, box {}\n", r.whyNotExact.empty() ? "" : "about ",
                  r.meshVolume, r.meshArea, describeLengths({r.box.x(), r.box.y(), r.box.z()}));
  out += fmt::format("hull       {} vertices, volume {:.6g} m^3, area {:.6g} m^2\n", r.hullVertices, r.hullVolume,
                     r.hullArea);
  out += fmt::format("convexity  {:.4f} (mesh volume / hull volume)\n", r.convexity);
  out += describeBody(r);
  for (const std::string& warning : r.warnings) out += "warning    " + warning + '\n';
  return out;
}

std::string reportToJson(const RockReport& r) {
  const auto triple = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
  Json out;
  out["path"] = r.path;
  out["format"] = r.format;
  out["bytes"] = r.bytes;
  out["vertices_read"] = r.verticesRead;
  out["triangles_read"] = r.trianglesRead;
  out["other_primitives"] = r.otherPrimitives;
  out["metres_per_file_unit"] = r.metresPerFileUnit;
  out["defects"] = defectsToJson(r);
  out["mesh"] = {{"vertices", r.vertices},
                 {"triangles", r.triangles},
                 {"closed", r.kept.closed},
                 {"open_edges", r.kept.openEdges},
                 {"non_manifold_edges", r.kept.nonManifoldEdges},
                 {"euler", r.kept.euler},
                 {"handles", r.kept.handles},
                 {"volume_m3", r.meshVolume},
                 {"volume_is_estimate", !r.whyNotExact.empty()},
                 {"area_m2", r.meshArea},
                 {"inertia_per_density_m5", r.whyNotExact.empty() ? triple(r.meshInertia) : Json()},
                 {"box_m", triple(r.box)}};
  out["hull"] = {{"vertices", r.hullVertices}, {"volume_m3", r.hullVolume}, {"area_m2", r.hullArea}};
  out["convexity"] = r.convexity;
  out["body"] = {{"use", useName(r.use)},
                 {"vertices", r.bodyVertices},
                 {"reduced", r.reduced},
                 {"contact_volume_m3", r.contactVolume},
                 {"subset_volume_m3", r.subsetVolume},
                 {"reduction_scale", r.reductionScale},
                 {"volume_error", r.volumeError},
                 {"symmetric_difference", r.symmetricDifference},
                 {"hull_outside_m", r.outside},
                 {"hull_inside_m", r.inside},
                 {"volume_m3", r.body.volume},
                 {"area_m2", r.body.area},
                 {"inertia_per_density_m5", triple(r.body.inertia)},
                 {"mean_square_radius_m2", r.body.meanSquareRadius},
                 {"longest_extent_m", r.longestExtent},
                 {"equal_volume_diameter_m", r.equalVolumeDiameter}};
  out["why_not_exact"] = r.whyNotExact.empty() ? Json() : Json(r.whyNotExact);
  out["warnings"] = r.warnings;
  return out.dump(2) + "\n";
}

std::string formatFit(const SphereFit& fit) {
  std::string out = fmt::format(
      "clump      {} spheres: volume {:+.3f} %, surface {:+.3f} %, inertia {:.3f} %, centre of mass {:.3f} % of the "
      "size\n           symmetric difference {:.3f} % of the mesh; inscribed spheres left {:.3f} % empty, radii grown "
      "by {}\n",
      fit.spheres.size(), percent(fit.volumeError), percent(fit.areaError), percent(fit.inertiaError),
      percent(fit.centroidShift), percent(fit.symmetricDifference), percent(fit.empty), describeLength(fit.growth));
  if (fit.parts > 1) out += fmt::format("           the spheres are {} parts that do not touch\n", fit.parts);
  return out;
}

std::string fitToJson(const SphereFit& fit) {
  Json json = {{"spheres", fit.spheres.size()},
               {"volume_error", fit.volumeError},
               {"area_error", fit.areaError},
               {"inertia_error", fit.inertiaError},
               {"centroid_shift", fit.centroidShift},
               {"symmetric_difference", fit.symmetricDifference},
               {"empty_before_growth", fit.empty},
               {"growth_m", fit.growth},
               {"parts", fit.parts},
               {"mesh_volume_m3", fit.mesh.principal.volume},
               {"clump_volume_m3", fit.clump.principal.volume}};
  for (const ChildSphere& child : fit.spheres) {
    json["centres_m"].push_back({child.centre.x(), child.centre.y(), child.centre.z()});
    json["radii_m"].push_back(child.radius);
  }
  return json.dump(2) + "\n";
}

}  // namespace granular
