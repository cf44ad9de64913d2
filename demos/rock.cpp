// Reads a scanned mesh, reports what was found, repaired and measured, and shows mesh and hull side by side.
#include "granular/mesh/rock.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "exit_code.h"
#include "granular/core/errors.h"
#include "granular/mesh/mesh_file.h"
#include "run_program.h"

namespace {

void writeText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out) throw granular::InputError("output " + path.string() + ": can't be written");
}

// The picture is drawn by VTK in a virtual display; without these the rest stands.
void drawPicture(const std::filesystem::path& out, bool ofClump) {
  const std::string script = std::string(GRANULAR_PLOTS_DIR) + "/render_rock.py";
  std::vector<std::string> program = {"xvfb-run", "-a", "/usr/bin/python3", script, out.string()};
  if (ofClump) program.push_back("clump");
  std::fflush(stdout);
  if (runProgram(program)) {
    std::printf("picture    %s\n", (out / (ofClump ? "rock_clump.png" : "rock.png")).c_str());
  } else {
    std::printf("picture    not drawn: it needs Debian's xvfb, xauth and python3-vtk9, and %s\n", script.c_str());
  }
}

// Spheres in place of the mesh: their list, their surface, and how well they fit.
void writeClump(const granular::Rock& rock, const std::filesystem::path& out,
                const granular::SphereFitOptions& options) {
  const granular::SphereFit fit = granular::fitSpheres(rock, options);
  std::fputs(granular::formatFit(fit).c_str(), stdout);
  writeText(out / "clump.json", granular::fitToJson(fit));
  granular::Frame toBody;
  const granular::Clump clump(fit.spheres, &toBody);
  granular::TriangleMesh surface = clump.surface(24);
  for (granular::Vec3& vertex : surface.vertices) vertex = toBody.toWorld(vertex);
  granular::writeMesh((out / "clump.stl").string(), surface);
  std::printf("written    clump.json (spheres and errors), clump.stl (m, in the frame of mesh.stl)\n");
  drawPicture(out, true);
}

void run(const std::string& mesh, const std::filesystem::path& out, const granular::RockOptions& options,
         const granular::SphereFitOptions* clump) {
  const granular::Rock rock = granular::loadRock(mesh, options);
  const std::string report = granular::formatReport(rock.report);
  std::fputs(report.c_str(), stdout);

  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error) throw granular::InputError("output " + out.string() + ": " + error.message());
  writeText(out / "report.txt", report);
  writeText(out / "report.json", granular::reportToJson(rock.report));
  granular::writeMesh((out / "mesh.stl").string(), rock.mesh);
  granular::writeMesh((out / "hull.stl").string(), rock.hull);
  granular::writeMesh((out / "body.stl").string(), rock.contactHull);
  std::printf("written    %s: report.txt, report.json, mesh.stl, hull.stl, body.stl (m)\n", out.c_str());
  drawPicture(out, false);
  if (clump) writeClump(rock, out, *clump);
}

int parseAndRun(int argc, char** argv) {
  CLI::App app(
      "Reads a scanned mesh (OBJ, STL, PLY, OFF, glTF, GLB), repairs it and makes a convex body of it.\n"
      "Writes report.txt, report.json, mesh.stl (repaired), hull.stl (full), body.stl (what contacts see), rock.png;\n"
      "with --clump also clump.json, clump.stl, rock_clump.png.\n"
      "Exit codes: 0 done, 1 the mesh or the output folder can't be used, 2 a problem of the program; others: wrong "
      "options.");
  std::string mesh, out;
  granular::RockOptions options;
  bool exact = false, keepSubset = false;
  app.add_option("mesh", mesh, "the mesh file")->required();
  app.add_option("--out", out, "folder for the results")->required();
  app.add_option("--unit", options.unit, "unit of the file: m dm cm mm um nm km in ft")->capture_default_str();
  app.add_option("--scale", options.scale, "factor on the file's coordinates")->capture_default_str();
  auto* extent = app.add_option("--extent", options.longestExtent, "scale the body to this longest extent, m");
  app.add_option("--diameter", options.equalVolumeDiameter,
                 "scale the body to the volume of a sphere of this diameter, m")
      ->excludes(extent);
  app.add_option("--vertices", options.vertexBudget, "most vertices of the hull that contacts see")
      ->capture_default_str();
  app.add_flag("--subset", keepSubset,
               "leave a reduced hull inside the full one instead of scaling it to the full volume");
  app.add_flag("--exact", exact, "mass properties of the closed mesh itself, contacts with its full hull");
  granular::SphereFitOptions fit;
  auto* spheres = app.add_option("--clump", fit.count, "fit this many spheres to the closed mesh as well")
                      ->check(CLI::PositiveNumber);
  auto* error = app.add_option("--clump-error", fit.volumeError,
                               "as many spheres as leave less than this part of the mesh's volume empty")
                    ->check(CLI::Range(1e-3, 1.0))
                    ->excludes(spheres);
  app.add_option("--clump-cells", fit.cells, "cells of the fit's grid along the longest edge")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  options.use = exact ? granular::RockUse::exact : granular::RockUse::hull;
  options.matchVolume = !keepSubset;
  run(mesh, out, options, *spheres || *error ? &fit : nullptr);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("rock", [&] { return parseAndRun(argc, argv); });
}
