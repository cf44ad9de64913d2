#include "granular/world/time_step.h"

#include <fmt/format.h>

#include <algorithm>

namespace granular {
namespace {

/// Sums of k g and eta g over the contacts of one body.
struct Rates {
  double stiffness = 0, damping = 0;
  void add(const ContactStiffness& contact, double g) {
    stiffness += contact.normal * g;
    damping += contact.dampingNormal * g;
  }
  double bound() const {
    if (stiffness <= 0) return infinity;
    // Twice: the neighbours may swing in antiphase.
    const double omega = std::sqrt(2 * stiffness);
    return stableRange(damping / omega) / omega;
  }
};

/// The compliance g of a body of unit density at its worst and its average place, over directions spread evenly.
struct Compliance {
  double worst = 0, mean = 0;
};
Compliance complianceOf(const Shape& shape) {
  const MassProperties& unit = shape.massProperties();
  Compliance result;
  const int samples = 2000;
  const double golden = pi * (3 - std::sqrt(5.0));
  for (int k = 0; k < samples; ++k) {
    // A Fibonacci spiral covers the sphere without clusters.
    const double z = 1 - (2 * k + 1.0) / samples;
    const double s = std::sqrt(1 - z * z);
    const Vec3 n(s * std::cos(golden * k), s * std::sin(golden * k), z);
    const Vec3 lever = shape.support(n).cross(n);
    const double g = 1 / unit.volume + lever.dot(unit.inertia.cwiseInverse().cwiseProduct(lever));
    result.worst = std::max(result.worst, g);
    result.mean += g / samples;
  }
  // A patch rocks about an axis with the second moment of its area, k <s^2>/I. For a cube on its face that is half of
  // 1/m, and slender bodies keep the ratio: both s and I are measured across the axis.
  const double rocking = 0.5 / unit.volume;
  result.mean += rocking;
  result.worst = std::max(result.worst, 1 / unit.volume + 2 * rocking);
  return result;
}

}  // namespace

double stableRange(double z) { return 2 * (std::sqrt(1 + 4 * z * z) - 2 * z); }

TimeStepBound boundBeforeRun(const std::vector<BodyKind>& kinds, const MaterialTable& materials, const LawOptions& law,
                             int contactsAssumed) {
  TimeStepBound result;
  for (const BodyKind& kind : kinds) {
    const Compliance unit = complianceOf(*kind.shape);
    const MassProperties& properties = kind.shape->massProperties();
    ContactBody self;
    self.inverseMass = 1 / (kind.density * properties.volume);
    self.radiusRatio = properties.meanSquareRadius / (kind.density * properties.inertia.mean());
    for (int partner = 0; partner < materials.count(); ++partner) {
      const LawConstants& constants = materials.constants(kind.material, partner);
      // A wall damps most for its stiffness; a twin makes the shortest contact.
      const ContactStiffness wall = stiffnessOf(constants, law, self, ContactBody{}, Vec3::UnitZ());
      const ContactStiffness twin = stiffnessOf(constants, law, self, self, Vec3::UnitZ());
      Rates rates;
      rates.add(wall, unit.worst / kind.density);
      for (int k = 1; k < contactsAssumed; ++k) rates.add(wall, unit.mean / kind.density);
      result.contactTime = std::min(result.contactTime, twin.contactTime);
      if (rates.bound() < result.bound) {
        result.bound = rates.bound();
        result.body = kind.shape->describe();
      }
    }
  }
  result.explanation =
      fmt::format("largest stable step {:.3g} s, set by {} with {} contacts at once; shortest contact time {:.3g} s",
                  result.bound, result.body, contactsAssumed, result.contactTime);
  return result;
}

TimeStepBound boundOfContacts(const World& world) {
  const Bodies& bodies = world.bodies;
  std::vector<Rates> rates(bodies.size());
  TimeStepBound result;
  const auto bodyAt = [&](std::size_t i, const Vec3& arm) {
    ContactBody body;
    body.inverseMass = bodies.inverseMass[i];
    body.radiusRatio = bodies.radiusRatio[i];
    body.arm = arm;
    const Mat3& R = bodies.frame[i].R;
    body.inverseInertia = R * bodies.inverseInertia[i].asDiagonal() * R.transpose();
    return body;
  };
  world.visitContacts([&](const Contact& contact) {
    const auto a = static_cast<std::size_t>(contact.a);
    const ContactBody bodyA = bodyAt(a, contact.patch.point - bodies.x[a]);
    ContactBody bodyB;
    std::int32_t materialB = 0;
    if (contact.b >= 0) {
      const auto b = static_cast<std::size_t>(contact.b);
      bodyB = bodyAt(b, contact.patch.point - bodies.x[b] - contact.shift);
      materialB = bodies.material[b];
    } else {
      materialB = world.walls[static_cast<std::size_t>(-1 - contact.b)]->material;
    }
    const Vec3& n = contact.touch.normal;
    ContactStiffness stiffness = stiffnessOf(world.materials.constants(bodies.material[a], materialB),
                                             world.options.lawOptions, bodyA, bodyB, n);
    stiffness.normal *= contact.share;
    stiffness.dampingNormal *= contact.share;
    result.contactTime = std::min(result.contactTime, stiffness.contactTime);
    const auto addTo = [&](std::int32_t index, const ContactBody& body) {
      if (index < 0 || body.inverseMass == 0) return;
      const Vec3 lever = body.arm.cross(n);
      const double rocking = (contact.patch.uu + contact.patch.vv) * body.inverseInertia.diagonal().maxCoeff();
      rates[static_cast<std::size_t>(index)].add(stiffness,
                                                 body.inverseMass + lever.dot(body.inverseInertia * lever) + rocking);
    };
    addTo(contact.a, bodyA);
    addTo(contact.b, bodyB);
  });
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (rates[i].bound() < result.bound) {
      result.bound = rates[i].bound();
      result.body = fmt::format("body {} ({})", bodies.id[i], bodies.shape[i]->describe());
    }
  }
  result.explanation =
      fmt::format("largest stable step with the present contacts {:.3g} s, set by {}", result.bound, result.body);
  return result;
}

}  // namespace granular
