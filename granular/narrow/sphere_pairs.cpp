// Pairs with a sphere: the nearest point of the other shape to the sphere's centre decides, in closed form.
#include "granular/narrow/kernels.h"

namespace granular {

bool touchSpheres(const PairView& pair, WarmCache& cache, NarrowCounts& counts, Touch& touch) {
  ++counts.warm;
  const double radiusA = pair.a.boundingRadius(), radiusB = pair.b.boundingRadius();
  const Vec3 d = pair.frameB.x - pair.frameA.x;
  const double distance = d.norm();
  const Vec3 n = distance > 0 ? Vec3(d / distance) : Vec3(Vec3::UnitX());
  const double overlap = radiusA + radiusB - distance;
  cache.kind = overlap > 0 ? WarmCache::smooth : WarmCache::apart;
  cache.touched = overlap > 0;
  cache.budget = std::max(0.0, -overlap);
  if (!(overlap > 0)) return false;
  touch.normal = n;
  touch.overlap = overlap;
  touch.onA = pair.frameA.x + radiusA * n;
  touch.onB = pair.frameB.x - radiusB * n;
  return true;
}

}  // namespace granular
