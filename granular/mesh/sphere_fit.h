// Any closed mesh as a clump: a greedy fit by inscribed spheres, each the one that fills most of what is still empty.
#pragma once

#include <string>
#include <vector>

#include "granular/shape/clump.h"

namespace granular {

struct SphereFitOptions {
  int count = 0;            ///< spheres; 0: as many as volumeError needs
  double volumeError = 0;   ///< with count = 0: the part of the mesh's volume that inscribed spheres may leave empty
  int mostSpheres = 2000;   ///< with count = 0: refused beyond
  bool matchVolume = true;  ///< all radii grow by one length until the union has the mesh's volume
  int cells = 48;           ///< of the grid along the longest edge of the mesh's box
};

/// The fit and how good it is; errors are (clump - mesh) / mesh.
struct SphereFit {
  std::vector<ChildSphere> spheres;  ///< in the coordinates of the mesh, m
  SolidProperties mesh, clump;       ///< of the closed mesh, and of the union of the spheres
  double empty = 0;                  ///< part of the mesh's volume outside the inscribed spheres
  double growth = 0;                 ///< added to all radii, m
  double volumeError = 0, areaError = 0;
  double inertiaError = 0;         ///< largest entry of the difference of both tensors over the mesh's largest moment
  double centroidShift = 0;        ///< of the two centres of mass, over the radius of the sphere of equal volume
  double symmetricDifference = 0;  ///< volume inside exactly one of both over the mesh's, counted on the grid
  int parts = 1;                   ///< of the clump that don't hang together
};

/// The fit in lines for people, and as JSON with SI units and stable keys (errors as fractions) for programs.
std::string formatFit(const SphereFit& fit);
std::string fitToJson(const SphereFit& fit);

/// Fits spheres to a closed mesh, triangles counter-clockwise seen from outside. Throws InputError for options out of
/// range, a mesh without volume, a mesh too thin for the grid, and an error not reached with mostSpheres.
SphereFit fitSpheres(const TriangleMesh& mesh, const SphereFitOptions& options);

}  // namespace granular
