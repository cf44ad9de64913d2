#include "granular/mesh/rock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"

namespace granular {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw InputError("mesh " + path + ": " + reason);
}

void checkOptions(const std::string& path, const RockOptions& options) {
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  const auto wanted = [&](double value) { return value == 0 || positive(value); };
  if (!positive(options.scale)) refuse(path, fmt::format("scale {} must be positive and finite", options.scale));
  if (!wanted(options.longestExtent))
    refuse(path, fmt::format("longest extent {} m must be positive and finite", options.longestExtent));
  if (!wanted(options.equalVolumeDiameter)) {
    refuse(path, fmt::format("equal-volume diameter {} m must be positive and finite", options.equalVolumeDiameter));
  }
  if (options.longestExtent > 0 && options.equalVolumeDiameter > 0) {
    refuse(path, "both a longest extent and an equal-volume diameter are asked for; give one");
  }
  if (options.vertexBudget < 4) refuse(path, fmt::format("vertex budget {}; at least 4", options.vertexBudget));
}

// What can't be used as a body in any way.
void checkUsable(const std::string& path, const RepairedMesh& repaired) {
  const MeshDefects& defects = repaired.defects;
  if (defects.nonFiniteVertices > 0) {
    refuse(path, fmt::format("{} vertices have a coordinate that is NaN or infinite; allowed are none",
                             defects.nonFiniteVertices));
  }
  if (repaired.mesh.triangles.empty()) refuse(path, "is flat or empty: no triangle with an area");
  // Rounded to single precision, the shape must still be there.
  Aabb box;
  for (const Vec3& v : repaired.mesh.vertices) box.include(v);
  constexpr double coarsest = 1e-3;
  const double extent = (box.hi - box.lo).maxCoeff();
  if (defects.coordinateStep > coarsest * extent) {
    refuse(path,
           fmt::format(
               "lies too far from its origin: single precision resolves {:.3g} there, the mesh measures {:.3g} (file "
               "units); at most {} of it is allowed: move it to its centre",
               defects.coordinateStep, extent, coarsest));
  }
}

std::string whyNotExact(const RepairedMesh& repaired) {
  if (repaired.defects.unorientableEdges > 0) {
    return fmt::format("its surface can't be oriented ({} edges)", repaired.defects.unorientableEdges);
  }
  if (!repaired.kept.closed) {
    return fmt::format("it is open: {} open and {} non-manifold edges", repaired.kept.openEdges,
                       repaired.kept.nonManifoldEdges);
  }
  return "";
}

ConvexHull hullOf(const std::string& path, const TriangleMesh& mesh) try {
  return convexHull(mesh.vertices);
} catch (const InputError& error) {
  refuse(path, std::string("is flat: no convex hull with a volume (") + error.what() + ")");
}

// The hull's polyhedron with the mass properties of the mesh inside it, and their frame.
class ExactRock final : public Polyhedron {
 public:
  ExactRock(const ConvexHull& hull, const SolidProperties& solid) : Polyhedron(ShapeKind::polyhedron) {
    const Frame frame = solid.frame();
    std::vector<Vec3> points;
    double bounding = 0, diameter = 0;
    for (const Vec3& v : hull.vertices) points.push_back(frame.toBody(v));
    for (std::size_t a = 0; a < points.size(); ++a) {
      bounding = std::max(bounding, points[a].norm());
      for (std::size_t b = 0; b < a; ++b) diameter = std::max(diameter, (points[a] - points[b]).squaredNorm());
    }
    topology = makePolyhedronTables(std::move(points), hull.faces);
    findOctantVertices();
    const double inner = topology.leastOffset();
    setMeasures(solid.principal, bounding, inner, std::sqrt(diameter), distinctAxis(solid.principal.inertia, false));
  }
};

void scaleMesh(TriangleMesh& mesh, double factor) {
  for (Vec3& v : mesh.vertices) v *= factor;
}

std::shared_ptr<const Polyhedron> makeBody(const ConvexHull& hull, const TriangleMesh& mesh, RockUse use,
                                           double factor) {
  ConvexHull scaled = hull;
  for (Vec3& v : scaled.vertices) v *= factor;
  if (use == RockUse::hull) return std::make_shared<const Polyhedron>(scaled.vertices);
  TriangleMesh solid = mesh;
  scaleMesh(solid, factor);
  return std::make_shared<const ExactRock>(scaled, solidProperties(solid.vertices, solid.triangles));
}

// The factor that brings the body to its target size.
double targetFactor(const RockOptions& options, const Polyhedron& body) {
  if (options.longestExtent > 0) return options.longestExtent / body.longestExtent();
  if (options.equalVolumeDiameter > 0) return options.equalVolumeDiameter / (2 * body.size());
  return 1;
}

void measureMesh(const Rock& rock, RockReport& report) {
  const TriangleMesh& mesh = rock.mesh;
  Aabb box;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& v : mesh.vertices) {
    box.include(v);
    middle += v / static_cast<double>(mesh.vertices.size());
  }
  report.box = box.hi - box.lo;
  report.vertices = static_cast<std::int64_t>(mesh.vertices.size());
  report.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  // About the middle of its vertices: what an open mesh lacks is then the cones over its holes.
  std::vector<Vec3> centred = mesh.vertices;
  for (Vec3& v : centred) v -= middle;
  report.meshVolume = signedVolume(centred, mesh.triangles);
  report.meshArea = surfaceArea(mesh.vertices, mesh.triangles);
  if (report.whyNotExact.empty()) report.meshInertia = solidProperties(mesh.vertices, mesh.triangles).principal.inertia;
  report.hullVolume = signedVolume(rock.hull.vertices, rock.hull.triangles);
  report.hullArea = surfaceArea(rock.hull.vertices, rock.hull.triangles);
  report.hullVertices = static_cast<std::int64_t>(rock.hull.vertices.size());
  report.convexity = report.meshVolume / report.hullVolume;
}

void measureBody(const Rock& rock, const HullReduction& reduction, double factor, RockReport& report) {
  const double volumeFactor = factor * factor * factor;
  report.bodyVertices = rock.body->tables().vertexCount();
  report.contactVolume = reduction.volume * volumeFactor;
  report.subsetVolume = reduction.subsetVolume * volumeFactor;
  report.reductionScale = reduction.scale;
  report.volumeError = reduction.volumeError;
  report.symmetricDifference = reduction.symmetricDifference;
  report.outside = reduction.outside * factor;
  report.inside = reduction.inside * factor;
  report.body = rock.body->massProperties();
  report.longestExtent = rock.body->longestExtent();
  report.equalVolumeDiameter = 2 * rock.body->size();
}

void addWarnings(RockReport& report) {
  if (!report.whyNotExact.empty()) {
    report.warnings.push_back(
        fmt::format("can't be an exact body: {}; used as its hull, whose volume mass and solid fraction use "
                    "({:.6g} m^3; the open mesh encloses about {:.6g} m^3)",
                    report.whyNotExact, report.hullVolume, report.meshVolume));
  }
  if (report.convexity < convexityWarning) {
    report.warnings.push_back(
        fmt::format("convexity {:.3f} is below {}: contacts see a hull {:.0f} % larger than the rock, without its "
                    "hollows; alternatives: accept the hull, a clump of spheres fitted to the mesh, or convex "
                    "pieces of your own",
                    report.convexity, convexityWarning, 100 * (1 / report.convexity - 1)));
  }
  if (report.kept.droppedArea > 0.1) {
    report.warnings.push_back(
        fmt::format("a part with {:.0f} % of the kept part's area was dropped; one file makes one body",
                    100 * report.kept.droppedArea));
  }
  if (report.kept.handles > 0) {
    report.warnings.push_back(fmt::format("the surface has {} handles (tunnels)", report.kept.handles));
  }
}

// Reads, repairs and measures; an inexact mesh is refused if `strict`, otherwise used as its hull.
Rock prepareRock(const std::string& path, RockOptions options, bool strict) {
  checkOptions(path, options);
  const double unit = metresPerUnit(options.unit) * options.scale;
  const RawMesh raw = importMesh(path);
  RepairedMesh repaired = repairMesh(raw);
  checkUsable(path, repaired);

  Rock rock;
  RockReport& report = rock.report;
  report.path = path;
  report.format = formatName(raw.format);
  report.bytes = raw.bytes;
  report.verticesRead = raw.file ? raw.file->listed : static_cast<std::int64_t>(raw.vertices.size());
  report.trianglesRead = static_cast<std::int64_t>(raw.triangles.size());
  report.otherPrimitives = raw.otherPrimitives;
  report.defects = repaired.defects;
  report.kept = repaired.kept;
  report.whyNotExact = whyNotExact(repaired);
  rock.mesh = std::move(repaired.mesh);

  // The hull in file units; a closed mesh without volume is folded paper, whatever its hull.
  const ConvexHull hull = hullOf(path, rock.mesh);
  const double volume = signedVolume(rock.mesh.vertices, rock.mesh.triangles);
  if (report.whyNotExact.empty() && !(volume > tolerance::zeroVolume * hullVolume(hull))) {
    refuse(path,
           fmt::format("has no volume: {:.3g} inside a hull of {:.3g} (file units cubed)", volume, hullVolume(hull)));
  }
  if (options.use == RockUse::exact && !report.whyNotExact.empty()) {
    if (strict) refuse(path, "can't be an exact body: " + report.whyNotExact + "; use its hull, or mend the file");
    options.use = RockUse::hull;
  }

  // The polyhedron that contacts see, brought to its size.
  HullReduction reduction;
  const int budget = options.use == RockUse::exact ? static_cast<int>(hull.vertices.size()) : options.vertexBudget;
  reduction = reduceHull(hull, {budget, options.matchVolume});
  report.use = options.use;
  report.reduced = reduction.hull.vertices.size() < hull.vertices.size();
  const double factor = unit * targetFactor(options, *makeBody(reduction.hull, rock.mesh, options.use, unit));
  report.metresPerFileUnit = factor;
  rock.body = makeBody(reduction.hull, rock.mesh, options.use, factor);
  rock.hull = hullMesh(hull);
  rock.contactHull = hullMesh(reduction.hull);
  for (TriangleMesh* mesh : {&rock.mesh, &rock.hull, &rock.contactHull}) scaleMesh(*mesh, factor);

  measureMesh(rock, report);
  measureBody(rock, reduction, factor, report);
  addWarnings(report);
  return rock;
}

}  // namespace

Rock loadRock(const std::string& path, const RockOptions& options) { return prepareRock(path, options, true); }

RockReport analyseMesh(const std::string& path, const RockOptions& options) {
  return prepareRock(path, options, false).report;
}

SphereFit fitSpheres(const Rock& rock, const SphereFitOptions& options) {
  require(rock.report.whyNotExact.empty(), rock.report.path + ": no clump: " + rock.report.whyNotExact);
  return fitSpheres(rock.mesh, options);
}

std::shared_ptr<const Polyhedron> makeRock(const std::string& path, const RockOptions& options, RockReport* report) {
  Rock rock = loadRock(path, options);
  if (report != nullptr) *report = rock.report;
  return rock.body;
}

}  // namespace granular
