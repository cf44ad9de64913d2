// Nanoseconds per call: the narrow phase by pair of shapes, warm (a pair that creeps over its contact, cache kept) and
// search (the full search every time); the contact-point rules; the laws; the rotation schemes; the sum of forces. Run
// on an idle core; figures vary by half from machine to machine.
#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "granular/core/random.h"
#include "granular/integrate/integrator.h"
#include "granular/law/law.h"
#include "granular/narrow/narrow.h"
#include "granular/point/contact_point.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/world/stages.h"

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

/// placeContact by every rule that it serves, for each pair of shapes.
void place(benchmark::State& state) {
  RuleOptions options;
  options.rule = static_cast<PointRule>(state.range(0));
  const auto a = makeShape(static_cast<int>(state.range(1))), b = makeShape(static_cast<int>(state.range(2)));
  struct Met {
    Frame a, b;
    Touch touch;
  };
  std::vector<Met> met;
  for (const Placed& p : makeContacts(*a, *b)) {
    Met each{Frame(p.a), Frame(p.b), {}};
    WarmCache cache;
    NarrowCounts counts;
    if (findTouch(*a, each.a, *b, each.b, true, cache, counts, each.touch)) met.push_back(each);
  }
  ContactPatch patch;
  std::size_t k = 0;
  for (auto _ : state) {
    placeContact(options, *a, met[k].a, *b, met[k].b, met[k].touch, patch);
    benchmark::DoNotOptimize(patch);
    if (++k == met.size()) k = 0;
  }
  state.SetLabel(std::string(pointRuleName(options.rule)));
}
void rules(benchmark::internal::Benchmark* b) {
  b->ArgNames({"rule", "a", "b"});
  for (const PointRule rule : {PointRule::witness, PointRule::faceCentroid, PointRule::pressureCentroid,
                               PointRule::patch, PointRule::stiffPatch, PointRule::foundation}) {
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) b->Args({static_cast<int>(rule), i, j});
    }
  }
}

/// One contact's law, of a point (area 0) and of a patch.
void law(benchmark::State& state) {
  const auto kind = static_cast<LawKind>(state.range(0));
  const bool hasArea = state.range(1) != 0;
  ContactParameters parameters;
  setElasticity({1e9, 0.3}, {1e9, 0.3}, parameters);
  const LawConstants constants = prepareLaw(parameters);
  const LawOptions options;
  Random random(3);
  struct Case {
    ContactBody a, b;
    ContactMotion motion;
    ContactHistory history;
  };
  std::vector<Case> cases(256);
  for (Case& c : cases) {
    const Vec3 n = random.direction();
    for (ContactBody* body : {&c.a, &c.b}) {
      body->inverseMass = 3e4;
      body->radiusRatio = 7e4;
      body->arm = (body == &c.a ? 1.5e-3 : -1.5e-3) * n + 1e-4 * random.direction();
      body->inverseInertia = 3e10 * Mat3::Identity();
    }
    ContactMotion& m = c.motion;
    m.normal = n;
    m.overlap = 1e-6;
    m.squaredDepth = 1e-12;
    m.velocity = 1e-3 * random.direction();
    m.slip = 1e-9 * random.direction();
    m.spin = random.direction();
    m.meanSpin = random.direction();
    m.dt = 1e-6;
    m.radius = 1e-3;
    m.u = perpendicular(n);
    m.centreArm = hasArea ? Vec3(1e-4 * m.u) : Vec3(Vec3::Zero());
    m.area = hasArea ? 1e-6 : 0;
    m.uu = m.vv = hasArea ? 1e-7 : 0;
  }
  const Law function = lawFunction(kind);
  ContactForce out;
  std::size_t k = 0;
  for (auto _ : state) {
    Case& c = cases[k];
    function(constants, options, c.a, c.b, c.motion, c.history, out);
    benchmark::DoNotOptimize(out);
    if (++k == cases.size()) k = 0;
  }
  state.SetLabel(std::string(lawName(kind)));
}

/// Prediction and advance of one body's rotation.
void rotate(benchmark::State& state) {
  const RotationScheme& scheme = rotationScheme(static_cast<SchemeKind>(state.range(0)));
  constexpr double dt = 1e-6;
  Random random(4);
  const Vec3 inertia(1, 2, 3), inverse = inertia.cwiseInverse(), torque = random.direction();
  Quat q = random.rotation(), qHalf = q;
  Vec3 w = random.direction(), wHalf = w, alpha = Vec3::Zero();
  for (auto _ : state) {
    scheme.predict(dt, qHalf, wHalf, alpha, q, w);
    scheme.advance(dt, inertia, inverse, torque, q, w, {qHalf, wHalf, alpha});
    benchmark::DoNotOptimize(qHalf);
  }
  state.SetLabel(std::string(scheme.name));
}

/// Stages of the step on a cubic lattice of 20^3 spheres that just overlap: ns per contact.
template <class Run>
void stage(benchmark::State& state, Run run) {
  MaterialTable materials;
  materials.add("grain", ContactParameters{});
  World world({}, std::move(materials));
  world.addShape(std::make_shared<Sphere>(1.5e-3));
  constexpr int side = 20;
  for (int k = 0; k < side * side * side; ++k) {
    NewBody body;
    const int row = k / side % side, layer = k / side / side;
    body.pose.x = 2.99e-3 * Vec3(k % side, row, layer);
    world.addBody(body);
  }
  startHalfSteps(world, 1e-6, 0, true);
  for (auto _ : state) run(world);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(world.contactCount()));
}
/// Of contacts that could not be added to their bodies at once.
void gather(benchmark::State& state) {
  stage(state, [](World& world) {
    World::Chunk& chunk = world.chunks[0];
    if (chunk.pulls.empty()) world.visitContacts([&](const Contact& found) { chunk.pulls.push_back(pullOf(found)); });
    chunk.lowest = 0;
    chunk.highest = static_cast<std::int32_t>(world.bodies.size());
    gatherForces(world);
  });
}
void allContacts(benchmark::State& state) {
  stage(state, [](World& world) {
    beginForces(world);
    makeContacts(1e-6, world);
  });
}

BENCHMARK(warm)->Apply(pairs);
BENCHMARK(search)->Apply(pairs);
BENCHMARK(place)->Apply(rules);
BENCHMARK(law)->ArgNames({"kind", "patch"})->ArgsProduct({{0, 1, 2, 3, 4}, {0, 1}});
BENCHMARK(rotate)->ArgName("scheme")->Arg(0)->Arg(1);
BENCHMARK(gather);
BENCHMARK(allContacts);

}  // namespace
