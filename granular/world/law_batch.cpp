#include "granular/world/law_batch.h"

#include <algorithm>

#include "granular/world/contact_radius.h"
#include "granular/world/stages.h"

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

/// Both parties of the contacts in a register, apart from where they touch.
void putBodies(const World& world, Contact* const* contacts, std::size_t k, ContactLanes& lanes) {
  std::array<const MotionRow*, wideSize> a, b;
  for (std::size_t i = 0; i < wideSize; ++i) {
    a[i] = &world.bodies.motion[at(contacts[i]->a)];
    b[i] = contacts[i]->b < 0 ? a[i] : &world.bodies.motion[at(contacts[i]->b)];  // a wall is put in its place
  }
  lanes.a.put(k, a);
  lanes.b.put(k, b);
}

/// Where they touch, and walls. Returns the material of B.
std::int32_t putContact(const World& world, const Contact& contact, std::size_t k, ContactLanes& lanes) {
  const Bodies& bodies = world.bodies;
  const ContactPatch& patch = contact.patch;
  lanes.a.arm.put(k, Vec3(patch.point - bodies.x(at(contact.a))));
  lanes.normal.put(k, contact.touch.normal);
  lanes.overlap[k] = patch.depth;
  lanes.share[k] = contact.share * patch.share;
  lanes.area[k] = patch.area;
  if (patch.area > 0) {
    lanes.centreArm.put(k, Vec3(patch.centre - patch.point));
    lanes.u.put(k, patch.u);
    lanes.uu[k] = patch.uu;
    lanes.vv[k] = patch.vv;
    lanes.uv[k] = patch.uv;
  }
  if (contact.b < 0) {
    const Wall& wall = *world.walls[at(-1 - contact.b)];
    putWall(wall, patch.point, k, lanes.b);
    return wall.material;
  }
  const std::size_t b = at(contact.b);
  lanes.b.arm.put(k, Vec3(patch.point - bodies.x(b) - contact.shift));
  return bodies.material[b];
}

}  // namespace

void LawBatch::begin(double dt, LawInLanes chosen, World::Chunk& into, World& of) {
  world = &of;
  chunk = &into;
  law = chosen;
  lanes.count = 0;
  lanes.dt = dt;
  lanes.rocking = rockingDamping(of.options.rule);
  manyMaterials = of.materials.count() > 1;
  elastic = lawReadsCurvature(of.options.law);
  if (manyMaterials) return;
  for (std::size_t k = 0; k < capacity; ++k)
    lanes.putConstants(k, of.materials.constants(0, 0), of.options.lawOptions.tension, elastic);
}

void LawBatch::add(Contact& contact, ContactHistory& history) {
  const std::size_t k = lanes.count++;
  contacts[k] = &contact;
  histories[k] = &history;
  __builtin_prefetch(&history);  // read when the batch is full
  if (lanes.count == capacity) finish();
}

void LawBatch::putRadii() {
  for (std::size_t k = 0; k < lanes.count; ++k) lanes.radius[k] = contactRadius(*world, *contacts[k]);
}

void LawBatch::finish() {
  const std::size_t count = lanes.count;
  if (count == 0) return;
  // Lanes beyond the last contact take part in loading whole registers, as that contact.
  for (std::size_t k = count; k % wideSize != 0; ++k) {
    contacts[k] = contacts[count - 1];
    histories[k] = histories[count - 1];
  }
  for (std::size_t k = 0; k < count; k += wideSize) {
    putBodies(*world, &contacts[k], k, lanes);
    lanes.putHistories(k, &histories[k]);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const Contact& contact = *contacts[k];
    const std::int32_t materialB = putContact(*world, contact, k, lanes);
    if (manyMaterials) {
      const std::int32_t materialA = world->bodies.material[at(contact.a)];
      lanes.putConstants(k, world->materials.constants(materialA, materialB), world->options.lawOptions.tension,
                         elastic);
    }
    lanes.squaredDepth[k] = contact.patch.squaredDepth;
  }
  if (elastic) putRadii();
  law(world->options.lawOptions, lanes);
  for (std::size_t k = 0; k < count; k += wideSize) {
    const std::size_t some = std::min(wideSize, count - k);
    lanes.takeForces(k, some, &contacts[k]);
    lanes.takeHistories(k, some, &histories[k]);
  }
  deliver(
      count, [this](std::size_t k) { return pullOf(*contacts[k]); }, *chunk, *world);
  lanes.count = 0;
}

}  // namespace granular
