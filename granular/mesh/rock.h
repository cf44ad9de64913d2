// From a scanned mesh to a convex body, with a report on everything that happened on the way: import, repair, mass
// properties by signed tetrahedra, convex hull, reduction to a vertex budget.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "granular/mesh/reduction.h"
#include "granular/mesh/repair.h"
#include "granular/mesh/sphere_fit.h"
#include "granular/shape/polyhedron.h"

namespace granular {

/// What the body takes from the mesh. Contacts always see a convex polyhedron.
enum class RockUse {
  hull,  ///< the hull, reduced to the vertex budget, solid throughout: mass and solid fraction use its volume
  exact  ///< the full hull for contacts; volume, centre of mass, inertia and <r^2> of the closed mesh itself
};

struct RockOptions {
  std::string unit = "m";          ///< of the file's coordinates: m, dm, cm, mm, um, nm, km, in, ft
  double scale = 1;                ///< applied to the coordinates, > 0
  double longestExtent = 0;        ///< if > 0: then scaled so that the body's longest extent is this, m
  double equalVolumeDiameter = 0;  ///< if > 0: then scaled so that a sphere of this diameter has the body's volume, m
  int vertexBudget = 60;           ///< of the hull that contacts see; at least 4
  bool matchVolume = true;         ///< a reduced hull is scaled to the volume of the full one
  RockUse use = RockUse::hull;
};

/// Everything measured. Lengths in m after unit and scale, volumes in m^3.
struct RockReport {
  std::string path;
  std::string format;
  std::int64_t bytes = 0;
  std::int64_t verticesRead = 0;     ///< as the file lists them; three per triangle in STL
  std::int64_t trianglesRead = 0;    ///< polygons count as the triangles they are cut into
  std::int64_t otherPrimitives = 0;  ///< points and lines, left out
  double metresPerFileUnit = 1;      ///< unit, scale and target together: file coordinate times this is metres

  MeshDefects defects;  ///< distances here in file units
  KeptPart kept;
  std::int64_t vertices = 0;  ///< of the kept part
  std::int64_t triangles = 0;

  double meshVolume = 0;  ///< enclosed by the kept part; an estimate when it is open
  double meshArea = 0;
  Vec3 meshInertia = Vec3::Zero();  ///< principal moments per density, m^5; zero when it is open
  Vec3 box = Vec3::Zero();          ///< extents along the file's axes
  double hullVolume = 0;            ///< of the full hull
  double hullArea = 0;
  std::int64_t hullVertices = 0;
  double convexity = 0;  ///< meshVolume / hullVolume

  RockUse use = RockUse::hull;
  bool reduced = false;           ///< the hull had more vertices than the budget
  std::int64_t bodyVertices = 0;  ///< of the polyhedron that contacts see
  double contactVolume = 0;       ///< of that polyhedron
  double subsetVolume = 0;        ///< before it was scaled to the full hull's volume
  double reductionScale = 1;
  double volumeError = 0;          ///< (contactVolume - hullVolume) / hullVolume
  double symmetricDifference = 0;  ///< volume inside exactly one of hull and reduced hull, as a fraction of the hull's
  double outside = 0;              ///< how far the hull stands out, at most, over the reduced hull's faces, m
  double inside = 0;               ///< how far the reduced hull stands out, at most, over the hull's faces, m
  MassProperties body;             ///< that mass and solid fraction use
  double longestExtent = 0;        ///< of the body
  double equalVolumeDiameter = 0;  ///< of the body

  std::string whyNotExact;  ///< empty when the mesh can be an exact body
  std::vector<std::string> warnings;
};

/// A rock and what it was made from, in metres; mesh, hull and contactHull in the frame of the file.
struct Rock {
  RockReport report;
  TriangleMesh mesh;         ///< the kept part
  TriangleMesh hull;         ///< its full hull
  TriangleMesh contactHull;  ///< the reduced hull that contacts see
  std::shared_ptr<const Polyhedron> body;
};

/// Reads a mesh and makes the body. Throws InputError naming the file and the reason: whatever importMesh throws,
/// vertices that are not finite, a mesh that is flat or without volume, coordinates too coarse for the extent, an open
/// or unorientable mesh asked for as an exact body, and options outside their range.
Rock loadRock(const std::string& path, const RockOptions& options);

/// The report alone. An open mesh asked for as an exact body is reported (whyNotExact), not refused.
RockReport analyseMesh(const std::string& path, const RockOptions& options);

/// The body alone; the report too if wanted.
std::shared_ptr<const Polyhedron> makeRock(const std::string& path, const RockOptions& options,
                                           RockReport* report = nullptr);

/// Spheres in place of the mesh of the rock. Throws InputError naming the file if the mesh can't be an exact body, and
/// whatever fitSpheres of a mesh throws.
SphereFit fitSpheres(const Rock& rock, const SphereFitOptions& options);

/// The report for people, in lines, and for programs, as JSON with SI units and stable keys.
std::string formatReport(const RockReport& report);
std::string reportToJson(const RockReport& report);

/// Below this convexity a warning names the alternatives to the hull.
inline constexpr double convexityWarning = 0.9;

}  // namespace granular
