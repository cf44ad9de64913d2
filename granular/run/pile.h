// The piling problem of Markauskas et al., Granular Matter 12, 107 (2010), section 4 (M): ellipsoids, or clumps of
// spheres in their place, dropped one by one beside a wall in a plane; and a cone in space, from a hopper.
//
// A pile is a packing from a scene of its own, so that it has checkpoints, sleep and reports like any other. Where M
// leaves things open:
//   * "10 s after the last particle" is a limit: the run ends when the pile is at rest.
//   * The side and the floor are of the particles' material.
//   * The time step is a part of the stability bound unless given (M: 2e-6 s).
//   * What is measured: analysis/pile.h.
#pragma once

#include <filesystem>
#include <string>

#include "granular/io/result.h"
#include "granular/run/packing_run.h"

namespace granular {

/// Defaults: M table 1 and section 4.1.
struct PileSettings {
  enum class Shape { ellipsoid, clump };
  Shape shape = Shape::ellipsoid;
  std::int64_t spheres = 17;  ///< clump: on the axis of the ellipsoid, an odd number
  std::int64_t count = 1000;
  std::int64_t seed = 1;
  double halfLength = 2.7e-3, halfWidth = 1.15e-3;  ///< semi-axes, m
  double mass = 2e-5;                               ///< of a particle, kg; inertia: the ellipsoid's
  double young = 183e6, poisson = 0.2;
  double friction = 0.3;
  double damping = 100;        ///< eta_n = eta_t, 1/s
  double height = 0.15;        ///< of the drop, m
  double spread = 1e-4;        ///< of the centre's place, m
  double interval = 0.04;      ///< between two particles, s
  double rest = 10;            ///< longest wait after the last one, s
  double sleep = 0;            ///< energy of the mean motion over m g d below which a particle may sleep; 0: none.
                               ///< Sleepers don't feel the shaking of every impact.
  std::optional<double> step;  ///< s; not given: half of the stability bound

  // A cone in space.
  bool space = false;
  double orifice = 30e-3;  ///< diameter, m
  double outlet = 60e-3;   ///< height of the orifice above the floor, m
};

/// Throws InputError for a count, a length or a number of spheres out of range, naming it.
void checkPile(const PileSettings& settings);

/// The deepest overlap of a fall from the height on the flattest place, over the size (law/hertz.h).
double expectedOverlap(const PileSettings& settings);

/// The scene. folder: where the hopper's mesh is (writeHopper); only named in a scene in space.
std::string formatPileScene(const PileSettings& settings);

/// The hopper of a cone: a funnel at 60 degrees to the floor under a shaft, open at both ends, with walls of some
/// thickness; written as folder/hopper.obj, m.
void writeHopper(const PileSettings& settings, const std::filesystem::path& folder);

/// What is measured of a pile.
struct PileResult {
  std::optional<double> angle, angleError;  ///< degrees
  std::optional<double> baseAngle;          ///< by the middle of the base, degrees
  std::optional<double> from, to, top;      ///< of the fitted line, m
  std::optional<double> height;             ///< m
  /// Of the right triangle with the height of a pile in the plane and its area, degrees.
  std::optional<double> triangleAngle;
  std::optional<double> porosity;        ///< of the sections as they are ("MS"); a pile in the plane alone
  std::optional<double> porositySmooth;  ///< with the ellipsoids' sections ("MS ellipse")
  double coordinationParticles = 0;      ///< particles touched by a particle, mean
  double coordinationSpheres = 0;        ///< contacts of a particle's children with others', mean
  double potentialContacts = 0;  ///< pairs of particles, or of children, near enough to be looked at, per particle
};

/// Measures the pile of a run, writes surface.csv, pile.json (for the picture) and the report of the packing with the
/// pile's numbers on top of result.json. The folder exists. told receives what result.json tells, when given.
PileResult writePileReport(const PackingRun& run, RunEnd end, int threads, const std::filesystem::path& out,
                           RunResult* told = nullptr);

/// For people, in lines.
std::string formatPile(const PileResult& result);

}  // namespace granular
