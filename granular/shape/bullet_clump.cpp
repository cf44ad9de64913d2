#include "granular/shape/bullet_clump.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include "granular/shape/bullet_vectors.h"

namespace granular {

void BulletCompoundDeleter::operator()(btCompoundShape* compound) const {
  for (int k = 0; k < compound->getNumChildShapes(); ++k) delete compound->getChildShape(k);
  delete compound;
}

BulletCompound makeBulletCompound(const Clump& clump, double scale) {
  BulletCompound compound(new btCompoundShape(true, static_cast<int>(clump.children().size())));
  for (const ChildSphere& child : clump.children()) {
    const btTransform place(btQuaternion::getIdentity(), toBullet(scale * child.centre));
    compound->addChildShape(place, new btSphereShape(scale * child.radius));
  }
  return compound;
}

}  // namespace granular
