// Nanoseconds per call of the narrow phase: warm (a pair that creeps over its contact, cache kept) and search (the full
// search every time), by pair of shapes. Run on an idle core; figures vary by half from machine to machine.
#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "granular/core/random.h"
#include "granular/narrow/narrow.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace {

using namespace granular;

std::unique_ptr<Shape> makeShape(int which) {
  Random random(1);
  std::vector<Vec3> cloud;
  switch (which) {
    case 0:
      return std::make_unique<Sphere>(1);
    case 1:
      return std::make_unique<Ellipsoid>(Vec3(1, 1, 2));
    case 2:
      return std::make_unique<Cylinder>(1, 2);
    case 3:
      return std::make_unique<Cone>(1, 2);
    case 4:
      return std::make_unique<Cuboid>(Vec3::Ones());
    default:
      for (int k = 0; k < 60; ++k) cloud.push_back(random.direction());
      return std::make_unique<Polyhedron>(cloud);
  }
}

struct Placed {
  Pose a, b;
  WarmCache cache;
  Vec3 slide, spin;
};

/// Random contacts of overlap 1e-3 of the size.
std::vector<Placed> makeContacts(const Shape& a, const Shape& b) {
  Random random(2);
  std::vector<Placed> placed(256);
  for (Placed& p : placed) {
    p.a = {Vec3::Zero(), random.rotation()};
    const Vec3 d = random.direction();
    p.b = {1e-3 * d, random.rotation()};
    NarrowCounts counts;
    Touch touch;
    for (int k = 0; k < 200; ++k) {
      WarmCache cache;
      if (findTouch(a, Frame(p.a), b, Frame(p.b), false, cache, counts, touch)) {
        p.b.x += std::max(touch.overlap - 1e-3, 1e-5) * d;
        if (touch.overlap < 1.1e-3) break;
      } else {
        p.b.x -= .5e-3 * d;
      }
    }
    p.slide = 1e-6 * random.direction();
    p.spin = 1e-6 * random.direction();
  }
  return placed;
}

void measure(benchmark::State& state, bool search) {
  const auto a = makeShape(static_cast<int>(state.range(0))), b = makeShape(static_cast<int>(state.range(1)));
  std::vector<Placed> placed = makeContacts(*a, *b);
  std::vector<std::pair<Frame, Frame>> frames;
  for (const Placed& p : placed) frames.emplace_back(Frame(p.a), Frame(p.b));
  NarrowCounts counts;
  Touch touch;
  std::size_t k = 0;
  double round = 0;
  for (auto _ : state) {
    Placed& p = placed[k];
    Frame& frameB = frames[k].second;
    frameB.x = p.b.x + std::sin(.01 * round) * p.slide;
    benchmark::DoNotOptimize(findTouch(*a, frames[k].first, *b, frameB, search, p.cache, counts, touch));
    if (++k == placed.size()) {
      k = 0;
      ++round;
    }
  }
  state.counters["searched"] = static_cast<double>(counts.searches) / static_cast<double>(state.iterations());
  state.counters["warm"] = static_cast<double>(counts.warm) / static_cast<double>(state.iterations());
}

void warm(benchmark::State& state) { measure(state, false); }
void search(benchmark::State& state) { measure(state, true); }

void pairs(benchmark::internal::Benchmark* b) {
  b->ArgNames({"a", "b"});
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) b->Args({i, j});
  }
}

BENCHMARK(warm)->Apply(pairs);
BENCHMARK(search)->Apply(pairs);

}  // namespace
