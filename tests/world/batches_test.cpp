// Contacts of spheres, clumps, ellipsoids, cuboids, polyhedra and cylinders made in batches, and the law in lanes,
// against one by one.
#include <gtest/gtest.h>
#include <omp.h>

#include <map>

#include "granular/narrow/support_piece.h"
#include "granular/point/overlap.h"
#include "granular/point/patch_lanes.h"
#include "granular/point/rules.h"
#include "granular/shape/clump.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/wall/plane_patch.h"
#include "granular/world/looks.h"
#include "narrow/scenes.h"
#include "world/heap.h"

namespace granular {
namespace {

using testing::isSameBits;
using testing::stateOf;

/// A heap of spheres of three sizes, of clumps, or of both, of two materials, one of them frictionless, turning as they
/// fall into a box.
enum class OfWhat { spheres, clumps, both };
std::unique_ptr<World> makeBalls(const WorldOptions& options, int perSide, OfWhat what = OfWhat::spheres) {
  MaterialTable materials;
  ContactParameters rough;
  rough.friction = 0.4;
  setElasticity({2e7, .3}, {2e7, .3}, rough);
  rough.dampingRateN = rough.dampingRateT = 300;
  materials.add("rough", rough);
  ContactParameters slick = rough;
  slick.stiffness = 2e4;
  slick.friction = 0;
  slick.dampingRateN = 100;
  materials.add("slick", slick);
  auto world = std::make_unique<World>(options, std::move(materials));
  const double pitch = 2.75e-3;
  testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  std::vector<std::int32_t> sizes;
  if (what != OfWhat::clumps) {
    for (const double radius : {1.5e-3, 1.3e-3, 1.1e-3})
      sizes.push_back(world->addShape(std::make_shared<Sphere>(radius)));
  }
  if (what != OfWhat::spheres) {
    std::vector<ChildSphere> chain, ring;
    for (int k = -2; k <= 2; ++k) chain.push_back({Vec3(.35e-3 * k, 0, 0), 1.1e-3 - .15e-3 * std::abs(k)});
    for (int k = 0; k < 7; ++k)
      ring.push_back({Vec3(.9e-3 * std::cos(.9 * k), .9e-3 * std::sin(.9 * k), .05e-3 * k), .55e-3});
    for (const auto& spheres : {chain, ring}) sizes.push_back(world->addShape(std::make_shared<Clump>(spheres)));
  }
  testing::addLattice(sizes, perSide, pitch, 100, *world);
  for (std::size_t i = 0; i < world->bodies.size(); i += 7) world->bodies.material[i] = 1;
  return world;
}

/// Everything a visitor can read of the contacts.
std::vector<double> contactsOf(const World& world) {
  std::vector<double> out;
  const auto add = [&](const Vec3& v) { out.insert(out.end(), {v.x(), v.y(), v.z()}); };
  world.visitContacts([&](const Contact& c) {
    out.insert(out.end(), {double(c.pair), double(c.a), double(c.b), double(c.spot.number), c.share, c.touch.overlap,
                           c.patch.area, c.patch.depth, c.patch.squaredDepth, c.patch.share, c.force.normalForce,
                           double(c.force.sliding), double(c.held), double(c.spot.childA), double(c.spot.childB)});
    for (const Vec3& v : {c.shift, c.touch.normal, c.touch.onA, c.touch.onB, c.patch.point, c.patch.centre,
                          c.force.force, c.force.couple, c.torqueA, c.torqueB}) {
      add(v + Vec3::Zero());  // one sign of zero
    }
  });
  return out;
}

struct Case {
  const char* name;
  WorldOptions options;
  OfWhat what = OfWhat::spheres;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

/// What make(options) makes, worked on in batches and one by one, started.
template <class Make>
std::array<std::unique_ptr<World>, 2> makeBothWays(WorldOptions options, const Make& make) {
  std::array<std::unique_ptr<World>, 2> worlds;
  for (const bool oneByOne : {false, true}) {
    options.noBatches = oneByOne;
    worlds[oneByOne] = make(options);
    startHalfSteps(*worlds[oneByOne], 5e-6, 0, true);
  }
  return worlds;
}

class Balls : public ::testing::TestWithParam<Case> {};

TEST_P(Balls, InBatchesHaveTheSameBitsAsOneByOne) {
  const auto worlds =
      makeBothWays(GetParam().options, [](const WorldOptions& o) { return makeBalls(o, 7, GetParam().what); });
  std::size_t contacts = 0, sliding = 0, batched = 0;
  const int steps = GetParam().what == OfWhat::spheres ? 400 : 1200;  // clumps fill less of their places
  for (int n = 0; n < steps; ++n) {
    for (auto& world : worlds) step(*world, 5e-6);
    ASSERT_TRUE(isSameBits(stateOf(*worlds[0]), stateOf(*worlds[1]))) << "step " << n;
    if (n % 20 != 0) continue;
    ASSERT_TRUE(isSameBits(contactsOf(*worlds[0]), contactsOf(*worlds[1]))) << "step " << n;
    worlds[0]->visitContacts([&](const Contact& contact) {
      ++contacts;
      sliding += contact.force.sliding;
    });
    for (const World::Chunk& chunk : worlds[0]->chunks) batched += chunk.briefs.size();
  }
  EXPECT_EQ(worlds[0]->sleep.fallen > 10, GetParam().options.sleep.on);
  EXPECT_GT(batched, 1000u);
  EXPECT_GT(sliding, 100u);
  EXPECT_LT(sliding, contacts);
  EXPECT_EQ(worlds[0]->report.contactSteps, worlds[1]->report.contactSteps);
  EXPECT_EQ(worlds[0]->report.narrow.warm, worlds[1]->report.narrow.warm);
  EXPECT_EQ(worlds[0]->report.deepestA, worlds[1]->report.deepestA);
  EXPECT_EQ(worlds[0]->report.deepestB, worlds[1]->report.deepestB);
}

std::vector<Case> cases() {
  std::vector<Case> all(14);
  all[0].name = "AsTheyAre";
  all[1].name = "WithoutTension";
  all[1].options.lawOptions.tension = false;
  all[1].options.lawOptions.frictionOfPush = true;
  all[2].name = "SlidingAlongTheVelocity";
  all[2].options.lawOptions.slideAlongVelocity = true;
  all[3].name = "Periodic";
  all[3].options.periods.length = {7 * 2.75e-3, 7 * 2.75e-3, 0};
  all[3].options.periods.origin = {-3.5 * 2.75e-3, -3.5 * 2.75e-3, 0};
  all[4].name = "AtTheDeepestPoint";
  all[4].options.rule.rule = PointRule::witness;
  all[5].name = "FallingAsleep";
  all[5].options.sleep.on = true;
  all[5].options.sleep.time = 1e-3;
  all[5].options.sleep.energy = 1;
  all[5].options.sleep.balance = 1e3;
  all[5].options.sleep.wake = 1;
  all[6].name = "Hertz";
  all[6].options.law = LawKind::hertz;
  all[7].name = "HertzMindlin";
  all[7].options.law = LawKind::hertzMindlin;
  all[8] = {"Clumps", {}, OfWhat::clumps};
  all[9] = {"ClumpsPeriodic", all[3].options, OfWhat::clumps};
  all[10] = {"ClumpsFallingAsleep", all[5].options, OfWhat::clumps};
  all[11] = {"ClumpsAmongSpheres", {}, OfWhat::both};
  all[12] = {"ClumpsAmongSpheresHertz", all[6].options, OfWhat::both};
  all[13] = {"ClumpsLookedAtEveryStep", {}, OfWhat::clumps};
  all[13].options.skips = {false, false, false};
  return all;
}

INSTANTIATE_TEST_SUITE_P(World, Balls, ::testing::ValuesIn(cases()), [](const auto& info) { return info.param.name; });

/// A heap of ellipsoids, nearly round and flat, of two materials, that falls into a box or onto a floor.
std::unique_ptr<World> makeEllipsoids(const WorldOptions& options, int perSide, double pitch) {
  MaterialTable materials;
  ContactParameters contact;
  setElasticity({1e7, .3}, {1e7, .3}, contact);
  contact.dampingRateN = contact.dampingRateT = 200;
  materials.add("rough", contact);
  contact.friction = 0;
  materials.add("slick", contact);
  auto world = std::make_unique<World>(options, std::move(materials));
  if (options.periods.length.isZero())
    testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  else
    world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  const std::vector<std::int32_t> shapes = {world->addShape(std::make_shared<Ellipsoid>(Vec3(1e-3, 1e-3, 1.28e-3))),
                                            world->addShape(std::make_shared<Ellipsoid>(Vec3(.6e-3, 1.28e-3, 1e-3)))};
  testing::addLattice(shapes, perSide, pitch, 100, *world);
  for (std::size_t i = 0; i < world->bodies.size(); i += 5) world->bodies.material[i] = 1;
  return world;
}

class Ellipsoids : public ::testing::TestWithParam<Case> {};

TEST_P(Ellipsoids, InBatchesHaveTheSameBitsAsOneByOne) {
  const double pitch = 2.6e-3;
  const auto worlds =
      makeBothWays(GetParam().options, [&](const WorldOptions& o) { return makeEllipsoids(o, 6, pitch); });
  std::size_t contacts = 0, batched = 0;
  for (int n = 0; n < 2000; ++n) {
    for (auto& world : worlds) step(*world, 5e-6);
    ASSERT_TRUE(isSameBits(stateOf(*worlds[0]), stateOf(*worlds[1]))) << "step " << n;
    if (n % 20 != 0) continue;
    ASSERT_TRUE(isSameBits(contactsOf(*worlds[0]), contactsOf(*worlds[1]))) << "step " << n;
    contacts += worlds[0]->contactCount();
    for (const World::Chunk& chunk : worlds[0]->chunks) batched += chunk.briefs.size();
    for (const World::Chunk& chunk : worlds[1]->chunks) ASSERT_TRUE(chunk.briefs.empty());
  }
  EXPECT_GT(contacts, 500u);
  EXPECT_EQ(batched > contacts / 3, GetParam().options.skips.feature);
  EXPECT_EQ(worlds[0]->sleep.fallen > 10, GetParam().options.sleep.on);
  const Report &batches = worlds[0]->report, &oneByOne = worlds[1]->report;
  EXPECT_EQ(batches.contactSteps, oneByOne.contactSteps);
  EXPECT_EQ(batches.narrow.warm, oneByOne.narrow.warm);
  EXPECT_EQ(batches.narrow.cold, oneByOne.narrow.cold);
  EXPECT_EQ(batches.narrow.searches, oneByOne.narrow.searches);
  EXPECT_EQ(batches.narrow.normalFlips, oneByOne.narrow.normalFlips);
  EXPECT_EQ(batches.deepestOverlap, oneByOne.deepestOverlap);
  EXPECT_EQ(batches.deepestA, oneByOne.deepestA);
  EXPECT_EQ(batches.deepestB, oneByOne.deepestB);
}

std::vector<Case> ellipsoidCases() {
  std::vector<Case> all(6);
  all[0].name = "AsTheyAre";
  all[1].name = "FallingAsleep";
  all[1].options.sleep = cases()[5].options.sleep;
  all[2].name = "Hertz";
  all[2].options.law = LawKind::hertz;
  all[3].name = "AtTheDeepestPointPeriodic";
  all[3].options.rule.rule = PointRule::witness;
  all[3].options.periods.length = {6 * 2.6e-3, 6 * 2.6e-3, 0};
  all[3].options.periods.origin = {-3 * 2.6e-3, -3 * 2.6e-3, 0};
  all[4].name = "LookedAtEveryStep";
  all[4].options.skips.separation = false;
  all[5].name = "SearchedAnew";
  all[5].options.skips.feature = false;
  return all;
}

INSTANTIATE_TEST_SUITE_P(World, Ellipsoids, ::testing::ValuesIn(ellipsoidCases()),
                         [](const auto& info) { return info.param.name; });

// Soft enough to sink deeper than the kernel's own proof reaches, where lanes ask the general route.
TEST(EllipsoidLooks, GoToTheGeneralRouteWhereTheyAreDeep) {
  WorldOptions options;
  options.gravity = Vec3(0, 0, -300);
  const Vec3 semiAxes(.3e-3, 1.3e-3, 1.1e-3);
  const auto worlds = makeBothWays(options, [&](const WorldOptions& o) {
    auto world = testing::makeEmptyWorld(o, {20, .5, .5, .3});
    world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
    const auto shape = world->addShape(std::make_shared<Ellipsoid>(semiAxes));
    testing::addLattice({shape}, 4, 2.2e-3, 100, *world);
    return world;
  });
  for (int n = 0; n < 2000; ++n) {
    for (auto& world : worlds) step(*world, 5e-6);
    ASSERT_TRUE(isSameBits(stateOf(*worlds[0]), stateOf(*worlds[1]))) << "step " << n;
  }
  const Ellipsoid shape(semiAxes);
  EXPECT_GT(worlds[0]->report.deepestOverlap * shape.size(), 2 * shape.leastCurvatureRadius());
  EXPECT_EQ(worlds[0]->report.narrow.warm, worlds[1]->report.narrow.warm);
  EXPECT_EQ(worlds[0]->report.narrow.searches, worlds[1]->report.narrow.searches);
}

using Shapes = std::vector<std::shared_ptr<const Shape>>;

/// A heap of these shapes that falls into a box, or onto a floor in a periodic one.
std::unique_ptr<World> makeHeapOf(const Shapes& kinds, const WorldOptions& options, int perSide) {
  auto world = testing::makeEmptyWorld(options);
  const double pitch = 3.2e-3;
  if (options.periods.length.isZero())
    testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  else
    world->walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
  std::vector<std::int32_t> shapes;
  for (const auto& shape : kinds) shapes.push_back(world->addShape(shape));
  testing::addLattice(shapes, perSide, pitch, 60, *world);
  return world;
}

/// A cube, a plate and a rod.
Shapes makeBoxes() {
  Shapes boxes;
  for (const Vec3& half : {Vec3(1e-3, 1e-3, 1e-3), Vec3(1.2e-3, .5e-3, 1.1e-3), Vec3(.5e-3, .6e-3, 1.4e-3)})
    boxes.push_back(std::make_shared<Cuboid>(half));
  return boxes;
}

/// The second moments of a patch times its area, world axes, m^4.
Mat3 inertiaOf(const ContactPatch& patch, const Vec3& normal) {
  const Vec3 &u = patch.u, v = normal.cross(u);
  return patch.area * (patch.uu * u * u.transpose() + patch.vv * v * v.transpose() +
                       patch.uv * (u * v.transpose() + v * u.transpose()));
}

/// A patch made in a batch against the right one, to round-off.
void expectSamePatch(const ContactPatch& found, const ContactPatch& right, const Vec3& normal, double reach,
                     double overlap, double size) {
  const Mat3 inertia = inertiaOf(right, normal);
  const double off = std::max({(found.point - right.point).norm() / reach, (found.centre - right.centre).norm() / reach,
                               std::abs(found.area - right.area) / std::max(right.area, 1e-300),
                               (inertiaOf(found, normal) - inertia).norm() / std::max(inertia.norm(), 1e-300)});
  EXPECT_NEAR(found.depth, right.depth, 1e-9 * overlap + 1e-13 * size);
  EXPECT_NEAR(found.squaredDepth, right.squaredDepth, 1e-9 * overlap * overlap + 1e-13 * size * overlap);
  EXPECT_EQ(found.share, 1);
  // The round-off of places and heights, which the outline is made of.
  EXPECT_LE(off, 1e-10 + 1e3 * std::numeric_limits<double>::epsilon() * size / overlap);
}

/// The two bodies of a contact.
struct Encounter {
  const Shape &a, &b;
  Frame frameA, frameB;
  double size;

  Encounter(const Bodies& bodies, const Contact& contact)
      : a(*bodies.shape[static_cast<std::size_t>(contact.a)]),
        b(*bodies.shape[static_cast<std::size_t>(contact.b)]),
        frameA(bodies.frame[static_cast<std::size_t>(contact.a)]),
        frameB(bodies.frame[static_cast<std::size_t>(contact.b)]),
        size(std::min(a.size(), b.size())) {
    frameB.x += contact.shift;
  }
};

/// What touched in contacts that were held to the search.
struct Seen {
  std::size_t faces = 0, edges = 0, placed = 0, ties = 0;
};

/// The touch of a contact of a batch against the full search, whose cache names what touches: the same depth, between
/// points of either body. False for a tie, where either is right; granted: by how much its depth may be above the
/// least, relative.
bool expectTouchAsSearched(const Encounter& pair, const Contact& contact, double granted, WarmCache& cache,
                           Touch& touch) {
  NarrowCounts counts;
  const Touch& found = contact.touch;
  const bool touches = findTouch(pair.a, pair.frameA, pair.b, pair.frameB, true, cache, counts, touch);
  EXPECT_TRUE(touches);
  const bool ties = (found.normal - touch.normal).norm() > 1e-9;
  EXPECT_GE(found.overlap, touch.overlap - 2e-12 * pair.size);
  EXPECT_LE(found.overlap, (ties ? 1 + granted : 1) * touch.overlap + 2e-12 * pair.size);
  EXPECT_LE((found.onA - found.onB - found.overlap * found.normal).norm(), 1e-14 * pair.size);
  // Where a rim lies so flat that it bends by 1e5 times its radius, round-off leaves the points this far beside each
  // other (slopeOfRoundOff).
  constexpr double within = 1 - 1e-7;
  EXPECT_TRUE(pair.a.contains(within * pair.frameA.toBody(found.onA)));
  EXPECT_TRUE(pair.b.contains(within * pair.frameB.toBody(found.onB)));
  return touches && !ties;
}

/// A contact that was left to the general way has the patch which that makes, to the bit.
void expectPatchOfTheGeneralWay(const RuleOptions& rule, const Encounter& pair, const Contact& contact) {
  ContactPatch patch;
  placeContact(rule, pair.a, pair.frameA, pair.b, pair.frameB, contact.touch, patch);
  EXPECT_EQ(contact.patch.point, patch.point);
  EXPECT_EQ(contact.patch.area, patch.area);
}

/// A contact of a batch against the exhaustive search, and its patch against the walk over all cells.
void expectAsSearched(const World& world, const Contact& contact, Seen& seen) {
  const RuleOptions& rule = world.options.rule;
  const Encounter pair(world.bodies, contact);
  WarmCache cache;
  Touch touch;
  if (!expectTouchAsSearched(pair, contact, 0, cache, touch)) {
    ++seen.ties;
    return;
  }
  EXPECT_LE((contact.touch.onA - touch.onA).norm(), 1e-10 * pair.size);
  (cache.kind == WarmCache::edgePair ? seen.edges : seen.faces) += 1;
  if (!contact.placed) return expectPatchOfTheGeneralWay(rule, pair, contact);
  ++seen.placed;
  const double overlap = contact.touch.overlap;
  const ContactPlane plane(contact.touch);
  OverlapArea area;
  ContactPatch patch;
  ASSERT_TRUE(
      measureByWalk(plane, pair.a, pair.frameA, pair.b, pair.frameB, overlap, powersFor(rule, overlap), 0, area));
  placePressure(rule, plane, area.moments, overlap, area.height, pair.size, patch);
  const double reach = std::sqrt(area.moments.xx / area.moments.area + area.moments.yy / area.moments.area);
  expectSamePatch(contact.patch, patch, contact.touch.normal, reach, overlap, pair.size);
}

class Cuboids : public ::testing::TestWithParam<Case> {};

TEST_P(Cuboids, InBatchesHaveTheTouchesAndPatchesOfOneByOne) {
  const WorldOptions& options = GetParam().options;
  const bool places = placesInLanes(options.rule.rule);
  const auto world = makeHeapOf(makeBoxes(), options, 6);
  startHalfSteps(*world, 5e-6, 0, true);
  Seen seen;
  std::size_t atWalls = 0;
  for (int n = 0; n < 6000; ++n) {
    step(*world, 5e-6);
    if (n % 10 != 0) continue;
    const Bodies& bodies = world->bodies;
    for (std::size_t c = 0; c < world->wallChunkBegin; ++c) {
      ASSERT_EQ(world->chunks[c].find, findCuboidContacts);
      for (const Contact& contact : world->chunks[c].contacts) expectAsSearched(*world, contact, seen);
    }
    // Planes, too.
    std::map<std::pair<std::int32_t, std::int32_t>, const Contact*> found;
    for (std::size_t c = world->wallChunkBegin; c < world->chunks.size(); ++c) {
      EXPECT_EQ(world->chunks[c].find != nullptr, places);
      for (const Contact& contact : world->chunks[c].contacts) found[{contact.a, contact.b}] = &contact;
    }
    for (const WallPair& pair : world->pairs.wallPairs) {
      const auto i = static_cast<std::size_t>(pair.body);
      const Shape& shape = *bodies.shape[i];
      const Plane& plane = *world->walls[static_cast<std::size_t>(pair.wall)]->asPlane();
      const Vec3 deepest = plane.deepest(shape, bodies.frameOf(i));
      const double overlap = plane.depth(deepest);
      const auto at = found.find({pair.body, -1 - pair.wall});
      if (std::abs(overlap) > 1e-14 * shape.size()) {
        ASSERT_EQ(at != found.end(), overlap > 0);
      }
      if (at == found.end()) continue;
      const Contact& contact = *at->second;
      SunkenSurface surface;
      ContactPatch patch;
      surface.look(options.rule, plane, deepest, shape, bodies.frameOf(i));
      const AreaMoments moments = surface.integrateWhole();
      surface.place(options.rule, moments, overlap, patch);
      EXPECT_EQ(contact.touch.normal, -plane.normal);
      EXPECT_NEAR(contact.touch.overlap, overlap, 1e-14 * shape.size());
      if (!contact.placed) {
        EXPECT_EQ(contact.patch.point, patch.point);
        EXPECT_EQ(contact.patch.area, patch.area);
        continue;
      }
      ++atWalls;
      const double reach = std::sqrt(moments.xx / moments.area + moments.yy / moments.area);
      expectSamePatch(contact.patch, patch, contact.touch.normal, reach, overlap, shape.size());
    }
  }
  EXPECT_EQ(atWalls > 300, places);
  EXPECT_GT(seen.faces, 2000u);
  EXPECT_GT(seen.edges, 2000u);
  EXPECT_LT(seen.ties, (seen.faces + seen.edges) / 100);
  EXPECT_EQ(seen.placed > (seen.faces + seen.edges) * 8 / 10, places);
}

std::vector<Case> boxCases() {
  std::vector<Case> all(5);
  all[4].name = "Foundation";
  all[4].options.rule.rule = PointRule::foundation;
  all[0].name = "Patch";
  all[0].options.rule.rule = PointRule::patch;
  all[1].name = "PressureCentroid";
  all[1].options.rule.rule = PointRule::pressureCentroid;
  all[2].name = "StiffPatch";
  all[3].name = "PatchInAPeriodicBox";
  all[3].options.rule.rule = PointRule::patch;
  all[3].options.periods.length = {6 * 3.2e-3, 6 * 3.2e-3, 0};
  all[3].options.periods.origin = {-3 * 3.2e-3, -3 * 3.2e-3, 0};
  return all;
}

INSTANTIATE_TEST_SUITE_P(World, Cuboids, ::testing::ValuesIn(boxCases()),
                         [](const auto& info) { return info.param.name; });

/// A rock, a tetrahedron, a prism whose ends have more corners than lanes look at, and a pyramid over such an end.
Shapes makePolyhedra() {
  Random random(5);
  std::vector<Vec3> tetrahedron, prism, pyramid = {Vec3(0, 0, 1.2e-3)};
  for (const Vec3& v : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)})
    tetrahedron.push_back(.8e-3 * v);
  for (int k = 0; k < 28; ++k) {
    const int side = k / 2;
    const double angle = side * pi / 7;
    prism.emplace_back(1e-3 * std::cos(angle), 1e-3 * std::sin(angle), k % 2 ? .9e-3 : -.9e-3);
    if (k % 2) pyramid.emplace_back(1.1e-3 * std::cos(angle), 1.1e-3 * std::sin(angle), -.6e-3);
  }
  return {testing::makeRock(random, 24, 1.3e-3, Vec3(1, .8, 1.2)), std::make_shared<Polyhedron>(tetrahedron),
          std::make_shared<Polyhedron>(prism), std::make_shared<Polyhedron>(pyramid)};
}

/// Lets a heap fall; calls visit(contact) for all contacts between its bodies in every eighth step, which must have
/// been found in batches by `find`.
template <class Visit>
void visitFound(decltype(World::Chunk::find) find, World& world, Visit&& visit) {
  for (int n = 0; n < 6000; ++n) {
    step(world, 5e-6);
    if (n % 8 != 0) continue;
    for (std::size_t c = 0; c < world.wallChunkBegin; ++c) {
      ASSERT_EQ(world.chunks[c].find, find);
      for (const Contact& contact : world.chunks[c].contacts) visit(contact);
    }
  }
}

class Polyhedra : public ::testing::TestWithParam<Case> {};

TEST_P(Polyhedra, InBatchesHaveTheTouchesAndPatchesOfOneByOne) {
  WorldOptions options = GetParam().options;
  options.gravity = Vec3(0, 0, -50);  // so that they are together soon
  const auto world = makeHeapOf(makePolyhedra(), options, 5);
  startHalfSteps(*world, 5e-6, 0, true);
  Seen seen;
  visitFound(findPolyhedronContacts, *world, [&](const Contact& contact) { expectAsSearched(*world, contact, seen); });
  EXPECT_GT(seen.faces, 1000u);
  EXPECT_GT(seen.edges, 1000u);
  EXPECT_LT(seen.ties, (seen.faces + seen.edges) / 100);
  EXPECT_EQ(seen.placed > (seen.faces + seen.edges) / 3, placesInLanes(options.rule.rule));
}

INSTANTIATE_TEST_SUITE_P(World, Polyhedra, ::testing::ValuesIn(boxCases()),
                         [](const auto& info) { return info.param.name; });

/// As long as wide, a rod and a disk.
Shapes makeCylinders() {
  return {std::make_shared<Cylinder>(1.1e-3, 2.2e-3), std::make_shared<Cylinder>(.7e-3, 2.8e-3),
          std::make_shared<Cylinder>(1.4e-3, 1e-3)};
}

class Cylinders : public ::testing::TestWithParam<Case> {};

TEST_P(Cylinders, InBatchesHaveTheTouchesAndPatchesOfOneByOne) {
  WorldOptions options = GetParam().options;
  options.gravity = Vec3(0, 0, -50);  // so that they are together soon
  const auto world = makeHeapOf(makeCylinders(), options, 5);
  startHalfSteps(*world, 5e-6, 0, true);
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> seen;  // by kinds of pieces
  std::size_t placed = 0, ties = 0;
  visitFound(findCylinderContacts, *world, [&](const Contact& contact) {
    const Encounter pair(world->bodies, contact);
    WarmCache cache;
    Touch touch;
    // What the proofs leave to minima within 10 degrees of each other (global_proof.h).
    const double granted = 1 / std::cos(pi / 18) - 1;
    if (!expectTouchAsSearched(pair, contact, granted, cache, touch)) {
      ++ties;
      return;
    }
    const std::int32_t a = decodePiece(cache.featureA).kind, b = decodePiece(cache.featureB).kind;
    ++seen[{std::min(a, b), std::max(a, b)}];
    if (!contact.placed) {
      expectPatchOfTheGeneralWay(options.rule, pair, contact);
      return;
    }
    ++placed;
    ContactPatch patch;
    placeContact(options.rule, pair.a, pair.frameA, pair.b, pair.frameB, contact.touch, patch);
    // One by one places are round-off of the world's coordinates away from their right ones; where a strip ends is
    // told by the depth along it, as much less exactly as it is long.
    const double longest = std::max(pair.a.longestExtent(), pair.b.longestExtent());
    const double extent = (pair.size + contact.patch.point.norm()) * longest / pair.size;
    expectSamePatch(contact.patch, patch, contact.touch.normal, pair.size, contact.touch.overlap, extent);
  });
  std::size_t all = 0;
  for (const auto& [kinds, count] : seen) all += count;
  EXPECT_GT((seen[{PieceName::side, PieceName::side}]), 500u);
  EXPECT_GT((seen[{PieceName::rim, PieceName::side}]), 500u);
  EXPECT_GT((seen[{PieceName::rim, PieceName::face}]), 500u);
  EXPECT_LT(ties, all / 50);
  const PointRule rule = options.rule.rule;
  EXPECT_EQ(placed > all / 2, rule == PointRule::patch || rule == PointRule::pressureCentroid);
}

INSTANTIATE_TEST_SUITE_P(World, Cylinders, ::testing::ValuesIn(boxCases()),
                         [](const auto& info) { return info.param.name; });

// Pairs of other bodies, between theirs in the order of ids, change who shares a register and when it is full.
TEST(LaneLooks, InBatchesMoveByTheSameBitsWhoeverSharesTheirBatch) {
  const Shapes polyhedra = makePolyhedra(), cylinders = makeCylinders();
  const Shapes boxes = {std::make_shared<Cuboid>(Vec3(1e-3, .8e-3, 1.2e-3))};
  for (const auto& [rule, all] : {std::pair{PointRule::patch, boxes}, std::pair{PointRule::stiffPatch, boxes},
                                  std::pair{PointRule::patch, polyhedra}, std::pair{PointRule::stiffPatch, polyhedra},
                                  std::pair{PointRule::patch, cylinders}}) {
    std::unique_ptr<World> worlds[2];
    for (const bool crowded : {false, true}) {
      WorldOptions options;
      options.rule.rule = rule;
      worlds[crowded] = testing::makeEmptyWorld(options);
      World& world = *worlds[crowded];
      world.walls.push_back(makePlaneWall(Vec3::Zero(), Vec3::UnitZ()));
      std::vector<std::int32_t> shapes;  // the first is looked at, all of them, of other measures, are the crowd
      for (const auto& each : all) shapes.push_back(world.addShape(each));
      Random random(3), others(4);
      for (int k = 0; k < 125; ++k) {
        NewBody body;
        body.shapeIndex = shapes.front();
        const auto draw = [&](Random& from) {
          const int row = k / 5 % 5, layer = k / 25;
          body.pose.x = 2.3e-3 * Vec3(k % 5, row, layer + .7);
          body.pose.q = from.rotation();
          body.velocity = Vec3(k % 5 < 2 ? .2 : -.2, row < 2 ? .2 : -.2, 0);
        };
        draw(random);
        world.addBody(body);
        if (!crowded || k % 3 == 2) continue;
        draw(others);
        body.pose.x.x() += 1;
        body.shapeIndex = shapes[static_cast<std::size_t>(k) % shapes.size()];
        world.addBody(body);
      }
      startHalfSteps(world, 5e-6, 0, true);
    }
    const auto stateOfThese = [](const World& world) {
      std::vector<double> state;
      for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        if (world.bodies.x(i).x() > .5) continue;
        for (int k = 0; k < 3; ++k) state.insert(state.end(), {world.bodies.x(i)[k], world.bodies.w(i)[k]});
      }
      return state;
    };
    std::size_t contacts = 0, crowd = 0;
    for (int n = 0; n < 1000; ++n) {
      for (auto& world : worlds) step(*world, 5e-6);
      ASSERT_TRUE(isSameBits(stateOfThese(*worlds[0]), stateOfThese(*worlds[1]))) << "step " << n;
      contacts += worlds[0]->contactCount();
      crowd += worlds[1]->contactCount();
    }
    EXPECT_GT(contacts, 5000u);
    EXPECT_GT(crowd, contacts + 1000);
  }
}

/// Bodies that fall together between walls, one of which shakes; three materials, one frictionless, one without
/// damping.
std::unique_ptr<World> makeGrains(const WorldOptions& options,
                                  const std::vector<std::shared_ptr<const Shape>>& shapes) {
  MaterialTable materials;
  materials.add("rough", {1e4, .8, .6, .4});
  materials.add("slick", {2e4, .5, .6, 0});
  materials.add("lively", {1e4, 1, 1, .2});
  WorldOptions heavy = options;
  heavy.gravity = Vec3(0, 0, -100);  // so that they are together soon
  auto world = std::make_unique<World>(heavy, std::move(materials));
  const double pitch = 2.7e-3;
  const int perSide = 5;
  testing::addBoxOfPlanes(0.5 * pitch * perSide, *world);
  WallPath path;
  path.amplitude = Vec3(1e-4, 0, 1e-5);
  path.frequency = 300;
  path.spin = Vec3(0, 0, 20);
  world->walls.front() = makeMovingWall(std::move(world->walls.front()), path, {});
  world->walls.front()->material = 2;
  std::vector<std::int32_t> kinds;
  for (const auto& shape : shapes) kinds.push_back(world->addShape(shape));
  testing::addLattice(kinds, perSide, pitch, 100, *world);
  for (std::size_t i = 0; i < world->bodies.size(); ++i) world->bodies.material[i] = std::int32_t(i % 7 % 3);
  return world;
}

struct Grains {
  const char* name;
  std::vector<std::shared_ptr<const Shape>> shapes;
  WorldOptions options;
  enum { none, some, all } areas;  ///< which contacts have a patch
};
void PrintTo(const Grains& grains, std::ostream* out) { *out << grains.name; }

class Contacts : public ::testing::TestWithParam<Grains> {};

TEST_P(Contacts, PressedInLanesHaveTheSameBitsAsOneByOne) {
  const auto worlds =
      makeBothWays(GetParam().options, [](const WorldOptions& o) { return makeGrains(o, GetParam().shapes); });
  std::size_t contacts = 0, sliding = 0, areas = 0, atWalls = 0;
  for (int n = 0; n < 2000; ++n) {
    for (auto& world : worlds) step(*world, 5e-6);
    ASSERT_TRUE(isSameBits(stateOf(*worlds[0]), stateOf(*worlds[1]))) << "step " << n;
    if (n % 20 != 0) continue;
    ASSERT_TRUE(isSameBits(contactsOf(*worlds[0]), contactsOf(*worlds[1]))) << "step " << n;
    worlds[0]->visitContacts([&](const Contact& contact) {
      ++contacts;
      sliding += contact.force.sliding;
      areas += contact.patch.area > 0;
      atWalls += contact.b < 0;
    });
  }
  EXPECT_GT(atWalls, 300u);
  EXPECT_GT(contacts, atWalls + 500);
  EXPECT_GT(sliding, 100u);
  EXPECT_LT(sliding, contacts);
  EXPECT_EQ(areas > 100, GetParam().areas != Grains::none);
  EXPECT_EQ(areas == contacts, GetParam().areas == Grains::all);
}

std::vector<Grains> grains() {
  const auto cube = std::make_shared<Cuboid>(Vec3(1.1e-3, 1.1e-3, 1.1e-3));
  const auto cylinder = std::make_shared<Cylinder>(1.1e-3, 2e-3);
  const auto ellipsoid = std::make_shared<Ellipsoid>(Vec3(1e-3, 1.2e-3, 1.5e-3));
  const auto clump = std::make_shared<Clump>(
      std::vector<ChildSphere>{{Vec3(-.6e-3, 0, 0), .9e-3}, {Vec3(.6e-3, 0, 0), .9e-3}, {Vec3(0, .7e-3, 0), .8e-3}});
  const auto sphere = std::make_shared<Sphere>(1.3e-3);
  // Searched for anew, the contacts of cubes are found one by one either way: those of batches agree to round-off only.
  const auto withRule = [](PointRule rule) {
    WorldOptions options;
    options.rule.rule = rule;
    options.skips.feature = false;
    return options;
  };
  std::vector<Grains> all = {
      {"CubesPatch", {cube}, withRule(PointRule::patch), Grains::all},
      {"CubesStiffPatch", {cube}, withRule(PointRule::stiffPatch), Grains::all},
      {"CubesPressureCentroid", {cube}, withRule(PointRule::pressureCentroid), Grains::none},
      {"CubesWitness", {cube}, withRule(PointRule::witness), Grains::none},
      {"CubesFoundation", {cube}, withRule(PointRule::foundation), Grains::all},
      {"CubesManifold", {cube}, withRule(PointRule::manifold), Grains::none},
      {"Cylinders", {cylinder}, withRule(PointRule::patch), Grains::some},
      {"Ellipsoids", {ellipsoid}, withRule(PointRule::patch), Grains::none},
      {"Clumps", {clump}, withRule(PointRule::patch), Grains::none},
      {"Mixed", {cube, clump, ellipsoid, sphere, cylinder}, {}, Grains::some},
      {"MixedWithoutTension", {cube, clump, ellipsoid, sphere, cylinder}, {}, Grains::some},
      {"MixedSlidingAlongTheVelocity", {cube, clump, ellipsoid, sphere, cylinder}, {}, Grains::some},
      {"MixedFallingAsleep", {cube, clump, ellipsoid, sphere, cylinder}, {}, Grains::some},
  };
  all[10].options.lawOptions.tension = false;
  all[10].options.lawOptions.frictionOfPush = true;
  all[11].options.lawOptions.slideAlongVelocity = true;
  SleepOptions& sleep = all[12].options.sleep;
  sleep.on = true;
  sleep.time = 1e-3;
  sleep.energy = 1;
  sleep.balance = 1e3;
  sleep.wake = 1;
  return all;
}

INSTANTIATE_TEST_SUITE_P(World, Contacts, ::testing::ValuesIn(grains()),
                         [](const auto& info) { return info.param.name; });

/// With one thread forces are added contact by contact, with several body by body.
TEST(Balls, MoveByTheSameBitsWithOneTwoAndFourThreads) {
  std::vector<std::vector<double>> states;
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    auto world = makeBalls({}, 17);
    testing::run(*world, 5e-6, 30);
    EXPECT_GE(world->bodies.movingSlots().size(), bodiesForThreads);
    EXPECT_GE(world->chunks.size(), chunksForThreads);
    EXPECT_GT(world->report.contactSteps, 1000u);
    states.push_back(stateOf(*world));
  }
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_TRUE(isSameBits(states[0], states[1]));
  EXPECT_TRUE(isSameBits(states[0], states[2]));
}

}  // namespace
}  // namespace granular
