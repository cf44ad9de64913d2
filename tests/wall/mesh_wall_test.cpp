#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/narrow/narrow.h"
#include "wall/wall_samples.h"

namespace granular {
namespace {

using namespace sample;

/// A box [-h, h]^3, 12 triangles. inwards: normals point into it (a room); else outwards (a block to lie on).
TriangleMesh box(const Vec3& h, bool inwards) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back(Vec3(k & 1 ? h.x() : -h.x(), k & 2 ? h.y() : -h.y(), k & 4 ? h.z() : -h.z()));
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    if (inwards) {
      mesh.triangles.push_back({q[0], q[2], q[1]});
      mesh.triangles.push_back({q[0], q[3], q[2]});
    } else {
      mesh.triangles.push_back({q[0], q[1], q[2]});
      mesh.triangles.push_back({q[0], q[2], q[3]});
    }
  }
  return mesh;
}

/// A rotation by the angle about a random horizontal axis.
Quat tiltBy(double angle, Random& random) {
  const double azimuth = random.uniform(0, 2 * pi);
  return rotationFromVector(angle * Vec3(std::cos(azimuth), std::sin(azimuth), 0));
}

void expectSamePlaneContact(const std::vector<WallTouch>& mesh, const std::vector<WallTouch>& plane, double size) {
  ASSERT_EQ(mesh.size(), plane.size());
  if (plane.empty()) return;
  EXPECT_NEAR(mesh[0].overlap, plane[0].overlap, 1e-12 * size);
  EXPECT_LT((mesh[0].normal - plane[0].normal).norm(), 1e-12);
  EXPECT_EQ(mesh[0].share, 1);
  EXPECT_EQ(mesh[0].spot, 0);
  EXPECT_LT((mesh[0].patch.point - plane[0].patch.point).norm(), 1e-9 * size);
  EXPECT_LT((mesh[0].patch.centre - plane[0].patch.centre).norm(), 1e-9 * size);
  EXPECT_NEAR(mesh[0].patch.area, plane[0].patch.area, 1e-9 * size * size);
  EXPECT_NEAR(mesh[0].patch.uu + mesh[0].patch.vv, plane[0].patch.uu + plane[0].patch.vv, 1e-9 * size * size);
}

TEST(MeshWall, CutsOfOnePlaneGiveThePlanesContacts) {
  Random random(1);
  const TriangleMesh cuts[] = {sheet(0.02, 1), sheet(0.02, 10), sheet(0.02, 10, true), sheet(0.02, 31, true)};
  for (bool level : {true, false})
    for (const TriangleMesh& cut : cuts) {
      const Frame pose = level ? Frame() : Frame(random.rotation().toRotationMatrix(), 0.01 * random.direction());
      const Vec3 up = pose.R.col(2);
      const auto mesh = makeMeshWall(placed(cut, pose), "sheet");
      const auto plane = makePlaneWall(pose.x, up);
      for (const auto& body : bodies())
        for (int trial = 0; trial < 40; ++trial) {
          const double overlap = body->size() * std::pow(10, random.uniform(-5, -1.5));
          // Every other body lies nearly flat: the azimuth of its tilt stays known to 1e-12.
          const Mat3 R =
              trial % 2 ? random.rotation().toRotationMatrix() : Mat3(pose.R * tiltBy(1e-4, random).toRotationMatrix());
          Frame frame(R, pose.toWorld(Vec3(random.uniform(-0.005, 0.005), random.uniform(-0.005, 0.005), 0)));
          frame = lowered(*body, frame, pose.x, up, overlap);
          for (PointRule rule :
               {PointRule::witness, PointRule::faceCentroid, PointRule::pressureCentroid, PointRule::patch})
            expectSamePlaneContact(touchesOf(*mesh, *body, frame, rule), touchesOf(*plane, *body, frame, rule),
                                   body->size());
          if (HasFailure()) FAIL() << body->describe() << " trial " << trial << ' ' << mesh->describe();
        }
    }
}

TEST(MeshWall, BodiesOnInternalVerticesAndEdgesFeelNothingOfThem) {
  // The same at positions that hit the mesh's own vertices and edges exactly.
  const auto mesh = makeMeshWall(sheet(0.02, 10), "sheet");
  const auto plane = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  for (const auto& body : bodies())
    for (double x : {0.0, 0.002, 0.001})
      for (double y : {0.0, 0.002, 0.001}) {
        const Frame frame = lowered(*body, Frame(Mat3::Identity(), Vec3(x, y, 0)), Vec3::Zero(), Vec3::UnitZ(), 1e-6);
        expectSamePlaneContact(touchesOf(*mesh, *body, frame), touchesOf(*plane, *body, frame), body->size());
      }
}

/// A block slides with friction over a wall: leapfrog with a spring-dashpot and the patch's point, enough to feel every
/// difference between two walls.
struct Slide {
  Vec3 x, v, w;
  Quat q;
};
Slide slideOver(const Wall& wall, const Shape& shape, Slide s, int steps) {
  const double dt = 1e-6, k = 1e4, density = 2500, eta = 0.5, mu = 0.2;
  const double mass = density * shape.massProperties().volume;
  const Vec3 inertia = density * shape.massProperties().inertia;
  std::vector<WallTouch> touches;
  for (int n = 0; n < steps; ++n) {
    const Frame frame(s.q.toRotationMatrix(), s.x);
    touches.clear();
    wall.touch(RuleOptions{}, shape, frame, touches);
    Vec3 force(0, 0, -9.81 * mass), torque = Vec3::Zero();
    for (const WallTouch& touch : touches) {
      const Vec3 arm = touch.patch.point - s.x;
      const Vec3 u = s.v + s.w.cross(arm);
      const double normal = touch.share * (k * touch.overlap + eta * u.dot(touch.normal));
      const Vec3 slip = u - touch.normal * touch.normal.dot(u);
      const Vec3 f = -normal * touch.normal - mu * normal * slip / (slip.norm() + 1e-6);
      force += f;
      torque += arm.cross(f);
    }
    s.v += dt / mass * force;
    s.x += dt * s.v;
    const Vec3 body = frame.unrotate(torque).cwiseQuotient(inertia);
    s.w += dt * frame.rotate(body);
    s.q = (rotationFromVector(dt * s.w) * s.q).normalized();
  }
  return s;
}

TEST(MeshWall, BlockSlidingOverAnyCutFollowsThePlanesTrajectory) {
  const Cuboid block(Vec3(0.0015, 0.0015, 0.0015));
  const auto plane = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  const Slide start{Vec3(-0.004, 0.001, 0.0015 - 1e-7), Vec3(0.4, 0.05, 0), Vec3(3, -2, 5), Quat::Identity()};
  const int steps = 12000;
  const Slide expected = slideOver(*plane, block, start, steps);
  EXPECT_GT((expected.x - start.x).norm(), 0.002);
  for (const TriangleMesh& cut : {sheet(0.02, 1), sheet(0.02, 10), sheet(0.02, 10, true)}) {
    const Slide got = slideOver(*makeMeshWall(cut, "sheet"), block, start, steps);
    EXPECT_LT((got.x - expected.x).norm(), 1e-9 * (expected.x - start.x).norm());
    EXPECT_LT((got.w - expected.w).norm(), 1e-9 * start.w.norm());
  }
}

TEST(MeshWall, RoomOfTwelveTrianglesHoldsLikeSixPlanes) {
  const Vec3 h(0.005, 0.004, 0.003);
  const auto room = makeMeshWall(box(h, true), "room");
  std::vector<std::unique_ptr<Wall>> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (double side : {-1.0, 1.0})
      planes.push_back(makePlaneWall(side * h[axis] * Vec3::Unit(axis), -side * Vec3::Unit(axis)));
  Random random(8);
  int several = 0;
  for (const auto& body : bodies())
    for (int trial = 0; trial < 300; ++trial) {
      // Pressed into a corner, an edge or a face of the room.
      Frame frame(random.rotation().toRotationMatrix(), Vec3::Zero());
      if (trial % 3 == 0) frame.R = Mat3::Identity();
      for (int axis = 0; axis < 3; ++axis) {
        if (random.uniform() < 0.3) continue;
        const double side = random.uniform() < 0.5 ? -1 : 1;
        frame = lowered(*body, frame, side * h[axis] * Vec3::Unit(axis), -side * Vec3::Unit(axis),
                        body->size() * std::pow(10, random.uniform(-5, -2)));
      }
      std::vector<WallTouch> expected;
      for (const auto& plane : planes) plane->touch(RuleOptions{}, *body, frame, expected);
      auto touches = touchesOf(*room, *body, frame);
      ASSERT_EQ(touches.size(), expected.size()) << body->describe() << " trial " << trial;
      several += touches.size() > 1;
      for (const WallTouch& plane : expected) {
        const auto same = std::find_if(touches.begin(), touches.end(),
                                       [&](const WallTouch& t) { return (t.normal - plane.normal).norm() < 1e-12; });
        ASSERT_NE(same, touches.end());
        EXPECT_EQ(same->share, 1);
        EXPECT_NEAR(same->overlap, plane.overlap, 1e-12 * body->size());
        EXPECT_LT((same->patch.point - plane.patch.point).norm(), 1e-9 * body->size());
        EXPECT_NEAR(same->patch.area, plane.patch.area, 1e-9 * plane.patch.area);
      }
    }
  EXPECT_GT(several, 300);
}

TEST(MeshWall, BoxOfTrianglesHoldsABodyLikeTheSolidBox) {
  // The whole force against that of the pair of convex bodies: faces, edges and corners, all by chance.
  const Vec3 h(0.004, 0.003, 0.002);
  const auto wall = makeMeshWall(box(h, false), "block");
  const Cuboid solid(h);
  Random random(5);
  const auto all = bodies();
  int count = 0, close = 0;
  for (int trial = 0; trial < 1200; ++trial) {
    const Shape& body = *all[random.below(all.size())];
    Frame frame(random.rotation().toRotationMatrix(), Vec3::Zero());
    const Vec3 direction = random.direction();
    const double wanted = body.size() * std::pow(10, random.uniform(-5, -2));
    const auto overlapAt = [&](double distance, Touch& touch) {
      frame.x = distance * direction;
      WarmCache cache;
      NarrowCounts counts;
      return findTouch(body, frame, solid, Frame(), true, cache, counts, touch) ? touch.overlap : 0.0;
    };
    double lo = 0, hi = 0.012;
    Touch touch;
    for (int k = 0; k < 40; ++k) (overlapAt(0.5 * (lo + hi), touch) > wanted ? lo : hi) = 0.5 * (lo + hi);
    const double overlap = overlapAt(lo, touch);
    if (!(overlap > 0 && overlap < 1.01 * wanted)) continue;
    ++count;
    const Wrench wrench = wrenchOf(touchesOf(*wall, body, frame), frame.x);
    const double error = (wrench.force + overlap * touch.normal).norm() / overlap;
    EXPECT_LT(error, 0.3) << body.describe() << " trial " << trial;
    close += error < 0.01;
  }
  // Where two parts share a contact, near the end of a ridge, the force may differ by part of itself.
  EXPECT_GT(count, 1000);
  EXPECT_GT(close, 0.99 * count);
}

/// Overlap of a body with ground made solid: a thin tetrahedron below each triangle.
double overlapWithGround(const TriangleMesh& ground, const Shape& body, const Frame& frame) {
  double largest = 0;
  for (const auto& t : ground.triangles) {
    std::array<Vec3, 4> points;
    for (std::size_t k = 0; k < 3; ++k) points[k] = ground.vertices[std::size_t(t[k])];
    const Vec3 middle = (points[0] + points[1] + points[2]) / 3;
    if ((middle - frame.x).norm() > body.boundingRadius() + 0.001) continue;
    points[3] = middle - Vec3(0, 0, 0.0005);
    Frame principal;
    const Polyhedron tetrahedron(points, &principal);
    double overlap = 0;
    if (overlaps(body, frame, tetrahedron, principal, &overlap)) largest = std::max(largest, overlap);
  }
  return largest;
}

TEST(MeshWall, BodiesTouchRoughGroundExactlyWhenTheyReachIt) {
  const TriangleMesh rough = ground(0.02, 25, 0.0004, 5);
  const auto wall = makeMeshWall(rough, "ground");
  Random random(31);
  int touching = 0;
  for (const auto& body : bodies())
    for (int trial = 0; trial < 40; ++trial) {
      const Mat3 R = random.rotation().toRotationMatrix();
      const Frame frame =
          lowered(*body, Frame(R, Vec3(random.uniform(-0.005, 0.005), random.uniform(-0.005, 0.005), 0)), Vec3::Zero(),
                  Vec3::UnitZ(), random.uniform(0, 0.0003));
      const double overlap = overlapWithGround(rough, *body, frame);
      const auto touches = touchesOf(*wall, *body, frame);
      double deepest = 0;
      for (const WallTouch& touch : touches) deepest = std::max(deepest, touch.overlap);
      if (overlap > 1e-9) {
        ++touching;
        EXPECT_FALSE(touches.empty()) << body->describe() << " trial " << trial << " overlap " << overlap;
        EXPECT_GT(wrenchOf(touches, frame.x).force.z(), 0);
        EXPECT_LT(deepest, 3e-4);
      } else {
        EXPECT_TRUE(touches.empty()) << body->describe() << " trial " << trial << " deepest " << deepest;
      }
    }
  EXPECT_GT(touching, 60);
}

TEST(MeshWall, SphereOnRoughGroundIsAsDeepAsItsNearestTriangle) {
  const TriangleMesh rough = ground(0.02, 25, 0.0004, 5);
  const auto wall = makeMeshWall(rough, "ground");
  const Sphere sphere(0.0015);
  Random random(32);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 centre(random.uniform(-0.005, 0.005), random.uniform(-0.005, 0.005), random.uniform(0.0012, 0.0015));
    const double overlap = -wall->clearance(centre, sphere.radius());
    const auto touches = touchesOf(*wall, sphere, Frame(Mat3::Identity(), centre));
    double deepest = 0;
    for (const WallTouch& touch : touches) deepest = std::max(deepest, touch.overlap);
    EXPECT_NEAR(deepest, std::max(0.0, overlap), 1e-15);
  }
}

TEST(MeshWall, SphereOnARidgeAndACornerTouchesAtTheNearestPoint) {
  // Against an outward box a sphere has one contact, with the nearest point of the box: clamp the centre to it.
  const Vec3 h(0.004, 0.003, 0.002);
  const auto block = makeMeshWall(box(h, false), "block");
  const Sphere sphere(0.0015);
  Random random(3);
  int ridges = 0, corners = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Vec3 c;
    for (int k = 0; k < 3; ++k) c[k] = random.uniform(-1, 1) * (h[k] + 0.0015);
    const Vec3 nearest = c.cwiseMax(-h).cwiseMin(h);
    const double distance = (c - nearest).norm();
    if (distance < 0.0013) continue;
    const auto touches = touchesOf(*block, sphere, Frame(Mat3::Identity(), c));
    if (distance >= 0.0015) {
      EXPECT_TRUE(touches.empty());
      continue;
    }
    ASSERT_EQ(touches.size(), 1u) << c.transpose();
    EXPECT_NEAR(touches[0].overlap, 0.0015 - distance, 1e-15);
    EXPECT_LT((touches[0].normal - (nearest - c) / distance).norm(), 1e-12);
    EXPECT_EQ(touches[0].share, 1);
    ridges += touches[0].spot % 3 == 1;
    corners += touches[0].spot % 3 == 2;
  }
  EXPECT_GT(ridges, 50);
  EXPECT_GT(corners, 5);
}

TEST(MeshWall, EllipsoidOnARidgeTouchesAtItsLeastDepth) {
  // Against the two-dimensional problem, solved by scanning normals.
  const auto block = makeMeshWall(box(Vec3(0.02, 0.004, 0.004), false), "block");
  const Ellipsoid egg(Vec3(0.001, 0.0015, 0.002));
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const Mat3 R = random.rotation().toRotationMatrix();
    const double angle = random.uniform(0.3, pi / 2 - 0.3);
    const Vec3 n(0, std::cos(angle), std::sin(angle)), ridge(0, 0.004, 0.004);
    const Frame frame = lowered(egg, Frame(R, Vec3(random.uniform(-0.01, 0.01), 0, 0)), ridge, n, 1e-5);
    // The lowest point straight above the ridge: shift the body so that it lies there.
    const Vec3 lowest = frame.toWorld(egg.support(frame.unrotate(-n)));
    const Vec3 across = Vec3::UnitX().cross(n);
    Frame placedFrame = frame;
    placedFrame.x -= across * across.dot(lowest - ridge);
    const auto touches = touchesOf(*block, egg, placedFrame);
    ASSERT_EQ(touches.size(), 1u);
    EXPECT_EQ(touches[0].spot % 3, 1);
    EXPECT_NEAR(touches[0].overlap, 1e-5, 1e-13);
    EXPECT_LT((touches[0].normal + n).norm(), 1e-5);
  }
}

TEST(MeshWall, CrossedEdgesTouchAlongTheirCommonNormal) {
  // A cube balanced on its edge across a ridge: the contact is the crossing.
  const auto block =
      makeMeshWall(placed(box(Vec3(0.02, 0.004, 0.004), false),
                          Frame(Eigen::AngleAxisd(pi / 4, Vec3::UnitX()).toRotationMatrix(), Vec3::Zero())),
                   "roof");
  const double top = 0.004 * std::sqrt(2.0);
  const Cuboid cube(Vec3(0.001, 0.001, 0.001));
  const Mat3 R =
      (Eigen::AngleAxisd(pi / 2 - 0.2, Vec3::UnitZ()) * Eigen::AngleAxisd(pi / 4, Vec3::UnitX())).toRotationMatrix();
  const Frame frame(R, Vec3(0.003, 0.0001, top + 0.001 * std::sqrt(2.0) - 1e-6));
  const auto touches = touchesOf(*block, cube, frame);
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_EQ(touches[0].spot % 3, 1);
  EXPECT_NEAR(touches[0].overlap, 1e-6, 1e-15);
  EXPECT_LT((touches[0].normal + Vec3::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(touches[0].patch.point.y(), 0, 1e-9);
}

TEST(MeshWall, MeshVertexPokesIntoAFace) {
  // A pyramid's apex under a block.
  TriangleMesh pyramid;
  pyramid.vertices = {Vec3(-0.01, -0.01, 0), Vec3(0.01, -0.01, 0), Vec3(0.01, 0.01, 0), Vec3(-0.01, 0.01, 0),
                      Vec3(0, 0, 0.01)};
  pyramid.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const auto wall = makeMeshWall(pyramid, "pyramid");
  Random random(6);
  for (const auto& body : bodies()) {
    if (body->kind() == ShapeKind::sphere || body->kind() == ShapeKind::ellipsoid) continue;
    // Its lowest face or side flat on the apex.
    const Mat3 tilt = rotationFromVector(0.3 * random.direction()).toRotationMatrix();
    Feature face;
    const Vec3 outward = body->supportFace(tilt * Vec3(0.1, 0.2, -1).normalized(), 0.3, face);
    if (face.count < 3) continue;
    const Mat3 R = Quat::FromTwoVectors(outward, Vec3(0.1, -0.2, -1).normalized()).toRotationMatrix();
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < face.count; ++k) middle += face[k] / face.count;
    const Vec3 n = R * outward;
    const Frame frame(R, Vec3(0, 0, 0.01) - R * middle + 1e-6 * n);
    const auto touches = touchesOf(*wall, *body, frame);
    ASSERT_EQ(touches.size(), 1u) << body->describe();
    EXPECT_EQ(touches[0].spot % 3, 2);
    EXPECT_NEAR(touches[0].overlap, 1e-6, 1e-13);
    EXPECT_LT((touches[0].normal - n).norm(), 1e-9);
  }
}

TEST(MeshWall, SpotsKeepTheirNamesWhenTheBodyMovesALittle) {
  const auto block = makeMeshWall(box(Vec3(0.004, 0.003, 0.002), false), "block");
  Random random(12);
  const auto all = bodies();
  int found = 0, moved = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Shape& body = *all[random.below(all.size())];
    const Quat q = random.rotation();
    const Vec3 toward = random.direction();
    Frame frame(q.toRotationMatrix(), 0.01 * toward);
    while (touchesOf(*block, body, frame).empty() && frame.x.norm() > 1e-3) frame.x -= 1e-5 * toward;
    const auto before = touchesOf(*block, body, frame);
    const auto after = touchesOf(
        *block, body, Frame((rotationFromVector(1e-10 * random.direction()) * q).toRotationMatrix(), frame.x));
    found += !before.empty();
    bool same = before.size() == after.size();
    for (std::size_t k = 0; same && k < before.size(); ++k) same = before[k].spot == after[k].spot;
    moved += !same;
    for (const WallTouch& touch : before) EXPECT_LT(touch.overlap, 1.1e-5) << body.describe();
  }
  EXPECT_GT(found, 1900);
  EXPECT_LE(moved, 2);
}

TEST(MeshWall, BlockPartlyOverATableEdgeIsHeldByTheTableAlone) {
  const auto table = makeMeshWall(box(Vec3(0.01, 0.01, 0.01), false), "table");
  const Cuboid block(Vec3(0.0015, 0.0015, 0.0015));
  for (double over : {-0.002, -0.001, 0.0, 0.0007, 0.0014}) {
    const Frame frame(Mat3::Identity(), Vec3(0.01 + over, 0.001, 0.0115 - 1e-6));
    const auto touches = touchesOf(*table, block, frame);
    ASSERT_EQ(touches.size(), 1u) << over;
    EXPECT_LT((touches[0].normal + Vec3::UnitZ()).norm(), 1e-12);
    EXPECT_NEAR(touches[0].overlap, 1e-6, 1e-15);
    const double lo = 0.01 + over - 0.0015, hi = std::min(0.01, lo + 0.003);
    EXPECT_NEAR(touches[0].patch.area, (hi - lo) * 0.003, 1e-12);
    EXPECT_NEAR(touches[0].patch.point.x(), 0.5 * (lo + hi), 1e-9);
  }
}

TEST(MeshWall, WrenchIsContinuousWhileABlockTipsOverATableEdge) {
  const auto table = makeMeshWall(box(Vec3(0.01, 0.01, 0.01), false), "table");
  const Cuboid block(Vec3(0.0015, 0.001, 0.0012));
  // Tips about the table's edge from inwards to outwards, kept at about one overlap above it.
  Wrench last;
  const int steps = 40000;
  double largest = 0;
  for (int k = 0; k <= steps; ++k) {
    const double tilt = -0.02 + 0.6 * k / steps;
    const Mat3 R = Eigen::AngleAxisd(tilt, Vec3(0.02, 1, 0.01).normalized()).toRotationMatrix();
    const Vec3 edge(0.01, 0, 0.01);
    const Frame frame(R, edge + R * Vec3(0.0002, 0, 0.0012 - 3e-6));
    const auto touches = touchesOf(*table, block, frame);
    ASSERT_FALSE(touches.empty()) << tilt;
    const Wrench wrench = wrenchOf(touches, edge);
    if (k > 0) {
      largest = std::max(largest, (wrench.force - last.force).norm());
      EXPECT_LT((wrench.force - last.force).norm(), 3e-7) << tilt;
    }
    last = wrench;
  }
  RecordProperty("largestForceStep", std::to_string(largest));
}

TEST(MeshWall, StepsAndThinWallsPushAwayFromTheNearestSideOnly) {
  const auto fin = makeMeshWall(box(Vec3(0.0002, 0.01, 0.01), false), "fin");
  const Cuboid block(Vec3(0.0015, 0.0015, 0.0015));
  // Across the top of the fin.
  auto touches = touchesOf(*fin, block, Frame(Mat3::Identity(), Vec3(0.0003, 0, 0.0115 - 1e-6)));
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_LT((touches[0].normal + Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(touches[0].overlap, 1e-6, 1e-15);
  // Beside it.
  touches = touchesOf(*fin, block, Frame(Mat3::Identity(), Vec3(0.0017 - 1e-6, 0, 0)));
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_LT((touches[0].normal + Vec3::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(touches[0].overlap, 1e-6, 1e-15);
}

TEST(MeshWall, NearlyCoplanarFacetsShareTheBlockByArea) {
  // Two halves of a sheet that differ by a hair in angle: the block must not feel where one ends.
  TriangleMesh mesh = sheet(0.02, 2);
  for (Vec3& v : mesh.vertices) v.z() = -1e-5 * std::abs(v.x());
  const auto wall = makeMeshWall(mesh, "hair");
  const Cuboid block(Vec3(0.0015, 0.0015, 0.0015));
  for (const PointRule rule : {PointRule::patch, PointRule::stiffPatch}) {
    // What the rule's rocking stiffness makes of that angle: times the second moment of the face per area.
    RuleOptions options;
    options.rule = rule;
    const double rocking = (rockingStiffness(options) - 1) * 9e-6 / 12 * 1e-5;
    for (double x : {-0.003, -0.0014, 0.0, 0.0004, 0.0014, 0.003}) {
      const Frame frame(Mat3::Identity(), Vec3(x, 0.0003, 0.0015 - 1e-5));
      const auto touches = touchesOf(*wall, block, frame, rule);
      const Wrench wrench = wrenchOf(touches, frame.x);
      EXPECT_NEAR(wrench.force.z(), 1e-5, 1e-7) << x;
      EXPECT_LT(wrench.moment.norm(), 1e-5 * 1.5e-5 + 1.01 * rocking) << x;
    }
  }
}

TEST(MeshWall, NearlyCoplanarFacetsAreOneFoundation) {
  TriangleMesh mesh = sheet(0.02, 2);
  for (Vec3& v : mesh.vertices) v.z() = -1e-5 * std::abs(v.x());
  const auto folded = makeMeshWall(mesh, "hair");
  const auto flat = makePlaneWall(Vec3::Zero(), Vec3::UnitZ());
  const Cuboid block(Vec3(0.0015, 0.0015, 0.0015));
  const auto forceOn = [&](const Wall& wall, const Frame& frame) {
    double sum = 0;
    for (const WallTouch& touch : touchesOf(wall, block, frame, PointRule::foundation))
      sum += touch.share * touch.patch.share * touch.patch.depth * touch.normal.z();
    return sum;
  };
  for (double x : {-0.003, -0.0014, -0.0007, 0.0, 0.0004, 0.0014, 0.003}) {
    const Frame frame(Mat3::Identity(), Vec3(x, 0.0003, 0.0015 - 1e-5));
    const double plane = forceOn(*flat, frame);
    // The surface lies deeper by the fold's 1e-5 times the distance, at most 4.5e-8 of 1e-5.
    EXPECT_NEAR(forceOn(*folded, frame) / plane, 1, 5e-3) << x;
  }
}

/// A funnel as a closed solid, sides of a cone with as many corners: concave ridges between them inside, convex ones
/// around the outlet at z = 0.
TriangleMesh funnel(int around, double narrow, double wide, double height, double wall) {
  TriangleMesh mesh;
  for (const auto& [radius, z] : {std::pair{narrow, 0.0}, std::pair{wide, height}, std::pair{wide + wall, height},
                                  std::pair{narrow + wall, 0.0}}) {
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * pi * k / around;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  for (int ring = 0; ring < 4; ++ring) {
    for (int k = 0; k < around; ++k) {
      const int next = (k + 1) % around, up = (ring + 1) % 4 * around;
      mesh.triangles.push_back({ring * around + k, up + k, ring * around + next});
      mesh.triangles.push_back({ring * around + next, up + k, up + next});
    }
  }
  return mesh;
}

TEST(MeshWall, SharesAtAFunnelsOutletAreNumbers) {
  // Deepest points beyond a concave ridge, near the rim: a facet over which nothing of the body lies has no part in it.
  const auto wall = makeMeshWall(funnel(24, 9e-3, 21e-3, 20e-3, 3e-3), "funnel");
  Random random(6);
  std::size_t touches = 0, several = 0;
  for (const auto& body : bodies()) {
    for (int trial = 0; trial < 3000; ++trial) {
      const double angle = random.uniform(0, 2 * pi), z = random.uniform(-1e-3, 2e-3);
      const Vec3 onWall((9e-3 + 0.6 * z) * std::cos(angle), (9e-3 + 0.6 * z) * std::sin(angle), z);
      const Vec3 inwards = Vec3(-std::cos(angle), -std::sin(angle), 0.6).normalized();
      const Quat q = random.rotation();
      // As deep as it takes to sink a little.
      const Vec3 lowest = q * body->support(q.conjugate() * -inwards);
      const double overlap = body->size() * std::pow(10, random.uniform(-4, -1.5));
      const Frame frame(q.toRotationMatrix(), onWall - lowest - overlap * inwards);
      std::vector<WallTouch> found;
      wall->touch({PointRule::patch}, *body, frame, found);
      touches += found.size();
      several += found.size() > 1;
      for (const WallTouch& touch : found) {
        EXPECT_GE(touch.share, 0);
        EXPECT_LE(touch.share, 1);
        EXPECT_TRUE(touch.patch.point.allFinite());
      }
    }
  }
  EXPECT_GT(touches, 5000u);
  EXPECT_GT(several, 500u);
}

TEST(MeshWall, ClearanceIsALowerBoundAndSidesAreTold) {
  const Vec3 h(0.004, 0.003, 0.002);
  const auto room = makeMeshWall(box(h, true), "room");
  const auto block = makeMeshWall(box(h, false), "block");
  Random random(2);
  for (int trial = 0; trial < 2000; ++trial) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = random.uniform(-1.5, 1.5) * h[k];
    const Vec3 nearest = p.cwiseMax(-h).cwiseMin(h);
    const bool inside = nearest == p;
    const double distance = inside ? (h - p.cwiseAbs()).minCoeff() : (p - nearest).norm();
    EXPECT_NEAR(room->clearance(p, 0.001), distance - 0.001, 1e-15);
    EXPECT_EQ(room->admits(p), inside);
    EXPECT_EQ(block->admits(p), !inside);
  }
}

TEST(MeshWall, CountsWhatItJoinsAndDrops) {
  TriangleMesh mesh = sheet(0.02, 2);
  const std::size_t shared = mesh.vertices.size();
  mesh.vertices.push_back(mesh.vertices[0]);
  mesh.triangles[0][0] = static_cast<int>(shared);
  mesh.triangles.push_back({0, 1, 1});
  const std::string text = makeMeshWall(mesh, "sheet.stl")->describe();
  EXPECT_NE(text.find("8 triangles in 1 facets, 4 ridges, 4 corners"), std::string::npos) << text;
  EXPECT_NE(text.find("1 vertices joined"), std::string::npos) << text;
  EXPECT_NE(text.find("1 triangles without area dropped"), std::string::npos) << text;
}

TEST(MeshWall, RefusesWhatIsNotAMesh) {
  TriangleMesh mesh;
  EXPECT_THROW(makeMeshWall(mesh, "empty.stl"), InputError);
  mesh = sheet(0.02, 1);
  mesh.triangles[0][1] = 17;
  EXPECT_THROW(makeMeshWall(mesh, "index.stl"), InputError);
  mesh = sheet(0.02, 1);
  mesh.vertices[2].x() = std::nan("");
  EXPECT_THROW(makeMeshWall(mesh, "nan.stl"), InputError);
  mesh = sheet(0.02, 1);
  for (Vec3& v : mesh.vertices) v = Vec3(v.x(), 0, 0);
  EXPECT_THROW(makeMeshWall(mesh, "line.stl"), InputError);
}

}  // namespace
}  // namespace granular
