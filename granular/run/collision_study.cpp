#include "granular/run/collision_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "granular/core/errors.h"
#include "granular/law/tensor.h"
#include "granular/run/stiff_collision.h"
#include "granular/shape/shape_table.h"
#include "granular/world/world.h"

namespace granular {
namespace {

// S table 6. Particles as in its table 7: half-lengths and radii of 1.5 mm.
constexpr std::array<CollisionPair, 8> pairsOfS = {{{"sphere", "sphere", 0.09},
                                                    {"ellipsoid", "ellipsoid", 0.32},
                                                    {"cylinder", "cylinder", 0.29},
                                                    {"tetrahedron", "tetrahedron", 0.20},
                                                    {"cube", "cube", 0.37},
                                                    {"cube", "sphere", 0.17},
                                                    {"cube", "cylinder", 0.27},
                                                    {"ellipsoid", "tetrahedron", 0.15}}};

/// Large enough that no contact reaches Coulomb's limit: beside it the normal force is never small.
constexpr double noLimit = 1e12;

/// Two bodies without gravity, a little apart so that they meet after `lead` s.
std::unique_ptr<World> makeWorld(const Encounter& e, const ColliderKind (&kinds)[2], const CollisionOptions& options,
                                 double lead) {
  WorldOptions choice;
  choice.gravity.setZero();
  choice.rule = options.rule;
  choice.law = options.law;
  choice.bruteForce = true;
  choice.deepOverlap = infinity;
  MaterialTable materials;
  materials.add("elastic", {options.stiffness, 1, 1, noLimit});
  auto world = std::make_unique<World>(choice, std::move(materials));
  for (std::size_t i = 0; i < 2; ++i) {
    const Collider& from = e.bodies[i];
    NewBody body;
    body.shapeIndex = world->addShape(from.shape);
    body.density = kinds[i].density;
    body.pose = from.pose;
    body.pose.x += (i == 0 ? -0.5 : 0.5) * lead * e.approach * e.normal;
    body.velocity = from.velocity;
    body.spin = from.spin;
    world->addBody(body);
  }
  return world;
}

/// Histories of the present contacts, in their order.
template <class Visitor>
void visitHistories(const World& world, Visitor&& visit) {
  world.visitContacts([&](const Contact& contact) {
    const auto slot = static_cast<std::size_t>(world.pairs.pairs[static_cast<std::size_t>(contact.pair)].slot);
    const PairMemory& memory = world.pairs.memory;
    const bool ofClump = contact.spot.ofClump();
    if (!ofClump && world.options.rule.rule != PointRule::manifold)
      return visit(contact, world.historyOf(contact.pair));
    for (const SpotHistory& spot : ofClump ? memory.clumps[slot].spots : memory.manifolds[slot].spots) {
      if (spot.spot == contact.spot) visit(contact, spot.history);
    }
  });
}

/// What a law reads of a body.
ContactBody viewBody(const Bodies& bodies, std::int32_t index, const Vec3& point) {
  const auto i = static_cast<std::size_t>(index);
  ContactBody body;
  body.inverseMass = bodies.inverseMass(i);
  body.radiusRatio = bodies.radiusRatio(i);
  body.arm = point - bodies.x(i);
  const Mat3& R = bodies.frameOf(i).R;
  body.inverseInertia = R * bodies.inverseInertiaOf(i).asDiagonal() * R.transpose();
  return body;
}

/// Energy of the tangential and torsional springs of all contacts, J: d.K d/2 of the displacement in the contact plane.
double springEnergy(const World& world) {
  const LawConstants& constants = world.materials.constants(0, 0);
  double sum = 0;
  visitHistories(world, [&](const Contact& contact, const ContactHistory& history) {
    const ContactBody a = viewBody(world.bodies, contact.a, contact.patch.point);
    const ContactBody b = viewBody(world.bodies, contact.b, contact.patch.point);
    const Vec3& n = contact.touch.normal;
    const double k = stiffnessOf(world.options.law, constants, world.options.lawOptions, a, b, n).tangential;
    double square = k * history.spring.squaredNorm();
    if (world.options.law == LawKind::tensor) {
      const TensorStiffness tensor = findTensorStiffness(constants, world.options.lawOptions, a, b, n);
      const Vec3 d = tensor.axes.transpose() * history.spring;
      square = d.dot(tensor.spring * d);
    }
    const double polar = contact.patch.area > 0 ? contact.patch.uu + contact.patch.vv : 0;
    sum += 0.5 * contact.share * (square + k * polar * history.twist * history.twist);
  });
  return sum;
}

/// Kinetic energy and angular momentum about the origin, from the state at the half step: exact between contacts.
struct Motion {
  double energy = 0;
  Vec3 angular = Vec3::Zero();
};
Motion measureMotion(const World& world) {
  const Bodies& bodies = world.bodies;
  Motion motion;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3 spin = bodies.inertiaOf(i).cwiseProduct(bodies.wHalfOf(i));
    motion.energy += 0.5 * (bodies.mass[i] * bodies.vHalf(i).squaredNorm() + spin.dot(bodies.wHalfOf(i)));
    motion.angular += bodies.mass[i] * bodies.x(i).cross(bodies.vHalf(i));
    motion.angular += bodies.isBall(i) ? spin : Vec3(bodies.orientationHalf(i) * spin);
  }
  return motion;
}

/// Angular momentum before, and the sum of the magnitudes of its parts about the common centre of mass.
struct Angular {
  Vec3 sum = Vec3::Zero();
  double scale = 0;
};
Angular measureAngular(const Encounter& e, const World& world) {
  const double total = e.bodies[0].mass + e.bodies[1].mass;
  const Vec3 centre = (e.bodies[0].mass * world.bodies.x(0) + e.bodies[1].mass * world.bodies.x(1)) / total;
  const Vec3 drift = (e.bodies[0].mass * e.bodies[0].velocity + e.bodies[1].mass * e.bodies[1].velocity) / total;
  Angular angular;
  for (std::size_t i = 0; i < 2; ++i) {
    const Collider& body = e.bodies[i];
    const Vec3& x = world.bodies.x(i);
    const Vec3 own = body.pose.q * body.inertia.cwiseProduct(body.pose.q.conjugate() * body.spin);
    angular.sum += body.mass * x.cross(body.velocity) + own;
    angular.scale += body.mass * (x - centre).cross(body.velocity - drift).norm() + own.norm();
  }
  return angular;
}

/// Of one collision; percent of the kinetic energy before, except angularMomentum.
struct Sample {
  bool finished = false;
  double residual = 0, totalEnergy = 0, kineticLoss = 0, angularMomentum = 0, stiffLimit = 0, overlap = 0;
  std::uint64_t uncertified = 0, coarse = 0;
};

Sample collide(const ColliderKind (&kinds)[2], const CollisionOptions& options, double dt, Random random) {
  const Encounter e = drawEncounter(kinds[0], kinds[1], options.ensemble, options.speed, random);
  const StiffCollision reference = resolveStiff(e, stiffSpringOf(options.law));
  const double before = reference.energyBefore;
  const auto world = makeWorld(e, kinds, options, random.uniform() * dt);
  const Angular angular = measureAngular(e, *world);

  // Step until the contact that begins has ended.
  Sample sample;
  sample.stiffLimit = 100 * reference.energyLeft / before;
  startHalfSteps(*world, dt, 0, true);
  double left = 0;
  bool touched = false;
  for (double n = 0; n < maxContactTimes * options.stepsPerContact; ++n) {
    step(*world, dt);
    if (world->contactCount() > 0) {
      touched = true;
      left = springEnergy(*world);
    } else if (touched) {
      sample.finished = true;
      break;
    }
  }

  // What is left.
  const Motion after = measureMotion(*world);
  sample.residual = 100 * left / before;
  sample.kineticLoss = 100 * (before - after.energy) / before;
  sample.totalEnergy = 100 * std::abs(after.energy + left - before) / before;
  sample.angularMomentum = angular.scale > 0 ? (after.angular - angular.sum).norm() / angular.scale : 0;
  sample.overlap = world->report.deepestOverlap;
  sample.uncertified = world->report.narrow.uncertified;
  sample.coarse = world->report.narrow.coarse;
  return sample;
}

/// Mean, its error and the worst of one figure over the finished samples.
template <class Figure>
Tally tally(const std::vector<Sample>& samples, Figure figure) {
  Tally result;
  double sum = 0, squares = 0, count = 0;
  for (const Sample& sample : samples) {
    if (!sample.finished) continue;
    const double value = figure(sample);
    sum += value;
    squares += value * value;
    ++count;
    if (std::abs(value) > std::abs(result.worst)) result.worst = value;
  }
  if (count == 0) return result;
  result.mean = sum / count;
  const double variance = std::max(squares / count - result.mean * result.mean, 0.0);
  result.error = count > 1 ? std::sqrt(variance / (count - 1)) : 0;
  return result;
}

void requirePositive(const char* name, double value) {
  require(std::isfinite(value) && value > 0, fmt::format("{} = {}: must be finite and > 0", name, value));
}

/// A stream of its own for each collision.
Random makeStream(std::uint64_t seed, std::int64_t number) {
  Random first(seed), second(first.bits() + static_cast<std::uint64_t>(number) * 0x9e3779b97f4a7c15ull);
  return second;
}

}  // namespace

std::span<const CollisionPair> collisionPairs() { return pairsOfS; }

StiffSpring stiffSpringOf(LawKind law) {
  switch (law) {
    case LawKind::linear:
      return StiffSpring::average;
    case LawKind::linearLocal:
      return StiffSpring::local;
    case LawKind::tensor:
      return StiffSpring::tensor;
    case LawKind::hertz:
    case LawKind::hertzMindlin:
      break;
  }
  throw InputError(
      fmt::format("law \"{}\": the study of collisions has springs of one stiffness alone: linear, "
                  "linear_local, tensor",
                  lawName(law)));
}

ColliderKind findColliderKind(std::string_view name) {
  const double r = 1.5e-3;
  const auto make = [](std::string_view shape, std::initializer_list<double> lengths) {
    return ColliderKind{makeShape(shape, std::vector<double>(lengths))};
  };
  if (name == "sphere") return make("sphere", {r});
  if (name == "ellipsoid") return make("ellipsoid", {r, r, 2 * r});
  if (name == "cylinder") return make("cylinder", {r, 2 * r});
  if (name == "cube") return make("cuboid", {r, r, r});
  if (name == "tetrahedron") {
    // Regular, of the volume of the sphere.
    const ColliderKind unit = make("polyhedron", {r, r, r, r, -r, -r, -r, r, -r, -r, -r, r});
    return {scaledShape(*unit.shape, r / unit.shape->size())};
  }
  throw InputError(
      fmt::format("shape \"{}\": unknown; there are sphere, ellipsoid, cylinder, tetrahedron, cube", name));
}

CollisionResult studyCollisions(const ColliderKind& a, const ColliderKind& b, const CollisionOptions& options) {
  requirePositive("speed", options.speed);
  requirePositive("stiffness", options.stiffness);
  requirePositive("density", std::min(a.density, b.density));
  require(options.samples >= 1, fmt::format("samples = {}: must be at least 1", options.samples));

  const ColliderKind kinds[2] = {a, b};
  const double mu =
      1 / (1 / (a.density * a.shape->massProperties().volume) + 1 / (b.density * b.shape->massProperties().volume));
  CollisionResult result;
  result.contactTime = pi * std::sqrt(mu / options.stiffness);
  CollisionOptions chosen = options;
  if (options.dt != 0) {
    requirePositive("dt", options.dt);
    chosen.stepsPerContact = result.contactTime / options.dt;
  }
  require(std::isfinite(chosen.stepsPerContact) && chosen.stepsPerContact >= 4,
          fmt::format("steps per contact time = {:.4g}: must be at least 4 (contact time {:.4g} s)",
                      chosen.stepsPerContact, result.contactTime));
  result.dt = result.contactTime / chosen.stepsPerContact;

  std::vector<Sample> samples(static_cast<std::size_t>(options.samples));
#pragma omp parallel for schedule(dynamic, 8)
  for (std::int64_t k = 0; k < options.samples; ++k) {
    samples[static_cast<std::size_t>(k)] = collide(kinds, chosen, result.dt, makeStream(options.seed, k));
  }

  result.residual = tally(samples, [](const Sample& s) { return s.residual; });
  result.totalEnergy = tally(samples, [](const Sample& s) { return s.totalEnergy; });
  result.kineticLoss = tally(samples, [](const Sample& s) { return s.kineticLoss; });
  result.angularMomentum = tally(samples, [](const Sample& s) { return s.angularMomentum; });
  result.stiffLimit = tally(samples, [](const Sample& s) { return s.stiffLimit; });
  result.stiffDifference = tally(samples, [](const Sample& s) { return std::abs(s.residual - s.stiffLimit); });
  for (const Sample& sample : samples) {
    result.unfinished += !sample.finished;
    result.uncertified += sample.uncertified;
    result.coarse += sample.coarse;
    result.deepestOverlap = std::max(result.deepestOverlap, sample.overlap);
  }
  return result;
}

}  // namespace granular
