// (e) Stacks: forces between cubes at rest, overhangs, towers of unequal blocks, dominoes.
#include <fmt/format.h>

#include <algorithm>

#include "verification/record.h"
#include "verification/scenes.h"

namespace granular {
namespace {

constexpr double gravity = 9.81, half = 1.5e-3;

WorldOptions stackOptions() {
  WorldOptions options = plainOptions();
  options.gravity = Vec3(0, 0, -gravity);
  return options;
}

/// One block of a tower: half-lengths, density, offset along x, turn about z.
struct Block {
  Vec3 half = Vec3::Constant(granular::half);
  double density = 2500, offset = 0, turn = 0;
  double weight() const { return density * 8 * half.prod() * gravity; }
};

/// From the floor up, each overlap the one that carries what is above: a static start.
std::unique_ptr<World> makeTower(const std::vector<Block>& blocks, const ContactParameters& contact) {
  auto world = makeWorld(stackOptions(), contact);
  addFloor(*world);
  double top = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    double carried = 0;
    for (std::size_t i = k; i < blocks.size(); ++i) carried += blocks[i].weight();
    top -= carried / contact.stiffness;
    const Block& block = blocks[k];
    place(*world, cuboidOf(block.half), {block.offset, 0, top + block.half.z()},
          Quat(Eigen::AngleAxisd(block.turn, Vec3::UnitZ())), block.density);
    top += 2 * block.half.z();
  }
  return world;
}

double stepOf(const World& world, double fraction) {
  const double lightest = *std::min_element(world.bodies.mass.begin(), world.bodies.mass.end());
  return fraction * pi * std::sqrt(0.5 * lightest / world.materials.constants(0, 0).parameters.stiffness);
}

/// Largest relative error of the force between neighbours (and on the floor) against the weight above.
double worstForceError(const World& world) {
  const std::size_t n = world.bodies.size();
  std::vector<double> carried(n, 0), got(n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = k; i < n; ++i) carried[k] += world.bodies.mass[i] * gravity;
  }
  world.visitContacts([&](const Contact& c) {
    const std::int32_t upper = std::max(c.a, c.b);
    got[static_cast<std::size_t>(upper)] += std::abs(c.force.force.z());
  });
  double worst = 0;
  for (std::size_t k = 0; k < n; ++k) worst = std::max(worst, std::abs(got[k] / carried[k] - 1));
  return worst;
}

TEST(Stacks, EachInterfaceCarriesTheWeightAbove) {
  struct Case {
    const char* name;
    double offset, turn, small, light;
  };
  const Case cases[] = {{"exactly aligned", 0, 0, 1, 1},         {"offset by round-off", 1e-18, 0, 1, 1},
                        {"offset by 10 %", .2 * half, 0, 1, 1},  {"every second turned by 45 deg", 0, pi / 4, 1, 1},
                        {"alternating sizes 1:10", 0, 0, .1, 1}, {"alternating masses 1:1000", 0, 0, 1, 1e-3}};
  for (const Case& c : cases) {
    std::vector<Block> blocks(6);
    for (std::size_t k = 1; k < blocks.size(); k += 2) {
      blocks[k].offset = c.offset;
      blocks[k].turn = c.turn;
      blocks[k].half *= c.small;
      blocks[k].density *= c.light;
    }
    // An offset block rocks before it rests: the others start at rest.
    auto world = makeTower(blocks, {1e6, .3, .3, .5});
    const bool rocks = c.offset > 1e-6;
    runFor(*world, stepOf(*world, .1), rocks ? .4 : .005);
    verifyBelow('e', fmt::format("six cubes, {}: worst error of F/(weight above)", c.name), 1e-6,
                worstForceError(*world), rocks ? "statics, after .4 s of decay" : "statics, from a static start");
    double lateral = 0;
    for (std::size_t k = 0; k < blocks.size(); ++k)
      lateral = std::max(lateral, std::abs(world->bodies.x(k).x() - blocks[k].offset));
    verifyBelow('e', fmt::format("six cubes, {}: drift / side", c.name), 1e-3, lateral / (2 * half), "stands");
  }
}

/// True if n blocks with the harmonic overhang times `factor` still stand after `time`.
bool standsOverhang(int n, double factor, double stiffness, double time) {
  std::vector<Block> blocks(static_cast<std::size_t>(n) + 1);
  // Block k (from the top, 0) sticks out 1/(2 (k + 1)) lengths beyond the one below; the lowest is the table.
  // The table's edge, then the blocks' centres.
  double offset = 20 * half - half;
  for (int k = n; k >= 1; --k) {
    offset += factor * 2 * half / (2 * k);
    blocks[static_cast<std::size_t>(n - k + 1)].offset = offset;
  }
  blocks[0].half = Vec3(20 * half, 4 * half, half);
  auto world = makeTower(blocks, {stiffness, .3, .3, .8});
  const double height = world->bodies.bounds.back().x.z();
  runFor(*world, stepOf(*world, .1), time);
  return world->bodies.bounds.back().x.z() > height - .2 * half;
}

TEST(Stacks, HarmonicOverhangStandsJustInsideAndFallsJustOutside) {
  const double reach[] = {.5, .75, .91667, 1.04167, 1.14167, 1.225};
  double sum = 0;
  for (int n = 1; n <= 6; ++n) {
    sum += 0.5 / n;
    verify('e', fmt::format("overhang of {} blocks, lengths", n), reach[n - 1], sum, 5.1e-6,
           "harmonic sum, five digits");
  }
  for (const double factor : {.98, 1.02}) {
    verifyThat('e', fmt::format("one block at {} of its overhang {}", factor, factor < 1 ? "stands" : "falls"),
               standsOverhang(1, factor, 1e6, .15) == (factor < 1), "statics");
    verifyThat('e', fmt::format("two blocks at {} of their overhang {}", factor, factor < 1 ? "stand" : "fall"),
               standsOverhang(2, factor, 1e6, .15) == (factor < 1), "statics");
  }
}

/// Time between the falls of the second and the fifth of six dominoes, s.
double dominoTime(double g, double stiffness) {
  WorldOptions options = stackOptions();
  options.gravity = Vec3(0, 0, -g);
  auto world = makeWorld(options, {stiffness, .4, .4, .5});
  addFloor(*world);
  const Vec3 size(.5e-3, 2e-3, 4e-3);
  const auto shape = cuboidOf(size);
  for (int k = 0; k < 6; ++k) place(*world, shape, {k * 3e-3, 0, size.z() - 2500 * 8 * size.prod() * g / stiffness});
  move(*world, 0, {.6 * std::sqrt(g * size.z()), 0, 0}, {0, .6 * std::sqrt(g / size.z()), 0});
  const double dt = stepOf(*world, .08);
  startHalfSteps(*world, dt, 0, true);
  double first = 0;
  while (world->time < 1 / std::sqrt(g)) {
    step(*world, dt);
    const auto fell = [&](std::size_t k) {
      return world->bodies.orientation(k).angularDistance(Quat::Identity()) > .3;
    };
    if (first == 0 && fell(1)) first = world->time;
    if (fell(4)) return world->time - first;
  }
  return infinity;
}

TEST(Stacks, DominoesRunWithTheRootOfGravity) {
  // All speeds scale with sqrt(g) if overlaps do not matter; here k_n stays, so that they grow with g: m g/k_n over the
  // size is 1e-6.
  const double ratio = dominoTime(9.81, 1e6) / dominoTime(4 * 9.81, 1e6);
  verify('e', "dominoes: time at g over time at 4 g", 2, ratio, .04,
         "similarity; contacts last a hundredth of the fall");
}

}  // namespace
}  // namespace granular
