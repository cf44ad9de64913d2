// Clumps: the union of their spheres against closed forms of lenses and chains, then against counted points, and the
// bounding tree against looking at every sphere.
#include "granular/shape/clump.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "granular/core/errors.h"
#include "granular/core/gauss_legendre.h"
#include "granular/core/random.h"
#include "granular/shape/bullet_clump.h"

namespace granular {
namespace {

std::vector<ChildSphere> randomSpheres(Random& random, int count, double scale) {
  std::vector<ChildSphere> spheres;
  for (int k = 0; k < count; ++k) {
    const Vec3 centre(random.uniform(-2, 2), random.uniform(-1, 1), random.uniform(-1, 1));
    spheres.push_back({scale * centre, scale * random.uniform(0.3, 1)});
  }
  return spheres;
}

/// A chain of spheres on a line, each cutting only its neighbours: zones of spheres between planes.
struct Zone {
  double from, to, centre, radius;
};
std::vector<Zone> zonesOf(const std::vector<Vec2>& chain) {  // (x, radius), ascending
  std::vector<Zone> zones;
  double from = chain.front().x() - chain.front().y();
  for (std::size_t k = 0; k < chain.size(); ++k) {
    double to = chain[k].x() + chain[k].y();
    if (k + 1 < chain.size()) {
      const double d = chain[k + 1].x() - chain[k].x();
      const double r = chain[k].y(), s = chain[k + 1].y();
      to = chain[k].x() + (d * d + r * r - s * s) / (2 * d);
    }
    zones.push_back({from, to, chain[k].x(), chain[k].y()});
    from = to;
  }
  return zones;
}

/// Measures of the body of revolution, polynomials per zone: five Gauss points are exact.
struct ChainMeasures {
  double volume = 0, centre = 0, axial = 0, across = 0, area = 0, squares = 0;
};
ChainMeasures measureChain(const std::vector<Vec2>& chain) {
  ChainMeasures m;
  const auto overZones = [&](auto add) {
    for (const Zone& zone : zonesOf(chain)) {
      for (int k = 0; k < 5; ++k) {
        const auto [node, weight] = gaussLegendreNode(5, k);
        const double half = 0.5 * (zone.to - zone.from);
        const double x = 0.5 * (zone.from + zone.to) + half * node;
        add(x, zone.radius * zone.radius - (x - zone.centre) * (x - zone.centre), zone.radius, weight * half);
      }
    }
  };
  overZones([&](double x, double square, double, double w) {
    m.volume += w * pi * square;
    m.centre += w * pi * square * x;
  });
  m.centre /= m.volume;
  overZones([&](double x, double square, double radius, double w) {
    const double from = x - m.centre;
    m.axial += w * pi / 2 * square * square;
    m.across += w * pi * (square * square / 4 + square * from * from);
    m.area += w * 2 * pi * radius;
    m.squares += w * 2 * pi * radius * (square + from * from);
  });
  return m;
}

void expectChain(const std::vector<Vec2>& chain, const Mat3& turn) {
  const ChainMeasures exact = measureChain(chain);
  std::vector<ChildSphere> spheres;
  for (const Vec2& each : chain) spheres.push_back({turn * Vec3(each.x(), 0, 0) + Vec3(1, -2, 3), each.y()});
  const SolidProperties solid = unionProperties(spheres);
  const double precision = 1e-11;
  EXPECT_NEAR(solid.principal.volume, exact.volume, precision * exact.volume);
  EXPECT_NEAR(solid.principal.area, exact.area, precision * exact.area);
  EXPECT_NEAR(solid.principal.meanSquareRadius * exact.area, exact.squares, precision * exact.squares);
  EXPECT_LT((solid.centroid - turn * Vec3(exact.centre, 0, 0) - Vec3(1, -2, 3)).norm(), 1e-11);
  const Vec3 axis = turn.col(0);
  EXPECT_NEAR(axis.dot(solid.inertia * axis), exact.axial, precision * exact.across);
  EXPECT_NEAR(turn.col(1).dot(solid.inertia * turn.col(1)), exact.across, precision * exact.across);
  EXPECT_NEAR(turn.col(2).dot(solid.inertia * axis), 0, precision * exact.across);
}

TEST(SphereUnion, OneSphereHasItsMeasuresToTheBit) {
  const Sphere sphere(1.5e-3);
  const Clump clump(std::vector<ChildSphere>{{Vec3(1, 2, 3), 1.5e-3}});
  EXPECT_EQ(clump.massProperties().volume, sphere.massProperties().volume);
  EXPECT_EQ(clump.massProperties().area, sphere.massProperties().area);
  EXPECT_EQ(clump.massProperties().inertia, sphere.massProperties().inertia);
  EXPECT_EQ(clump.massProperties().meanSquareRadius, sphere.massProperties().meanSquareRadius);
  EXPECT_EQ(clump.boundingRadius(), sphere.boundingRadius());
  EXPECT_EQ(clump.innerRadius(), sphere.innerRadius());
  EXPECT_EQ(clump.longestExtent(), sphere.longestExtent());
  EXPECT_EQ(clump.size(), sphere.size());
  EXPECT_EQ(clump.children()[0].centre, Vec3::Zero());
}

TEST(SphereUnion, TwoSpheresLessTheirLensMeetTheClosedForm) {
  for (const double distance : {0.2, 0.9, 1.4, 1.69999}) {
    const double r = 1, s = 0.7;
    if (distance <= r - s) continue;
    const std::vector<ChildSphere> pair{{Vec3::Zero(), r}, {Vec3(0, distance, 0), s}};
    // The lens of two spheres (two caps).
    const double lens = pi * std::pow(r + s - distance, 2) *
                        (distance * distance + 2 * distance * (r + s) - 3 * (r - s) * (r - s)) / (12 * distance);
    const double both = 4 * pi / 3 * (r * r * r + s * s * s);
    EXPECT_NEAR(unionProperties(pair).principal.volume, both - lens, 1e-11 * both) << distance;
  }
}

TEST(SphereUnion, ChainsInAnyDirectionMeetTheirClosedForms) {
  Random random(7);
  const std::vector<std::vector<Vec2>> chains{{{0, 1}, {1.2, 0.7}},
                                              {{0, 1}, {1.999999, 1}},
                                              {{-2, 0.5}, {-1.2, 0.8}, {0, 1}, {1.2, 0.8}, {2, 0.5}},
                                              {{0, 0.1}, {0.15, 0.1}, {0.3, 0.1}, {0.45, 0.1}}};
  for (const auto& chain : chains) {
    expectChain(chain, Mat3::Identity());
    expectChain(chain, (Mat3() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished());
    for (int trial = 0; trial < 5; ++trial) expectChain(chain, random.rotation().toRotationMatrix());
  }
}

TEST(SphereUnion, SeparateSpheresAddUp) {
  const std::vector<ChildSphere> spheres{{Vec3(0, 0, 0), 1}, {Vec3(3, 0, 0), 1}, {Vec3(0, 5, 1), 0.5}};
  EXPECT_NEAR(unionProperties(spheres).principal.volume, 4 * pi / 3 * 2.125, 1e-12);
  EXPECT_EQ(countParts(spheres), 3);
  EXPECT_EQ(countParts(std::vector<ChildSphere>{{Vec3(0, 0, 0), 1}, {Vec3(1.5, 0, 0), 0.5}, {Vec3(2.5, 0, 0), 0.5}}),
            1);
}

TEST(SphereUnion, MeasuresTurnAndMoveWithTheSpheres) {
  Random random(11);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<ChildSphere> spheres = randomSpheres(random, 3 + 4 * trial, 1);
    const SolidProperties before = unionProperties(spheres);
    const Mat3 turn = random.rotation().toRotationMatrix();
    for (ChildSphere& child : spheres) child.centre = turn * child.centre + Vec3(5, -7, 2);
    const SolidProperties after = unionProperties(spheres);
    EXPECT_NEAR(after.principal.volume, before.principal.volume, 1e-10 * before.principal.volume);
    EXPECT_NEAR(after.principal.area, before.principal.area, 1e-10 * before.principal.area);
    EXPECT_NEAR(after.principal.meanSquareRadius, before.principal.meanSquareRadius,
                1e-10 * before.principal.meanSquareRadius);
    EXPECT_LT((after.centroid - turn * before.centroid - Vec3(5, -7, 2)).norm(), 1e-10);
    EXPECT_LT((after.inertia - turn * before.inertia * turn.transpose()).norm(), 1e-10 * before.inertia.norm());
  }
}

TEST(SphereUnion, VolumeAndInertiaAreThoseOfCountedPoints) {
  Random random(13);
  for (int trial = 0; trial < 4; ++trial) {
    const Clump clump(randomSpheres(random, 12, 1));
    const Aabb box = clump.bounds(Frame{});
    const Vec3 extent = box.hi - box.lo;
    const double all = extent.prod();
    const int count = 400000;
    double inside = 0;
    Vec3 inertia = Vec3::Zero(), centre = Vec3::Zero();
    for (int n = 0; n < count; ++n) {
      const Vec3 p = box.lo + Vec3(random.uniform(), random.uniform(), random.uniform()).cwiseProduct(extent);
      if (!clump.contains(p)) continue;
      inside += 1;
      centre += p;
      inertia += Vec3::Constant(p.squaredNorm()) - p.cwiseProduct(p);
    }
    // Five standard errors of the counted share; moments weigh the outer points by up to their squared distance.
    const double share = inside / count, volume = clump.massProperties().volume;
    const double error = 5 * all * std::sqrt(share * (1 - share) / count);
    const double reach = clump.boundingRadius();
    EXPECT_NEAR(share * all, volume, error);
    EXPECT_LT(centre.norm() * all / count, error * reach);
    EXPECT_LT((inertia * all / count - clump.massProperties().inertia).norm(), error * reach * reach);
  }
}

TEST(SphereUnion, HiddenSpheresChangeNothing) {
  std::vector<ChildSphere> spheres{{Vec3(0, 0, 0), 1}, {Vec3(1, 0, 0), 0.8}};
  const Clump plain(spheres);
  spheres.push_back({Vec3(0.1, 0.1, 0), 0.5});
  spheres.push_back({Vec3(1, 0, 0), 0.8});
  const Clump crowded(spheres);
  ASSERT_EQ(crowded.children().size(), 2u);
  EXPECT_EQ(crowded.massProperties().volume, plain.massProperties().volume);
  EXPECT_EQ(crowded.children()[1].centre, plain.children()[1].centre);
}

TEST(Clump, IsRefusedWithTheReason) {
  const auto refusal = [](const std::vector<ChildSphere>& spheres) -> std::string {
    try {
      const Clump clump(spheres);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal({}), "clump: no spheres given; at least one is needed");
  EXPECT_EQ(refusal({{Vec3::Zero(), 1}, {Vec3::Zero(), -2}}),
            "clump: radius of sphere 2 is -2 m; it must be finite and above 0");
  EXPECT_EQ(refusal({{Vec3(0, std::nan(""), 0), 1}}), "clump: the centre of sphere 1 is not finite");
}

TEST(Clump, SaysWhenItsSpheresDontHangTogether) {
  const Clump clump(std::vector<ChildSphere>{{Vec3(0, 0, 0), 1e-3}, {Vec3(5e-3, 0, 0), 1e-3}});
  EXPECT_EQ(clump.parts(), 2);
  EXPECT_NE(clump.describe().find("in 2 parts that do not touch"), std::string::npos);
}

TEST(Clump, LiesAlongItsPrincipalAxesAboutItsCentreOfMass) {
  Random random(17);
  for (int trial = 0; trial < 5; ++trial) {
    const std::vector<ChildSphere> spheres = randomSpheres(random, 9, 1e-3);
    Frame toBody;
    const Clump clump(spheres, &toBody);
    const SolidProperties own = unionProperties(clump.children());
    EXPECT_LT(own.centroid.norm(), 1e-11 * clump.size());
    const Mat3 skew = own.inertia - Mat3(clump.massProperties().inertia.asDiagonal());
    EXPECT_LT(skew.norm(), 1e-9 * own.inertia.norm());
    for (int n = 0; n < 200; ++n) {
      const Vec3 p = 2e-3 * random.direction() * random.uniform();
      const bool inside = std::any_of(spheres.begin(), spheres.end(), [&](const ChildSphere& child) {
        return (toBody.toWorld(p) - child.centre).norm() <= child.radius;
      });
      EXPECT_EQ(clump.contains(p), inside);
    }
  }
}

TEST(Clump, KeepsPrescribedMassProperties) {
  MassProperties prescribed;
  prescribed.volume = 2;
  prescribed.area = 5;
  prescribed.inertia = Vec3(1, 2, 2.5);
  prescribed.meanSquareRadius = 1.5;
  const Clump clump(std::vector<ChildSphere>{{Vec3(0.1, 0, 0), 0.5}}, prescribed);
  EXPECT_EQ(clump.massProperties().inertia, prescribed.inertia);
  EXPECT_EQ(clump.children()[0].centre, Vec3(0.1, 0, 0));
  EXPECT_NEAR(clump.unionMeasures().volume, pi / 6, 1e-14);
  prescribed.volume = 0;
  EXPECT_THROW(Clump(std::vector<ChildSphere>{{Vec3::Zero(), 1}}, prescribed), InputError);
}

TEST(Clump, BoundsAreThoseOfItsSpheres) {
  Random random(19);
  const Clump clump(randomSpheres(random, 20, 1));
  for (int trial = 0; trial < 20; ++trial) {
    const Frame frame(random.rotation().toRotationMatrix(), random.direction());
    const Aabb box = clump.bounds(frame);
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = frame.unrotate(Vec3::Unit(k));
      EXPECT_NEAR(box.hi[k], frame.toWorld(clump.support(d))[k], 1e-14 * clump.boundingRadius());
      EXPECT_NEAR(box.lo[k], frame.toWorld(clump.support(-d))[k], 1e-14 * clump.boundingRadius());
    }
  }
}

std::array<double, 3> middleOf(const TriangleMesh& mesh, const std::array<int, 3>& t) {
  const auto at = [&](int vertex) { return mesh.vertices[static_cast<std::size_t>(vertex)]; };
  const Vec3 sum = at(t[0]) + at(t[1]) + at(t[2]);
  return {sum.x(), sum.y(), sum.z()};
}

TEST(Clump, OuterSurfaceLeavesOutHiddenTrianglesAlone) {
  Random random(8);
  for (int n = 0; n < 20; ++n) {
    const Clump clump(randomSpheres(random, 15, 1e-3));
    const TriangleMesh whole = clump.surface(16), outer = clump.outerSurface(16);
    std::set<std::array<double, 3>> kept;
    for (const auto& t : outer.triangles) kept.insert(middleOf(outer, t));
    EXPECT_LT(outer.triangles.size(), whole.triangles.size());
    EXPECT_EQ(kept.size(), outer.triangles.size());
    std::size_t matched = 0;
    for (const auto& t : whole.triangles) {
      const bool isKept = kept.count(middleOf(whole, t)) > 0;
      matched += isKept;
      if (isKept) continue;
      // A single sphere holds all of it.
      const auto holds = [&](const ChildSphere& child) {
        return std::all_of(t.begin(), t.end(), [&](int vertex) {
          return (whole.vertices[static_cast<std::size_t>(vertex)] - child.centre).norm() < child.radius * (1 - 1e-12);
        });
      };
      EXPECT_TRUE(std::any_of(clump.children().begin(), clump.children().end(), holds));
    }
    EXPECT_EQ(matched, outer.triangles.size()) << "triangles that the closed surfaces lack";
  }
}

TEST(Clump, SurfacesOfSmallSpheresLieAsFarFromThemAsThatOfTheLargest) {
  const std::vector<ChildSphere> spheres = {{Vec3::Zero(), 4e-3}, {Vec3(10e-3, 0, 0), 1e-3}};
  const Clump clump(spheres);
  constexpr int resolution = 40;
  const TriangleMesh mesh = clump.surface(resolution);
  std::array<double, 2> furthest{};
  for (const auto& t : mesh.triangles) {
    const auto sum = middleOf(mesh, t);
    const Vec3 middle(sum[0] / 3, sum[1] / 3, sum[2] / 3);
    const auto at = [&](std::size_t k) {
      return (middle - clump.children()[k].centre).norm() / clump.children()[k].radius;
    };
    const std::size_t nearer = std::abs(at(0) - 1) < std::abs(at(1) - 1) ? 0 : 1;
    furthest[nearer] = std::max(furthest[nearer], (1 - at(nearer)) * clump.children()[nearer].radius);
  }
  EXPECT_NEAR(furthest[1] / furthest[0], 1, 0.1);
}

TEST(SphereTree, FindsExactlyTheSpheresThatAreNear) {
  Random random(23);
  for (const int count : {1, 2, 3, 17, 200}) {
    const std::vector<ChildSphere> spheres = randomSpheres(random, count, 1);
    const SphereTree tree(spheres);
    int looks = 0;
    for (int trial = 0; trial < 50; ++trial) {
      const Vec3 at = 3 * random.direction();
      const double reach = random.uniform(0, 1);
      std::set<std::int32_t> found, expected;
      const auto isNear = [&](const Vec3& centre, double radius) {
        ++looks;
        return (centre - at).norm() <= radius + reach;
      };
      tree.visitNear(isNear, [&](std::int32_t k) { EXPECT_TRUE(found.insert(k).second); });
      for (std::size_t k = 0; k < spheres.size(); ++k) {
        if ((spheres[k].centre - at).norm() <= spheres[k].radius + reach) expected.insert(static_cast<std::int32_t>(k));
      }
      EXPECT_EQ(found, expected);
    }
    if (count == 200) {
      EXPECT_LT(looks, 50 * 200);
    }
  }
}

TEST(Clump, EntersBulletAsACompoundOfSpheres) {
  Random random(29);
  const Clump clump(randomSpheres(random, 5, 1e-3));
  const BulletCompound compound = makeBulletCompound(clump, 1e3);
  ASSERT_EQ(compound->getNumChildShapes(), static_cast<int>(clump.children().size()));
  for (std::size_t k = 0; k < clump.children().size(); ++k) {
    const btVector3 place = compound->getChildTransform(static_cast<int>(k)).getOrigin();
    EXPECT_NEAR(place.x(), 1e3 * clump.children()[k].centre.x(), 1e-15);
  }
}

}  // namespace
}  // namespace granular
