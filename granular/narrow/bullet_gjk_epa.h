// Bullet's GJK/EPA behind a plain interface. It sees scaled lengths, zero margin, and B in A's axes; its answer is a
// proposal, to be certified by the caller: for exactly aligned stacked cubes it returns the overlap over sqrt(3) along
// the cube's diagonal, and a small part of shallow vertex-face pairs it calls separate.
#pragma once

#include "granular/narrow/difference.h"

namespace granular {

/// What a penetration solver says of two shapes, A's body axes, m.
struct PenetrationAnswer {
  bool penetrating = false;
  Vec3 normal = Vec3::UnitX();  ///< unit, from A to B
  double overlap = 0;
};

/// Asks btGjkEpaSolver2::Penetration, starting from the guess of the direction from A to B.
PenetrationAnswer askBullet(const Difference& c, const Vec3& guess);

}  // namespace granular
