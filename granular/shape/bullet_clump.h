// A clump for those who use Bullet's own world: its children as a btCompoundShape.
#pragma once

#include <memory>

#include "granular/shape/clump.h"

class btCompoundShape;

namespace granular {

/// Deletes the compound with its children, which Bullet leaves to their owner.
struct BulletCompoundDeleter {
  void operator()(btCompoundShape* compound) const;
};
using BulletCompound = std::unique_ptr<btCompoundShape, BulletCompoundDeleter>;

/// The children as btSphereShapes in the clump's body axes, multiplied by scale. Child k is child k of the clump.
BulletCompound makeBulletCompound(const Clump& clump, double scale);

}  // namespace granular
