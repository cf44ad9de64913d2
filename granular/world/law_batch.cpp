#include "granular/world/law_batch.h"

#include "granular/world/contact_radius.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// A wall: nothing of it turns or yields, and its surface moves as it does at the contact point.
void putWall(const Wall& wall, const Vec3& point, std::size_t k, ContactLanes::Party& party) {
  party.arm.put(k, Vec3::Zero());
  party.v.put(k, wall.motion.velocityAt(point));
  party.w.put(k, wall.motion.spin);
  party.vHalf.put(k, wall.stepMotion.velocityAt(point));
  party.spinHalf.put(k, wall.stepMotion.spin);
  party.inverseMass[k] = party.radiusRatio[k] = 0;
}

/// What the law reads of a contact, apart from its history.
void putContact(const World& world, const Contact& contact, std::size_t k, ContactLanes& lanes) {
  // Both parties.
  const Bodies& bodies = world.bodies;
  const ContactPatch& patch = contact.patch;
  const std::size_t a = at(contact.a);
  lanes.a.arm.put(k, Vec3(patch.point - bodies.x[a]));
  lanes.a.put(k, bodies, a);
  std::int32_t materialB;
  if (contact.b < 0) {
    const Wall& wall = *world.walls[at(-1 - contact.b)];
    putWall(wall, patch.point, k, lanes.b);
    materialB = wall.material;
  } else {
    const std::size_t b = at(contact.b);
    lanes.b.arm.put(k, Vec3(patch.point - bodies.x[b] - contact.shift));
    lanes.b.put(k, bodies, b);
    materialB = bodies.material[b];
  }
  const LawConstants& constants = world.materials.constants(bodies.material[a], materialB);
  lanes.putConstants(k, constants, world.options.lawOptions.tension);
  if (lawReadsCurvature(world.options.law)) {
    lanes.putElasticity(k, constants);
    lanes.radius[k] = contactRadius(world, contact);
    lanes.squaredDepth[k] = patch.squaredDepth;
  }

  // What touches.
  lanes.normal.put(k, contact.touch.normal);
  lanes.overlap[k] = patch.depth;
  lanes.share[k] = contact.share * patch.share;
  lanes.area[k] = patch.area;
  if (!(patch.area > 0)) return;
  lanes.centreArm.put(k, Vec3(patch.centre - patch.point));
  lanes.u.put(k, patch.u);
  lanes.uu[k] = patch.uu;
  lanes.vv[k] = patch.vv;
  lanes.uv[k] = patch.uv;
}

}  // namespace

void LawBatch::begin(double dt, LawInLanes chosen, const World& of) {
  world = &of;
  law = chosen;
  lanes.count = 0;
  lanes.dt = dt;
  lanes.rocking = rockingDamping(of.options.rule);
}

void LawBatch::add(Contact& contact, ContactHistory& history, ContactPull& pull) {
  items[lanes.count++] = {&contact, &history, &pull};
  __builtin_prefetch(&history);  // read when the batch is full
  if (lanes.count == ContactLanes::capacity) finish();
}

void LawBatch::finish() {
  for (std::size_t k = 0; k < lanes.count; ++k) {
    putContact(*world, *items[k].contact, k, lanes);
    lanes.putHistory(k, *items[k].history);
  }
  law(world->options.lawOptions, lanes);
  for (std::size_t k = 0; k < lanes.count; ++k) {
    const auto& [contact, history, pull] = items[k];
    lanes.takeForce(k, contact->force);
    lanes.takeHistory(k, *history);
    lanes.takePull(k, contact->a, contact->b, *pull);
    contact->torqueA = lanes.torqueA.take(k);
    contact->torqueB = lanes.torqueB.take(k);
  }
  lanes.count = 0;
}

}  // namespace granular
