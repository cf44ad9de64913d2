// Bullet's persistent manifold as a contact-point rule: each step's certified touch is fed to btPersistentManifold's
// own logic, which keeps up to four points, drops those that drift, and replaces those that come near; the force is
// shared among the points that still penetrate. The manifold lives in plain data between steps, so that it can be saved
// and no Bullet object is kept; Bullet sees it in units in which the smaller body measures 10.
#pragma once

#include <array>
#include <cstdint>

#include "granular/narrow/narrow.h"
#include "granular/pair/manifold.h"

namespace granular {

/// One contact of the rule: where, how deep, and its share of the pair's stiffness and damping.
struct ManifoldContact {
  Touch touch;
  std::int32_t spot = 0;
  double share = 1;
};

/// Adds this step's touch of the pair to its manifold, refreshes all points to the bodies' poses, and lists those that
/// penetrate, by spot, with equal shares. Returns their number, 1 to 4 (the touch itself is always among them).
int refreshManifold(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, const Touch& touch,
                    Manifold& manifold, std::array<ManifoldContact, 4>& out);

}  // namespace granular
