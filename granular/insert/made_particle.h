// Particles made up from random numbers: sand and woodchips as S makes them (section 8.1).
//
// Sand: 5 to 20 points placed at random on a sphere or a prolate ellipsoid (uniform over its area) repel each other as
// charges do and slide over the surface; the slide is stopped before it ends, so that no two particles of as many
// points are alike; their hull is the particle. S says neither how large the template is nor when to stop. Chosen here:
// a template of radius 1.5 mm (the half-width of S's other particles), and a stop half-way along the path to rest.
//
// Woodchips: four random points on a circle at one end, four on a wider one at the other (S section 8.1.2).
//
// A draw that comes out flat, or with two points so close that they are one, is drawn again and counted.
#pragma once

#include <cstdint>
#include <memory>

#include "granular/core/random.h"
#include "granular/shape/polyhedron.h"

namespace granular {

struct SandOptions {
  double radius = 1.5e-3;  ///< minor semi-axis of the template, m
  double aspect = 1;       ///< major over minor semi-axis of the template: 1 is the sphere; S's ellipsoid has 3
  int minPoints = 5, maxPoints = 20;
  double spread = 0.5;  ///< how far the repulsion is followed: fraction of the path to rest, 0 to 1
};

struct WoodchipOptions {
  double minLength = 5e-3, maxLength = 7e-3;    ///< m
  double minThin = 0.4e-3, maxThin = 0.7e-3;    ///< radius of the circle at one end, m
  double minThick = 1.0e-3, maxThick = 1.3e-3;  ///< radius of the circle at the other end, m
};

/// Both throw InputError for a length that is not positive, an empty range, fewer than 4 points, or a spread outside 0
/// to 1. redrawn, when given, is raised by the number of degenerate draws.
std::unique_ptr<Polyhedron> makeSand(const SandOptions& options, Random& random, std::uint64_t* redrawn = nullptr);
std::unique_ptr<Polyhedron> makeWoodchip(const WoodchipOptions& options, Random& random,
                                         std::uint64_t* redrawn = nullptr);

/// Bounds of longestExtent() of whatever the two can make, m.
double longestSand(const SandOptions& options);
double longestWoodchip(const WoodchipOptions& options);

/// The points of a sand particle before the hull is taken, m: on the template, slid along `spread` of their path to
/// rest.
std::vector<Vec3> spreadPoints(const SandOptions& options, int count, Random& random);

}  // namespace granular
