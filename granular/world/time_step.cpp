#include "granular/world/time_step.h"

#include <fmt/format.h>

#include <algorithm>

#include "granular/law/linear.h"
#include "granular/shape/clump.h"
#include "granular/shape/curvature.h"
#include "granular/world/contact_radius.h"

namespace granular {
namespace {

/// Children of a clump that differ in height by less than this part of its size touch a flat neighbour together: about
/// the deepest overlap of a contact that is not hit hard.
constexpr double togetherDepth = 0.01;

/// How a body gives way to a contact, 1/kg: g of its centre and its turning about the arm, along the normal and, for
/// laws whose tangential stiffness may decide, in the softest direction across it; and of its rocking on the area.
struct Compliance {
  double point = 0, rocking = 0, side = 0;
};

/// Sums of k g and eta g over the contacts of one body.
struct Rates {
  double stiffness = 0, damping = 0;
  void add(const ContactStiffness& contact, const Compliance& g, const RuleOptions& rule) {
    stiffness += std::max(contact.normal * (g.point + rockingStiffness(rule) * g.rocking), contact.tangential * g.side);
    damping += std::max(contact.dampingNormal * (g.point + rockingDamping(rule) * g.rocking),
                        contact.dampingTangential * g.side);
  }
  double bound() const {
    if (stiffness <= 0) return infinity;
    // Twice: the neighbours may swing in antiphase.
    const double omega = std::sqrt(2 * stiffness);
    return stableRange(damping / omega) / omega;
  }
};

/// The compliance of a body of unit density at its worst and its average place, over directions spread evenly.
struct ShapeCompliance {
  Compliance worst, mean;
};

/// g of a body of unit density for a contact at a point of its surface along n, body axes.
double giveAt(const MassProperties& unit, const Vec3& point, const Vec3& n) {
  const Vec3 lever = point.cross(n);
  return 1 / unit.volume + lever.dot(unit.inertia.cwiseInverse().cwiseProduct(lever));
}

/// The largest g across n, over the directions t in the contact plane, for the inverse inertia in body axes.
double sideGive(double inverseMass, const Mat3& inverseInertia, const Vec3& arm, const Vec3& n) {
  const Vec3 t = perpendicular(n), first = arm.cross(t), second = arm.cross(n.cross(t));
  const double a = first.dot(inverseInertia * first), b = second.dot(inverseInertia * second);
  const double c = first.dot(inverseInertia * second);
  return inverseMass + 0.5 * (a + b) + std::hypot(0.5 * (a - b), c);
}

Compliance compliancesAt(const MassProperties& unit, const Vec3& point, const Vec3& n) {
  const Mat3 inverse = unit.inertia.cwiseInverse().asDiagonal();
  return {giveAt(unit, point, n), 0, sideGive(1 / unit.volume, inverse, point, n)};
}

/// The same for all children that touch at once where a flat neighbour presses on a clump: each is as stiff as a
/// contact of its own.
Compliance compliancesOf(const Clump& clump, const Vec3& n) {
  const ChildSphere& highest = highestChild(clump.children(), n);
  const double floor = n.dot(highest.centre) + highest.radius - togetherDepth * clump.size();
  Compliance sum;
  for (const ChildSphere& child : clump.children()) {
    if (n.dot(child.centre) + child.radius < floor) continue;
    const Compliance g = compliancesAt(clump.massProperties(), child.centre + sphereSupport(child.radius, n), n);
    sum.point += g.point;
    sum.side += g.side;
  }
  return sum;
}

ShapeCompliance complianceOf(const Shape& shape, const RuleOptions& rule) {
  const MassProperties& unit = shape.massProperties();
  const Clump* clump = asClump(shape);
  ShapeCompliance result;
  const int samples = 2000;
  const double golden = pi * (3 - std::sqrt(5.0));
  for (int k = 0; k < samples; ++k) {
    // A Fibonacci spiral covers the sphere without clusters.
    const double z = 1 - (2 * k + 1.0) / samples;
    const double s = std::sqrt(1 - z * z);
    const Vec3 n(s * std::cos(golden * k), s * std::sin(golden * k), z);
    const Compliance g = clump ? compliancesOf(*clump, n) : compliancesAt(unit, shape.support(n), n);
    result.worst.point = std::max(result.worst.point, g.point);
    result.worst.side = std::max(result.worst.side, g.side);
    result.mean.point += g.point / samples;
    result.mean.side += g.side / samples;
  }
  if (shape.kind() == ShapeKind::sphere || shape.kind() == ShapeKind::ellipsoid || clump) return result;

  // A patch rocks about an axis with the second moment of its area, k <s^2>/I. For a cube on its face that is half of
  // 1/m, and slender bodies keep the ratio: both s and I are measured across the axis.
  result.mean.rocking = 0.5 / unit.volume;
  const Compliance face{1 / unit.volume, 2 * result.mean.rocking, result.worst.side};
  if (face.point + rockingStiffness(rule) * face.rocking > result.worst.point) result.worst = face;
  return result;
}

/// The tensor law's tangential rates where they exceed the normal ones: rho^2 and zeta_t of law/tensor.h.
void stretchRates(const LawConstants& constants, ContactStiffness& stiffness) {
  stiffness.dampingNormal =
      std::max(stiffness.dampingNormal, constants.dampingT * stiffness.contactTime * stiffness.normal / pi);
  stiffness.normal *= std::max(1.0, constants.stiffnessRatio);
}

/// The larger principal second moment of the area per area, m^2.
double largestMoment(const ContactPatch& patch) {
  return 0.5 * (patch.uu + patch.vv) + std::hypot(0.5 * (patch.uu - patch.vv), patch.uv);
}

}  // namespace

double stableRange(double z) { return 2 * (std::sqrt(1 + 4 * z * z) - 2 * z); }

TimeStepBound boundBeforeRun(const std::vector<BodyKind>& kinds, const MaterialTable& materials,
                             const WorldOptions& options, int contactsAssumed) {
  TimeStepBound result;
  // The tensor law lets a body swing with the compliance of its partner too: the largest there is.
  const bool shared = options.law == LawKind::tensor;
  const bool hertz = lawReadsCurvature(options.law), asked = lawSetsStiffness(options.law);
  std::vector<ShapeCompliance> compliances;
  ShapeCompliance largest;
  for (const BodyKind& kind : kinds) {
    const ShapeCompliance unit = complianceOf(*kind.shape, options.rule);
    const double inverse = 1 / kind.density;
    const double side = asked ? inverse : 0;  // the linear laws' k_t is made for the compliance across
    compliances.push_back({{unit.worst.point * inverse, unit.worst.rocking * inverse, unit.worst.side * side},
                           {unit.mean.point * inverse, unit.mean.rocking * inverse, unit.mean.side * side}});
    largest.worst.point = std::max(largest.worst.point, compliances.back().worst.point);
    largest.mean.point = std::max(largest.mean.point, compliances.back().mean.point);
  }
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const BodyKind& kind = kinds[k];
    ShapeCompliance felt = compliances[k];
    if (shared) {
      felt.worst.point = 0.5 * (felt.worst.point + largest.worst.point);
      felt.mean.point = 0.5 * (felt.mean.point + largest.mean.point);
    }
    const MassProperties& properties = kind.shape->massProperties();
    ContactBody self;
    self.inverseMass = 1 / (kind.density * properties.volume);
    self.radiusRatio = properties.meanSquareRadius / (kind.density * properties.inertia.mean());
    for (int partner = 0; partner < materials.count(); ++partner) {
      const LawConstants& constants = materials.constants(kind.material, partner);
      // A wall damps most for its stiffness, and is the flattest partner; a twin makes the shortest contact. Both
      // through the centre of mass, where every law of springs of the library has the stiffness k_n.
      const LawKind law = asked ? options.law : LawKind::linear;
      const double overlap = options.expectedOverlap * kind.shape->size(), radius = largestRadius(*kind.shape);
      ContactStiffness wall =
          stiffnessOf(law, constants, options.lawOptions, self, ContactBody{}, Vec3::UnitZ(), overlap, radius);
      const ContactStiffness twin =
          stiffnessOf(law, constants, options.lawOptions, self, self, Vec3::UnitZ(), overlap, 0.5 * radius);
      if (shared) stretchRates(constants, wall);
      Rates rates;
      rates.add(wall, felt.worst, options.rule);
      for (int n = 1; n < contactsAssumed; ++n) rates.add(wall, felt.mean, options.rule);
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
  if (hertz)
    result.explanation += fmt::format("; both at overlaps of {:g} % of the size", 100 * options.expectedOverlap);
  return result;
}

TimeStepBound boundOfContacts(const World& world) {
  const Bodies& bodies = world.bodies;
  const LawKind law = world.options.law;
  std::vector<Rates> rates(bodies.size());
  TimeStepBound result;
  const auto bodyAt = [&](std::size_t i, const Vec3& arm) {
    ContactBody body;
    body.inverseMass = bodies.inverseMass(i);
    body.radiusRatio = bodies.radiusRatio(i);
    body.arm = arm;
    const Mat3& R = bodies.frameOf(i).R;
    body.inverseInertia = R * bodies.inverseInertiaOf(i).asDiagonal() * R.transpose();
    return body;
  };
  const auto rests = [&](std::int32_t index) { return index < 0 || !bodies.moves(static_cast<std::size_t>(index)); };
  world.visitContacts([&](const Contact& contact) {
    if (rests(contact.a) && rests(contact.b)) return;  // nothing swings
    const auto a = static_cast<std::size_t>(contact.a);
    const ContactBody bodyA = bodyAt(a, contact.patch.point - bodies.x(a));
    ContactBody bodyB;
    std::int32_t materialB = 0;
    if (contact.b >= 0) {
      const auto b = static_cast<std::size_t>(contact.b);
      bodyB = bodyAt(b, contact.patch.point - bodies.x(b) - contact.shift);
      materialB = bodies.material[b];
    } else {
      materialB = world.walls[static_cast<std::size_t>(-1 - contact.b)]->material;
    }
    const Vec3& n = contact.touch.normal;
    const LawConstants& constants = world.materials.constants(bodies.material[a], materialB);
    const bool hertz = lawReadsCurvature(law);
    const double radius = hertz ? contactRadius(world, contact) : 0;
    ContactStiffness stiffness =
        stiffnessOf(law, constants, world.options.lawOptions, bodyA, bodyB, n, contact.patch.depth, radius);
    result.contactTime = std::min(result.contactTime, stiffness.contactTime);

    // k g of either body; with the tensor law half the contact's own rate, in the direction that swings fastest.
    const double share = contact.share * contact.patch.share;
    const double compliance = localInverseMass(bodyA, n) + localInverseMass(bodyB, n);
    const auto addTo = [&](std::int32_t index, const ContactBody& body) {
      if (index < 0 || body.inverseMass == 0) return;
      Rates& own = rates[static_cast<std::size_t>(index)];
      const double rocking = largestMoment(contact.patch) * body.inverseInertia.diagonal().maxCoeff();
      const RuleOptions& rule = world.options.rule;
      ContactStiffness spot = stiffness;
      spot.normal *= share;
      spot.tangential *= share;
      spot.dampingNormal *= share;
      spot.dampingTangential *= share;
      if (law != LawKind::tensor) {
        const double side = lawSetsStiffness(law) ? sideGive(body.inverseMass, body.inverseInertia, body.arm, n) : 0;
        own.add(spot, {localInverseMass(body, n), rocking, side}, rule);
        return;
      }
      own.add(spot, {0, rocking, 0}, rule);
      spot.normal = share * constants.parameters.stiffness;
      spot.dampingNormal =
          share * constants.dampingN[world.options.lawOptions.tension] * std::sqrt(spot.normal / (share * compliance));
      stretchRates(constants, spot);
      own.add(spot, {0.5 * compliance, 0, 0}, rule);
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
