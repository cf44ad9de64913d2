// Who touches whom, and how hard: coordination number, fabric tensor, contact forces, overlaps.
#pragma once

#include <optional>

#include "granular/analysis/bed.h"
#include "granular/analysis/table.h"

namespace granular {

struct ContactNetwork {
  /// Distinct particles in touch, per particle; a pair counts once however many contacts it has. Walls are not
  /// neighbours.
  std::vector<std::int32_t> neighbours;
  /// Contacts with walls, per particle (a flat face on a cylinder has several).
  std::vector<std::int32_t> wallContacts;
  /// Touches too little to be held: fewer than two touching bodies that are no rattlers themselves (each wall contact
  /// counts as one).
  std::vector<std::uint8_t> rattler;

  double coordination = 0;  ///< mean of neighbours over all particles
  std::optional<double>
      coordinationHeld;  ///< mean over particles that are no rattlers, contacts with rattlers left out
  std::size_t rattlers = 0, pairs = 0, particleContacts = 0, wallContactCount = 0, particlesAtWalls = 0;

  double largestOverlap = 0;  ///< m, walls included
  double largestRelativeOverlap =
      0;  ///< overlap / the smaller size (radius of the sphere of equal volume) of the two bodies
  double meanRelativeOverlap = 0;                             ///< over all contacts
  std::optional<double> meanNormalForce, largestNormalForce;  ///< over contacts between particles, N

  Mat3 fabric = Mat3::Zero();           ///< <n n^T> over contacts between particles; trace 1
  Mat3 fabricWithWalls = Mat3::Zero();  ///< the same with the contacts with walls
};

/// Throws InputError for a contact that names a particle that does not exist.
ContactNetwork analyseContacts(const Bed& bed);

/// Number and share of particles for each number of neighbours: all, and those away from walls.
Table tabulateCoordination(const ContactNetwork& network);
/// The fabric tensor's components, eigenvalues and deviator.
Table tabulateFabric(const ContactNetwork& network);
/// Probability density of the compressive normal force over its mean: contacts between particles, contacts with walls.
Table tabulateForces(const Bed& bed, double bin);

}  // namespace granular
