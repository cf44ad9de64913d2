#include "granular/run/encounter.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "granular/core/errors.h"
#include "granular/narrow/gjk.h"

namespace granular {
namespace {

using Kind = VelocityEnsemble::Kind;

constexpr std::array<VelocityEnsemble, 7> ensembles = {{
    {"gaussian", "flux-weighted; Gaussian velocities, Gaussian spins with the same deviation of the surface speed",
     Kind::gaussian, 1},
    {"thermal", "flux-weighted; Gaussian velocities and spins, equal energy in each degree of freedom", Kind::thermal,
     1},
    {"fast_spin", "as gaussian with ten times the spin", Kind::gaussian, 10},
    {"slow_spin", "as gaussian with a tenth of the spin", Kind::gaussian, 0.1},
    {"no_spin", "as gaussian without spin", Kind::gaussian, 0},
    {"head_on", "no spin, centres meet head-on, random orientations", Kind::headOn, 0},
    {"normal", "no spin, the relative velocity along the normal of the contact, poses as gaussian", Kind::normal, 0},
}};

/// Deviations of the velocities of one body.
struct Deviation {
  double velocity = 0;
  Vec3 spin = Vec3::Zero();  // body axes
};

Deviation deviationOf(const Collider& body, double reducedMass, const VelocityEnsemble& ensemble, double speed) {
  Deviation sigma;
  if (ensemble.kind == Kind::thermal) {
    // Temperature such that a body of the reduced mass moves with `speed`.
    const double temperature = reducedMass * speed * speed;
    sigma.velocity = std::sqrt(temperature / body.mass);
    sigma.spin = (temperature * body.inertia.cwiseInverse()).cwiseSqrt();
  } else {
    sigma.velocity = speed;
    sigma.spin.setConstant(ensemble.spin * speed / body.shape->size());
  }
  return sigma;
}

/// Moves B along the unit direction d until it touches A; false if it passes by. Conservative advancement: no gap
/// closes faster than the motion along its separating direction.
bool moveToTouch(const Vec3& d, Encounter& e) {
  Collider &a = e.bodies[0], &b = e.bodies[1];
  const Frame frameA(a.pose);
  const double size = std::min(a.shape->size(), b.shape->size());
  Vec3 guess = frameA.unrotate(b.pose.x - a.pose.x);
  for (int k = 0; k < 200; ++k) {
    Difference c(*a.shape, frameA, *b.shape, Frame(b.pose));
    const Nearest nearest = findNearest(c, Vec3::Zero(), guess, 1e-10);
    if (nearest.inside) return false;
    const Vec3 normal = frameA.rotate(nearest.direction);
    const double rate = -d.dot(normal);
    if (rate <= 0) return false;
    guess = nearest.direction;
    // Half the gap asked for is left open: at zero there is no direction to see.
    if (nearest.gap > 1e-6 * size) {
      b.pose.x += ((nearest.gap - 0.5e-6 * size) / rate) * d;
      continue;
    }
    // Close the rest along the normal, so that it stays the normal.
    b.pose.x -= nearest.gap * normal;
    e.normal = normal;
    e.point = frameA.toWorld(nearest.onA);
    return true;
  }
  return false;
}

/// Random orientations, and B at the end of a random line of approach. Isotropic lines that are uniform across meet a
/// convex surface uniformly by area.
bool drawTouch(bool central, Random& random, Encounter& e) {
  Collider &a = e.bodies[0], &b = e.bodies[1];
  a.pose = {Vec3::Zero(), random.rotation()};
  const Vec3 d = random.direction();
  const double reach = a.shape->boundingRadius() + b.shape->boundingRadius();
  const double radius = central ? 0 : reach * std::sqrt(random.uniform()), angle = random.uniform(0, 2 * pi);
  const Vec3 u = perpendicular(d);
  b.pose.q = random.rotation();
  b.pose.x = radius * (std::cos(angle) * u + std::sin(angle) * d.cross(u)) - 1.5 * reach * d;
  return moveToTouch(d, e);
}

/// Approach speed per velocity and spin (body axes) of body k.
struct Sensitivity {
  Vec3 velocity, spin;
};
Sensitivity sensitivityOf(const Encounter& e, int k) {
  const Collider& body = e.bodies[static_cast<std::size_t>(k)];
  const Vec3 n = k == 0 ? e.normal : Vec3(-e.normal);
  return {n, body.pose.q.conjugate() * (e.point - body.pose.x).cross(n)};
}

/// Velocities of an encounter drawn with weight max(u_n, 0); false if the configuration is to be drawn anew.
bool drawFlux(const std::array<Deviation, 2>& sigma, Random& random, Encounter& e) {
  // Variance of u_n, and its largest value over all configurations.
  double variance = 0, most = 0;
  std::array<Sensitivity, 2> by;
  for (int k = 0; k < 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    by[i] = sensitivityOf(e, k);
    const double square = sigma[i].velocity * sigma[i].velocity;
    variance += square + sigma[i].spin.cwiseProduct(by[i].spin).squaredNorm();
    most += square + std::pow(sigma[i].spin.maxCoeff() * e.bodies[i].shape->boundingRadius(), 2);
  }
  if (random.uniform() > std::sqrt(variance / most)) return false;

  // Unconditional velocities, then the part along the sensitivity replaced.
  const double target = std::sqrt(-2 * variance * std::log(1 - random.uniform()));
  const auto drawNormal = [&] { return random.normal(); };
  std::array<Vec3, 2> v, w;
  double speed = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    v[i] = sigma[i].velocity * Random::drawComponents(drawNormal);
    w[i] = sigma[i].spin.cwiseProduct(Random::drawComponents(drawNormal));
    speed += by[i].velocity.dot(v[i]) + by[i].spin.dot(w[i]);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const double gain = (target - speed) / variance;
    const Vec3 square = sigma[i].spin.cwiseProduct(sigma[i].spin);
    e.bodies[i].velocity = v[i] + gain * sigma[i].velocity * sigma[i].velocity * by[i].velocity;
    e.bodies[i].spin = e.bodies[i].pose.q * (w[i] + gain * square.cwiseProduct(by[i].spin));
  }
  e.approach = target;
  return true;
}

/// Velocities along one direction, in the frame of the common centre of mass.
void approachAlong(const Vec3& direction, double speed, Encounter& e) {
  const double total = e.bodies[0].mass + e.bodies[1].mass;
  e.bodies[0].velocity = (speed * e.bodies[1].mass / total) * direction;
  e.bodies[1].velocity = (-speed * e.bodies[0].mass / total) * direction;
  e.approach = speed * e.normal.dot(direction);
}

}  // namespace

std::span<const VelocityEnsemble> velocityEnsembles() { return ensembles; }

const VelocityEnsemble& findEnsemble(std::string_view name) {
  std::string known;
  for (const VelocityEnsemble& each : ensembles) {
    if (each.name == name) return each;
    known += (known.empty() ? "" : ", ") + std::string(each.name);
  }
  throw InputError("ensemble \"" + std::string(name) + "\": unknown; there are " + known);
}

Encounter drawEncounter(const ColliderKind& a, const ColliderKind& b, const VelocityEnsemble& ensemble, double speed,
                        Random& random) {
  require(std::isfinite(speed) && speed > 0, "speed = " + std::to_string(speed) + " m/s: must be finite and > 0");
  Encounter e;
  for (std::size_t i = 0; i < 2; ++i) {
    const ColliderKind& kind = i == 0 ? a : b;
    const MassProperties& unit = kind.shape->massProperties();
    e.bodies[i].shape = kind.shape;
    e.bodies[i].mass = kind.density * unit.volume;
    e.bodies[i].inertia = kind.density * unit.inertia;
  }
  const double mu = 1 / (1 / e.bodies[0].mass + 1 / e.bodies[1].mass);
  const std::array<Deviation, 2> sigma = {deviationOf(e.bodies[0], mu, ensemble, speed),
                                          deviationOf(e.bodies[1], mu, ensemble, speed)};
  const bool central = ensemble.kind == Kind::headOn;
  while (true) {
    if (!drawTouch(central, random, e)) continue;
    if (central) {
      approachAlong((e.bodies[1].pose.x - e.bodies[0].pose.x).normalized(), speed, e);
      return e;
    }
    if (!drawFlux(sigma, random, e)) continue;
    if (ensemble.kind != Kind::normal) return e;
    approachAlong(e.normal, e.approach, e);
    for (Collider& body : e.bodies) body.spin.setZero();
    return e;
  }
}

double kineticEnergyOf(const Collider& body) {
  const Vec3 spin = body.pose.q.conjugate() * body.spin;
  return 0.5 * (body.mass * body.velocity.squaredNorm() + spin.dot(body.inertia.cwiseProduct(spin)));
}

}  // namespace granular
