#include "granular/analysis/contact_network.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "granular/core/errors.h"

namespace granular {

namespace {

/// Compressive normal force of a contact, N: the force on a points against the normal from a to b.
double takeNormalForce(const BedContact& contact) { return -contact.force.dot(contact.normal); }

/// Distinct touching pairs of particles (a < b), sorted.
std::vector<std::pair<std::int32_t, std::int32_t>> collectPairs(const Bed& bed) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  for (const BedContact& contact : bed.contacts)
    if (contact.b >= 0) pairs.emplace_back(std::min(contact.a, contact.b), std::max(contact.a, contact.b));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Takes particles with fewer than two supports away until none is left to take.
void findRattlers(const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs, ContactNetwork& network) {
  const std::size_t n = network.neighbours.size();
  std::vector<std::vector<std::int32_t>> touching(n);
  for (const auto& [a, b] : pairs) {
    touching[static_cast<std::size_t>(a)].push_back(b);
    touching[static_cast<std::size_t>(b)].push_back(a);
  }
  std::vector<std::int32_t> supports(n);
  std::vector<std::size_t> queue;
  for (std::size_t i = 0; i < n; ++i) {
    supports[i] = network.neighbours[i] + network.wallContacts[i];
    if (supports[i] < 2) queue.push_back(i);
  }
  network.rattler.assign(n, 0);
  while (!queue.empty()) {
    const std::size_t i = queue.back();
    queue.pop_back();
    if (network.rattler[i]) continue;
    network.rattler[i] = 1;
    ++network.rattlers;
    for (const std::int32_t j : touching[i])
      if (--supports[static_cast<std::size_t>(j)] < 2) queue.push_back(static_cast<std::size_t>(j));
  }

  // The mean over what is left.
  std::size_t held = 0;
  for (const auto& [a, b] : pairs)
    if (!network.rattler[static_cast<std::size_t>(a)] && !network.rattler[static_cast<std::size_t>(b)]) held += 2;
  if (network.rattlers < n)
    network.coordinationHeld = static_cast<double>(held) / static_cast<double>(n - network.rattlers);
}

/// Overlaps, forces and fabric.
void measureContacts(const Bed& bed, ContactNetwork& network) {
  double relative = 0, force = 0, strongest = 0;
  for (const BedContact& contact : bed.contacts) {
    const bool wall = contact.b < 0;
    double size = bed.shapes[static_cast<std::size_t>(contact.a)]->size();
    if (!wall) size = std::min(size, bed.shapes[static_cast<std::size_t>(contact.b)]->size());
    network.largestOverlap = std::max(network.largestOverlap, contact.overlap);
    network.largestRelativeOverlap = std::max(network.largestRelativeOverlap, contact.overlap / size);
    relative += contact.overlap / size;
    const Mat3 square = contact.normal * contact.normal.transpose();
    network.fabricWithWalls += square;
    if (wall) continue;
    network.fabric += square;
    force += takeNormalForce(contact);
    strongest = std::max(strongest, takeNormalForce(contact));
  }
  if (bed.contacts.empty()) return;
  network.meanRelativeOverlap = relative / static_cast<double>(bed.contacts.size());
  network.fabricWithWalls /= static_cast<double>(bed.contacts.size());
  if (network.particleContacts == 0) return;
  network.fabric /= static_cast<double>(network.particleContacts);
  network.meanNormalForce = force / static_cast<double>(network.particleContacts);
  network.largestNormalForce = strongest;
}

}  // namespace

ContactNetwork analyseContacts(const Bed& bed) {
  const auto n = static_cast<std::int32_t>(bed.size());
  ContactNetwork network;
  network.neighbours.assign(bed.size(), 0);
  network.wallContacts.assign(bed.size(), 0);
  for (const BedContact& contact : bed.contacts) {
    require(contact.a >= 0 && contact.a < n && contact.b < n && contact.a != contact.b,
            "bed: a contact names particles " + std::to_string(contact.a) + " and " + std::to_string(contact.b) +
                " of " + std::to_string(n));
    if (contact.b >= 0) {
      ++network.particleContacts;
      continue;
    }
    ++network.wallContactCount;
    if (network.wallContacts[static_cast<std::size_t>(contact.a)]++ == 0) ++network.particlesAtWalls;
  }
  const auto pairs = collectPairs(bed);
  for (const auto& [a, b] : pairs) {
    ++network.neighbours[static_cast<std::size_t>(a)];
    ++network.neighbours[static_cast<std::size_t>(b)];
  }
  network.pairs = pairs.size();
  if (n > 0) network.coordination = 2.0 * static_cast<double>(pairs.size()) / n;
  findRattlers(pairs, network);
  measureContacts(bed, network);
  return network;
}

Table tabulateCoordination(const ContactNetwork& network) {
  Table table{
      "coordination",
      "Particles by number of touching particles (a pair counts once, walls are not counted): all particles, and "
      "those that touch no wall; number and share.",
      {"neighbours", "particles", "share", "particles_off_walls", "share_off_walls"},
      {}};
  std::int32_t most = 0;
  for (const std::int32_t z : network.neighbours) most = std::max(most, z);
  std::vector<double> all(static_cast<std::size_t>(most) + 1), inside(all.size());
  double insideTotal = 0;
  for (std::size_t i = 0; i < network.neighbours.size(); ++i) {
    const auto z = static_cast<std::size_t>(network.neighbours[i]);
    all[z] += 1;
    if (network.wallContacts[i] > 0) continue;
    inside[z] += 1;
    insideTotal += 1;
  }
  const double total = static_cast<double>(network.neighbours.size());
  for (std::size_t z = 0; z < all.size(); ++z)
    table.rows.push_back({static_cast<double>(z), all[z], all[z] / total, inside[z], inside[z] / insideTotal});
  return table;
}

Table tabulateFabric(const ContactNetwork& network) {
  Table table{
      "fabric",
      "Fabric tensor <n n^T> of the contact normals (trace 1; isotropic: 1/3 each). Rows: contacts between particles; "
      "contacts with walls too. Eigenvalues ascending; deviator: sqrt(3/2 D:D) of the deviatoric part D.",
      {"contacts", "xx", "yy", "zz", "xy", "xz", "yz", "eigenvalue_1", "eigenvalue_2", "eigenvalue_3", "deviator"},
      {}};
  const auto add = [&](const Mat3& f, std::size_t contacts) {
    if (contacts == 0) return;
    const Vec3 e = Eigen::SelfAdjointEigenSolver<Mat3>(f, Eigen::EigenvaluesOnly).eigenvalues();
    const double deviator = std::sqrt(1.5) * (f - Mat3::Identity() / 3).norm();
    table.rows.push_back({static_cast<double>(contacts), f(0, 0), f(1, 1), f(2, 2), f(0, 1), f(0, 2), f(1, 2), e[0],
                          e[1], e[2], deviator});
  };
  add(network.fabric, network.particleContacts);
  add(network.fabricWithWalls, network.particleContacts + network.wallContactCount);
  return table;
}

Table tabulateForces(const Bed& bed, double bin) {
  Table table{"forces",
              "Probability density of the compressive normal force over its mean, f/<f>, per contact: contacts between "
              "particles, and contacts with walls over their own mean. Contacts without compression are left out; the "
              "last bin holds everything above.",
              {"force_over_mean", "density_particles", "density_walls"},
              {}};
  std::array<std::vector<double>, 2> forces;
  for (const BedContact& contact : bed.contacts)
    if (takeNormalForce(contact) > 0) forces[contact.b < 0 ? 1 : 0].push_back(takeNormalForce(contact));

  // Everything above ten means shares the last bin, so that the densities integrate to one.
  const auto bins = static_cast<std::size_t>(std::ceil(10 / bin));
  std::array<std::vector<double>, 2> density;
  for (std::size_t k = 0; k < 2; ++k) {
    density[k].assign(bins, 0.0);
    double mean = 0;
    for (const double f : forces[k]) mean += f / static_cast<double>(forces[k].size());
    for (const double f : forces[k])
      density[k][static_cast<std::size_t>(std::min(f / mean / bin, static_cast<double>(bins - 1)))] +=
          1 / (static_cast<double>(forces[k].size()) * bin);
  }
  for (std::size_t b = 0; b < bins; ++b)
    table.rows.push_back({(static_cast<double>(b) + 0.5) * bin, density[0][b], density[1][b]});
  if (forces[0].empty() && forces[1].empty()) table.rows.clear();
  return table;
}

}  // namespace granular
