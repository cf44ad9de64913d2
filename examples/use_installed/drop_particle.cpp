// A first program with the library: a random rotation, and the fall of a point during 0.1 s.
#include <cstdio>

#include "granular/core/random.h"

int main() {
  granular::Random random(1);
  const granular::Frame frame(granular::Pose{{0, 0, 1}, random.rotation()});
  const granular::Vec3 top = frame.toWorld({0, 0, 0.001});
  std::printf("top of the particle at %.6f %.6f %.6f m\n", top.x(), top.y(), top.z());
  return std::abs((top - frame.x).norm() - 0.001) < 1e-15 ? 0 : 1;
}
