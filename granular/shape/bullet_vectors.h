// Bullet's vectors and ours, and the build of Bullet that this library needs.
#pragma once

#include <LinearMath/btVector3.h>

#include "granular/core/math.h"

namespace granular {

static_assert(sizeof(btScalar) == 8, "Bullet must be the double-precision build");

inline btVector3 toBullet(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 fromBullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace granular
